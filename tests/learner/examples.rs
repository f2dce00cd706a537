//! Every file in `examples/` does what it says: each checks its own result.

#![allow(clippy::duplicate_mod, reason = "two examples share an agent")]

#[path = "../../examples/own_agent.rs"]
mod own_agent;
#[path = "../../examples/own_study.rs"]
mod own_study;
#[path = "../../examples/record_a_run.rs"]
mod record_a_run;
#[path = "../../examples/train_in_ten_lines.rs"]
mod train_in_ten_lines;
#[path = "../../examples/watch_every_step.rs"]
mod watch_every_step;

#[test]
fn own_agent_reaches_the_goal() {
    own_agent::main().unwrap();
}

#[test]
fn own_study_runs_its_twenty_trials() {
    own_study::main().unwrap();
}

#[test]
fn record_a_run_leaves_a_recording_of_each_episode_and_of_the_run() {
    record_a_run::main().unwrap();
}

#[test]
fn train_in_ten_lines_ends_globally_optimal() {
    train_in_ten_lines::main().unwrap();
}

#[test]
fn watch_every_step_sees_every_collision() {
    watch_every_step::main().unwrap();
}
