//! A maze that is known, and a robot that is not sure where in it it is: a partially observable
//! Markov decision process whose moves may slip (Kaelbling, Littman and Cassandra 1998).
//!
//! [`Pomdp`] says what moves do and what is perceived, [`Belief`] how likely each state is, and
//! [`BeliefPlanner`] what the best action costs.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::belief::Belief;
use crate::agent::model::rewards::RewardModel;
use crate::agent::model::slips::each_other;
use xcs::{Action, MAX_ACTIONS, Percept};

/// In place of a state: the goal, where the episode ends.
pub const GOAL: u32 = u32::MAX;

/// States, what is perceived in each, and what each action does there. Every step costs 1, unless
/// there are [`RewardModel`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Pomdp {
    actions: usize,
    /// The probability that another action than the chosen one is executed ([`each_other`]).
    slip: f64,
    /// By state and action: the state that it leads to when executed, or [`GOAL`].
    next: Vec<u32>,
    /// By state: the number of its percept.
    looks: Vec<u32>,
    /// All percepts, in order.
    percepts: Vec<Percept>,
    rewards: Option<RewardModel>,
}

impl Pomdp {
    /// States by their percepts; `next` gives the state, or [`GOAL`], that an executed action leads
    /// to. With probability `slip` another action than the chosen one is executed, each with the same chance.
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

    /// The same where more is paid than at the goal.
    pub fn with_prizes(self, rewards: RewardModel) -> Self {
        let rewards = Some(rewards);
        Self { rewards, ..self }
    }

    /// The number of states, the goal not counted.
    pub fn states(&self) -> usize {
        self.looks.len()
    }

    /// The number of percepts.
    pub fn looks(&self) -> usize {
        self.percepts.len()
    }

    /// The number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// The probability that a move slips.
    pub fn slip(&self) -> f64 {
        self.slip
    }

    /// What is perceived in a state.
    pub fn percept(&self, state: u32) -> &Percept {
        &self.percepts[self.look(state) as usize]
    }

    /// The number of what is perceived in a state: the same for states that look alike.
    pub fn look(&self, state: u32) -> u32 {
        self.looks[state as usize]
    }

    /// The number of a percept; `None` when no state looks like that.
    pub fn look_of(&self, percept: &Percept) -> Option<u32> {
        self.percepts
            .binary_search(percept)
            .ok()
            .map(|at| at as u32)
    }

    /// The state that an executed action leads to, or [`GOAL`].
    pub fn next(&self, state: u32, executed: Action) -> u32 {
        self.next[state as usize * self.actions + executed.index()]
    }

    /// All states that look like this.
    pub fn alike(&self, look: u32) -> impl Iterator<Item = u32> + '_ {
        let states = 0..self.states() as u32;
        states.filter(move |&state| self.look(state) == look)
    }

    /// What is believed when an episode begins anywhere and looks like this.
    pub fn first_belief(&self, look: u32) -> Belief {
        Belief::even(self.alike(look))
    }

    /// Does every number in it mean something?
    pub fn is_sound(&self) -> bool {
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
                .is_none_or(|rewards| rewards.is_sound(states))
    }

    /// What is paid on the way.
    pub fn rewards(&self) -> Option<&RewardModel> {
        self.rewards.as_ref()
    }

    /// What a later step counts for, beside the one now.
    pub fn discount(&self) -> f64 {
        self.rewards().map_or(1.0, |rewards| rewards.discount)
    }

    /// What every step costs.
    pub fn cost_of_step(&self) -> f64 {
        if self.rewards.is_none() { 1.0 } else { 0.0 }
    }

    /// What a move from a state to the next costs beside that, without what follows it.
    pub fn cost_of_move(&self, state: u32, next: u32) -> f64 {
        self.rewards()
            .map_or(0.0, |rewards| -rewards.gain(state, next))
    }

    /// The steps from the goal at which one is as well off as with such a cost, were there nothing
    /// but the goal.
    pub fn in_steps(&self, cost: f64) -> f64 {
        self.rewards()
            .map_or(cost, |rewards| rewards.in_steps(-cost))
    }

    /// What each state costs one who sees the state (value iteration), at most `most`; without prizes
    /// that is the expected steps to the goal.
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
