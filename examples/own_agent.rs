//! An agent of one's own: it remembers, for each percept and action, the fewest steps to a goal
//! that ever followed.

use std::collections::BTreeMap;
use std::path::Path;

use xcscr::agent::{Agent, EndCredit, Knowledge, StepCredit};
use xcscr::arena::{ArenaKind, Outcome};
use xcscr::trial::{Plan, Trial};
use xcscr::world::Maze;
use xcscr::xcs::{Action, Percept, PredictionArray};

/// The fewest steps to a goal after each action, by percept.
struct FewestSteps {
    actions: usize,
    fewest: BTreeMap<Percept, Vec<Option<f64>>>,
    percept: Option<Percept>,
    episode: Vec<(Percept, Action)>,
}

impl Agent for FewestSteps {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.percept = Some(*percept);
        self.worth(percept)
    }

    fn update(&mut self, action: Action, _: Outcome) -> StepCredit {
        self.episode
            .extend(self.percept.map(|percept| (percept, action)));
        StepCredit::default()
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        for (back, (percept, action)) in self.episode.drain(..).rev().enumerate() {
            if reached_goal {
                let row = self
                    .fewest
                    .entry(percept)
                    .or_insert(vec![None; self.actions]);
                let steps = -(back as f64);
                let known = &mut row[action.index()];
                *known = Some(known.map_or(steps, |best| best.max(steps)));
            }
        }
        EndCredit {
            long_term_reward: 0.0,
            learning_rate: 1.0,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        500
    }

    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.knowledge().worth(percept, self.actions)
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::Table(self.fewest.clone())
    }

    fn rule_count(&self) -> usize {
        self.fewest.len()
    }
}

/// Runs it.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let maze = Maze::load(Path::new("worlds/maze4.json"))?;
    let agent = FewestSteps {
        actions: maze.action_count(),
        fewest: BTreeMap::new(),
        percept: None,
        episode: Vec::new(),
    };
    let plan = Plan::new(maze).arena(ArenaKind::Grid);
    let mut trial = Trial::with_agent(plan, Box::new(agent))?;
    let _ = trial.run(&mut ());
    let progress = trial.progress();
    println!(
        "shortest episode: {:?} steps; optimal after episode {:?}",
        progress.best_steps, progress.first_optimal_episode
    );
    assert!(progress.best_steps.is_some());
    Ok(())
}
