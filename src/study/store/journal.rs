//! A journal of finished trials on disk: one trial per line, each line with its checksum.
//!
//! A journal has one writer, which only appends. Only complete lines count, because a killed process
//! can leave an incomplete last line. A bad line before the last is damage, and the journal is
//! rejected.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::record::{Figures, TrialRecord};
use crate::disk;
use crate::study::error;
use crate::{Error, ErrorKind};

/// The folder of the journals in the folder of a study.
pub const JOURNALS: &str = "journals";
/// The end of the name of a journal.
const SUFFIX: &str = ".journal";
/// The maximum length of a line, which is more than a record needs.
const MOST_LINE_BYTES: u64 = 1 << 20;

/// The first words of a journal.
const MAGIC: &str = "xcscr study journal";
/// The version of the line format.
const FORMAT: u32 = 5;

/// A finished trial in a journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// The id of its arm.
    pub arm: String,
    /// Its number within the arm, from 1.
    pub trial: usize,
    pub result: Result<Figures, String>,
}

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    arms: Vec<String>,
    /// Trials per arm.
    trials: usize,
}

impl Journal {
    /// Starts a journal in a new file in the folder of a study with these arms, and so many trials of each.
    pub fn begin(study: &Path, arms: &[String], trials: usize) -> Result<Self, Error> {
        let folder = study.join(JOURNALS);
        let mut builder = tempfile::Builder::new();
        builder.prefix("").suffix(SUFFIX).rand_bytes(10);
        // Temporary files are readable only by their owner; make this one as readable as other
        // files.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let made = builder.tempfile_in(&folder).map_err(error::io(&folder))?;
        let kept = made.keep();
        let (file, path) = kept.map_err(|fault| error::io(&folder)(fault.error))?;
        let mut journal = Self {
            path,
            file,
            arms: arms.to_vec(),
            trials,
        };
        let begun = journal.file.write_all(header().as_bytes());
        begun
            .and_then(|()| journal.file.sync_all())
            .map_err(error::io(&journal.path))?;
        Ok(journal)
    }

    /// Appends records.
    pub fn write(&mut self, records: &[TrialRecord]) -> Result<(), Error> {
        let line = |record: &TrialRecord| {
            line(&Line {
                arm: self.arms[record.trial / self.trials].clone(),
                trial: record.trial % self.trials + 1,
                result: record.result.clone(),
            })
        };
        let lines: String = records.iter().map(line).collect();
        self.file
            .write_all(lines.as_bytes())
            .map_err(error::io(&self.path))
    }

    /// Flushes the appended records to the disk.
    pub fn sync(&mut self) -> Result<(), Error> {
        self.file.sync_data().map_err(error::io(&self.path))
    }
}

/// Returns the journals in the folder of a study, sorted.
///
/// # Errors
/// When the folder of the journals is a link, because journals are written and removed there, or cannot be read.
pub fn all(study: &Path) -> Result<Vec<PathBuf>, Error> {
    let folder = study.join(JOURNALS);
    if folder.is_symlink() {
        return Err(ErrorKind::CannotCreate.error(format!(
            "{} is a link: replace it with the folder that it points to",
            folder.display()
        )));
    }
    let io = &error::io(&folder);
    let mut found = Vec::new();
    for entry in folder.read_dir().map_err(io)? {
        let name = entry.map_err(io)?.file_name();
        // Ignore other files, such as those of a network file system.
        if name.to_str().is_some_and(|name| name.ends_with(SUFFIX)) {
            found.push(folder.join(name));
        }
    }
    found.sort();
    Ok(found)
}

/// Checks that a file begins like a journal before it is removed. A user may give a file such a name, and a killed
/// process leaves a beginning of the first line.
pub fn require_journal(path: &Path) -> Result<(), Error> {
    let file = disk::open(path).map_err(error::io(path))?;
    let mut first = Vec::new();
    let read = file.take(MAGIC.len() as u64).read_to_end(&mut first);
    read.map_err(error::io(path))?;
    if MAGIC.as_bytes().starts_with(&first) {
        Ok(())
    } else {
        Err(ErrorKind::CannotCreate.error(format!(
            "{} is not a journal of xcscr; nothing was removed: move the file to another folder, then \
             run the command again",
            path.display()
        )))
    }
}

/// Calls `each` with the lines of a journal, in their order. An incomplete last line is ignored.
///
/// # Errors
/// When the first line is that of no journal, or a line before the last is bad; or an error of `each`.
pub fn read(path: &Path, each: &mut dyn FnMut(Line) -> Result<(), Error>) -> Result<(), Error> {
    let file = disk::open(path).map_err(error::io(path))?;
    let mut lines = BufReader::new(file);
    let mut next = || next_line(&mut lines).map_err(error::io(path));
    let first = next()?;
    if first != header().as_bytes() {
        // A half-written header is the beginning of a new journal.
        return if header().as_bytes().starts_with(&first) {
            Ok(())
        } else {
            Err(error::damaged(path)(foreign(&first)))
        };
    }
    for number in 2.. {
        let line = next()?;
        match parse(&line) {
            _ if line.is_empty() => break,
            Some(line) => each(line)?,
            None if next()?.is_empty() => break,
            None => return Err(error::damaged(path)(damaged_line(number))),
        }
    }
    Ok(())
}

