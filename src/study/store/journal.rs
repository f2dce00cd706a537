//! A journal of finished trials on disk: one trial per line, each line with its checksum.
//!
//! A journal has one writer, which only appends. Only complete lines count, because a killed process
//! can leave an incomplete last line. A bad line before the last is damage, and the journal is
//! rejected.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use super::record::TrialRecord;
use crate::Error;
use crate::disk;
use crate::study::error;

/// The maximum length of a line, which is more than a record needs.
const MOST_LINE_BYTES: u64 = 1 << 20;

/// The first words of a journal.
const MAGIC: &str = "xcscr study journal";
/// The version of the line format.
const FORMAT: u32 = 4;
/// The words of a header between its plan and the plan that it adds trials to.
const LARGER_THAN: &str = ", larger than ";
/// The random characters at the end of a name.
const RANDOM_CHARACTERS: usize = 10;

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Starts a journal of a task in a new file in `folder`. `smaller` is the plan to which this plan adds
    /// trials.
    pub fn begin(
        folder: &Path,
        task: usize,
        plan: &str,
        smaller: Option<&str>,
    ) -> Result<Self, Error> {
        let mut builder = tempfile::Builder::new();
        let prefix = format!("{task:05}-");
        builder.prefix(&prefix).rand_bytes(RANDOM_CHARACTERS);
        // Temporary files are readable only by their owner; make this one as readable as other
        // files.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let made = builder.tempfile_in(folder).map_err(error::io(folder))?;
        let kept = made.keep();
        let (file, path) = kept.map_err(|fault| error::io(folder)(fault.error))?;
        let mut journal = Self { path, file };
        let begun = journal.file.write_all(header(plan, smaller).as_bytes());
        begun
            .and_then(|()| journal.file.sync_all())
            .map_err(error::io(&journal.path))?;
        Ok(journal)
    }

    /// Appends records.
    pub fn write(&mut self, records: &[TrialRecord]) -> Result<(), Error> {
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

/// Returns the task in the name of a journal, or `None` for a file of another name.
pub fn task_of(name: &str) -> Option<usize> {
    let (task, random) = name.split_once('-')?;
    let is_ours = task.len() >= 5
        && task.bytes().all(|digit| digit.is_ascii_digit())
        && random.len() == RANDOM_CHARACTERS
        && random.bytes().all(|byte| byte.is_ascii_alphanumeric());
    task.parse().ok().filter(|_| is_ours)
}

/// Returns true if a file begins like a journal of any plan. A killed process leaves a beginning of
/// the first line.
///
/// # Errors
/// An error of the file system.
pub fn is_journal(path: &Path) -> Result<bool, Error> {
    let file = disk::open(path).map_err(error::io(path))?;
    let mut first = Vec::new();
    let read = file.take(MAGIC.len() as u64).read_to_end(&mut first);
    read.map_err(error::io(path))?;
    Ok(MAGIC.as_bytes().starts_with(&first))
}

/// Calls `each` with the records of a journal, in the order of its lines, and with the place of its
/// plan in `plans`. An incomplete last line is ignored, and so is the journal of a larger plan.
///
/// # Errors
/// When the journal belongs to none of the plans, or a line before the last is
/// bad; or an error of `each`.
pub fn read(
    path: &Path,
    plans: &[&str],
    each: &mut dyn FnMut(usize, TrialRecord) -> Result<(), Error>,
) -> Result<(), Error> {
    let file = disk::open(path).map_err(error::io(path))?;
    let mut lines = BufReader::new(file);
    let mut next = || next_line(&mut lines).map_err(error::io(path));
    let first = next()?;
    let place = |plan: &str| plans.iter().position(|known| *known == plan);
    let plan = match plans_in(&first) {
        // A half-written header is the beginning of a new journal.
        None if is_begun(&first) => return Ok(()),
        Some((plan, smaller)) => match place(plan) {
            None if smaller.and_then(place).is_some() => return Ok(()),
            known => known,
        },
        None => None,
    };
    let plan = plan.ok_or_else(|| error::damaged(path)(foreign(&first)))?;
    for number in 2.. {
        let line = next()?;
        match parse(&line) {
            _ if line.is_empty() => break,
            Some(record) => each(plan, record)?,
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

fn header(plan: &str, smaller: Option<&str>) -> String {
    let larger = |smaller: &str| {
        let plans = format!("{plan}{LARGER_THAN}{smaller}");
        format!("{plans} {}", sum(&plans))
    };
    let plans = smaller.map_or(plan.to_owned(), larger);
    format!("{}{plans}\n", start_of_header())
}

fn start_of_header() -> String {
    format!("{MAGIC} {FORMAT}, plan ")
}

/// Returns the plan of a journal with this first line, and the plan that it adds trials to. A checksum protects
/// both, because the journal of an unknown larger plan is ignored.
fn plans_in(header: &[u8]) -> Option<(&str, Option<&str>)> {
    let line = std::str::from_utf8(header).ok()?.strip_suffix('\n')?;
    let words = line.strip_prefix(&start_of_header())?;
    if !words.contains(LARGER_THAN) {
        return Some((words, None));
    }
    let (plans, found) = words.rsplit_once(' ')?;
    let (plan, smaller) = plans.split_once(LARGER_THAN)?;
    (sum(plans) == found).then_some((plan, Some(smaller)))
}

/// Returns the checksum of a text. It is compared as text: a number has several spellings, and a flipped bit may
/// turn one into another.
fn sum(text: &str) -> String {
    format!("{:08x}", crc32fast::hash(text.as_bytes()))
}

/// Returns true for a first line without an end.
fn is_begun(header: &[u8]) -> bool {
    let start = start_of_header();
    let shared = start.len().min(header.len());
    !header.ends_with(b"\n") && header[..shared] == start.as_bytes()[..shared]
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
    format!("{} {json}\n", sum(&json))
}

fn parse(line: &[u8]) -> Option<TrialRecord> {
    let line = line.strip_suffix(b"\n")?;
    let (found, json) = std::str::from_utf8(line).ok()?.split_once(' ')?;
    let intact = found == sum(json);
    intact.then(|| serde_json::from_str(json).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use std::fs::{self, OpenOptions};

    use super::*;

    fn contents(path: &Path, plan: &str) -> Result<Vec<TrialRecord>, Error> {
        let mut records = Vec::new();
        read(path, &[plan], &mut |_, record| {
            records.push(record);
            Ok(())
        })?;
        Ok(records)
    }

    fn records(count: usize) -> Vec<TrialRecord> {
        let record = |trial| TrialRecord {
            trial,
            result: Err(format!("fault {trial}")),
        };
        (0..count).map(record).collect()
    }

    /// A folder with the journal of a plan `p`.
    fn written(records: &[TrialRecord]) -> (tempfile::TempDir, PathBuf, String) {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = Journal::begin(folder.path(), 1, "p", Some("o")).unwrap();
        journal.write(records).unwrap();
        journal.sync().unwrap();
        let text = fs::read_to_string(&journal.path).unwrap();
        (folder, journal.path, text)
    }

    #[test]
    fn a_journal_cut_to_any_length_keeps_complete_lines() {
        let all = records(3);
        let (_folder, path, full) = written(&all);
        let mut found = 0;
        for length in 0..=full.len() {
            fs::write(&path, &full[..length]).unwrap();
            let records = contents(&path, "p").unwrap();
            let ends = full[..length].matches('\n').count();
            assert_eq!(records, all[..ends.saturating_sub(1)], "cut to {length}");
            found = records.len();
        }
        assert_eq!(found, 3);
    }

    #[test]
    fn a_flipped_bit_is_damage_except_in_the_last_line_which_may_be_incomplete() {
        let (_folder, path, sound) = written(&records(3));
        let sound = sound.into_bytes();
        let last = sound.len() - line(&records(3)[2]).len();
        for at in 0..8 * sound.len() {
            let mut bytes = sound.clone();
            bytes[at / 8] ^= 1 << (at % 8);
            fs::write(&path, &bytes).unwrap();
            // A flipped bit may create a line end, which splits a line in two.
            let may_be_torn = at / 8 >= last - 1 && bytes[at / 8] != b'\n';
            match contents(&path, "p") {
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
        assert!(contents(&path, "p").is_err());
    }

    #[test]
    fn the_journal_of_another_plan_is_refused_unless_it_adds_trials_to_this_one() {
        let (_folder, path, _) = written(&records(1));
        assert!(contents(&path, "q").is_err());
        assert!(contents(&path, "o").unwrap().is_empty());
    }

    #[test]
    fn a_journal_of_another_format_is_refused_with_both_versions() {
        let (_folder, path, text) = written(&records(1));
        fs::write(&path, text.replace("journal 4", "journal 1")).unwrap();
        let fault = contents(&path, "p").unwrap_err().to_string();
        let words = "it has format 1, and this version reads format 4";
        assert!(fault.contains(words), "{fault}");
    }
}
