//! Trains one method in one maze with one seed, and prints the result.

use std::path::Path;

use xcscr::{agent::Method, arena::ArenaKind, trial::Plan, world::Maze};

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let maze = Maze::load(Path::new("worlds/maze4.json"))?;
    let plan = Plan::new(maze).method(Method::XcscrPlus).seed(7);
    let trial = plan.arena(ArenaKind::Grid).run()?;
    let progress = trial.progress();
    println!(
        "globally optimal after episode {:?}, {} steps in all, {} rules",
        progress.first_optimal_episode,
        progress.steps,
        trial.method().rule_count()
    );
    assert!(progress.optimal);
    Ok(())
}
