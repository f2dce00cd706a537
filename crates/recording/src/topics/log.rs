//! `/log`: events as text.

use foxglove::messages::{Log, log::Level};

use super::scene::timestamp;
use xcscr_learner::episode::{Ending, Episode, Step};
use xcscr_robot::arena::Outcome;

/// Logs the start of an episode.
pub(crate) fn began(episode: u32, time_ns: u64) -> Log {
    line(
        time_ns,
        Level::Info,
        "episode",
        format!("episode {episode} begins"),
    )
}

/// Logs a collision; `None` if the step had none.
pub(crate) fn collision(step: &Step<'_>, time_ns: u64) -> Option<Log> {
    let Outcome::Collided { impulse_n_s } = step.outcome else {
        return None;
    };
    let going = step.view.maze.direction(step.action)?.name();
    let (col, row) = (step.cell.col, step.cell.row);
    let impulse = impulse_n_s.map_or_else(String::new, |n_s| format!(", impulse {n_s:.1} N s"));
    let value = step
        .credit
        .filtered
        .map_or_else(String::new, |[before, after]| {
            format!("; value of {going} {before:.0} -> {after:.0}")
        });
    let text = format!("contact going {going} at ({col},{row}){impulse}{value}");
    Some(line(time_ns, Level::Warning, "arena", text))
}

/// Logs the end of an episode.
pub(crate) fn ended(episode: &Episode, time_ns: u64) -> Log {
    let how = match episode.ending {
        Ending::Goal => "reached the goal",
        Ending::StepLimit => "gave up",
    };
    let (number, steps, hits) = (episode.episode, episode.steps, episode.collisions);
    let imprinted = if episode.imprinted {
        ", imprinted a policy"
    } else {
        ""
    };
    let limit = episode.step_threshold;
    let text = format!(
        "episode {number} {how} after {steps} steps, {hits} collisions{imprinted}; step limit {limit}"
    );
    line(time_ns, Level::Info, "episode", text)
}

/// Logs that the policy became or ceased to be globally optimal.
pub(crate) fn optimal(is_optimal: bool, time_ns: u64) -> Log {
    let text = if is_optimal {
        "the greedy policy is globally optimal now"
    } else {
        "the greedy policy is no longer globally optimal"
    };
    line(time_ns, Level::Info, "policy", text.to_owned())
}

fn line(time_ns: u64, level: Level, name: &str, message: String) -> Log {
    Log {
        timestamp: Some(timestamp(time_ns)),
        level: level as i32,
        message,
        name: name.to_owned(),
        file: String::new(),
        line: 0,
    }
}
