//! A journal of finished trials on disk: one trial per line, each line with its checksum.
//!
//! Only complete lines count. A killed process can leave an incomplete last line, which is cut off
//! when the journal is opened again. A bad line before the last is damage, and the journal is
//! rejected. At the end of a study the journal is rewritten in the order of the trials, so equal
//! studies have equal journals.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use super::record::TrialRecord;
use crate::disk;
use crate::study::error::StudyError;

/// The maximum length of a line, which is more than a record needs.
const MOST_LINE_BYTES: u64 = 1 << 20;

/// The first words of a journal.
const MAGIC: &str = "xcscr study journal";
/// The version of the line format. Version 2 added `optimal_episodes`.
const FORMAT: u32 = 2;

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens or creates the journal of the study with this plan. The first `whole` bytes are valid.
    pub fn open(path: &Path, plan: &str, whole: u64) -> Result<Self, StudyError> {
        let opened = disk::require_plain(path)
            .and_then(|()| OpenOptions::new().create(true).append(true).open(path));
        let file = opened.map_err(|cause| StudyError::create(path, cause))?;
        let mut journal = Self {
            path: path.to_owned(),
            file,
        };
        journal.repair(whole, plan)?;
        Ok(journal)
    }

    /// Starts a journal in a new file that has no other writer.
    pub fn begin(path: &Path, file: File, plan: &str) -> Result<Self, StudyError> {
        let path = path.to_owned();
        let mut journal = Self { path, file };
        journal.repair(0, plan)?;
        Ok(journal)
    }

    /// Truncates the file to the valid bytes, and writes the header if it is missing.
    fn repair(&mut self, whole: u64, plan: &str) -> Result<(), StudyError> {
        let cut = self.file.set_len(whole);
        let begun = cut.and_then(|()| match whole {
            0 => self.file.write_all(header(plan).as_bytes()),
            _ => Ok(()),
        });
        begun
            .and_then(|()| self.file.sync_all())
            .map_err(|cause| StudyError::io(&self.path, cause))
    }

    /// Appends records.
    pub fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError> {
        let lines: String = records.iter().map(line).collect();
        let written = self.file.write_all(lines.as_bytes());
        written.map_err(|cause| StudyError::io(&self.path, cause))
    }

    /// Flushes the appended records to the disk.
    pub fn sync(&mut self) -> Result<(), StudyError> {
        let synced = self.file.sync_data();
        synced.map_err(|cause| StudyError::io(&self.path, cause))
    }
}

/// Writes a journal of these records.
pub fn write(
    file: &mut dyn Write,
    plan: &str,
    mut records: impl Iterator<Item = TrialRecord>,
) -> io::Result<()> {
    file.write_all(header(plan).as_bytes())?;
    records.try_for_each(|record| file.write_all(line(&record).as_bytes()))
}

/// Calls `each` with the records of a journal, in the order of its lines. A missing journal has no
/// records. Returns the number of bytes up to the end of the last complete line. At most one
/// incomplete line follows.
///
/// # Errors
/// [`StudyError::Damaged`] when the journal belongs to another plan, or a line before the last is
/// bad; or an error of `each`.
pub fn read(
    path: &Path,
    plan: &str,
    each: &mut dyn FnMut(TrialRecord) -> Result<(), StudyError>,
) -> Result<u64, StudyError> {
    let mut lines = match disk::open(path) {
        Ok(file) => BufReader::new(file),
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(0),
        Err(cause) => return Err(StudyError::io(path, cause)),
    };
    let mut next = || next_line(&mut lines).map_err(|cause| StudyError::io(path, cause));
    let header = header(plan);
    let first = next()?;
    if first != header.as_bytes() {
        // A half-written header is the beginning of a new journal.
        return match header.as_bytes().starts_with(&first) {
            true => Ok(0),
            false => Err(StudyError::damaged(path, foreign(&first))),
        };
    }
    let mut whole = header.len() as u64;
    for number in 2.. {
        let line = next()?;
        match parse(&line) {
            _ if line.is_empty() => break,
            Some(record) => each(record)?,
            None if next()?.is_empty() => break,
            None => return Err(StudyError::damaged(path, damaged_line(number))),
        }
        whole += line.len() as u64;
    }
    Ok(whole)
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

fn header(plan: &str) -> String {
    format!("{MAGIC} {FORMAT}, plan {plan}\n")
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
        _ => "it is not the journal of this plan".to_owned(),
    }
}

