//! A custom observer: sees every step of a trial, and counts collisions by cell.

use std::collections::BTreeMap;
use std::path::Path;

use xcscr::arena::Outcome;
use xcscr::episode::{Observer, Step};
use xcscr::trial::{Plan, Trial};
use xcscr::world::Maze;

/// The number of collisions, by column and row of the cell.
#[derive(Default)]
struct Bumps(BTreeMap<(u16, u16), u32>);

impl Observer for Bumps {
    fn stepped(&mut self, step: &Step<'_>) {
        if let Outcome::Collided { .. } = step.outcome {
            *self.0.entry((step.cell.col, step.cell.row)).or_default() += 1;
        }
    }
}

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let maze = Maze::load(Path::new("worlds/maze4.json"))?;
    let mut trial = Trial::new(Plan::new(maze).episodes(20))?;
    let mut bumps = Bumps::default();
    let _ = trial.run(&mut bumps);
    for ((col, row), count) in &bumps.0 {
        println!("cell {col},{row}: {count} collisions");
    }
    let all: u32 = bumps.0.values().sum();
    assert_eq!(u64::from(all), trial.progress().collisions);
    Ok(())
}
