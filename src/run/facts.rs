//! The facts of a run in its recordings.

use serde::Serialize;
use serde_json::Value;

use crate::arena::ArenaKind;
use crate::record::{RobotShape, RunInfo, RunKind};
use crate::trial::{Config, Plan, Settings};

/// Returns the facts of a run for its recordings.
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
        kind: RunKind::Training,
    }
}

/// Returns the dimensions of the simulated robot. The grid world's robot is a symbol that fits into
/// a cell.
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

/// Returns the selected options, and the settings that differ from the defaults of this version.
/// The other settings would take a tenth of an episode's file.
fn unusual(config: &Config) -> Value {
    let mut chosen = value(config);
    without(&mut chosen["settings"], &value(&Settings::default()));
    chosen
}

fn value(of: &impl Serialize) -> Value {
    serde_json::to_value(of).expect("plain data becomes JSON")
}

/// Removes the fields that equal those of `usual`, and sections that become empty.
fn without(chosen: &mut Value, usual: &Value) {
    let Some(fields) = chosen.as_object_mut() else {
        return;
    };
    fields.retain(|name, field| {
        let is_section = field.is_object();
        without(field, &usual[name]);
        if is_section {
            field != &serde_json::json!({})
        } else {
            *field != usual[name]
        }
    });
}
