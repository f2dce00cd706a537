//! Planning on beliefs: real-time dynamic programming (RTDP-Bel; Geffner and Bonet 1998).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::belief::{Belief, Branch};
use crate::agent::model::pomdp::{GOAL, Pomdp};
use crate::agent::model::rewards::MOST_STEPS;
use xcs::random::Stream;
use xcs::{Action, MAX_ACTIONS, PredictionArray};

/// The maximum number of beliefs with stored costs. Beyond it, all costs are dropped.
pub const MOST_BELIEFS: usize = 500_000;

/// The maximum number of sweeps over the states of a belief until its costs converge.
const MOST_SWEEPS: usize = 16;

/// The number of weighed states after which sweeping stops. One decision then takes some 50 ms at
/// most.
const MOST_WEIGHED: usize = 300_000;

/// The maximum number of steps of a simulated episode.
pub const MOST_SIMULATED_STEPS: u32 = 100;

/// The effort of a simulated episode.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Effort {
    /// The number of states in all beliefs on the path.
    pub weighed: usize,
    /// The greatest change of the cost of a belief.
    pub change: f64,
}

/// Returns the difference below which a cost counts as equal to another.
fn tie(cost: f64) -> f64 {
    1e-9 * cost.abs().min(1.0)
}

/// The expected cost of each action: steps to the goal or, with auxiliary rewards, the negated
/// value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Costs {
    costs: [f64; MAX_ACTIONS],
    actions: usize,
}

impl Costs {
    /// Returns the costs by action.
    pub fn as_slice(&self) -> &[f64] {
        &self.costs[..self.actions]
    }

    /// Returns the costs by action, in steps from the goal (see [`Pomdp::in_steps`]).
    pub fn in_steps<'a>(&'a self, pomdp: &'a Pomdp) -> impl Iterator<Item = f64> + 'a {
        let costs = self.as_slice().iter();
        costs.map(|&cost| pomdp.in_steps(cost))
    }

    /// Returns by how many steps an action costs more than the best.
    pub fn regret(&self, action: Action, pomdp: &Pomdp) -> f64 {
        pomdp.in_steps(self.costs[action.index()]) - pomdp.in_steps(self.least())
    }

    /// Returns the least cost.
    pub fn least(&self) -> f64 {
        self.as_slice()
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min)
    }

    /// Returns the first action with the least cost.
    pub fn best(&self) -> Action {
        let least = self.least();
        let mut actions = Action::all(self.actions);
        let best = actions.find(|action| self.costs[action.index()] <= least + tie(least));
        best.expect("one of the costs is the least")
    }
}

/// Costs of beliefs. A cost is initialised as if the state were fully observed, which never exceeds the real cost.
/// Beliefs with the same [key](Belief::key) share a cost, which can exceed the real cost of one of them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct BeliefPlanner {
    /// By state: its cost under full observability.
    seen: Vec<f64>,
    /// By key of a belief.
    costs: BTreeMap<u64, f64>,
}

impl BeliefPlanner {
    /// Creates a planner without stored costs.
    pub fn new(pomdp: &Pomdp) -> Self {
        Self {
            seen: pomdp.costs_when_seen(MOST_STEPS),
            costs: BTreeMap::new(),
        }
    }

    /// Returns true if the planner was created for this world.
    pub fn belongs_to(&self, pomdp: &Pomdp) -> bool {
        self.seen == Self::new(pomdp).seen && self.costs.values().all(|cost| cost.is_finite())
    }

    /// Returns the cost of a state under full observability.
    pub fn cost_when_seen(&self, state: u32) -> f64 {
        self.seen[state as usize]
    }

    fn cost(&self, belief: &Belief) -> f64 {
        let known = (!self.costs.is_empty()).then(|| self.costs.get(&belief.key()));
        known.flatten().copied().unwrap_or_else(|| {
            let states = belief.states().iter();
            states
                .map(|&(state, weight)| weight * self.cost_when_seen(state))
                .sum()
        })
    }

    /// Returns the cost of each action in a belief, as planned so far.
    pub fn costs(&self, pomdp: &Pomdp, belief: &Belief) -> Costs {
        self.look_ahead(pomdp, belief).0
    }

    /// Like [`costs`](Self::costs). If moves are exact, first simulates until the costs converge.
    pub fn settled_costs(&mut self, pomdp: &Pomdp, belief: &Belief) -> Costs {
        if pomdp.slip() == 0.0 {
            self.settle(pomdp, belief);
        }
        self.costs(pomdp, belief)
    }

