//! `xcscr replay`: what a recording shows, in words or in a viewer, and whether a new run gives
//! the same bytes.

mod browser;
mod serve;
mod story;
mod stream;
mod summary;
mod verify;

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use xcscr::record::Comparison;
use xcscr::record::reader::{Recording, TopicInfo};
use xcscr::run::{RunError, RunFolder, Source};

use super::failure::{Exit, Failure};
use super::live::{LIVE_PORT, LiveArgs};
use super::output::OutputFile;
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
    /// Serve the stories of two runs side by side, or write them to a file.
    #[arg(long, conflicts_with_all = ["verify", "story", "live", "json"])]
    compare: bool,
    /// Write a recording, or a whole run, as ROS 2 would have recorded it: /tf, /odom, /scan, /map.
    #[arg(long, requires = "output", conflicts_with_all = ["verify", "serve", "story", "compare", "live", "json"])]
    ros: bool,
    /// The file to write a story, a comparison, or a recording for ROS 2 to (.mcap).
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace that file if it exists.
    #[arg(long, requires = "output")]
    force: bool,
    /// Open the first link in the browser.
    #[arg(long)]
    open: bool,
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
    if args.compare {
        return compare(args, out);
    }
    if let Some(output) = &args.output {
        return match &args.recordings[..] {
            [run] if args.story => story::run(run, output, args.force),
            [recording] if args.ros => {
                let file = OutputFile::free(output, args.force)?;
                file.write(&ros_bag(recording)?)
            }
            [_] => Err(usage(
                "`--output` is for `--story`, `--compare` and `--ros`",
            )),
            _ => Err(usage("`--story` and `--ros` take one run or recording")),
        };
    }
    if args.open && !args.serve {
        return Err(usage("`--open` is for `--serve` and `--compare`"));
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
        serve::run(serve::offers(&shown.files)?, &args.service(), out)
    } else if args.json {
        show_json(&files, out)
    } else {
        args.recordings.iter().try_for_each(|path| show(path, out))
    }
}

impl ReplayArgs {
    fn service(&self) -> serve::Service<'_> {
        serve::Service {
            port: self.port.unwrap_or(0),
            origins: &self.live.allow_origin,
            open: self.open,
        }
    }
}

/// An episode or a whole run for ROS 2.
fn ros_bag(recording: &Path) -> Result<Vec<u8>, RunError> {
    match recording.is_dir() {
        true => RunFolder::open(recording).ros_bag(),
        false => Source::of(recording)?.ros_bag(),
    }
}

/// Two runs side by side, into a file or to a viewer.
fn compare(args: &ReplayArgs, out: &mut impl Write) -> Result<(), Failure> {
    let [a, b] = &args.recordings[..] else {
        return Err(usage("`--compare` takes two runs"));
    };
    if let Some(output) = &args.output {
        let file = OutputFile::free(output, args.force)?;
        return file.write(&Comparison::of([a, b])?.bytes);
    }
    let comparison = Comparison::of([a, b])?;
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("comparison.mcap");
    std::fs::write(&file, &comparison.bytes)?;
    let [of_a, of_b] = &comparison.headings;
    let offer = serve::Offer {
        what: format!("A: {of_a}\nB: {of_b}"),
        layout: comparison.layout,
        files: vec![file],
    };
    serve::run(vec![offer], &args.service(), out)
}

fn usage(what: &str) -> Failure {
    Failure::new(Exit::Usage, what.to_owned())
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
