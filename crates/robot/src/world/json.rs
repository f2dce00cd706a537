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
        source.span(raw),
        format!("`{key}` is {found}, expected {expected}"),
        format!("expected {expected}"),
        format!("a world looks like this: {EXAMPLE}"),
    )
}

/// Returns the error for a missing key.
pub fn missing_key(source: Source<'_>, key: &str) -> WorldError {
    let at = source.text.find('{').unwrap_or(0);
    source.fault(
        at..at + 1,
        format!("the world has no `{key}`"),
        format!("`{key}` is missing in this object"),
        format!("a world looks like this: {EXAMPLE}"),
    )
}

/// Refuses an empty text, TOML, and JSON values other than objects.
pub fn refuse_other_kinds(source: Source<'_>) -> Result<(), WorldError> {
    let body = source.text.trim_ascii_start();
    let start = source.span(body).start;
    let help = format!("a world is one JSON object: {EXAMPLE}");
    if body.is_empty() {
        return Err(source.fault(0..0, "the file is empty", "expected a world here", help));
    }
    match kind(body) {
        Some("an object") => Ok(()),
        _ if source.origin.ends_with(".toml") => {
            let help = "run a study file with `xcscr study run FILE`, and give a settings file after `--config`";
            let title = "a world is a JSON file";
            Err(source.fault(start..start + 1, title, "this is TOML", help))
        }
        None => Ok(()),
        Some(other) => Err(source.fault(
            start..start + 1,
            format!("the file holds {other}, expected an object"),
            "expected `{`",
            help,
        )),
    }
}

/// Returns the error for text after the end of the world.
pub fn text_after_end(source: Source<'_>, error: &serde_json::Error) -> WorldError {
    let at = offset(source.text, error);
    source.fault(
        at..at + 1,
        "there is text after the end of the world",
        "the world ended before this",
        "remove everything after the closing `}`",
    )
}

/// Returns the error for a text that is not JSON.
pub fn syntax_fault(source: Source<'_>, error: &serde_json::Error) -> WorldError {
    let (text, at) = (source.text, offset(source.text, error));
    let place = format!(" at line {} column {}", error.line(), error.column());
    let cause = error.to_string().replace(&place, "");
    let (at, title, label, help) = if error.is_eof() {
        let help = "close every `\"`, `[` and `{`";
        let title = "the file ends in the middle of the world";
        (at, title, "the file ends here", help)
    } else if let Some(at) = control_character(text, at + 2) {
        let help = "remove it; a line break within a text is written `\\n`";
        let title = "there is a control character in a string";
        (at, title, "not allowed here", help)
    } else if let Some(comma) = trailing_comma(text, at) {
        let title = "there is a comma before a closing bracket";
        (comma, title, "nothing follows", "remove the comma")
    } else if is_not_finite(text, at) {
        let help = "write a finite number, such as 1.0";
        let title = "JSON allows only finite numbers";
        (at, title, "not a number", help)
    } else {
        let help =
            "see json.org for the rules; the usual causes are missing quotes, commas and brackets";
        (at, "the file is not valid JSON", cause.as_str(), help)
    };
    source.fault(at..at + 1, title, label, help)
}

/// Returns the first control character in a string among the first bytes, which must be valid JSON.
fn control_character(text: &str, first: usize) -> Option<usize> {
    let mut bytes = text.bytes().enumerate().take(first);
    let mut in_string = false;
    while let Some((at, byte)) = bytes.next() {
        match byte {
            b'"' => in_string = !in_string,
            b'\\' if in_string => {
                bytes.next();
            }
            0..b' ' if in_string => return Some(at),
            _ => {}
        }
    }
    None
}

/// Returns the comma before the closing bracket at this byte.
fn trailing_comma(text: &str, at: usize) -> Option<usize> {
    let is_bracket = matches!(text.as_bytes().get(at), Some(b']' | b'}'));
    let before = text.get(..at).filter(|_| is_bracket)?;
    Some(before.trim_ascii_end().strip_suffix(',')?.len())
}

/// Returns the byte that a JSON error points at.
fn offset(text: &str, error: &serde_json::Error) -> usize {
    let lines = text
        .split_inclusive('\n')
        .take(error.line().saturating_sub(1));
    lines.map(str::len).sum::<usize>() + error.column().saturating_sub(1)
}

/// Returns true if the text here is a non-finite number as other languages write it (NaN, inf).
fn is_not_finite(text: &str, at: usize) -> bool {
    let rest = text.get(at..).unwrap_or_default();
    let rest = rest.strip_prefix('-').unwrap_or(rest);
    ["nan", "inf"].iter().any(|word| {
        rest.get(..3)
            .is_some_and(|start| start.eq_ignore_ascii_case(word))
    })
}