    /// Simulates exact moves from each state of a belief, until the costs converge or the work exceeds a limit.
    pub fn settle(&mut self, pomdp: &Pomdp, belief: &Belief) {
        let mut weighed = 0;
        for _ in 0..MOST_SWEEPS {
            let mut change = 0.0_f64;
            for &(state, _) in belief.states() {
                let next = |state, action| pomdp.next(state, action);
                let effort = self.follow(pomdp, state, belief.clone(), next);
                change = change.max(effort.change);
                weighed += effort.weighed;
                if weighed > MOST_WEIGHED {
                    return;
                }
            }
            if change < 1e-9 {
                break;
            }
        }
    }

    /// Returns the value of each action in a belief: less by 1 for each step from the goal. Of actions with equal
    /// costs, the first has the greatest value. The others may lead to beliefs that no simulated episode visited,
    /// which may cost more than known.
    pub fn values(&self, pomdp: &Pomdp, belief: &Belief) -> PredictionArray {
        let mut values = PredictionArray::new(pomdp.actions());
        let costs = self.costs(pomdp, belief);
        let best = costs.best();
        let greatest = -pomdp.in_steps(costs.least());
        for (action, steps) in Action::all(pomdp.actions()).zip(costs.in_steps(pomdp)) {
            let of_another = greatest.next_down().min(-steps);
            values.set(action, if action == best { greatest } else { of_another });
        }
        values
    }

    /// Returns the number of beliefs with stored costs.
    pub fn beliefs(&self) -> usize {
        self.costs.len()
    }

    /// Returns the costs of the actions, and the branches of the best one.
    fn look_ahead(&self, pomdp: &Pomdp, belief: &Belief) -> (Costs, Vec<Branch>) {
        let mut costs = Costs {
            costs: [0.0; MAX_ACTIONS],
            actions: pomdp.actions(),
        };
        let mut best: Option<(f64, Vec<Branch>)> = None;
        for action in Action::all(pomdp.actions()) {
            let branches = belief.branches(pomdp, action);
            let after = |branch: &Branch| branch.probability * self.cost(&branch.belief);
            let after = branches.iter().map(after).sum::<f64>();
            let cost = belief.cost_of_acting(pomdp, action) + pomdp.discount() * after;
            costs.costs[action.index()] = cost;
            if best.as_ref().is_none_or(|best| cost < best.0 - tie(best.0)) {
                best = Some((cost, branches));
            }
        }
        (costs, best.map_or_else(Vec::new, |best| best.1))
    }

    /// Simulates one greedy episode from a state with initial belief `belief`, and updates the cost
    /// of each belief on the path.
    pub fn simulate(
        &mut self,
        pomdp: &Pomdp,
        start: u32,
        belief: Belief,
        stream: &mut Stream,
    ) -> Effort {
        let next = |state, action| moved(pomdp, state, action, stream);
        self.follow(pomdp, start, belief, next)
    }

    /// Like [`simulate`](Self::simulate), with `next` as the transition function; it returns [`GOAL`]
    /// at a goal.
    fn follow(
        &mut self,
        pomdp: &Pomdp,
        start: u32,
        mut belief: Belief,
        mut next: impl FnMut(u32, Action) -> u32,
    ) -> Effort {
        let (mut state, mut effort) = (start, Effort::default());
        for _ in 0..MOST_SIMULATED_STEPS {
            let (costs, branches) = self.look_ahead(pomdp, &belief);
            effort.weighed += belief.states().len();
            effort.change = effort.change.max(self.store(&belief, costs.least()));
            state = next(state, costs.best());
            if state == GOAL {
                break;
            }
            let look = pomdp.look(state);
            // States that the belief dropped may be the true ones.
            let Some(branch) = branches.into_iter().find(|branch| branch.look == look) else {
                break;
            };
            belief = branch.belief;
        }
        effort
    }

    /// Stores the cost of a belief, and returns the absolute change.
    fn store(&mut self, belief: &Belief, cost: f64) -> f64 {
        if self.costs.len() >= MOST_BELIEFS {
            self.costs.clear();
        }
        let (before, cost) = (self.cost(belief), cost.min(MOST_STEPS));
        self.costs.insert(belief.key(), cost);
        (cost - before).abs()
    }
}

/// Draws the state after an action, or [`GOAL`].
pub fn moved(pomdp: &Pomdp, state: u32, action: Action, stream: &mut Stream) -> u32 {
    if pomdp.slip() == 0.0 || !stream.chance(pomdp.slip()) {
        return pomdp.next(state, action);
    }
    let others = Action::all(pomdp.actions()).filter(|&other| other != action);
    let others: Vec<Action> = others.collect();
    pomdp.next(state, stream.choose(&others).copied().unwrap_or(action))
}
