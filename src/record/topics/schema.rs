//! JSON schemas in the form that viewers read: flat objects, each field with its type, and on
//! demand with its meaning and unit.

use std::borrow::Cow;

use foxglove::Schema;
use serde_json::Value;

use crate::record::json::json_tree;

/// Numbers and the names they stand for.
type Names = &'static [(u8, &'static str)];

/// The type of a field.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Bool,
    Count,
    Number,
    Text,
    Numbers,
    Named(Names),
}

impl Kind {
    /// Returns true if a field of this type can have this value. An unknown number in a list is
    /// null.
    fn admits(self, value: &Value) -> bool {
        match self {
            Self::Bool => value.is_boolean(),
            Self::Count => value.is_u64(),
            Self::Named(names) => names
                .iter()
                .any(|(n, _)| value.as_u64() == Some((*n).into())),
            Self::Number => value.is_number(),
            Self::Text => value.is_string(),
            Self::Numbers => value
                .as_array()
                .is_some_and(|list| list.iter().all(|one| one.is_number() || one.is_null())),
        }
    }

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

/// A message of our own: its fields by name, type and meaning.
#[derive(Debug)]
pub(in crate::record) struct Object {
    name: &'static str,
    fields: Vec<(&'static str, Kind, &'static str)>,
}

impl Object {
    /// Creates a message without fields.
    pub fn new(name: &'static str) -> Self {
        let fields = Vec::new();
        Self { name, fields }
    }

    fn with(mut self, field: &'static str, kind: Kind, meaning: &'static str) -> Self {
        self.fields.push((field, kind, meaning));
        self
    }

    pub fn bool(self, field: &'static str, meaning: &'static str) -> Self {
        self.with(field, Kind::Bool, meaning)
    }

    /// Adds a non-negative integer.
    pub fn count(self, field: &'static str, meaning: &'static str) -> Self {
        self.with(field, Kind::Count, meaning)
    }

    pub fn number(self, field: &'static str, meaning: &'static str) -> Self {
        self.with(field, Kind::Number, meaning)
    }

    pub fn numbers(self, field: &'static str, meaning: &'static str) -> Self {
        self.with(field, Kind::Numbers, meaning)
    }

    pub fn text(self, field: &'static str, meaning: &'static str) -> Self {
        self.with(field, Kind::Text, meaning)
    }

    /// Adds a number that stands for a name. Viewers colour states by such numbers, in this order:
    /// blue, orange, yellow, green, cyan, purple. Colours of words carry no meaning.
    pub fn named(self, field: &'static str, names: Names, meaning: &'static str) -> Self {
        self.with(field, Kind::Named(names), meaning)
    }

    /// Returns the first fault of a message: it must be an object with known fields of the right
    /// types.
    pub fn fault(&self, data: &[u8]) -> Option<String> {
        let Some(message) = json_tree(data) else {
            return Some("is not JSON, or too large for a message of xcscr".to_owned());
        };
        let Some(fields) = message.as_object() else {
            return Some("is not a JSON object".to_owned());
        };
        fields.iter().find_map(|(name, value)| {
            let known = self.fields.iter().find(|(field, ..)| field == name);
            match known {
                None => Some(format!("has an unknown field `{name}`")),
                Some((_, kind, _)) if !kind.admits(value) => Some(format!(
                    "has a field `{name}` whose type differs from the schema"
                )),
                Some(_) => None,
            }
        })
    }

    /// Returns the schema; `explained` adds the meaning of each field.
    pub fn schema(&self, explained: bool) -> Schema {
        let field = |(field, kind, meaning): &(&str, Kind, &str)| {
            let kind = kind.text();
            let meaning = match explained {
                true => format!(r#","description":"{meaning}""#),
                false => String::new(),
            };
            format!(r#""{field}":{{{kind}{meaning}}}"#)
        };
        let fields: Vec<String> = self.fields.iter().map(field).collect();
        let text = format!(
            r#"{{"type":"object","properties":{{{}}}}}"#,
            fields.join(",")
        );
        Schema {
            name: self.name.to_owned(),
            encoding: "jsonschema".to_owned(),
            data: Cow::Owned(text.into_bytes()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_schema_is_json_with_a_field_for_each_entry() {
        let object = Object::new("xcscr.Test").bool("a", "yes or no");
        let object = object.numbers("b", "metres");
        let [brief, explained] = [false, true].map(|explained| -> serde_json::Value {
            serde_json::from_slice(&object.schema(explained).data).unwrap()
        });
        for json in [&brief, &explained] {
            assert_eq!(json["properties"]["a"]["type"], "boolean");
            assert_eq!(json["properties"]["b"]["items"]["type"], "number");
        }
        assert_eq!(explained["properties"]["b"]["description"], "metres");
        assert!(brief["properties"]["b"]["description"].is_null());
    }
}
