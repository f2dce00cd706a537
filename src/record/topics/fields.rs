//! The fields of JSON messages.

use serde::{Serialize, Serializer};
use serde_json::Value;

use super::decimal;

/// The fields of a message, in the order in which they are written. Numbers are rounded, and fields
/// without a value are omitted.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::record) struct Fields(pub Vec<(&'static str, Value)>);

/// Creates the fields of a message from the file of its schema, names and values. A name that the
/// schema lacks is a compile error.
macro_rules! fields {
    ($schema:literal: $($name:ident: $value:expr),+ $(,)?) => {{
        const SCHEMA: &str = include_str!($schema);
        $(const {
            assert!(
                $crate::record::topics::fields::declares(SCHEMA, concat!("\n  \"", stringify!($name), "\":")),
                concat!($schema, " has no field ", stringify!($name)),
            );
        })+
        $crate::record::topics::fields::Fields(vec![$((stringify!($name), $crate::record::topics::fields::value(&$value))),+])
    }};
}
pub(super) use fields;

impl Serialize for Fields {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let known = self.0.iter().filter(|(_, value)| !value.is_null());
        to.collect_map(known.map(|(name, value)| (name, value)))
    }
}

/// Returns true if a schema contains the beginning of the line that declares a field.
pub(super) const fn declares(schema: &str, line: &str) -> bool {
    let (schema, line) = (schema.as_bytes(), line.as_bytes());
    let mut at = 0;
    while at + line.len() <= schema.len() {
        let mut same = 0;
        while same < line.len() && schema[at + same] == line[same] {
            same += 1;
        }
        if same == line.len() {
            return true;
        }
        at += 1;
    }
    false
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
    use super::declares;

    #[test]
    fn fields_keep_their_order_and_those_without_a_value_are_omitted() {
        let unknown = None::<f64>;
        let message = fields! { "contact.json":
            touching: true, x_m: unknown, y_m: [Some(0.123_46), None], step: 1
        };
        let text = serde_json::to_string(&message).unwrap();
        assert_eq!(text, r#"{"touching":true,"y_m":[0.123,null],"step":1}"#);
    }

    #[test]
    fn a_schema_declares_its_fields_only() {
        let schema = include_str!("contact.json");
        assert!(declares(schema, "\n  \"x_m\":"));
        assert!(!declares(schema, "\n  \"m\":"), "control");
        assert!(!declares(schema, "\n  \"speed\":"), "control");
    }
}
