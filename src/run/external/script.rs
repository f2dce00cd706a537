//! Repeats what an external agent did: its actions as an agent, and its wheel speeds as an arena.

use std::collections::BTreeMap;

use super::{ExternalActions, ExternalEpisode, WheelSpeeds};
use crate::agent::{
    Agent, Choice, DecisionSource, EndCredit, Explorer, Knowledge, StepCredit, Transition,
};
use crate::arena::{Arena, Outcome, View, WheelDrive};
use crate::world::Cell;
use xcs::{Action, Percept, PredictionArray};

/// Repeats the actions and the rewards of an episode.
pub struct Script<'a> {
    episode: &'a ExternalEpisode,
    /// The number of moves of the maze.
    moves: usize,
    step: usize,
}

impl<'a> Script<'a> {
    /// Creates the agent for a maze with this number of moves.
    pub fn new(episode: &'a ExternalEpisode, moves: usize) -> Self {
        Self {
            episode,
            moves,
            step: 0,
        }
    }
}

impl Agent for Script<'_> {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.values(percept)
    }

    fn choose(&mut self, _: &Percept, _: &PredictionArray, _: &mut Explorer) -> Choice {
        let number = match &self.episode.actions {
            ExternalActions::Moves(moves) => moves[self.step],
            // No move. `ScriptedWheels` has the speeds.
            ExternalActions::Wheels(_) => self.moves,
        };
        let action = Action::new(number).expect("actions are checked");
        Choice::new(action, DecisionSource::Table)
    }

    fn update(&mut self, _: &Transition<'_>) -> StepCredit {
        self.step += 1;
        StepCredit {
            short_term_reward: self.episode.rewards[self.step - 1],
            ..StepCredit::default()
        }
    }

    fn end_episode(&mut self, _: bool) -> EndCredit {
        EndCredit {
            long_term_reward: 0.0,
            learning_rate: 0.0,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        u32::try_from(self.episode.actions.len()).unwrap_or(u32::MAX)
    }

    fn values(&self, _: &Percept) -> PredictionArray {
        PredictionArray::new(self.moves)
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::Table(BTreeMap::new())
    }

    fn rule_count(&self) -> usize {
        0
    }
}

/// A robot that repeats wheel speeds: each action, whatever it is, is one step of 50 ms.
pub struct ScriptedWheels {
    drive: WheelDrive,
    script: WheelSpeeds,
    step: usize,
    last_mps: [f64; 2],
}

impl ScriptedWheels {
    /// Creates an arena for as many actions as the script has speeds.
    pub fn new(drive: WheelDrive, script: WheelSpeeds) -> Self {
        Self {
            drive,
            script,
            step: 0,
            last_mps: [0.0; 2],
        }
    }
}

impl Arena for ScriptedWheels {
    fn reset(&mut self, start: Cell) {
        self.drive.reset(start, self.script.heading_rad);
        self.step = 0;
        self.last_mps = [0.0; 2];
    }

    fn act(&mut self, _: Action) -> Outcome {
        self.last_mps = self.script.speeds_mps[self.step];
        self.step += 1;
        self.drive.step(self.last_mps);
        if self.drive.has_arrived() {
            return Outcome::ReachedGoal;
        }
        match self.drive.impulse_n_s() {
            0.0 => Outcome::Moved,
            impulse => Outcome::Collided {
                impulse_n_s: Some(impulse),
            },
        }
    }

    fn view(&self) -> View<'_> {
        View {
            wheels_mps: Some(self.last_mps),
            ..self.drive.view()
        }
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.drive.set_clock(time_ns);
    }

    fn reseed(&mut self, seed: u64) {
        self.drive.reseed(seed);
        self.step = 0;
        self.last_mps = [0.0; 2];
    }
}
