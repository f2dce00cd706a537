//! The keys of a world file.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};

use super::error::Fault;
use super::origin::Origin;
use super::rows::MAX_SIDE;
use super::solid;

/// An example of a world file, for help lines.
const EXAMPLE: &str = "{ \"name\": \"tiny\", \"rows\": [\"####\", \"#SG#\", \"####\"] }";

/// The keys of a world file, before they are checked.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Keys {
    pub name: Option<String>,
    #[serde(default = "one_metre")]
    pub cell_size_m: f64,
    #[serde(default = "four")]
    pub moves: f64,
    #[serde(default)]
    pub wrap: bool,
    #[serde(default)]
    pub origin: Origin,
    pub rows: Strings,
    pub floor: Option<Strings>,
    pub solid: Option<solid::Keys>,
}

fn one_metre() -> f64 {
    1.0
}

fn four() -> f64 {
    4.0
}

impl Keys {
    /// Reads the text of a world file.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        let help = || format!("a world is one JSON object: {EXAMPLE}");
        match text.trim_ascii_start().bytes().next() {
            None => Err(Fault::new("the file is empty", help())),
            // A list would be read as the values of the keys, in order.
            Some(b'[') => Err(Fault::new(
                "the file holds an array, expected an object",
                help(),
            )),
            _ => serde_json::from_str(text).map_err(|error| match error.is_data() {
                true => Fault::at_json(&error, format!("a world looks like this: {EXAMPLE}")),
                false => {
                    let help = "the usual causes are missing quotes, commas and brackets";
                    Fault::at_json(&error, help)
                }
            }),
        }
    }
}

/// A list of texts, of which there are at most as many as a world has rows.
#[derive(Debug)]
pub(super) struct Strings(pub Vec<String>);

impl<'de> Deserialize<'de> for Strings {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct StringsVisitor;

        impl<'de> Visitor<'de> for StringsVisitor {
            type Value = Strings;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an array of strings")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Strings, A::Error> {
                let mut strings = Vec::new();
                while let Some(string) = seq.next_element()? {
                    if strings.len() == MAX_SIDE {
                        let most =
                            format!("a world has at most {MAX_SIDE} columns and {MAX_SIDE} rows");
                        return Err(A::Error::custom(most));
                    }
                    strings.push(string);
                }
                Ok(Strings(strings))
            }
        }

        deserializer.deserialize_seq(StringsVisitor)
    }
}
