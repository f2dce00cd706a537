//! JSON schemas, as viewers read them: flat objects, each field with its meaning and unit.

use std::borrow::Cow;
use std::fmt::Write;

use foxglove::Schema;

/// The type of a field.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    Bool,
    /// A whole number from 0.
    Count,
    Number,
    Text,
    Numbers,
    /// A number that stands for a name. Viewers colour states by such numbers, in this order: blue,
    /// orange, yellow, green, cyan, purple; words get colours that mean nothing.
    Named(&'static [(u8, &'static str)]),
}

impl Kind {
    fn text(self) -> String {
        let text = match self {
            Self::Bool => r#""type":"boolean""#,
            Self::Count => r#""type":"integer""#,
            Self::Number => r#""type":"number""#,
            Self::Text => r#""type":"string""#,
            Self::Numbers => r#""type":"array","items":{"type":"number"}"#,
            Self::Named(names) => {
                let names = names.iter();
                let names = names.map(|(n, name)| format!(r#"{{"const":{n},"title":"{name}"}}"#));
                let names: Vec<String> = names.collect();
                return format!(r#""type":"integer","oneOf":[{}]"#, names.join(","));
            }
        };
        text.to_owned()
    }
}

/// The schema of an object whose fields are given by name, type and meaning.
pub(super) fn object(name: &str, fields: &[(&str, Kind, &str)]) -> Schema {
    let mut text = r#"{"type":"object","properties":{"#.to_owned();
    for (i, (field, kind, meaning)) in fields.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        let kind = kind.text();
        write!(
            text,
            r#"{comma}"{field}":{{{kind},"description":"{meaning}"}}"#
        )
        .expect("a string can be written to");
    }
    text.push_str("}}");
    Schema {
        name: name.to_owned(),
        encoding: "jsonschema".to_owned(),
        data: Cow::Owned(text.into_bytes()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_schema_is_json_with_a_field_for_each_entry() {
        let fields = [
            ("a", Kind::Bool, "yes or no"),
            ("b", Kind::Numbers, "metres"),
        ];
        let schema = object("xcscr.Test", &fields);
        let json: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
        assert_eq!(json["properties"]["a"]["type"], "boolean");
        assert_eq!(json["properties"]["b"]["items"]["type"], "number");
        assert_eq!(json["properties"]["b"]["description"], "metres");
    }
}
