//! What was learned from a plan. A plan is run once, however many tests of this program look at it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Progress, Settings};
use xcscr::world::{Maze, Recipe};

use crate::kit;

/// A finished trial: its plan, its figures, and what was learned.
#[derive(Clone)]
pub struct Learned {
    pub plan: Plan,
    pub knowledge: Knowledge,
    pub progress: Progress,
}

impl Learned {
    fn new(plan: Plan) -> Self {
        let trial = plan.run().unwrap();
        Self {
            plan: trial.plan().clone(),
            knowledge: trial.method().knowledge(),
            progress: trial.progress().clone(),
        }
    }
}

/// Returns what was learned from a plan.
pub fn learned(plan: Plan) -> Arc<Learned> {
    type Cell = Arc<OnceLock<Arc<Learned>>>;
    static ALL: OnceLock<Mutex<HashMap<String, Cell>>> = OnceLock::new();
    let cell = {
        let mut all = ALL.get_or_init(Mutex::default).lock().unwrap();
        all.entry(format!("{plan:?}")).or_default().clone()
    };
    cell.get_or_init(|| Arc::new(Learned::new(plan))).clone()
}

/// Returns a bundled or a generated world.
pub fn world(name: &str) -> Maze {
    match name.parse::<Recipe>() {
        Ok(recipe) => recipe.maze().unwrap(),
        Err(_) => kit::trial::maze(name),
    }
}

/// Returns a plan on the grid with the sensor `neighbours`.
pub fn gridded(maze: Maze, method: Method) -> Plan {
    let plan = Plan::new(maze).method(method).arena(ArenaKind::Grid);
    plan.sensor(Sensor::Neighbours)
}

/// Changes the settings of a plan.
pub fn with(mut plan: Plan, change: impl FnOnce(&mut Settings)) -> Plan {
    change(&mut plan.config.settings);
    plan
}
