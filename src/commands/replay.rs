//! `xcscr replay`: what a recording shows, and whether a new run gives the same bytes.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use xcscr::record::reader::Recording;
use xcscr::record::{self, RecordMode};
use xcscr::study::{Plan, Trial};
use xcscr::world::Maze;

use super::failure::{Exit, Failure};
use super::progress::Progress;
use super::train;

/// Arguments of `replay`.
#[derive(Debug, clap::Args)]
pub struct ReplayArgs {
    /// Recordings (.mcap), or the folder of a run.
    #[arg(required = true, value_name = "RECORDING|RUN")]
    recordings: Vec<PathBuf>,
    /// Run the trial again, and compare every recording with it bit by bit.
    #[arg(long)]
    verify: bool,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// What became of one recording, as `--json` prints it.
#[derive(serde::Serialize)]
struct Verified {
    file: String,
    same: bool,
    /// The first difference from the run that was made again.
    difference: Option<String>,
}

/// Shows or verifies recordings.
pub fn run(args: &ReplayArgs, out: &mut impl Write) -> Result<(), Failure> {
    let mut files = Vec::new();
    for path in &args.recordings {
        files.extend(recordings(path)?);
    }
    if args.verify {
        verify(&files, args.json, out)
    } else {
        files.iter().try_for_each(|file| show(file, out))
    }
}

/// The recordings that a path names: itself, or those of a run folder.
fn recordings(path: &Path) -> Result<Vec<PathBuf>, Failure> {
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
    files.sort();
    if files.is_empty() {
        let message = format!("{} holds no recordings (.mcap)", path.display());
        return Err(Failure::new(Exit::Missing, message));
    }
    Ok(files)
}

fn show(file: &Path, out: &mut impl Write) -> Result<(), Failure> {
    let recording = Recording::open(file)?;
    writeln!(out, "{}", file.display())?;
    for (key, value) in recording.metadata("run").into_iter().flatten() {
        writeln!(out, "  {key:9} {value}")?;
    }
    for topic in recording.topics() {
        writeln!(
            out,
            "  {:16} {:6} {}",
            topic.name, topic.messages, topic.schema
        )?;
    }
    Ok(())
}

/// Verifies all recordings; those of the same run are compared with one new run.
fn verify(files: &[PathBuf], json: bool, out: &mut impl Write) -> Result<(), Failure> {
    let mut verified = Vec::new();
    let mut again: Option<Again> = None;
    for file in files {
        let difference = match Source::of(file) {
            Ok(source) => {
                if again.as_ref().is_none_or(|run| !run.serves(&source)) {
                    again = Some(Again::new(&source)?);
                }
                let run = again.as_ref().expect("a run was just made");
                run.difference(&source)?
            }
            Err(failure) if failure.exit == Exit::BadData => Some(failure.to_string()),
            Err(failure) => return Err(failure),
        };
        let same = difference.is_none();
        verified.push(Verified {
            file: file.display().to_string(),
            same,
            difference,
        });
    }
    report(&verified, json, out)
}

fn report(verified: &[Verified], json: bool, out: &mut impl Write) -> Result<(), Failure> {
    let (same, all) = (verified.iter().filter(|v| v.same).count(), verified.len());
    if json {
        writeln!(out, "{}", serde_json::to_string_pretty(verified)?)?;
    } else {
        for Verified {
            file, difference, ..
        } in verified
        {
            if let Some(difference) = difference {
                writeln!(out, "{file}: {difference}")?;
            }
        }
        writeln!(
            out,
            "{same} of {all} recordings are the same as a new run, to the bit"
        )?;
    }
    if same == all {
        return Ok(());
    }
    let message = format!("{} of {all} recordings differ from a new run", all - same);
    Err(Failure::new(Exit::Refuted, message))
}

/// Where a recording says that it comes from.
struct Source {
    plan: Plan,
    mode: RecordMode,
    /// The episode that it shows; `None` for the whole run.
    episode: Option<u32>,
    bytes: Vec<u8>,
}

impl Source {
    fn of(file: &Path) -> Result<Self, Failure> {
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

/// A trial that was run again, into a folder that goes away afterwards.
struct Again {
    plan: Plan,
    mode: RecordMode,
    folder: tempfile::TempDir,
}

impl Again {
    fn new(source: &Source) -> Result<Self, Failure> {
        let plan = &source.plan;
        let folder = tempfile::tempdir().map_err(|cause| {
            Failure::new(
                Exit::CannotCreate,
                format!("cannot make a temporary folder: {cause}"),
            )
        })?;
        let mut trial = Trial::new(plan.clone())?;
        let recorder = train::recorder(folder.path(), plan, source.mode)?;
        train::train(
            &mut trial,
            recorder,
            Progress::new(plan.config.episodes, false),
        )?;
        Ok(Self {
            plan: plan.clone(),
            mode: source.mode,
            folder,
        })
    }

    fn serves(&self, source: &Source) -> bool {
        self.mode == source.mode && self.plan == source.plan
    }

    /// The first difference between a recording and that of this run.
    fn difference(&self, source: &Source) -> Result<Option<String>, Failure> {
        let name = match source.episode {
            None => "run.mcap".to_owned(),
            Some(episode) => format!("ep-{episode:04}.mcap"),
        };
        let Ok(bytes) = fs::read(self.folder.path().join(&name)) else {
            let episodes = self.plan.config.episodes;
            return Ok(Some(format!(
                "a new run of {episodes} episodes makes no {name}"
            )));
        };
        let difference = record::compare(&source.bytes, &bytes)?;
        Ok(difference.map(|difference| difference.to_string()))
    }
}
