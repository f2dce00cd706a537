//! A recording as a single HTML page that plays it without network access or other files.
//!
//! The page of a comparison has the pages of both runs in frames, which play and pause together.
//!
//! A page contains the recording's messages as JSON (`data.rs`) and a script that draws them. The
//! page of a run also contains its episodes, packed (`episodes.rs`). The script's functions that
//! need no page are in `timeline.js` and `words.js`; Node tests them (`*.test.mjs`).

mod data;
mod episodes;
mod shapes;

use std::path::PathBuf;

use minijinja::{Environment, Value, context};

use crate::error::Error;
use crate::page::escaped;
use crate::record::RecordingKind;
use crate::record::layout::SIDES;
use crate::record::reader::Recording;
use data::Data;

const COMPARISON: &str = include_str!("comparison.html");
const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = concat!(
    include_str!("timeline.js"),
    "\n",
    include_str!("words.js"),
    "\n",
    include_str!("drawing.js"),
    "\n",
    include_str!("player.js")
);

/// Returns a recording as an HTML page that plays it in a browser. A comparison plays both runs
/// side by side.
///
/// # Errors
/// If messages cannot be decoded or the world is missing.
pub fn page(recording: &Recording) -> Result<String, Error> {
    if recording.extent() != Some(RecordingKind::Comparison) {
        let data = Data::of(recording, None)?;
        return Ok(page_of(&data, data.heading()));
    }
    let [a, b] = SIDES.map(|side| Data::of(recording, Some(side)));
    let (a, b) = (a?, b?);
    let [title_a, title_b] =
        [("A", &a), ("B", &b)].map(|(side, data)| format!("{side}: {}", data.heading()));
    Ok(filled(
        COMPARISON,
        context! {
            title_a => escaped(&title_a),
            title_b => escaped(&title_b),
            a => escaped(&page_of(&a, &title_a)),
            b => escaped(&page_of(&b, &title_b)),
        },
    ))
}

/// Returns the page of a run: it plays the highlights, and the episodes with these recordings. Of
/// many or large episodes, it contains a part, which takes at most 2.5 MB.
///
/// # Errors
/// If messages cannot be decoded, the world is missing, or a recording cannot be read.
pub fn page_of_run(highlights: &Recording, episodes: &[PathBuf]) -> Result<String, Error> {
    let mut data = Data::of(highlights, None)?;
    data.packed_episodes = episodes::packed(episodes)?;
    Ok(page_of(&data, data.heading()))
}

/// Returns the page of one run.
fn page_of(data: &Data, title: &str) -> String {
    let json = serde_json::to_string(data).expect("the data have text keys and finite numbers");
    let values = context! {
        title => escaped(title),
        style => STYLE,
        data => inert(&json),
        script => SCRIPT,
    };
    filled(PAGE, values)
}

/// Returns a template with these values, which are not escaped.
fn filled(template: &str, values: Value) -> String {
    let page = Environment::new().render_str(template, values);
    // The newline at the end of a template is not part of it.
    page.expect("the templates beside this file are valid") + "\n"
}

/// Escapes every `<`, so that the JSON cannot end the element that contains it.
fn inert(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_look_like_placeholders_stay_as_they_are() {
        let values = context! { a => "{{ b }}", b => 2 };
        assert_eq!(filled("x {{a}} {{b}}\n", values), "x {{ b }} 2\n");
    }

    #[test]
    fn json_cannot_end_its_element() {
        let json = serde_json::to_string("</script><script>alert(1)").unwrap();
        let inert = inert(&json);
        assert!(!inert.contains('<'));
        let read: String = serde_json::from_str(&inert).unwrap();
        assert_eq!(read, "</script><script>alert(1)");
    }
}
