//! `xcscr replay`: what a recording shows, in words or in a viewer, and whether a new run gives
//! the same bytes.

mod serve;
mod story;
mod stream;
mod summary;
mod verify;

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use xcscr::record::reader::{Recording, TopicInfo};

use super::failure::{Exit, Failure};
use super::live::{LIVE_PORT, LiveArgs};
use super::source::recordings;

/// Arguments of `replay`.
#[derive(Debug, clap::Args)]
pub struct ReplayArgs {
    /// Recordings (.mcap), or the folder of a run.
    #[arg(required = true, value_name = "RECORDING|RUN")]
    recordings: Vec<PathBuf>,
    /// Run the trial again, and compare every recording with it bit by bit.
    #[arg(long, conflicts_with = "live")]
    verify: bool,
    /// Serve the recordings on this machine only, and print links that open them in a viewer.
    #[arg(long, conflicts_with_all = ["verify", "live"])]
    serve: bool,
    /// Write the story of one run, which shows in less than two minutes how it learned.
    #[arg(long, requires = "output", conflicts_with_all = ["verify", "serve", "live", "json"])]
    story: bool,
    /// The file to write the story to (.mcap).
    #[arg(short, long, value_name = "FILE", requires = "story")]
    output: Option<PathBuf>,
    /// Replace that file if it exists.
    #[arg(long, requires = "story")]
    force: bool,
    #[command(flatten)]
    live: LiveArgs,
    /// The port for `--serve` and `--live` [default: any that is free, 8765].
    #[arg(long, value_name = "P")]
    port: Option<u16>,
    /// Print one JSON document.
    #[arg(long, conflicts_with_all = ["serve", "live"])]
    json: bool,
}

/// Shows, serves, streams or verifies recordings.
pub fn run(args: &ReplayArgs, out: &mut impl Write) -> Result<(), Failure> {
    if let Some(output) = &args.output {
        return match &args.recordings[..] {
            [run] => story::run(run, output, args.force),
            _ => Err(Failure::new(
                Exit::Usage,
                "a story is that of one run".to_owned(),
            )),
        };
    }
    let mut files = Vec::new();
    for path in &args.recordings {
        files.extend(recordings(path)?);
    }
    if let Some(broadcast) = args.live.open(args.port.unwrap_or(LIVE_PORT), 1.0)? {
        stream::run(&files, broadcast)
    } else if args.verify {
        verify::run(&files, args.json, out)
    } else if args.serve {
        let shown = story::tell_missing(&args.recordings, files)?;
        let port = args.port.unwrap_or(0);
        serve::run(&shown.files, port, &args.live.allow_origin, out)
    } else if args.json {
        show_json(&files, out)
    } else {
        args.recordings.iter().try_for_each(|path| show(path, out))
    }
}

/// What a recording says of itself.
#[derive(Debug, Serialize)]
struct Shown {
    file: String,
    run: BTreeMap<String, String>,
    topics: Vec<TopicInfo>,
}

impl Shown {
    fn of(file: &Path) -> Result<Self, Failure> {
        let recording = Recording::open(file)?;
        Ok(Self {
            file: file.display().to_string(),
            run: recording.metadata("run").cloned().unwrap_or_default(),
            topics: recording.topics(),
        })
    }

    fn print(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{}", self.file)?;
        for (key, value) in &self.run {
            writeln!(out, "  {key:9} {value}")?;
        }
        for topic in &self.topics {
            writeln!(
                out,
                "  {:16} {:6} {}",
                topic.name, topic.messages, topic.schema
            )?;
        }
        Ok(())
    }
}

fn show_json(files: &[PathBuf], out: &mut impl Write) -> Result<(), Failure> {
    let shown: Result<Vec<Shown>, _> = files.iter().map(|file| Shown::of(file)).collect();
    Ok(writeln!(out, "{}", serde_json::to_string_pretty(&shown?)?)?)
}

/// Sums up a run, or says what a recording holds.
fn show(path: &Path, out: &mut impl Write) -> Result<(), Failure> {
    let files = recordings(path)?;
    if let Some(run) = summary::whole_run(path) {
        return summary::print(path, &run, &files, out);
    }
    files
        .iter()
        .try_for_each(|file| Ok(Shown::of(file)?.print(out)?))
}
