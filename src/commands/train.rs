//! `xcscr train`: trains and records a new learner.

use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::disk;
use xcscr::record::RecordMode;
use xcscr::run::{Finished, Resumed, RunFolder, Session};
use xcscr::sensor::Sensor;
use xcscr::trial::{Config, Plan, Settings, Trial, Unread};

use super::choices::{self, SettingsArgs};
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::output::print_json;
use super::progress::EpisodeProgress;
use super::results::Results;
use super::terminal::say;
use super::train_report::TrainReport;

/// The options that cannot be changed once a run has begun.
const CHOICES: [&str; 12] = [
    "world", "method", "arena", "sensor", "episodes", "seed", "out", "force", "robot", "config",
    "set", "record",
];

/// Arguments of `train`.
#[derive(Debug, clap::Args)]
pub struct TrainArgs {
    /// World file, or the name of a bundled world such as maze4.
    #[arg(required_unless_present = "resume")]
    world: Option<PathBuf>,
    /// Learning method.
    #[arg(long, default_value = Method::default().name(), value_parser = choices::method())]
    method: Method,
    /// Arena of the robot: simulated physics, or a plain grid.
    #[arg(long, default_value = "physics", value_parser = choices::arena())]
    arena: ArenaKind,
    /// Percept of the robot [default: lidar in physics, neighbours on the grid; with -position where
    /// cells share a percept but need different actions].
    #[arg(long, value_parser = choices::sensor())]
    sensor: Option<Sensor>,
    /// Number of episodes.
    #[arg(long, default_value_t = 180, value_name = "N", value_parser = choices::count::<u32>)]
    episodes: u32,
    /// Seed of all random numbers. The same command and seed give the same bytes.
    #[arg(long, default_value_t = 1, value_name = "S", value_parser = choices::seed)]
    seed: u64,
    /// Folder of the run [default: recordings/<world>-<method>-<arena>-s<seed>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the folder of an earlier run.
    #[arg(long)]
    force: bool,
    /// Resume the interrupted run in this folder. The result is bit-identical to that of an
    /// uninterrupted run.
    #[arg(long, value_name = "DIR", conflicts_with_all = CHOICES)]
    resume: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingsArgs,
    /// Start with what another run learned: the folder of the run, or its rules.json.
    #[arg(long, value_name = "RULES|RUN", conflicts_with = "resume")]
    init_rules: Option<PathBuf>,
    /// Episodes to record: all, every:N, beams (all, with each lidar beam) or none.
    #[arg(long, default_value = "all", value_name = "MODE")]
    record: RecordMode,
    /// Print one JSON document instead of the report.
    #[arg(long)]
    json: bool,
    /// Do not show progress.
    #[arg(long)]
    quiet: bool,
}

impl TrainArgs {
    /// Returns the plan, and the settings without effect.
    fn plan(&self) -> Result<(Plan, Vec<Unread>), Failure> {
        let resolved = self.settings.resolve(&Settings::of(self.method))?;
        let unread = resolved.unread(self.method, self.arena);
        // The command line requires a world without `--resume`.
        let maze = choices::world(self.world.as_deref().unwrap_or(Path::new("")))?;
        let config = Config {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            method: self.method,
            arena: self.arena,
            sensor: self
                .sensor
                .unwrap_or_else(|| Sensor::usual_for(self.arena, &maze)),
            episodes: self.episodes,
            seed: self.seed,
            initial: self
                .init_rules
                .as_deref()
                .map(choices::read_rules)
                .transpose()?,
            settings: resolved.settings,
        };
        Ok((Plan { maze, config }, unread))
    }
}

/// Trains, records, saves and reports.
pub fn run(args: &TrainArgs, out: &mut Results) -> Result<(), Failure> {
    let (session, interrupt) = match &args.resume {
        None => begin(args)?,
        Some(folder) => match resume(folder)? {
            (Resumed::Unfinished(session), interrupt) => (*session, interrupt),
            (Resumed::Finished(folder), _) => return say_finished(&folder, args.json, out),
        },
    };
    let mut progress = EpisodeProgress::of(session.trial().plan().config.episodes, args.quiet);
    let finished = session.run(&mut progress, &|| interrupt.came());
    drop(progress);
    let Finished {
        trial,
        folder,
        recording,
    } = finished?;
    let report = TrainReport::new(&trial, folder.path());
    if args.json {
        return print_json(&report, out);
    }
    report.print(&trial, &recording, out)
}

fn begin(args: &TrainArgs) -> Result<(Session, Interrupt), Failure> {
    let (plan, unread) = args.plan()?;
    let default = || PathBuf::from("recordings").join(plan.folder_name());
    let path = args.out.clone().unwrap_or_else(default);
    for setting in unread {
        say(&format!("warning: {setting}"));
    }
    if args.sensor.is_none() && plan.config.sensor != Sensor::usual_in(args.arena) {
        say(&position_note(&plan));
    }
    say_warnings(&plan);
    let trial = Trial::new(plan)?;
    let folder = RunFolder::create(&path, args.force)?;
    let interrupt = watch(&folder)?;
    Ok((Session::begin(folder, trial, args.record)?, interrupt))
}

/// Resumes the run in a folder. Removes a trailing slash, so that the name is the same as in a new
/// run.
fn resume(folder: &Path) -> Result<(Resumed, Interrupt), Failure> {
    let path: PathBuf = folder.components().collect();
    let folder = RunFolder::resume(&path)?;
    let interrupt = watch(&folder)?;
    Ok((Session::resume(folder)?, interrupt))
}

/// Watches for signals. The folder must already be locked by this process.
fn watch(folder: &RunFolder) -> Result<Interrupt, Failure> {
    let folder = RunFolder::open(folder.path());
    let shutdown_message = move || {
        let message = format!("interrupted in an episode{}", folder.resume_hint());
        Failure::new(ErrorKind::Interrupted, message)
    };
    Interrupt::watch(shutdown_message)
}

/// Explains why the default percept includes the position.
fn position_note(plan: &Plan) -> String {
    let Config { arena, sensor, .. } = &plan.config;
    format!(
        "note: no policy on the percept `{}` is optimal here, because cells share a percept but need different actions; \
         the robot also perceives its position (`{}`)",
        Sensor::usual_in(*arena).name(),
        sensor.name()
    )
}

/// Prints the warnings about a plan on stderr.
fn say_warnings(plan: &Plan) {
    for warning in plan.warnings() {
        say(&format!("warning: {warning}"));
    }
}

/// Reports that the run is already finished, which is a success.
fn say_finished(folder: &RunFolder, json: bool, out: &mut Results) -> Result<(), Failure> {
    let episodes = folder.plan()?.config.episodes;
    let run_dir = disk::named(folder.path());
    if json {
        let said =
            serde_json::json!({ "run_dir": run_dir, "finished": true, "episodes": episodes });
        return print_json(&said, out);
    }
    Ok(writeln!(
        out,
        "{run_dir} is finished: all {episodes} episodes have been run"
    )?)
}
