//! A known maze with an uncertain robot position: a partially observable Markov decision process whose
//! moves may slip (Kaelbling, Littman and Cassandra 1998).
//!
//! The estimator tracks the probability of each state, and the planner computes the expected costs of actions.

use serde::{Deserialize, Serialize};

use crate::agent::model::rewards::RewardModel;
use xcs::{Action, MAX_ACTIONS, Percept};
use xcscr_robot::world::each_other;

/// The pseudo-state of the goal, where the episode ends.
pub const GOAL: u32 = u32::MAX;

/// States, their percepts, and the effects of actions. Every step costs 1, unless there is a
/// [`RewardModel`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Pomdp {
    actions: usize,
    /// The probability that an action other than the chosen one is executed ([`each_other`]).
    slip: f64,
    /// By state and action: the next state when the action is executed, or [`GOAL`].
    next: Vec<u32>,
    /// By state: the number of its percept.
    looks: Vec<u32>,
    /// All percepts, sorted.
    percepts: Vec<Percept>,
    rewards: Option<RewardModel>,
}

impl Pomdp {
    /// Creates the process from the percepts of its states. `next` returns the next state of an executed
    /// action, or [`GOAL`]. With probability `slip`, one of the other actions is executed, each equally
    /// likely.
    pub fn new(
        actions: usize,
        slip: f64,
        seen: &[Percept],
        next: impl Fn(usize, Action) -> u32,
    ) -> Self {
        let mut percepts = seen.to_vec();
        percepts.sort_unstable();
        percepts.dedup();
        let look = |percept| percepts.partition_point(|other| other < percept) as u32;
        let states = 0..seen.len();
        Self {
            actions,
            slip,
            next: states
                .flat_map(|state| Action::all(actions).map(move |action| (state, action)))
                .map(|(state, action)| next(state, action))
                .collect(),
            looks: seen.iter().map(look).collect(),
            percepts,
            rewards: None,
        }
    }

    /// Adds auxiliary rewards.
    pub fn with_rewards(self, rewards: RewardModel) -> Self {
        let rewards = Some(rewards);
        Self { rewards, ..self }
    }

    /// Returns the number of states without the goal.
    pub fn states(&self) -> usize {
        self.looks.len()
    }

    /// Returns the number of percepts.
    pub fn looks(&self) -> usize {
        self.percepts.len()
    }

    /// Returns the number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// Returns the probability that a move slips.
    pub fn slip(&self) -> f64 {
        self.slip
    }

    /// Returns the percept of a state.
    pub fn percept(&self, state: u32) -> &Percept {
        &self.percepts[self.look(state) as usize]
    }

    /// Returns the number of a state's percept, which is the same for aliased states.
    pub fn look(&self, state: u32) -> u32 {
        self.looks[state as usize]
    }

    /// Returns the number of a percept; `None` if no state has it.
    pub fn look_of(&self, percept: &Percept) -> Option<u32> {
        self.percepts
            .binary_search(percept)
            .ok()
            .map(|at| at as u32)
    }

    /// Returns the next state of an executed action, or [`GOAL`].
    pub fn next(&self, state: u32, executed: Action) -> u32 {
        self.next[state as usize * self.actions + executed.index()]
    }

    /// Returns all states with this percept.
    pub fn aliased(&self, look: u32) -> impl Iterator<Item = u32> + '_ {
        let states = 0..self.states() as u32;
        states.filter(move |&state| self.look(state) == look)
    }

    /// Returns true if all numbers are valid.
    pub fn is_valid(&self) -> bool {
        let (states, looks) = (self.states(), self.percepts.len());
        (1..=MAX_ACTIONS).contains(&self.actions)
            && self.next.len() == states * self.actions
            && (0.0..=1.0).contains(&self.slip)
            && self
                .next
                .iter()
                .all(|&next| next == GOAL || (next as usize) < states)
            && self.looks.iter().all(|&look| (look as usize) < looks)
            && self.percepts.is_sorted()
            && self
                .rewards
                .as_ref()
                .is_none_or(|rewards| rewards.is_valid(states))
    }

    /// Returns the auxiliary rewards.
    pub fn rewards(&self) -> Option<&RewardModel> {
        self.rewards.as_ref()
    }

    /// Returns the discount per step.
    pub fn discount(&self) -> f64 {
        self.rewards().map_or(1.0, |rewards| rewards.discount)
    }

    /// Returns the cost of every step.
    pub fn cost_of_step(&self) -> f64 {
        if self.rewards.is_none() { 1.0 } else { 0.0 }
    }

    /// Returns the additional immediate cost of a move from one state to another.
    pub fn cost_of_move(&self, state: u32, next: u32) -> f64 {
        self.rewards()
            .map_or(0.0, |rewards| -rewards.gain(state, next))
    }

    /// Converts a cost to the equivalent number of steps from the goal without auxiliary rewards.
    pub fn in_steps(&self, cost: f64) -> f64 {
        self.rewards()
            .map_or(cost, |rewards| rewards.in_steps(-cost))
    }

    /// Returns the cost of each state, at most `most`, if states are fully observable (value iteration).
    /// Without auxiliary rewards, this is the expected number of steps to the goal. The true optimum of a maze
    /// (`xcscr_robot::world::Paths`) is computed independently, so that a test can compare both.
    pub fn costs_when_seen(&self, most: f64) -> Vec<f64> {
        let mut costs = vec![0.0; self.states()];
        for _ in 0..most.max(1.0) as u64 * 10 {
            let change = (0..self.states()).fold(0.0_f64, |change, state| {
                let cost = self.cost_when_seen(&costs, state).min(most);
                let before = std::mem::replace(&mut costs[state], cost);
                change.max((cost - before).abs())
            });
            if change < 1e-9 {
                break;
            }
        }
        costs
    }

    fn cost_when_seen(&self, costs: &[f64], state: usize) -> f64 {
        let row = &self.next[state * self.actions..][..self.actions];
        let (mut least, mut sum) = (f64::INFINITY, 0.0);
        for &next in row {
            let after = costs
                .get(next as usize)
                .map_or(0.0, |cost| self.discount() * cost);
            let cost = self.cost_of_move(state as u32, next) + after;
            least = least.min(cost);
            sum += cost;
        }
        let each = each_other(self.slip, self.actions);
        self.cost_of_step() + (1.0 - self.slip) * least + each * (sum - least)
    }
}
