//! What the recordings of a run say about it.

use crate::record::{RobotShape, RunInfo};
use crate::trial::Plan;

/// What the recordings of a run say about it.
pub(super) fn run_info(plan: &Plan) -> RunInfo {
    let config = &plan.config;
    RunInfo {
        world_json: plan.maze.to_json(),
        config_json: serde_json::to_string(config).expect("plain data becomes JSON"),
        seed: config.seed,
        method: config.method.name().to_owned(),
        arena: config.arena.name().to_owned(),
        sensor: config.sensor,
        episodes: config.episodes,
        robot: RobotShape::for_cell(plan.maze.cell_size_m()),
        is_evaluation: false,
    }
}
