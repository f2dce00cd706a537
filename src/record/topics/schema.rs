//! JSON schemas in the form that viewers read: flat objects, each field with its type, its meaning
//! and its unit. Each message has a file in this folder. Numbers that stand for names are listed
//! under `oneOf`: viewers colour states by such numbers, in this order: blue, orange, yellow, green,
//! cyan, purple. Colours of words carry no meaning.

use std::borrow::Cow;

use foxglove::Schema;
use serde_json::Value;

use crate::record::json::json_tree;

/// Begins the meaning of a field.
const MEANING: &str = r#","description":""#;
/// Begins the list of the fields that every message has, at the end of a schema.
const REQUIRED: &str = r#","required":["#;

/// Returns the schema of a file; `explained` keeps the meaning of each field, and which fields are
/// required.
pub(super) fn schema(name: &str, file: &str, explained: bool) -> Schema {
    let text: String = file.lines().map(str::trim).collect();
    let text = match explained {
        true => text,
        false => brief(&text),
    };
    Schema {
        name: name.to_owned(),
        encoding: "jsonschema".to_owned(),
        data: Cow::Owned(text.into_bytes()),
    }
}

/// Removes the meanings, which contain no quotation marks, and the list of required fields.
fn brief(text: &str) -> String {
    let fields = text.split_once(REQUIRED);
    let text = fields.map_or(text.to_owned(), |(fields, _)| format!("{fields}}}"));
    let mut parts = text.split(MEANING);
    let first = parts.next().into_iter();
    let rest = parts.filter_map(|part| Some(part.split_once('"')?.1));
    first.chain(rest).collect()
}

/// Returns the tree of a schema; null for other schemas than JSON.
pub(super) fn tree(schema: &Schema) -> Value {
    json_tree(&schema.data).unwrap_or_default()
}

/// Returns the first fault of a message against its schema: it must be an object with known fields of
/// the right types, and with all required ones.
pub(super) fn fault(schema: &Value, data: &[u8]) -> Option<String> {
    let Some(message) = json_tree(data) else {
        return Some("is not JSON, or too large for a message of xcscr".to_owned());
    };
    let Some(fields) = message.as_object() else {
        return Some("is not a JSON object".to_owned());
    };
    let wrong = |(name, value): (&String, &Value)| match schema["properties"].get(name) {
        None => Some(format!("has an unknown field `{name}`")),
        Some(field) if !admits(field, value) => Some(format!(
            "has a field `{name}` whose type differs from the schema"
        )),
        Some(_) => None,
    };
    let required = schema["required"].as_array().into_iter().flatten();
    let mut required = required.filter_map(Value::as_str);
    let missing = required.find(|name| !fields.contains_key(*name));
    let missing = || Some(format!("has no field `{}`", missing?));
    fields.iter().find_map(wrong).or_else(missing)
}

/// Returns true if a field can have this value. An unknown number in a list is null.
fn admits(field: &Value, value: &Value) -> bool {
    let names = field["oneOf"].as_array();
    let is_named = |names: &Vec<Value>| names.iter().any(|name| name["const"] == *value);
    match field["type"].as_str() {
        Some("boolean") => value.is_boolean(),
        Some("integer") => value.is_u64() && names.is_none_or(is_named),
        Some("number") => value.is_number(),
        Some("string") => value.is_string(),
        _ => value
            .as_array()
            .is_some_and(|list| list.iter().all(|one| one.is_number() || one.is_null())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_brief_schema_has_the_types_of_all_fields_only() {
        let file = include_str!("episode.json");
        let [brief, explained] = [false, true].map(|explained| -> Value {
            serde_json::from_slice(&schema("xcscr.Test", file, explained).data).unwrap()
        });
        let mut without = explained.clone();
        without.as_object_mut().unwrap().remove("required").unwrap();
        for field in without["properties"].as_object_mut().unwrap().values_mut() {
            let meaning = field.as_object_mut().unwrap().remove("description");
            assert!(meaning.is_some_and(|meaning| meaning.is_string()));
        }
        assert_eq!(brief, without);
    }
}
