//! A corridor of eight cells, the smallest multistep problem. Only the last door is rewarded. The
//! value of every other step is the discounted value of the next cell.
//!
//! `cargo run -p xcs --example corridor` prints the values of going left and right in each cell.

use xcs::{Action, Environment, Params, Percept, Response, Runner};

const CELLS: u64 = 8;
const LEFT: usize = 0;

#[derive(Default)]
struct Corridor {
    cell: u64,
}

/// Returns the cell's number in binary.
fn seen_from(cell: u64) -> Percept {
    Percept::from_word(cell, 3)
}

impl Environment for Corridor {
    fn actions(&self) -> usize {
        2
    }

    fn begin(&mut self) -> Percept {
        self.cell = 0;
        seen_from(self.cell)
    }

    fn act(&mut self, action: Action) -> Response {
        self.cell = match action.index() {
            LEFT => self.cell.saturating_sub(1),
            _ => self.cell + 1,
        };
        let out = self.cell == CELLS;
        Response {
            reward: if out { 1000.0 } else { 0.0 },
            next: (!out).then(|| seen_from(self.cell)),
        }
    }
}

/// Returns a runner that has learned for 500 episodes.
fn learned() -> Result<Runner<Corridor>, xcs::bounds::OutOfRange> {
    let mut runner = Runner::new(Corridor::default(), Params::default(), 1)?;
    for _ in 0..500 {
        runner.learn();
    }
    Ok(runner)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut runner = learned()?;
    println!("cell   left  right");
    for cell in 0..CELLS {
        let values = runner.xcs().values(&seen_from(cell));
        let [left, right] = [0, 1].map(|at| values.as_slice()[at].unwrap_or(f64::NAN));
        println!("{cell:4} {left:6.1} {right:6.1}");
    }
    println!("out of the corridor in {} steps", runner.test().steps);
    Ok(())
}

#[test]
fn the_shortest_path_is_learned() {
    let episode = learned().unwrap().test();
    assert!(
        episode.ended && u64::from(episode.steps) == CELLS,
        "{episode:?}"
    );
}

#[test]
fn control_a_learner_that_never_explored_long_enough_has_not_found_it() {
    let mut runner = Runner::new(Corridor::default(), Params::default(), 1).unwrap();
    runner.step_limit = 7;
    (0..500).for_each(|_| {
        runner.learn();
    });
    assert!(!runner.test().ended);
}
