//! Conversion of Python arguments to a plan.

use std::collections::BTreeSet;
use std::ffi::CString;
use std::path::Path;

use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
use xcscr_learner::agent::Method;
use xcscr_learner::trial::{Plan, Resolved, RobotProfile, Settings};
use xcscr_robot::arena::ArenaKind;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Maze, Recipe};

/// What messages say about the command line, and what Python has in its place.
const OPTIONS: [(&str, &str); 14] = [
    ("--set: ", "settings: "),
    (", or replace that study with `study run --force`", ""),
    (", or replace the run in it with `--force`", ""),
    (", even with `--force`", ""),
    ("replace it with `--force`", "remove it"),
    ("`--out`", "`out`"),
    ("`--jobs`", "`jobs`"),
    ("`--tasks`", "`tasks`"),
    ("`--robot`", "`robot`"),
    ("`--sensor ", "`sensor="),
    ("`--arena grid`", "`arena=\"grid\"`"),
    ("`--set ", "`settings` "),
    (
        "`xcscr config show` lists all",
        "the page \"Settings\" lists all",
    ),
    ("run the same command again", "make the same call again"),
];

/// Returns a message that names arguments of Python.
fn in_python(message: impl std::fmt::Display) -> String {
    let replaced = |text: String, (option, argument): &(&str, &str)| text.replace(option, argument);
    OPTIONS.iter().fold(message.to_string(), replaced)
}

/// Converts an error to a `ValueError` with its message.
pub fn invalid(fault: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(in_python(fault))
}

/// Warns about plans that are bound to fail or to miss the optimum, with each warning only once.
///
/// # Errors
/// If Python turns warnings into errors.
pub fn warn(py: Python<'_>, plans: impl Iterator<Item = Plan>) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    let warnings = plans.flat_map(|plan| {
        let world = plan.maze.name().to_owned();
        let warnings = plan.warnings().into_iter();
        warnings.map(move |warning| in_python(format!("{world}: {warning}")))
    });
    let distinct: BTreeSet<String> = warnings.collect();
    distinct.into_iter().try_for_each(|text| {
        let text = CString::new(text).map_err(invalid)?;
        PyErr::warn(py, &category, &text, 2)
    })
}

/// Finds a member of a closed set by name.
fn by_name<T: Copy>(what: &str, name: &str, all: &[T], of: fn(T) -> &'static str) -> PyResult<T> {
    let found = all.iter().copied().find(|&one| of(one) == name);
    found.ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|&one| of(one)).collect();
        invalid(format!(
            "unknown {what} {name:?}: choose one of {}",
            names.join(", ")
        ))
    })
}

/// Loads a bundled world, a generated one such as `rooms-12-3`, a world file, or the JSON text of a
/// world.
fn world(text: &str) -> PyResult<Maze> {
    if text.trim_start().starts_with('{') {
        return Maze::from_json(text.as_bytes(), "world").map_err(invalid);
    }
    if let Ok(recipe) = text.parse::<Recipe>() {
        return recipe.maze().map_err(invalid);
    }
    Maze::find(Path::new(text)).map_err(invalid)
}

/// The arguments from Python; `None` selects the default.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Choice {
    world: String,
    arena: String,
    sensor: Option<String>,
    robot: Option<String>,
    settings: Vec<String>,
    seed: u64,
}

impl Choice {
    /// Creates the plan for these arguments, a method and a number of episodes.
    pub fn plan(&self, method: Option<&str>, episodes: u32) -> PyResult<Plan> {
        let maze = world(&self.world)?;
        let arena = by_name("arena", &self.arena, ArenaKind::ALL, ArenaKind::name)?;
        let sensor = match &self.sensor {
            Some(name) => by_name("sensor", name, Sensor::ALL, Sensor::name)?,
            None => Sensor::usual_for(arena, &maze),
        };
        let robot = self.robot.as_deref().map(RobotProfile::load).transpose();
        let robot = robot.map_err(invalid)?;
        let method = method.map(|name| by_name("method", name, Method::ALL, Method::name));
        let method = method.transpose()?;
        let defaults = method.map_or_else(Settings::default, Settings::of);
        let resolved = Resolved::with_robot(&defaults, robot.as_ref(), &[], &self.settings);
        let settings = resolved.map_err(invalid)?.settings;
        let mut plan = Plan::new(maze)
            .arena(arena)
            .sensor(sensor)
            .settings(settings);
        if let Some(method) = method {
            plan = plan.method(method);
        }
        let plan = plan.episodes(episodes).seed(self.seed).settled();
        plan.check().map_err(invalid)?;
        plan.config.check_fit(&plan.maze).map_err(invalid)?;
        Ok(plan)
    }
}
