//! The fields of JSON messages.

use serde::{Serialize, Serializer};
use serde_json::Value;

use super::decimal;

/// The fields of a message, in the order in which they are written. Numbers are rounded, and fields
/// without a value are omitted.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::record) struct Fields(pub Vec<(&'static str, Value)>);

/// Creates the fields of a message from names and values.
macro_rules! fields {
    ($($name:ident: $value:expr),+ $(,)?) => {
        $crate::record::topics::fields::Fields(vec![
            $((stringify!($name), $crate::record::topics::fields::value(&$value))),+
        ])
    };
}
pub(super) use fields;

impl Serialize for Fields {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let known = self.0.iter().filter(|(_, value)| !value.is_null());
        to.collect_map(known.map(|(name, value)| (name, value)))
    }
}

/// Returns the value of a field.
pub(super) fn value(of: &impl Serialize) -> Value {
    let mut value = serde_json::to_value(of).expect("plain data becomes JSON");
    round(&mut value);
    value
}

/// Rounds a number, or all numbers of a list.
fn round(value: &mut Value) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(round),
        Value::Number(number) if number.is_f64() => {
            *value = number.as_f64().map(decimal).into();
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn fields_keep_their_order_and_those_without_a_value_are_omitted() {
        let message = fields! { b: 1, none: None::<f64>, a: [Some(0.123_46), None], t: true };
        let text = serde_json::to_string(&message).unwrap();
        assert_eq!(text, r#"{"b":1,"a":[0.123,null],"t":true}"#);
    }
}
