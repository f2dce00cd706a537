//! The facts of an episode, one type per fact. Each is written on a topic of its own.
//!
//! Drawings are made from these facts (`topics`), and readers of a recording read these facts.

mod contact;
mod curve;
mod decision;
mod episode;
mod learned;
mod localisation;
mod outcome;
mod pose;

pub use contact::Contact;
pub use curve::Curve;
pub use decision::Decision;
pub use episode::{Begin, End, Outlook};
pub use learned::Learned;
pub use localisation::Localisation;
pub use outcome::StepOutcome;
pub use pose::Pose;

use std::borrow::Cow;
use std::io;

use foxglove::Schema;
use foxglove::messages::{LaserScan, Log};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use schemars::transform::{RecursiveTransform, Transform};
use serde::Serialize;
use serde_json::ser::{CompactFormatter, Formatter, Serializer};

use super::topics::decimal;

/// A fact.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// An episode begins.
    Begin(Begin),
    /// The robot chooses an action.
    Decision(Decision),
    /// The outcome of the action is known.
    Outcome(StepOutcome),
    /// The robot is somewhere.
    Pose(Pose),
    /// The error of the estimated pose is known.
    Localisation(Localisation),
    /// The lidar measured.
    Scan(LaserScan),
    /// The robot hits a wall, or leaves it.
    Contact(Contact),
    /// The policy changed.
    Learned(Learned),
    /// The learning curve so far.
    Curve(Curve),
    /// An episode ends.
    End(End),
    /// Something is worth a line of text.
    Log(Log),
}

/// Writes a fact as JSON, with numbers rounded to three decimals.
pub fn write_json(to: &mut Vec<u8>, fact: &impl Serialize) {
    let mut json = Serializer::with_formatter(to, Rounding);
    fact.serialize(&mut json)
        .expect("our messages have text keys and a vector has room");
}

/// Writes compact JSON with rounded numbers.
struct Rounding;

impl Formatter for Rounding {
    fn write_f64<W: ?Sized + io::Write>(&mut self, to: &mut W, number: f64) -> io::Result<()> {
        CompactFormatter.write_f64(to, decimal(number))
    }
}

/// Returns the schema of a fact, in the form that viewers read: a flat object, each field with one
/// type and its meaning. Fields that can be absent are not required.
pub fn schema<F: JsonSchema>(name: &str) -> Schema {
    let settings = SchemaSettings::default().for_serialize().with(|settings| {
        settings.meta_schema = None;
        settings.inline_subschemas = true;
        settings.transforms.clear();
    });
    let mut schema = settings.into_generator().into_root_schema_for::<F>();
    schema.remove("title");
    RecursiveTransform(plain).transform(&mut schema);
    Schema {
        name: name.to_owned(),
        encoding: "jsonschema".to_owned(),
        data: Cow::Owned(schema.as_value().to_string().into_bytes()),
    }
}

/// Removes what viewers do not read: bounds of numbers, null as a second type, and the markup of
/// descriptions.
fn plain(schema: &mut schemars::Schema) {
    schema.remove("format");
    schema.remove("minimum");
    schema.remove("maximum");
    if let Some(serde_json::Value::String(text)) = schema.get_mut("description") {
        *text = text.replace('\n', " ").replace('\\', "");
    }
    if let Some(types) = schema.get_mut("type")
        && let Some(first) = types.get(0)
    {
        *types = first.clone();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_and_fields_without_a_value_are_omitted() {
        #[derive(Serialize)]
        struct Fact {
            x_m: f64,
            #[serde(skip_serializing_if = "Option::is_none")]
            y_m: Option<f64>,
            values: [Option<f64>; 2],
        }
        let fact = Fact {
            x_m: 0.123_46,
            y_m: None,
            values: [Some(-49.999_6), None],
        };
        let mut text = Vec::new();
        write_json(&mut text, &fact);
        assert_eq!(text, br#"{"x_m":0.123,"values":[-50.0,null]}"#);
    }

    #[test]
    fn a_field_has_one_type_and_only_those_always_present_are_required() {
        let schema = schema::<Contact>("xcscr.Contact");
        let schema: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
        assert_eq!(schema["properties"]["x_m"]["type"], "number");
        let required = serde_json::json!(["episode", "step", "touching"]);
        assert_eq!(schema["required"], required);
    }
}
