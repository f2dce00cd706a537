//! Finished trials on disk, one per line, each with its checksum.
//!
//! A line counts once it is whole. What a killed process left half written is cut off when the
//! journal is opened again. At the end of a study the journal is rewritten in the order of the
//! trials, so that equal studies leave equal bytes.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::record::TrialRecord;
use crate::disk;
use crate::study::error::StudyError;

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens or begins the journal of the study with this plan, and reads what is in it.
    pub fn open(path: &Path, plan: &str) -> Result<(Self, Vec<TrialRecord>), StudyError> {
        let (records, whole) = read(path, plan)?;
        let opened = disk::require_plain(path)
            .and_then(|()| OpenOptions::new().create(true).append(true).open(path));
        let file = opened.map_err(|cause| StudyError::create(path, cause))?;
        let mut journal = Self {
            path: path.to_owned(),
            file,
        };
        journal.repair(whole, plan)?;
        Ok((journal, records))
    }

    /// Cuts off what is not whole.
    fn repair(&mut self, whole: usize, plan: &str) -> Result<(), StudyError> {
        let cut = self.file.set_len(whole as u64);
        let begun = cut.and_then(|()| match whole {
            0 => self.file.write_all(header(plan).as_bytes()),
            _ => Ok(()),
        });
        begun
            .and_then(|()| self.file.sync_all())
            .map_err(|cause| StudyError::io(&self.path, cause))
    }

    /// Adds records; when this returns, they are on the disk.
    pub fn append(&mut self, records: &[TrialRecord]) -> Result<(), StudyError> {
        let lines: String = records.iter().map(line).collect();
        let written = self.file.write_all(lines.as_bytes());
        written
            .and_then(|()| self.file.sync_data())
            .map_err(|cause| StudyError::io(&self.path, cause))
    }
}

/// The text of a journal of these records.
pub fn text(plan: &str, records: &[TrialRecord]) -> String {
    records
        .iter()
        .fold(header(plan), |text, record| text + &line(record))
}

/// The records of a journal, and the length of its whole lines; none when there is no journal.
pub fn read(path: &Path, plan: &str) -> Result<(Vec<TrialRecord>, usize), StudyError> {
    let bytes = match disk::read_plain(path) {
        Ok(bytes) => bytes,
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Vec::new(),
        Err(cause) => return Err(StudyError::io(path, cause)),
    };
    let header = header(plan);
    let Some(mut rest) = bytes.strip_prefix(header.as_bytes()) else {
        // A header half written is the beginning of a new journal.
        return match header.as_bytes().starts_with(&bytes) {
            true => Ok((Vec::new(), 0)),
            false => Err(StudyError::damaged(
                path,
                "it does not begin as the journal of its plan",
            )),
        };
    };
    let mut records = Vec::new();
    while let Some(end) = rest.iter().position(|byte| *byte == b'\n') {
        match parse(&rest[..end]) {
            Some(record) => records.push(record),
            // Nothing after a torn line was acknowledged.
            None => break,
        }
        rest = &rest[end + 1..];
    }
    let whole = bytes.len() - rest.len();
    Ok((records, whole))
}

fn header(plan: &str) -> String {
    format!("xcscr study journal 1, plan {plan}\n")
}

fn line(record: &TrialRecord) -> String {
    let json = serde_json::to_string(record).expect("plain data becomes JSON");
    format!("{:08x} {json}\n", crc32fast::hash(json.as_bytes()))
}

fn parse(line: &[u8]) -> Option<TrialRecord> {
    let (sum, json) = std::str::from_utf8(line).ok()?.split_once(' ')?;
    let intact = u32::from_str_radix(sum, 16).ok()? == crc32fast::hash(json.as_bytes());
    intact.then(|| serde_json::from_str(json).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn records(count: usize) -> Vec<TrialRecord> {
        let record = |trial| TrialRecord {
            trial,
            result: Err(format!("fault {trial}")),
        };
        (0..count).map(record).collect()
    }

    #[test]
    fn whatever_the_length_it_was_cut_to_whole_lines_are_kept_and_writing_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let all = records(3);
        let full = text("p", &all);
        for length in 0..=full.len() {
            fs::write(&path, &full[..length]).unwrap();
            let (mut journal, kept) = Journal::open(&path, "p").unwrap();
            assert_eq!(kept, all[..kept.len()]);
            journal.append(&all[kept.len()..]).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), full, "cut to {length}");
        }
    }

    #[test]
    fn a_flipped_bit_ends_what_counts() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let mut bytes = text("p", &records(3)).into_bytes();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 4;
        fs::write(&path, bytes).unwrap();
        assert_eq!(read(&path, "p").unwrap().0, records(1));
    }

    #[test]
    fn the_journal_of_another_plan_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        fs::write(&path, text("p", &records(1))).unwrap();
        assert!(read(&path, "q").is_err());
    }
}
