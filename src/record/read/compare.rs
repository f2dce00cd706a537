//! Comparison of two recordings.

use std::fmt;
use std::path::Path;

use serde_json::Value;

use super::reader::{Message, Recording};
use crate::record::error::RecordError;

/// The first difference between two recordings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// The time of the difference, in nanoseconds of simulation time; 0 outside of messages.
    pub time_ns: u64,
    /// The topic, or `attachment NAME`, `metadata` or `file` outside of messages.
    pub topic: String,
    /// The path of the field in a JSON message; `byte N` in other messages.
    pub field: String,
    /// The value in the first recording.
    pub first: String,
    /// The value in the second recording.
    pub second: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.time_ns as f64 / 1e9;
        let Self {
            topic,
            field,
            first,
            second,
            ..
        } = self;
        write!(
            f,
            "at {seconds} s, {topic}, {field}: {first} against {second}"
        )
    }
}

/// Compares two recordings: facts of the run first, then message by message, then the bytes.
/// Returns `None` if the bytes are identical.
///
/// # Errors
/// If either recording is invalid.
pub fn compare(first: &[u8], second: &[u8]) -> Result<Option<Difference>, RecordError> {
    if first == second {
        return Ok(None);
    }
    let a = Recording::from_bytes(Path::new("the first"), first.to_vec())?;
    let b = Recording::from_bytes(Path::new("the second"), second.to_vec())?;
    if let Some(difference) = facts(&a, &b) {
        return Ok(Some(difference));
    }
    Ok(Some(match messages(&a, &b)? {
        Some(difference) => difference,
        None => bytes(0, "file".to_owned(), first, second),
    }))
}

fn facts(a: &Recording, b: &Recording) -> Option<Difference> {
    if a.metadata("run") != b.metadata("run") {
        let show = |one: &Recording| format!("{:?}", one.metadata("run"));
        return Some(other("metadata", "run", show(a), show(b)));
    }
    let names = |one: &Recording| {
        let names: Vec<_> = one.attachments().iter().map(|x| x.name.clone()).collect();
        names.join(" ")
    };
    if names(a) != names(b) {
        return Some(other("attachments", "names", names(a), names(b)));
    }
    let pairs = a.attachments().iter().zip(b.attachments());
    let mut unequal = pairs.filter(|(x, y)| x != y);
    unequal.next().map(|(x, y)| {
        let topic = format!("attachment {}", x.name);
        bytes(0, topic, &x.data, &y.data)
    })
}

fn messages(a: &Recording, b: &Recording) -> Result<Option<Difference>, RecordError> {
    let (mut left, mut right) = (a.messages(), b.messages());
    loop {
        match (left.next().transpose()?, right.next().transpose()?) {
            (None, None) => return Ok(None),
            (Some(x), Some(y)) if x.time_ns == y.time_ns && x.topic() == y.topic() => {
                if x.data != y.data {
                    return Ok(Some(within(&x, &y)));
                }
            }
            (x, y) => return Ok(Some(missing(x.as_ref(), y.as_ref()))),
        }
    }
}

/// Returns the difference if one recording lacks a message or has it at another time.
fn missing(x: Option<&Message>, y: Option<&Message>) -> Difference {
    let show = |one: Option<&Message>| match one {
        Some(message) => format!("{} at {} ns", message.topic(), message.time_ns),
        None => "the end".to_owned(),
    };
    let earliest = [x, y]
        .into_iter()
        .flatten()
        .min_by_key(|message| message.time_ns);
    Difference {
        time_ns: earliest.map_or(0, |message| message.time_ns),
        topic: earliest.map_or_else(String::new, |message| message.topic().to_owned()),
        field: "next message".to_owned(),
        first: show(x),
        second: show(y),
    }
}

/// Returns the difference between two messages on the same topic at the same time.
fn within(x: &Message, y: &Message) -> Difference {
    let found = x.json().zip(y.json());
    let found = found.and_then(|(a, b)| field(&a, &b, String::new()));
    match found {
        Some((field, first, second)) => Difference {
            time_ns: x.time_ns,
            topic: x.topic().to_owned(),
            field,
            first,
            second,
        },
        None => bytes(x.time_ns, x.topic().to_owned(), &x.data, &y.data),
    }
}

/// Returns the path of the first field that differs, with both values.
fn field(a: &Value, b: &Value, path: String) -> Option<(String, String, String)> {
    match (a, b) {
        (Value::Object(x), Value::Object(y)) => {
            let keys = x.keys().chain(y.keys().filter(|key| !x.contains_key(*key)));
            keys.into_iter().find_map(|key| {
                let path = if path.is_empty() {
                    key.clone()
                } else {
                    format!("{path}.{key}")
                };
                field(
                    x.get(key).unwrap_or(&Value::Null),
                    y.get(key).unwrap_or(&Value::Null),
                    path,
                )
            })
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            let mut pairs = x.iter().zip(y).enumerate();
            pairs.find_map(|(i, (x, y))| field(x, y, format!("{path}[{i}]")))
        }
        _ => (a != b).then(|| (path, a.to_string(), b.to_string())),
    }
}

fn bytes(time_ns: u64, topic: String, a: &[u8], b: &[u8]) -> Difference {
    let same = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let show = |bytes: &[u8]| match bytes.get(same) {
        Some(byte) => format!("{byte:#04x}"),
        None => "the end".to_owned(),
    };
    Difference {
        time_ns,
        topic,
        field: format!("byte {same}"),
        first: show(a),
        second: show(b),
    }
}

fn other(topic: &str, field: &str, first: String, second: String) -> Difference {
    Difference {
        time_ns: 0,
        topic: topic.to_owned(),
        field: field.to_owned(),
        first,
        second,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_first_field_that_differs_is_named_by_its_path() {
        let a = json!({"a": 1, "value": [1.0, 2.0]});
        let b = json!({"a": 1, "value": [1.0, 2.5]});
        let found = field(&a, &b, String::new()).unwrap();
        assert_eq!(found, ("value[1]".into(), "2.0".into(), "2.5".into()));
        assert_eq!(field(&a, &a, String::new()), None);
    }

    #[test]
    fn a_field_that_one_side_lacks_differs() {
        let found = field(&json!({}), &json!({"b": true}), String::new()).unwrap();
        assert_eq!(found, ("b".into(), "null".into(), "true".into()));
    }

    #[test]
    fn bytes_that_end_early_differ_at_their_end() {
        let found = bytes(7, "/tf".into(), &[1, 2], &[1, 2, 3]);
        assert_eq!(
            (found.field.as_str(), found.first.as_str()),
            ("byte 2", "the end")
        );
    }
}
