//! From JSON text to the raw values of the known keys, each still with its place in the text.

use std::fmt;

use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

use super::error::WorldError;
use super::source::{Source, quoted};

/// The keys of a world file.
const KEYS: [&str; 5] = ["name", "cell_size_m", "moves", "wrap", "rows"];

/// What a world file looks like, for help lines.
const EXAMPLE: &str = "{ \"name\": \"tiny\", \"rows\": [\"####\", \"#SG#\", \"####\"] }";

/// The values of a world file as they stand in the text, not yet read.
#[derive(Default)]
pub struct Document<'a> {
    values: [Option<&'a str>; KEYS.len()],
    fault: Option<KeyFault<'a>>,
}

/// A key that should not be where it is.
struct KeyFault<'a> {
    key: String,
    /// The value after the key.
    value: &'a str,
    /// The value after the first occurrence of the same key.
    first: Option<&'a str>,
}

impl<'a> Document<'a> {
    /// Splits the text into values; refuses what is no JSON object, and unknown or repeated keys.
    pub fn parse(source: Source<'a>) -> Result<Self, WorldError> {
        refuse_other_kinds(source)?;
        let mut json = serde_json::Deserializer::from_str(source.text);
        let document = Self::deserialize(&mut json)
            .and_then(|document| json.end().map(|()| document))
            .map_err(|error| syntax_fault(source, &error))?;
        match &document.fault {
            Some(fault) => Err(fault.report(source)),
            None => Ok(document),
        }
    }

    /// The raw value of one of the known keys.
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
                    first,
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

/// The first elements of a JSON array, raw.
pub struct Elements<'a, const MOST: usize> {
    /// At most `MOST` of them.
    pub first: Vec<&'a str>,
    /// How many elements there are in all.
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

/// What kind of JSON value a text begins with, with its article; `None` for no JSON at all.
pub fn kind(raw: &str) -> Option<&'static str> {
    match raw.bytes().next()? {
        b'{' => Some("an object"),
        b'[' => Some("an array"),
        b'"' => Some("a string"),
        b't' | b'f' => Some("a boolean"),
        b'n' => Some("null"),
        b'-' | b'0'..=b'9' => Some("a number"),
        _ => None,
    }
}

/// The error for a value of the wrong type.
pub fn wrong_type(source: Source<'_>, key: &str, raw: &str, expected: &str) -> WorldError {
    let found = kind(raw).unwrap_or("something else");
    source.fault(
        source.span(raw),
        format!("`{key}` is {found}, expected {expected}"),
        format!("expected {expected}"),
        format!("a world looks like this: {EXAMPLE}"),
    )
}

/// The error for a key that is not there.
pub fn missing_key(source: Source<'_>, key: &str) -> WorldError {
    let at = source.text.find('{').unwrap_or(0);
    source.fault(
        at..at + 1,
        format!("the world has no `{key}`"),
        format!("`{key}` is missing in this object"),
        format!("a world looks like this: {EXAMPLE}"),
    )
}

fn refuse_other_kinds(source: Source<'_>) -> Result<(), WorldError> {
    let body = source.text.trim_ascii_start();
    let start = source.span(body).start;
    let help = format!("a world is one JSON object: {EXAMPLE}");
    if body.is_empty() {
        return Err(source.fault(0..0, "the file is empty", "expected a world here", help));
    }
    match kind(body) {
        None | Some("an object") => Ok(()),
        Some(other) => Err(source.fault(
            start..start + 1,
            format!("the file holds {other}, expected an object"),
            "expected `{`",
            help,
        )),
    }
}

impl KeyFault<'_> {
    fn report(&self, source: Source<'_>) -> WorldError {
        let key = quoted(&self.key);
        let here = key_span(source, self.value, &self.key);
        if let Some(first) = self.first {
            let places = vec![
                source.place(here, "again here"),
                source.place(key_span(source, first, &self.key), "first here"),
            ];
            let help = format!("keep one {key} and remove the other");
            return source.fault_at(places, format!("the key {key} is repeated"), help);
        }
        let title = format!("the key {key} is unknown");
        source.fault(here, title, "no such key in a world", suggestion(&self.key))
    }
}

/// "Did you mean" for a key, or the list of keys.
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

/// The span of the key, quotes included, before a raw value.
fn key_span(source: Source<'_>, value: &str, key: &str) -> std::ops::Range<usize> {
    let before = source.text[..source.span(value).start].trim_end();
    let end = before.trim_end_matches(':').trim_end().len();
    let literal = format!("\"{key}\"");
    match source.text[..end].ends_with(&literal) {
        true => end - literal.len()..end,
        // A key with escape sequences: its closing quote will do.
        false => end.saturating_sub(1)..end,
    }
}

/// The error for a text that is no JSON.
fn syntax_fault(source: Source<'_>, error: &serde_json::Error) -> WorldError {
    let at = offset(source.text, error);
    let text = error.to_string();
    let cause = text.split(" at line ").next().unwrap_or_default();
    if cause.starts_with("control character") {
        // Here the column is that of the last good character.
        let help = "remove it; a line break within a text is written `\\n`";
        let title = "there is a control character in a string";
        return source.fault(at + 1..at + 2, title, "not allowed here", help);
    }
    let (title, label, help) = match cause {
        "trailing characters" => (
            "there is text after the end of the world",
            "the world ended before this",
            "remove everything after the closing `}`",
        ),
        "trailing comma" => (
            "there is a comma before a closing bracket",
            "nothing follows the comma",
            "remove the comma",
        ),
        _ if error.is_eof() => (
            "the file ends in the middle of the world",
            "the file ends here",
            "add what is missing: every `\"`, `[` and `{` needs its partner",
        ),
        _ if is_not_finite(source.text, at) => (
            "JSON knows only finite numbers",
            "not a number",
            "write a finite number, such as 1.0",
        ),
        _ => (
            "the file is no valid JSON",
            cause,
            "see json.org for the rules; the usual causes are missing quotes, commas and brackets",
        ),
    };
    source.fault(at..at + 1, title, label, help)
}

/// The byte that a JSON error points at.
fn offset(text: &str, error: &serde_json::Error) -> usize {
    let lines = text
        .split_inclusive('\n')
        .take(error.line().saturating_sub(1));
    lines.map(str::len).sum::<usize>() + error.column().saturating_sub(1)
}

/// Does one of the words that other languages write for such numbers stand here?
fn is_not_finite(text: &str, at: usize) -> bool {
    let rest = text.get(at..).unwrap_or_default();
    let rest = rest.strip_prefix('-').unwrap_or(rest);
    ["nan", "inf"].iter().any(|word| {
        rest.get(..3)
            .is_some_and(|start| start.eq_ignore_ascii_case(word))
    })
}
