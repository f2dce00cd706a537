//! Runs small trials into folders.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use xcscr::arena::{Arena, GridArena};
use xcscr::episode::{self, Explorer, Observer};
use xcscr::random::{Stream, StreamName};
use xcscr::record::{RecordError, RecordMode, RecordSummary, Recorder, RobotShape, RunInfo};
use xcscr::reward::{self, Method, RewardMethod};
use xcscr::sensor::Sensor;
use xcscr::world::Maze;
use xcscr::xcs;

/// A trial of so many episodes.
#[derive(Clone)]
pub struct Trial {
    pub world: &'static str,
    pub seed: u64,
    pub episodes: u32,
    pub mode: RecordMode,
}

impl Default for Trial {
    fn default() -> Self {
        Self {
            world: "maze4",
            seed: 1,
            episodes: 4,
            mode: RecordMode::All,
        }
    }
}

impl Trial {
    pub fn maze(&self) -> Maze {
        let path = format!("{}/worlds/{}.json", env!("CARGO_MANIFEST_DIR"), self.world);
        Maze::load(Path::new(&path)).unwrap()
    }

    pub fn info(&self) -> RunInfo {
        let maze = self.maze();
        RunInfo {
            world_json: maze.to_json(),
            config_json: "{}".to_owned(),
            seed: self.seed,
            method: "xcscr".to_owned(),
            arena: "grid".to_owned(),
            sensor: Sensor::Neighbours,
            episodes: self.episodes,
            robot: RobotShape::for_cell(maze.cell_size_m()),
        }
    }

    pub fn learner(&self) -> Box<dyn RewardMethod> {
        let actions = self.maze().action_count();
        let (xcs, params) = (xcs::Params::default(), reward::Params::default());
        Method::Xcscr.build(actions, xcs, params, self.seed)
    }

    /// Runs the trial; stops when the observer says so.
    pub fn run(&self, method: &mut dyn RewardMethod, observer: &mut dyn Observer) {
        let mut arena = GridArena::new(self.maze());
        self.run_in(&mut arena, method, observer);
    }

    pub fn run_in(
        &self,
        arena: &mut dyn Arena,
        method: &mut dyn RewardMethod,
        observer: &mut dyn Observer,
    ) {
        let mut explorer = Explorer::new(0.3, Stream::new(self.seed, StreamName::Exploration));
        let starts = self.maze().start_cells();
        for number in 1..=self.episodes {
            let start = starts[number as usize % starts.len()];
            let (sensor, explorer) = (Sensor::Neighbours, &mut explorer);
            let (_, flow) = episode::run(number, start, arena, sensor, method, explorer, observer);
            if flow == ControlFlow::Break(()) {
                break;
            }
        }
    }

    /// Runs the trial and records it.
    pub fn record(&self, folder: &Path) -> Result<RecordSummary, RecordError> {
        let mut recorder = Recorder::create(folder, &self.maze(), self.info(), self.mode)?;
        let mut method = self.learner();
        self.run(method.as_mut(), &mut recorder);
        recorder.finish(method.as_ref())
    }
}

/// The names of the files in a folder, in order.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// The recordings of a summary, read back.
pub fn contents(files: &[PathBuf]) -> Vec<Vec<u8>> {
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}
