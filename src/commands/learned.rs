//! What was learned, from the folder of a run or a lone file of rules.

use std::path::PathBuf;

use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::run::{RunFolder, Source};
use xcscr::sensor::Sensor;
use xcscr::trial::{Config, Plan, Settings};
use xcscr::world::Maze;

use super::choices;
use super::failure::{Exit, Failure};

/// Where to find what was learned, and what it is about.
#[derive(Debug, clap::Args)]
pub struct LearnedArgs {
    /// The folder of a run, one of its recordings, or a rules.json file.
    #[arg(value_name = "RUN|RULES")]
    run: PathBuf,
    /// Another world file than the run's own; needed for a lone rules.json.
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,
    /// Another percept than the run's own.
    #[arg(long, value_parser = choices::sensor())]
    sensor: Option<Sensor>,
}

impl LearnedArgs {
    /// Is it the folder of a run, and no lone file of rules?
    pub fn is_a_run(&self) -> bool {
        self.run.is_dir()
    }

    /// Is it a run as it was, so that running it again gives the same?
    pub fn can_be_repeated(&self) -> bool {
        self.is_a_run() && self.world.is_none() && self.sensor.is_none()
    }

    /// The plan of the run, and what was learned. A lone file of rules does not tell where it was
    /// learned: in `arena`, or else in physics.
    pub fn load(&self, arena: Option<ArenaKind>) -> Result<(Plan, Knowledge), Failure> {
        let is_file = self.run.exists() && !self.run.is_dir();
        let is_recording = self.run.extension().is_some_and(|end| end == "mcap");
        let (mut plan, knowledge) = if is_file && is_recording {
            let source = Source::of(&self.run)?;
            let knowledge = source.knowledge()?;
            (source.plan, knowledge)
        } else if is_file {
            let knowledge = choices::read_rules(&self.run)?;
            let arena = arena.unwrap_or(ArenaKind::Physics);
            (self.plan_of_rules(&knowledge, arena)?, knowledge)
        } else {
            let folder = RunFolder::open(&self.run);
            (folder.plan()?, folder.knowledge()?)
        };
        if let Some(world) = &self.world {
            plan.maze = Maze::find(world)?;
        }
        plan.config.sensor = self.sensor.unwrap_or(plan.config.sensor);
        Ok((plan, knowledge))
    }

    /// A folder beside it for what is made of it.
    pub fn beside(&self) -> PathBuf {
        let name = match self.run.is_dir() {
            true => self.run.file_name(),
            false => self.run.file_stem(),
        };
        let name = name.unwrap_or_default().to_string_lossy();
        self.run.with_file_name(format!("{name}-evaluation"))
    }

    /// A plan around a lone file of rules.
    fn plan_of_rules(&self, knowledge: &Knowledge, arena: ArenaKind) -> Result<Plan, Failure> {
        let world = self.world.as_ref().ok_or_else(|| {
            let message = format!(
                "{} does not say in which world it was learned: add `--world FILE`",
                self.run.display()
            );
            Failure::new(Exit::Usage, message)
        })?;
        let config = Config {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            method: Method::of(knowledge).unwrap_or(Method::Xcscr),
            arena,
            sensor: Sensor::usual_in(arena),
            episodes: 1,
            seed: 1,
            settings: Settings::default(),
            initial: None,
        };
        let maze = Maze::find(world)?;
        Ok(Plan { maze, config })
    }
}
