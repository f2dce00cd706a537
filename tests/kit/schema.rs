//! Validates messages against the JSON schemas of their channels. Supports the keywords that
//! recordings use, and fails on any other.

use serde_json::Value;

/// Returns the first part of a value that the schema does not allow, with its position.
pub fn fault(schema: &Value, value: &Value) -> Option<String> {
    fault_at("", schema, value)
}

fn fault_at(place: &str, schema: &Value, value: &Value) -> Option<String> {
    let words = schema.as_object().expect("a schema is an object");
    let faults = words.iter().filter_map(|(word, wanted)| match &**word {
        "type" => (!is_of(wanted, value)).then(|| format!("{place}: {value} is not {wanted}")),
        "properties" => fault_of_fields(place, wanted, value),
        "items" => {
            let mut items = value.as_array()?.iter().enumerate();
            items.find_map(|(n, item)| fault_at(&format!("{place}[{n}]"), wanted, item))
        }
        "required" => {
            let mut names = wanted.as_array().unwrap().iter().filter_map(Value::as_str);
            let fields = value.as_object()?;
            let missing = names.find(|name| !fields.contains_key(*name))?;
            Some(format!("{place}.{missing} is missing"))
        }
        "description" => None,
        unknown => panic!("unsupported schema keyword `{unknown}`"),
    });
    faults.collect::<Vec<_>>().into_iter().next()
}

/// Returns true if a value has the type that a schema names.
fn is_of(wanted: &Value, value: &Value) -> bool {
    match wanted.as_str().expect("a type is one word") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        unknown => panic!("unsupported type `{unknown}`"),
    }
}

/// Returns a fault of the fields. A field that is not in the schema is a fault, too.
fn fault_of_fields(place: &str, known: &Value, value: &Value) -> Option<String> {
    value.as_object()?.iter().find_map(|(field, value)| {
        let place = format!("{place}.{field}");
        match known.get(field) {
            Some(schema) => fault_at(&place, schema, value),
            None => Some(format!("{place} is not in the schema")),
        }
    })
}
