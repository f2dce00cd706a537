//! Splits JSON text into the raw values of the known keys, each with its location in the text.
//!
//! Raw values are slices of the text, so their places need no bookkeeping.

use std::fmt;

use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

use super::error::WorldError;
use super::json::{refuse_other_kinds, syntax_fault, text_after_end};
use super::source::{Source, quoted};

/// The keys of a world file.
const KEYS: [&str; 8] = [
    "name",
    "cell_size_m",
    "moves",
    "wrap",
    "origin",
    "rows",
    "floor",
    "solid",
];

/// The values of a world file as raw text.
#[derive(Default)]
pub struct Document<'a> {
    values: [Option<&'a str>; KEYS.len()],
    fault: Option<KeyFault<'a>>,
}

/// An unknown or repeated key.
struct KeyFault<'a> {
    key: String,
    /// The value after the key.
    value: &'a str,
    is_repeated: bool,
}

impl<'a> Document<'a> {
    /// Splits the text into values. Refuses text that is no JSON object, and unknown or repeated
    /// keys.
    pub fn parse(source: Source<'a>) -> Result<Self, WorldError> {
        refuse_other_kinds(source)?;
        let mut json = serde_json::Deserializer::from_str(source.text);
        let document =
            Self::deserialize(&mut json).map_err(|error| syntax_fault(source, &error))?;
        json.end().map_err(|error| text_after_end(source, &error))?;
        match &document.fault {
            Some(fault) => Err(fault.report(source)),
            None => Ok(document),
        }
    }

    /// Returns the raw value of one of the known keys.
    pub fn value(&self, key: &str) -> Option<&'a str> {
        let index = KEYS.iter().position(|&known| known == key)?;
        self.values[index]
    }

    fn note(&mut self, key: &str, value: &'a str) {
        if self.fault.is_some() {
            return;
        }
        let slot = KEYS.iter().position(|&known| known == key);
        let first = slot.and_then(|slot| self.values[slot]);
        match slot {
            Some(slot) if first.is_none() => self.values[slot] = Some(value),
            _ => {
                self.fault = Some(KeyFault {
                    key: key.to_owned(),
                    value,
                    is_repeated: first.is_some(),
                });
            }
        }
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for Document<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(DocumentVisitor)
    }
}

struct DocumentVisitor;

impl<'de> Visitor<'de> for DocumentVisitor {
    type Value = Document<'de>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Document<'de>, A::Error> {
        let mut document = Document::default();
        while let Some(key) = map.next_key::<String>()? {
            let value: &RawValue = map.next_value()?;
            document.note(&key, value.get());
        }
        Ok(document)
    }
}

/// The first elements of a JSON array, as raw text.
pub struct Elements<'a, const MOST: usize> {
    /// At most `MOST` elements.
    pub first: Vec<&'a str>,
    /// The total number of elements.
    pub count: usize,
}

impl<'de: 'a, 'a, const MOST: usize> Deserialize<'de> for Elements<'a, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(ElementsVisitor)
    }
}

struct ElementsVisitor<const MOST: usize>;

impl<'de, const MOST: usize> Visitor<'de> for ElementsVisitor<MOST> {
    type Value = Elements<'de, MOST>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut first = Vec::new();
        while first.len() < MOST {
            match seq.next_element::<&RawValue>()? {
                Some(element) => first.push(element.get()),
                None => break,
            }
        }
        let mut count = first.len();
        while count >= MOST && seq.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        Ok(Elements { first, count })
    }
}

impl KeyFault<'_> {
    fn report(&self, source: Source<'_>) -> WorldError {
        let key = quoted(&self.key);
        let at = source.start_of(self.value);
        if self.is_repeated {
            let help = format!("keep one {key} and remove the other");
            return source.fault(at, format!("the key {key} is repeated"), help);
        }
        let title = format!("the key {key} is unknown");
        source.fault(at, title, suggestion(&self.key))
    }
}

/// Returns a "did you mean" for a key, or the list of keys.
fn suggestion(key: &str) -> String {
    let short: String = key.chars().take(32).collect();
    KEYS.into_iter()
        .map(|known| (known, strsim::jaro_winkler(known, &short.to_lowercase())))
        .filter(|&(_, likeness)| likeness > 0.75)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or_else(
            || format!("the keys of a world are `{}`", KEYS.join("`, `")),
            |(known, _)| format!("did you mean `{known}`?"),
        )
}