fn line(record: &TrialRecord) -> String {
    let json = serde_json::to_string(record).expect("plain data becomes JSON");
    format!("{:08x} {json}\n", crc32fast::hash(json.as_bytes()))
}

fn parse(line: &[u8]) -> Option<TrialRecord> {
    let line = line.strip_suffix(b"\n")?;
    let (sum, json) = std::str::from_utf8(line).ok()?.split_once(' ')?;
    // Compare as text: a number has several spellings, and a flipped bit may turn one into another.
    let intact = sum == format!("{:08x}", crc32fast::hash(json.as_bytes()));
    intact.then(|| serde_json::from_str(json).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn contents(path: &Path, plan: &str) -> Result<(Vec<TrialRecord>, u64), StudyError> {
        let mut records = Vec::new();
        let whole = read(path, plan, &mut |record| {
            records.push(record);
            Ok(())
        })?;
        Ok((records, whole))
    }

    fn text(plan: &str, records: &[TrialRecord]) -> String {
        let mut text = Vec::new();
        write(&mut text, plan, records.iter().cloned()).unwrap();
        String::from_utf8(text).unwrap()
    }

    fn records(count: usize) -> Vec<TrialRecord> {
        let record = |trial| TrialRecord {
            trial,
            result: Err(format!("fault {trial}")),
        };
        (0..count).map(record).collect()
    }

    #[test]
    fn a_journal_cut_to_any_length_keeps_complete_lines_and_can_be_continued() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let all = records(3);
        let full = text("p", &all);
        for length in 0..=full.len() {
            fs::write(&path, &full[..length]).unwrap();
            let (records, whole) = contents(&path, "p").unwrap();
            let mut journal = Journal::open(&path, "p", whole).unwrap();
            let kept = records.len();
            assert_eq!(records, all[..kept]);
            journal.write(&all[kept..]).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), full, "cut to {length}");
        }
    }

    #[test]
    fn a_flipped_bit_is_damage_except_in_the_last_line_which_may_be_incomplete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let sound = text("p", &records(3)).into_bytes();
        let last = sound.len() - line(&records(3)[2]).len();
        for at in 0..8 * sound.len() {
            let mut bytes = sound.clone();
            bytes[at / 8] ^= 1 << (at % 8);
            fs::write(&path, &bytes).unwrap();
            // A flipped bit may create a line end, which splits a line in two.
            let may_be_torn = at / 8 >= last - 1 && bytes[at / 8] != b'\n';
            match contents(&path, "p") {
                Ok((records, _)) => {
                    assert!(may_be_torn, "bit {at} is taken for work that is not done");
                    assert!(records.len() < 3, "bit {at} changes nothing");
                }
                Err(fault) => assert!(!may_be_torn, "bit {at}: {fault}"),
            }
        }
    }

    #[test]
    fn a_line_without_an_end_does_not_exhaust_memory() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        fs::write(&path, text("p", &records(1))).unwrap();
        let file = OpenOptions::new().append(true).open(&path).unwrap();
        file.set_len(64 << 30).unwrap();
        assert!(contents(&path, "p").is_err());
    }

    #[test]
    fn the_journal_of_another_plan_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        fs::write(&path, text("p", &records(1))).unwrap();
        assert!(contents(&path, "q").is_err());
    }

    #[test]
    fn a_journal_of_another_format_is_refused_with_both_versions() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let old = text("p", &records(1)).replace("journal 2", "journal 1");
        fs::write(&path, old).unwrap();
        let fault = contents(&path, "p").unwrap_err().to_string();
        let words = "it has format 1, and this version reads format 2";
        assert!(fault.contains(words), "{fault}");
    }
}
