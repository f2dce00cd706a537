//! What the recordings of a run say about it.

use serde::Serialize;
use serde_json::Value;

use crate::arena::ArenaKind;
use crate::record::{RobotShape, RunInfo};
use crate::trial::{Config, Plan, Settings};

/// What the recordings of a run say about it.
pub(super) fn run_info(plan: &Plan) -> RunInfo {
    let config = &plan.config;
    RunInfo {
        world_json: plan.maze.to_json(),
        config_json: unusual(config).to_string(),
        seed: config.seed,
        method: config.method.name().to_owned(),
        arena: config.arena.name().to_owned(),
        sensor: config.sensor,
        episodes: config.episodes,
        robot: robot_shape(plan),
        slip: config.settings.arena.slip,
        goal: config.settings.reward.goal,
        is_evaluation: false,
    }
}

/// The simulated robot's sizes; on the grid, which has none, a symbol that fits into a cell.
fn robot_shape(plan: &Plan) -> RobotShape {
    let physics = &plan.config.settings.physics;
    match plan.config.arena {
        ArenaKind::Grid => RobotShape::for_cell(plan.maze.cell_size_m()),
        ArenaKind::Physics => RobotShape {
            radius_m: physics.radius_m,
            wheel_base_m: physics.wheel_base_m,
        },
    }
}

/// All that was chosen, and of the settings those that differ from the defaults of this version:
/// the others would take a tenth of what an episode takes.
fn unusual(config: &Config) -> Value {
    let mut chosen = value(config);
    without(&mut chosen["settings"], &value(&Settings::default()));
    chosen
}

fn value(of: &impl Serialize) -> Value {
    serde_json::to_value(of).expect("plain data becomes JSON")
}

/// Leaves out what is as it is `usual`; sections that are left empty, too.
fn without(chosen: &mut Value, usual: &Value) {
    let Some(fields) = chosen.as_object_mut() else {
        return;
    };
    fields.retain(|name, field| {
        let is_section = field.is_object();
        without(field, &usual[name]);
        match is_section {
            true => field != &serde_json::json!({}),
            false => *field != usual[name],
        }
    });
}
