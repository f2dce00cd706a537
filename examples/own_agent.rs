//! Runs a custom agent, `agents/fewest_steps.rs`, in one trial.

use std::path::Path;

use xcscr::arena::ArenaKind;
use xcscr::trial::{Plan, Trial};
use xcscr::world::Maze;

#[path = "agents/fewest_steps.rs"]
mod fewest_steps;
use fewest_steps::FewestSteps;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let maze = Maze::load(Path::new("worlds/maze4.json"))?;
    let plan = Plan::new(maze).arena(ArenaKind::Grid).settled();
    let agent = Box::new(FewestSteps::new(&plan));
    let mut trial = Trial::with_agent(plan, agent)?;
    let _ = trial.run(&mut ());
    let progress = trial.progress();
    println!(
        "shortest episode: {:?} steps; optimal after episode {:?}",
        progress.best_steps, progress.first_optimal_episode
    );
    assert!(progress.best_steps.is_some());
    Ok(())
}
