//! Errors in JSON text: syntax errors and values of the wrong type.

use super::error::WorldError;
use super::source::Source;

/// An example of a world file, for help lines.
const EXAMPLE: &str = "{ \"name\": \"tiny\", \"rows\": [\"####\", \"#SG#\", \"####\"] }";

/// Returns the kind of JSON value that a text begins with, with its article; `None` if it is not
/// JSON.
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

/// Returns the error for a value of the wrong type.
pub fn wrong_type(source: Source<'_>, key: &str, raw: &str, expected: &str) -> WorldError {
    let found = kind(raw).unwrap_or("something else");
    source.fault(
        source.start_of(raw),
        format!("`{key}` is {found}, expected {expected}"),
        format!("a world looks like this: {EXAMPLE}"),
    )
}

/// Returns the error for a missing key.
pub fn missing_key(source: Source<'_>, key: &str) -> WorldError {
    let at = source.text.find('{').unwrap_or(0);
    source.fault(
        at,
        format!("the world has no `{key}`"),
        format!("a world looks like this: {EXAMPLE}"),
    )
}

/// Refuses an empty text, TOML, and JSON values other than objects.
pub fn refuse_other_kinds(source: Source<'_>) -> Result<(), WorldError> {
    let body = source.text.trim_ascii_start();
    let start = source.start_of(body);
    let help = format!("a world is one JSON object: {EXAMPLE}");
    if body.is_empty() {
        return Err(source.fault(0, "the file is empty", help));
    }
    match kind(body) {
        Some("an object") => Ok(()),
        _ if source.origin.ends_with(".toml") => {
            let help = "run a study file with `xcscr study run FILE`, and give a settings file after `--config`";
            let title = "a world is a JSON file";
            Err(source.fault(start, title, help))
        }
        None => Ok(()),
        Some(other) => Err(source.fault(
            start,
            format!("the file holds {other}, expected an object"),
            help,
        )),
    }
}

/// Returns the error for text after the end of the world.
pub fn text_after_end(source: Source<'_>, error: &serde_json::Error) -> WorldError {
    let at = offset(source.text, error);
    source.fault(
        at,
        "there is text after the end of the world",
        "remove everything after the closing `}`",
    )
}

/// Returns the error for a text that is not JSON.
pub fn syntax_fault(source: Source<'_>, error: &serde_json::Error) -> WorldError {
    let place = format!(" at line {} column {}", error.line(), error.column());
    let cause = error.to_string().replace(&place, "");
    let help = "the usual causes are missing quotes, commas and brackets";
    source.fault(
        offset(source.text, error),
        format!("the file is not valid JSON: {cause}"),
        help,
    )
}

/// Returns the byte that a JSON error points at.
fn offset(text: &str, error: &serde_json::Error) -> usize {
    let lines = text
        .split_inclusive('\n')
        .take(error.line().saturating_sub(1));
    lines.map(str::len).sum::<usize>() + error.column().saturating_sub(1)
}
