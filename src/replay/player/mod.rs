//! A recording as a single HTML page that plays it without network access or other files.
//!
//! A page contains the recording's facts as JSON (`data.rs`, read by `reading.rs`) and a script that draws them. The
//! page of a run also contains its episodes, packed (`episodes.rs`), and names the most instructive ones (`chapters.rs`). The script's functions that
//! need no page are in `timeline.mjs`, `words.mjs` and `colours.mjs`; Node tests them (`*.test.mjs`).

mod chapters;
mod data;
mod episodes;
mod reading;
mod world;

use std::path::PathBuf;

use minijinja::{Environment, Value, context};

use crate::Error;
use crate::page::escaped;
use crate::record::event;
use crate::record::reader::Recording;
use data::Data;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// The modules of the script, each after those that it imports.
const MODULES: [&str; 5] = [
    include_str!("timeline.mjs"),
    include_str!("words.mjs"),
    include_str!("colours.mjs"),
    include_str!("drawing.mjs"),
    include_str!("player.mjs"),
];

/// Returns a recording as an HTML page that plays it in a browser.
///
/// # Errors
/// If messages cannot be decoded or the world is missing.
pub fn page(recording: &Recording) -> Result<String, Error> {
    Ok(page_of(&Data::of(recording)?))
}

/// Returns the page of a run: it plays a drive of the learned policy, and the episodes with these
/// recordings. `run` is the recording of the run. Of many or large episodes, the page contains a
/// part, which takes at most 2.5 MB; the chapters are preferred.
///
/// # Errors
/// If messages cannot be decoded, the world is missing, or a recording cannot be read.
pub fn page_of_run(
    drive: &Recording,
    run: &Recording,
    episodes: &[PathBuf],
) -> Result<String, Error> {
    let chapters = chapters::chapters(run, &reading::maze(run)?)?;
    let mut data = Data::of_policy(drive)?;
    data.set_run(chapters, episodes)?;
    Ok(page_of(&data))
}

/// Returns the page of one run.
fn page_of(data: &Data) -> String {
    let mut json = Vec::new();
    event::write_json(&mut json, data);
    let json = String::from_utf8_lossy(&json);
    let values = context! {
        title => escaped(data.heading()),
        style => STYLE,
        data => inert(&json),
        script => bundled(&MODULES),
    };
    filled(PAGE, values)
}

/// Returns a template with these values, which are not escaped.
fn filled(template: &str, values: Value) -> String {
    let page = Environment::new().render_str(template, values);
    // The newline at the end of a template is not part of it.
    page.expect("the templates beside this file are valid") + "\n"
}

/// Joins modules to one, which needs no other file: imports and exports are left out.
fn bundled(modules: &[&str]) -> String {
    let lines = modules.iter().flat_map(|module| module.lines());
    let lines = lines.filter(|line| !line.starts_with("import "));
    let lines = lines.map(|line| line.strip_prefix("export ").unwrap_or(line));
    lines.flat_map(|line| [line, "\n"]).collect()
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
