//! Where recordings lie, and what run they come from.

use std::fs;
use std::path::{Path, PathBuf};

use xcscr::record::RecordMode;
use xcscr::record::reader::Recording;
use xcscr::trial::Plan;
use xcscr::world::Maze;

use super::failure::{Exit, Failure};

/// The recordings that a path names: itself, or those of a run folder.
pub fn recordings(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let unreadable =
        |cause| Failure::new(Exit::Io, format!("cannot read {}: {cause}", path.display()));
    let entries: Result<Vec<_>, _> = fs::read_dir(path).map_err(unreadable)?.collect();
    let mut files: Vec<PathBuf> = entries
        .map_err(unreadable)?
        .iter()
        .map(|e| e.path())
        .collect();
    // Unfinished recordings are kept in the list, so that nobody takes the rest for the whole.
    let is_recording = |file: &PathBuf| {
        let name = file.to_string_lossy();
        name.ends_with(".mcap") || name.ends_with(".mcap.part")
    };
    files.retain(is_recording);
    // Episodes by their numbers, of which those beyond 9999 have more digits.
    files.sort_by_cached_key(|file| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let number: String = name.chars().filter(char::is_ascii_digit).collect();
        (number.is_empty(), number.len(), name.into_owned())
    });
    if files.is_empty() {
        let message = format!("{} holds no recordings (.mcap)", path.display());
        return Err(Failure::new(Exit::Missing, message));
    }
    Ok(files)
}

/// Where a recording says that it comes from.
pub struct Source {
    /// How to run it again.
    pub plan: Plan,
    /// Which episodes were kept.
    pub mode: RecordMode,
    /// The episode that it shows; `None` for the whole run.
    pub episode: Option<u32>,
    /// The whole file.
    pub bytes: Vec<u8>,
}

impl Source {
    /// Reads a recording.
    pub fn of(file: &Path) -> Result<Self, Failure> {
        let recording = Recording::open(file)?;
        let damaged = |what: String| {
            let message = format!("{}: {what}", file.display());
            Failure::new(Exit::BadData, message)
        };
        let attached = |name: &str| {
            let missing = || damaged(format!("the attachment {name} is missing"));
            recording.attachment(name).ok_or_else(missing)
        };
        let config = serde_json::from_slice(attached("config.json")?)
            .map_err(|fault| damaged(format!("config.json: {fault}")))?;
        let maze = Maze::from_json(attached("world.json")?, "world.json")?;
        let metadata = recording.metadata("run");
        let entry = |key: &str| metadata.and_then(|m| m.get(key)).map_or("", String::as_str);
        let mode = entry("record")
            .parse()
            .map_err(|fault| damaged(format!("{fault}")))?;
        Ok(Self {
            plan: Plan { maze, config },
            mode,
            episode: entry("episode").parse().ok(),
            bytes: recording.bytes().to_vec(),
        })
    }
}