/// Returns the next line with its line end, if it has one. Empty at the end of the file.
fn next_line(lines: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut line = Vec::new();
    lines.take(MOST_LINE_BYTES).read_until(b'\n', &mut line)?;
    Ok(line)
}

fn damaged_line(number: u64) -> String {
    format!(
        "line {number} is damaged, and is not the last line: delete it, then run its trial again with \
         `xcscr study run` (planned study: `xcscr study task`)"
    )
}

fn header() -> String {
    format!("{MAGIC} {FORMAT}\n")
}

/// Returns the checksum of a text. It is compared as text: a number has several spellings, and a flipped bit may
/// turn one into another.
fn sum(text: &str) -> String {
    format!("{:08x}", crc32fast::hash(text.as_bytes()))
}

/// Describes what is wrong with the first line of a journal.
fn foreign(bytes: &[u8]) -> String {
    let first = bytes.split(|byte| *byte == b'\n').next().unwrap_or(&[]);
    let words = std::str::from_utf8(first).ok();
    let version = words.and_then(|text| text.strip_prefix(MAGIC)?.trim().split(',').next());
    match version.and_then(|version| version.parse::<u32>().ok()) {
        Some(found) if found != FORMAT => format!(
            "it has format {found}, and this version reads format {FORMAT}; run the study again, \
             in another folder"
        ),
        _ => "it is not the journal of a study".to_owned(),
    }
}

fn line(line: &Line) -> String {
    let json = serde_json::to_string(line).expect("plain data becomes JSON");
    format!("{} {json}\n", sum(&json))
}

fn parse(line: &[u8]) -> Option<Line> {
    let line = line.strip_suffix(b"\n")?;
    let (found, json) = std::str::from_utf8(line).ok()?.split_once(' ')?;
    let intact = found == sum(json);
    intact.then(|| serde_json::from_str(json).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use std::fs::{self, OpenOptions};

    use super::*;

    fn contents(path: &Path) -> Result<Vec<usize>, Error> {
        let mut trials = Vec::new();
        read(path, &mut |line| {
            trials.push(line.trial);
            Ok(())
        })?;
        Ok(trials)
    }

    fn records(count: usize) -> Vec<TrialRecord> {
        let record = |trial| TrialRecord {
            trial,
            result: Err(format!("fault {trial}")),
        };
        (0..count).map(record).collect()
    }

    /// A folder with the journal of an arm.
    fn written(records: &[TrialRecord]) -> (tempfile::TempDir, PathBuf, String) {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join(JOURNALS)).unwrap();
        let mut journal = Journal::begin(folder.path(), &["arm".to_owned()], 3).unwrap();
        journal.write(records).unwrap();
        journal.sync().unwrap();
        assert_eq!(all(folder.path()).unwrap(), [journal.path.clone()]);
        let text = fs::read_to_string(&journal.path).unwrap();
        (folder, journal.path, text)
    }

    #[test]
    fn a_journal_cut_to_any_length_keeps_complete_lines() {
        let (_folder, path, full) = written(&records(3));
        let mut found = 0;
        for length in 0..=full.len() {
            fs::write(&path, &full[..length]).unwrap();
            let trials = contents(&path).unwrap();
            let ends = full[..length].matches('\n').count();
            assert_eq!(
                trials,
                [1, 2, 3][..ends.saturating_sub(1)],
                "cut to {length}"
            );
            found = trials.len();
        }
        assert_eq!(found, 3);
    }

    #[test]
    fn a_flipped_bit_is_damage_except_in_the_last_line_which_may_be_incomplete() {
        let (_folder, path, sound) = written(&records(3));
        let sound = sound.into_bytes();
        let last = 1 + sound[..sound.len() - 1]
            .iter()
            .rposition(|&byte| byte == b'\n')
            .unwrap();
        for at in 0..8 * sound.len() {
            let mut bytes = sound.clone();
            bytes[at / 8] ^= 1 << (at % 8);
            fs::write(&path, &bytes).unwrap();
            // A flipped bit may create a line end, which splits a line in two.
            let may_be_torn = at / 8 >= last - 1 && bytes[at / 8] != b'\n';
            match contents(&path) {
                Ok(records) => {
                    assert!(may_be_torn, "bit {at} is taken for work that is not done");
                    assert!(records.len() < 3, "bit {at} changes nothing");
                }
                Err(fault) => assert!(!may_be_torn, "bit {at}: {fault}"),
            }
        }
    }

    #[test]
    fn a_line_without_an_end_does_not_exhaust_memory() {
        let (_folder, path, _) = written(&records(1));
        let file = OpenOptions::new().append(true).open(&path).unwrap();
        file.set_len(64 << 30).unwrap();
        assert!(contents(&path).is_err());
    }

    #[test]
    fn a_journal_of_another_format_is_refused_with_both_versions() {
        let (_folder, path, text) = written(&records(1));
        fs::write(&path, text.replace("journal 5", "journal 4")).unwrap();
        let fault = contents(&path).unwrap_err().to_string();
        let words = "it has format 4, and this version reads format 5";
        assert!(fault.contains(words), "{fault}");
    }
}
