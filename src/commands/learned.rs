//! Loads what was learned from a run folder, a recording, or a rules.json file.

use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::run::{RecordedRun, RunFolder};
use xcscr::sensor::Sensor;
use xcscr::trial::{Config, Plan, Settings};

use super::choices;
use super::failure::Failure;

/// The source of a learned policy, and its world and sensor.
#[derive(Debug, clap::Args)]
pub struct LearnedArgs {
    /// The folder of a run, one of its recordings, or a rules.json file.
    #[arg(value_name = "RUN|RULES")]
    run: PathBuf,
    /// World file to use instead of the run's own. Required with a rules.json.
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,
    /// Percept to use instead of the run's own.
    #[arg(long, value_parser = choices::sensor())]
    sensor: Option<Sensor>,
}

/// What was learned.
pub struct Learned {
    /// The plan of the run, with the world and the percept of the arguments.
    pub plan: Plan,
    /// The knowledge.
    pub knowledge: Knowledge,
    /// The edge of the cells in which the policy was trained, in metres; `None` for a file of rules.
    pub trained_cell_m: Option<f64>,
}

/// Returns the plan of a run and what was learned, from its folder or one of its recordings.
pub fn of_run(run: &Path, is_recording: bool) -> Result<(Plan, Knowledge), Failure> {
    if is_recording {
        let source = RecordedRun::of(run)?;
        let knowledge = source.knowledge()?;
        return Ok((source.run.plan, knowledge));
    }
    let folder = RunFolder::open(run);
    Ok((folder.plan()?, folder.knowledge()?))
}

/// Returns the path of a sibling of a run whose name ends with `suffix`.
pub fn beside(run: &Path, suffix: &str) -> PathBuf {
    let name = if run.is_dir() {
        run.file_name()
    } else {
        run.file_stem()
    };
    let name = name.unwrap_or_default().to_string_lossy();
    run.with_file_name(format!("{name}{suffix}"))
}

impl LearnedArgs {
    /// Returns true if the source is a run folder, and not a recording or a file of rules.
    pub fn is_a_run(&self) -> bool {
        self.run.is_dir()
    }

    /// Returns what was learned, and its plan. A file of rules does not name its arena: then the arena is
    /// `arena`, or physics by default.
    pub fn load(&self, arena: Option<ArenaKind>) -> Result<Learned, Failure> {
        let is_file = self.run.exists() && !self.run.is_dir();
        let is_recording = self.run.extension().is_some_and(|end| end == "mcap");
        if is_file && !is_recording {
            let knowledge = choices::read_rules(&self.run)?;
            let arena = arena.unwrap_or(ArenaKind::Physics);
            let plan = self.plan_of_rules(&knowledge, arena)?;
            return Ok(Learned {
                plan: plan.fitted(),
                // The file does not say where its percepts are known.
                knowledge: knowledge.elsewhere(),
                trained_cell_m: None,
            });
        }
        let (own, knowledge) = of_run(&self.run, is_file)?;
        let mut plan = own.clone();
        if let Some(world) = &self.world {
            plan.maze = choices::world(world)?;
        }
        plan.config.sensor = self.sensor.unwrap_or(plan.config.sensor);
        let knowledge = if plan == own {
            knowledge
        } else {
            knowledge.elsewhere()
        };
        Ok(Learned {
            plan: plan.fitted(),
            knowledge,
            trained_cell_m: Some(own.maze.cell_size_m()),
        })
    }

    /// Returns a plan for a file of rules.
    fn plan_of_rules(&self, knowledge: &Knowledge, arena: ArenaKind) -> Result<Plan, Failure> {
        let world = self.world.as_ref().ok_or_else(|| {
            let message = format!(
                "{} does not say in which world it was learned: add `--world FILE`",
                self.run.display()
            );
            Failure::new(ErrorKind::Usage, message)
        })?;
        let config = Config {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            method: Method::of(knowledge).unwrap_or(Method::Xcscr),
            arena,
            sensor: self.sensor.unwrap_or(Sensor::usual_in(arena)),
            episodes: 1,
            seed: 1,
            settings: Settings::default(),
            initial: None,
        };
        let maze = choices::world(world)?;
        Ok(Plan { maze, config })
    }
}
