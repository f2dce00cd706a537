//! JSON schemas in the form that viewers read: flat objects, each field with its type, its meaning
//! and its unit. Each message has a file in this folder. Numbers that stand for names are listed
//! under `oneOf`: viewers colour states by such numbers, in this order: blue, orange, yellow, green,
//! cyan, purple. Colours of words carry no meaning.

use std::borrow::Cow;

use foxglove::Schema;
use serde_json::Value;

use crate::record::json::json_tree;

/// Returns the schema of a file.
pub(super) fn schema(name: &str, file: &str) -> Schema {
    let text: String = file.lines().map(str::trim).collect();
    Schema {
        name: name.to_owned(),
        encoding: "jsonschema".to_owned(),
        data: Cow::Owned(text.into_bytes()),
    }
}

/// Returns the tree of a schema; null for other schemas than JSON.
pub(super) fn tree(schema: &Schema) -> Value {
    json_tree(&schema.data).unwrap_or_default()
}
