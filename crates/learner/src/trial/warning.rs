//! Warnings about plans that cannot succeed, issued before the work starts.

use std::fmt;

use super::plan::{Config, Plan};
use super::settings::{MOST_STEPS, PATHS_AN_EPISODE};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze, Paths};

/// The maximum number of groups of cells, and of cells per group, that a warning lists.
const MOST_NAMED: usize = 3;

/// Reasons why a trial is bound to fail, or to miss the optimum.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Episodes are shorter than the shortest path, at least from some starts.
    StepLimit {
        /// The maximum number of steps of an episode.
        steps: u32,
        /// The longest shortest path from any start.
        longest: u32,
    },
    /// Some cells are perceptually aliased, and no action is best in all of them.
    Aliased {
        /// The percept that does not distinguish them.
        sensor: Sensor,
        /// The cells, group by group.
        groups: Vec<Vec<Cell>>,
    },
    /// A move takes longer than the time-out of actions.
    TimeOut {
        /// The duration of a move, in seconds.
        move_s: f64,
        /// `physics.time_out_s`.
        time_out_s: f64,
    },
    /// The range of the lidar is too short to distinguish free cells of this size from walls.
    ShortLidar {
        /// `physics.lidar.range_m`.
        range_m: f64,
        /// Edge length of a cell in metres.
        cell_size_m: f64,
        /// The size of the largest cells that the lidar can distinguish from walls, in metres.
        largest_cell_m: f64,
    },
}

impl Plan {
    /// Returns the warnings about the [settled](Self::settled) plan. The plan can be run
    /// nevertheless.
    pub fn warnings(&self) -> Vec<Warning> {
        let plan = self.clone().settled();
        let paths = Paths::with_slip(&plan.maze, plan.config.settings.arena.slip);
        [step_limit(&plan, &paths), aliased_cells(&plan, &paths)]
            .into_iter()
            .flatten()
            .chain(self.robot_warnings())
            .collect()
    }

    /// Returns the warnings about the robot in cells of this size.
    pub fn robot_warnings(&self) -> Vec<Warning> {
        let Self { maze, config } = self;
        let warnings = [time_out(config, maze), short_lidar(config, maze)];
        warnings.into_iter().flatten().collect()
    }
}

fn step_limit(plan: &Plan, paths: &Paths) -> Option<Warning> {
    let steps = plan.config.settings.reward.step_threshold;
    let longest = paths.longest(&plan.maze);
    (steps < longest).then_some(Warning::StepLimit { steps, longest })
}

/// Only cells on optimal paths matter. What a history distinguishes depends on the way of the robot.
fn aliased_cells(plan: &Plan, paths: &Paths) -> Option<Warning> {
    let sensor = plan.config.sensor;
    if plan.config.settings.sensor.history > 0 {
        return None;
    }
    let groups = sensor.misleading(&plan.maze, paths);
    (!groups.is_empty()).then_some(Warning::Aliased { sensor, groups })
}

fn time_out(config: &Config, maze: &Maze) -> Option<Warning> {
    let physics = config.robot()?;
    let (move_s, time_out_s) = (physics.move_time_s(maze.cell_size_m()), physics.time_out_s);
    (move_s > time_out_s).then_some(Warning::TimeOut { move_s, time_out_s })
}

fn short_lidar(config: &Config, maze: &Maze) -> Option<Warning> {
    let (lidar, cell_size_m) = (&config.robot()?.lidar, maze.cell_size_m());
    let largest_cell_m = lidar.largest_cell_m();
    let is_short = config.sensor.is_sensed() && cell_size_m > largest_cell_m;
    is_short.then_some(Warning::ShortLidar {
        range_m: lidar.range_m,
        cell_size_m,
        largest_cell_m,
    })
}

impl Warning {
    /// Returns a hint in words, if one is known.
    fn help(&self) -> Option<String> {
        match self {
            Self::StepLimit { longest, .. } => {
                let steps = longest.saturating_mul(PATHS_AN_EPISODE);
                (steps <= MOST_STEPS).then(|| format!("`--set reward.step_threshold={steps}`"))
            }
            Self::Aliased { sensor, .. } => {
                Some(format!("`--sensor {}`", sensor.with_position().name()))
            }
            Self::TimeOut { move_s, .. } => {
                let time_out_s = (3.0 * move_s).ceil();
                Some(format!("`--set physics.time_out_s={time_out_s}`"))
            }
            Self::ShortLidar { largest_cell_m, .. } => Some(format!(
                "cells of at most {:.2} m (`cell_size_m`), or a robot with a longer lidar (`--robot`)",
                // Rounded down, so that the named size raises no warning.
                (100.0 * largest_cell_m).floor() / 100.0
            )),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StepLimit { steps, longest } => write!(
                f,
                "episodes end after {steps} steps, but the longest shortest path has {longest}"
            ),
            Self::Aliased { sensor, groups } => write!(
                f,
                "the sensor `{}` cannot distinguish these cells, and no action is best in all of them: {}",
                sensor.name(),
                listed(groups)
            ),
            Self::TimeOut { move_s, time_out_s } => write!(
                f,
                "a move takes about {move_s:.1} s, but actions time out after {time_out_s} s"
            ),
            Self::ShortLidar {
                range_m,
                cell_size_m,
                ..
            } => write!(
                f,
                "the lidar has a range of {range_m} m, too short to distinguish free cells of \
                 {cell_size_m} m from walls"
            ),
        }?;
        self.help().map_or(Ok(()), |help| write!(f, "; try {help}"))
    }
}

/// Lists the first of some groups of cells.
fn listed(groups: &[Vec<Cell>]) -> String {
    let shown = groups.iter().take(MOST_NAMED).map(|cells| named(cells));
    let shown = shown.collect::<Vec<_>>().join("; ");
    match groups.len().saturating_sub(MOST_NAMED) {
        0 => shown,
        more => format!("{shown}; and {more} more such groups"),
    }
}

