//! `xcscr replay --html`: a page that plays a recording.

use std::io::Write;
use std::path::{Path, PathBuf};

use xcscr::record::Extent;
use xcscr::record::player;
use xcscr::record::reader::Recording;

use super::{browser, highlights};
use crate::commands::failure::{Exit, Failure};
use crate::commands::output::OutputFile;
use crate::commands::terminal::file_link;

/// Writes the page of a recording, or of the highlights of a run, to `file`, and prints its address.
pub fn write(
    recordings: &[PathBuf],
    (file, force): (&Path, bool),
    open: bool,
    out: &mut impl Write,
) -> Result<(), Failure> {
    let [path] = recordings else {
        let message = "`--html` takes one recording, or one run".to_owned();
        return Err(Failure::new(Exit::Usage, message));
    };
    let output = OutputFile::free(file, force)?;
    output.write(page_of(path)?.as_bytes())?;
    let link = file_link(file);
    writeln!(out, "{link}")?;
    if open {
        browser::open(&link);
    }
    Ok(())
}

fn page_of(path: &Path) -> Result<String, Failure> {
    if !path.is_dir() {
        return Ok(player::page(&Recording::open(path)?)?);
    }
    let recordings = crate::commands::source::recordings(path)?;
    let with_highlights = highlights::write_missing(&[path.to_owned()], recordings)?;
    let is_highlights = |file: &&PathBuf| file.ends_with(Extent::Highlights.file_name());
    let found = with_highlights.files.iter().find(is_highlights);
    let file = found.ok_or_else(|| {
        let path = path.display();
        let message = format!("{path} has no highlights; give one of its recordings (ep-....mcap)");
        Failure::new(Exit::Missing, message)
    })?;
    Ok(player::page(&Recording::open(file)?)?)
}
