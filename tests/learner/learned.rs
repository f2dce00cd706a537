//! What was learned from a plan. A plan is run once, however many tests of this program look at it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

use xcscr::agent::{Estimator, Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{Bounds, GreedySteps, Plan, Progress, Settings};
use xcscr::world::{Maze, Recipe};

use crate::kit;

/// A finished trial: its plan, its figures, and what was learned.
#[derive(Clone)]
pub struct Learned {
    pub plan: Plan,
    pub knowledge: Knowledge,
    pub progress: Progress,
    /// The number of rules, or of the pairs or beliefs of a table or plan.
    pub rules: usize,
}

impl Learned {
    fn new(plan: Plan) -> Self {
        let trial = plan.run().unwrap();
        Self {
            plan: trial.plan().clone(),
            knowledge: trial.method().knowledge(),
            progress: trial.progress().clone(),
            rules: trial.method().rule_count(),
        }
    }

    /// The mean steps of the greedy policy.
    pub fn steps(&self) -> f64 {
        GreedySteps::of(&self.plan, &self.knowledge).mean
    }

    /// The steps of the greedy policy as a multiple of those of the best one.
    pub fn ratio(&self) -> f64 {
        let greedy = GreedySteps::of(&self.plan, &self.knowledge);
        greedy.ratio(&self.plan).unwrap()
    }

    /// The fewest mean steps from an unknown start.
    pub fn bound(&self) -> f64 {
        Bounds::of_belief(&self.plan.maze, self.plan.config.sensor).unwrap()
    }

    /// The share of moves that slip, as the learner estimates it.
    pub fn slip(&self) -> f64 {
        match &self.knowledge {
            Knowledge::MapRules { map, .. } => map.pomdp.slip(),
            _ => panic!("no map"),
        }
    }

    /// The number of states on the maps.
    pub fn states(&self) -> usize {
        match &self.knowledge {
            Knowledge::MapRules { map, .. } => map.states.len(),
            _ => panic!("no map"),
        }
    }

    /// Does it know of one cell in which all episodes begin?
    pub fn knows_its_start(&self) -> bool {
        match &self.knowledge {
            Knowledge::MapRules { map, .. } => map.begin.is_some(),
            _ => false,
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

/// Returns a world of these rows.
pub fn drawn(rows: &[impl AsRef<str>]) -> Maze {
    let rows: Vec<&str> = rows.iter().map(AsRef::as_ref).collect();
    let text = serde_json::json!({ "name": "drawn", "rows": rows });
    Maze::from_json(text.to_string().as_bytes(), "drawn.json").unwrap()
}

/// Returns a plan on the grid with the sensor `neighbours`.
pub fn gridded(maze: Maze, method: Method) -> Plan {
    let plan = Plan::new(maze).method(method).arena(ArenaKind::Grid);
    plan.sensor(Sensor::Neighbours)
}

/// The same, with a map from the first step on for the methods that have one.
pub fn mapped(maze: Maze, method: Method) -> Plan {
    let plan = gridded(maze, method);
    with(plan, |settings| settings.plus.estimator = Estimator::Map)
}

/// The same in a bundled or generated world, with 100 steps for an episode at most.
pub fn limited(name: &str, method: Method) -> Plan {
    let plan = mapped(world(name), method);
    with(plan, |settings| settings.reward.step_threshold = 100)
}

/// Changes the settings of a plan.
pub fn with(mut plan: Plan, change: impl FnOnce(&mut Settings)) -> Plan {
    change(&mut plan.config.settings);
    plan
}