/// Lists the first of some cells, as column and row.
fn named(cells: &[Cell]) -> String {
    let place = |cell: &Cell| format!("{},{}", cell.col, cell.row);
    let shown: Vec<String> = cells.iter().take(MOST_NAMED).map(place).collect();
    match cells.len().saturating_sub(MOST_NAMED) {
        0 => shown.join(" "),
        more => format!("{} and {more} more", shown.join(" ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::Method;
    use crate::trial::{Resolved, Settings};
    use xcscr_robot::arena::ArenaKind;
    use xcscr_robot::world::Recipe;

    fn maze(name: &str) -> Maze {
        match name.parse::<Recipe>() {
            Ok(recipe) => recipe.maze().unwrap(),
            Err(_) => Maze::load(format!("../../worlds/{name}.json").as_ref()).unwrap(),
        }
    }

    fn said(world: &str, method: Method, sensor: Sensor, sets: &[&str]) -> Vec<String> {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let settings = Resolved::new(&Settings::default(), &[], &sets);
        let plan = Plan::new(maze(world)).method(method);
        let plan = plan.arena(ArenaKind::Grid).sensor(sensor).episodes(1);
        let warnings = plan
            .settings(settings.unwrap().settings)
            .warnings()
            .into_iter();
        warnings.map(|warning| warning.to_string()).collect()
    }

    #[test]
    fn the_shipped_mazes_raise_no_warnings() {
        for world in ["maze4", "maze5", "maze6", "maze4-classic", "woods1"] {
            for &method in Method::ALL {
                let said = said(world, method, Sensor::Neighbours, &[]);
                assert_eq!(said, [""; 0], "{world}, {}", method.name());
            }
        }
    }

    #[test]
    fn a_step_limit_below_the_shortest_path_is_named_and_the_default_never_is() {
        let (world, method, sensor) = ("dfs-40-1", Method::QLearning, Sensor::Position);
        assert_eq!(said(world, method, sensor, &[]), [""; 0]);
        let longest = Paths::new(&maze(world)).longest(&maze(world));
        assert!(longest > 50, "{longest}");
        let limit = format!("reward.step_threshold={}", longest - 1);
        let wanted = format!(
            "episodes end after {} steps, but the longest shortest path has {longest}; try \
             `--set reward.step_threshold={}`",
            longest - 1,
            4 * longest
        );
        assert_eq!(said(world, method, sensor, &[&limit]), [wanted]);
        let enough = format!("reward.step_threshold={longest}");
        assert_eq!(said(world, method, sensor, &[&enough]), [""; 0]);
    }

    #[test]
    fn with_slip_the_best_actions_are_those_of_value_iteration() {
        // Next to the only path, there are aliased cells that are reached only by slips.
        let (world, method, sensor) = ("maze4", Method::QLearning, Sensor::Neighbours);
        assert_eq!(said(world, method, sensor, &[]), [""; 0]);
        let slippery = said(world, method, sensor, &["arena.slip=0.25"]);
        assert!(
            slippery.len() == 1 && slippery[0].contains("5,2 4,5"),
            "{slippery:?}"
        );
    }

    #[test]
    fn cells_that_are_too_large_for_the_robot_are_named() {
        let said = |cell_size_m: f64, sets: &[&str]| {
            let rows = ["#####", "#S.G#", "#####"];
            let text = format!(r#"{{ "cell_size_m": {cell_size_m}, "rows": {rows:?} }}"#);
            let maze = Maze::from_json(text.as_bytes(), "large.json").unwrap();
            let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
            let settings = Resolved::new(&Settings::default(), &[], &sets).unwrap();
            let plan = Plan::new(maze).settings(settings.settings);
            plan.warnings()
                .iter()
                .map(Warning::to_string)
                .collect::<Vec<_>>()
        };
        assert_eq!(said(1.0, &[]), [""; 0]);
        let slow = "a move takes about 20.6 s, but actions time out after 10 s; try `--set \
                    physics.time_out_s=62`";
        let slow_robot = ["physics.max_speed_mps=0.05", "physics.arrival_mps=0.02"];
        assert_eq!(said(1.0, &slow_robot), [slow]);
        let wanted = "the lidar has a range of 8 m, too short to distinguish free cells of 5 m from walls; try \
                      cells of at most 4.21 m (`cell_size_m`), or a robot with a longer lidar (`--robot`)";
        assert_eq!(said(5.0, &[]), [wanted]);
        assert_eq!(said(4.21, &[]), [""; 0], "the size that the warning names");
        assert_eq!(said(4.22, &[]).len(), 1, "control");
    }

    #[test]
    fn very_large_mazes_are_searched_too() {
        assert!(maze("dfs-150-1").is_too_large());
        let said = said("dfs-150-1", Method::QLearning, Sensor::Neighbours, &[]);
        assert!(
            said.len() == 1 && said[0].contains("more such groups"),
            "{said:?}"
        );
    }

    #[test]
    fn aliased_cells_on_paths_are_named_and_the_position_distinguishes_them() {
        let said = |method, sensor| said("dfs-12-1", method, sensor, &[]);
        let named = said(Method::Xcscr, Sensor::Neighbours);
        let words = "the sensor `neighbours` cannot distinguish these cells, and no action is best in all \
                     of them: ";
        assert!(named.len() == 1 && named[0].starts_with(words), "{named:?}");
        assert!(
            named[0].ends_with("; try `--sensor neighbours-position`"),
            "{named:?}"
        );
        assert_eq!(said(Method::Xcscr, Sensor::NeighboursPosition), [""; 0]);
    }
}
