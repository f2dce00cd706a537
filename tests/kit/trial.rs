//! Runs small trials into folders.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use xcscr::agent::{Agent, Explorer, Method, Setup};
use xcscr::arena::{Arena, ArenaKind, GridArena, PhysicsArena, PhysicsParams};
use xcscr::episode::{self, Observer, Start};
use xcscr::record::{RecordMode, RecordSummary, Recorder, RobotShape, RunInfo, RunKind};
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::trial::Plan;
use xcscr::world::Maze;
use xcscr::xcs::random::Stream;

/// Loads a bundled world.
#[track_caller]
pub fn maze(name: &str) -> Maze {
    let path = format!("{}/worlds/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Maze::load(Path::new(&path)).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns a plan for a method on the grid of a bundled world, with the sensor `neighbours`.
#[track_caller]
pub fn on_the_grid(world: &str, method: Method) -> Plan {
    let plan = Plan::new(maze(world)).method(method);
    plan.arena(ArenaKind::Grid).sensor(Sensor::Neighbours)
}

/// A trial with a number of episodes.
#[derive(Clone)]
pub struct Trial {
    pub world: &'static str,
    pub seed: u64,
    pub episodes: u32,
    pub mode: RecordMode,
    /// The probability of a random step.
    pub explore: f64,
    pub arena: &'static str,
}

impl Default for Trial {
    fn default() -> Self {
        Self {
            world: "maze4",
            seed: 1,
            episodes: 4,
            mode: RecordMode::All,
            explore: 0.3,
            arena: "grid",
        }
    }
}

impl Trial {
    pub fn maze(&self) -> Maze {
        maze(self.world)
    }

    pub fn info(&self) -> RunInfo {
        let maze = self.maze();
        RunInfo {
            world_json: maze.to_json(),
            config_json: "{}".to_owned(),
            seed: self.seed,
            method: "xcscr".to_owned(),
            arena: self.arena.to_owned(),
            sensor: Sensor::Neighbours,
            episodes: self.episodes,
            robot: RobotShape::for_cell(maze.cell_size_m()),
            slip: 0.0,
            goal: 1000.0,
            kind: RunKind::Training,
        }
    }

    pub fn learner(&self) -> Box<dyn Agent> {
        let actions = self.maze().action_count();
        Method::Xcscr.build(actions, 0, Setup::default(), self.seed)
    }

    /// Runs the trial. Stops if the observer requests it.
    pub fn run(&self, method: &mut dyn Agent, observer: &mut dyn Observer) {
        let mut arena: Box<dyn Arena> = match self.arena {
            "grid" => Box::new(GridArena::new(self.maze())),
            _ => {
                let params = PhysicsParams::default();
                Box::new(PhysicsArena::new(self.maze(), params, self.seed).unwrap())
            }
        };
        let exploration = Stream::new(self.seed, StreamName::Exploration);
        let mut explorer = Explorer::new(self.explore, exploration);
        let (cell, sensor) = (self.maze().start_cells()[0], Sensor::Neighbours);
        for episode in 1..=self.episodes {
            let (arena, explorer) = (arena.as_mut(), &mut explorer);
            let start = Start {
                episode,
                cell,
                evolves: true,
            };
            let (_, flow) = episode::run(start, arena, sensor, method, explorer, observer);
            if flow == ControlFlow::Break(()) {
                break;
            }
        }
    }

    /// Creates a recorder for the trial.
    pub fn recorder(&self, folder: &Path) -> Result<Recorder, xcscr::Error> {
        Recorder::create(folder, &self.maze(), self.info(), self.mode)
    }

    /// Runs the trial with a learner and records it.
    pub fn record_with(
        &self,
        folder: &Path,
        method: &mut dyn Agent,
    ) -> Result<RecordSummary, xcscr::Error> {
        let mut recorder = self.recorder(folder)?;
        self.run(method, &mut recorder);
        recorder.finish(method)
    }

    /// Runs the trial with XCSCR and records it.
    pub fn record(&self, folder: &Path) -> Result<RecordSummary, xcscr::Error> {
        self.record_with(folder, self.learner().as_mut())
    }
}

/// Reads the recordings of a summary.
pub fn contents(files: &[PathBuf]) -> Vec<Vec<u8>> {
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}
