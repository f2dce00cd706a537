//! Planned exploration over percepts: the path to the nearest action whose optimistic value exceeds the known
//! value.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::agent::credit::params::Params;
use crate::agent::model::collision_rules::CollisionRules;
use crate::agent::model::transitions::Transitions;
use crate::agent::planner::sweeping::PlannedValues;
use xcs::random::Stream;
use xcs::{Action, MAX_ACTIONS};

/// The minimum relative amount by which an optimistic value must exceed the known value.
const NEGLIGIBLE: f64 = 1e-9;
/// The number of percepts searched for a path that was left by a slip.
const NEAR: usize = 50;

/// The model, the plan and the collision rules that exploration uses.
pub(in crate::agent) struct Inputs<'a> {
    pub model: &'a Transitions,
    pub known: &'a PlannedValues,
    pub collisions: &'a CollisionRules,
}

/// Searches forward from the present percept. An untried action is assumed to lead straight to the
/// goal, unless a collision or a return is predicted. If nothing is left to try, but no path to a goal
/// is known, the predictions are ignored. The path found is followed until something new is learned.
#[derive(Debug, Clone)]
pub(in crate::agent) struct Exploration {
    actions: usize,
    /// The optimistic value of an untried action above the floor, and the value of an action that
    /// collides. A certain collision is never worth trying.
    goal: f64,
    collision: f64,
    step: f64,
    /// The rest of the path, next step last.
    path: Vec<(usize, Action)>,
    /// counts changes of the model that may change an optimistic value, from 1.
    version: u64,
    /// By percept: the version in which no optimistic value exceeded the known value.
    exhausted: Vec<u64>,
    /// By percept: the optimistic values of its untried actions, and the version that they were
    /// computed in.
    forecasts: Vec<(u64, [f64; MAX_ACTIONS])>,
    search: Search,
}

/// A search, retained to reuse its allocations.
#[derive(Debug, Clone, Default)]
struct Search {
    number: u32,
    open: BinaryHeap<(u64, Reverse<usize>)>,
    /// By percept: how it was reached.
    reached: Vec<Reached>,
    ends: Vec<(usize, Action)>,
}

/// How a percept was reached.
#[derive(Debug, Clone, Copy, Default)]
struct Reached {
    /// The last search that reached it.
    search: u32,
    /// The step that led to it; `None` where the search began.
    before: Option<(usize, Action)>,
    /// The discount of an optimistic value along the path.
    factor: f64,
}

impl Exploration {
    pub fn new(actions: usize, params: &Params, floor: f64) -> Self {
        Self {
            actions,
            goal: params.goal - floor,
            collision: (params.collision - floor).min(0.0),
            step: params.step,
            path: Vec::new(),
            version: 1,
            exhausted: Vec::new(),
            forecasts: Vec::new(),
            search: Search::default(),
        }
    }

    /// Invalidates the plan, because the model changed in a way that may change an optimistic
    /// value.
    pub fn invalidate(&mut self) {
        self.version += 1;
        self.path.clear();
    }

    /// Discards the path at the beginning of an episode.
    pub fn begin(&mut self) {
        self.path.clear();
    }

    /// Marks the successor `to` of a best action as exhausted if `from` is exhausted.
    pub fn follow(&mut self, from: usize, to: usize) {
        if self.is_exhausted(from) {
            self.set_exhausted(to);
        }
    }

    fn is_exhausted(&self, percept: usize) -> bool {
        self.exhausted.get(percept) == Some(&self.version)
    }

    fn set_exhausted(&mut self, percept: usize) {
        let length = self.exhausted.len().max(percept + 1);
        self.exhausted.resize(length, 0);
        self.exhausted[percept] = self.version;
    }

    /// Returns the next step of exploration; `None` if no optimistic value exceeds the known value.
    pub fn next(
        &mut self,
        from: usize,
        inputs: &Inputs<'_>,
        stream: &mut Stream,
    ) -> Option<Action> {
        let is_on_path = self
            .path
            .last()
            .is_some_and(|&(percept, _)| percept == from);
        if !is_on_path && !self.rejoin(from, inputs) {
            self.path.clear();
            if self.is_exhausted(from) {
                return None;
            }
            self.find(from, inputs, true, stream);
            if self.path.is_empty() && inputs.known.value(from) <= 0.0 {
                // No path to a goal is known, so a prediction must be wrong.
                self.find(from, inputs, false, stream);
            }
            if self.path.is_empty() {
                self.set_exhausted(from);
            }
        }
        self.path.pop().map(|(_, action)| action)
    }

    /// Returns to the path after a slip if it is near; otherwise returns false.
    fn rejoin(&mut self, from: usize, inputs: &Inputs<'_>) -> bool {
        if self.path.is_empty() || !inputs.model.slips().any() {
            return false;
        }
        self.search.begin(from, inputs.model.percepts().len());
        for _ in 0..NEAR {
            let Some((factor, percept)) = self.search.pop() else {
                return false;
            };
            if let Some(at) = self.path.iter().position(|&(on_it, _)| on_it == percept) {
                self.path.truncate(at + 1);
                self.search.trace(percept, &mut self.path);
                return true;
            }
            for action in Action::all(self.actions) {
                if let Some((next, left)) = self.step(percept, action, inputs) {
                    self.search.push(factor * left, next, (percept, action));
                }
            }
        }
        false
    }

    /// Finds the path with the greatest optimistic value. Untried actions are as good as predicted if
    /// predictions are trusted, and lead straight to the goal otherwise.
    fn find(&mut self, from: usize, inputs: &Inputs<'_>, trusts: bool, stream: &mut Stream) {
        let mut best = inputs.known.value(from) * (1.0 + NEGLIGIBLE);
        self.search.begin(from, inputs.model.percepts().len());
        while let Some((factor, percept)) = self.search.pop() {
            if factor * self.goal < best {
                break;
            }
            let values = self.optimistic_values(percept, inputs);
            for action in Action::all(self.actions) {
                let moves = values[action.index()] > 0.0;
                let is_doubtful = inputs.model.is_doubtful(percept, action, moves);
                if inputs.model.is_known(percept, action) && !is_doubtful {
                    if let Some((next, left)) = self.step(percept, action, inputs) {
                        self.search.push(factor * left, next, (percept, action));
                    }
                } else if let Some(next) = inputs
                    .known
                    .predicted_return(inputs.model, percept, action)
                    .filter(|_| trusts)
                {
                    let slips = inputs.model.slips();
                    let factor = factor * slips.discount(inputs.known.gamma());
                    self.search.push(factor, next, (percept, action));
                } else {
                    let value = if trusts {
                        values[action.index()]
                    } else {
                        self.goal
                    };
                    self.search
                        .offer(factor * value, (percept, action), &mut best);
                }
            }
        }
        if let Some(&(last, action)) = stream.choose(&self.search.ends) {
            self.path.push((last, action));
            self.search.trace(last, &mut self.path);
        }
    }

    /// Returns the successor of a known pair, and the discount of the step; `None` if it leads nowhere else.
    fn step(&self, percept: usize, action: Action, inputs: &Inputs<'_>) -> Option<(usize, f64)> {
        let Inputs { model, known, .. } = inputs;
        if model.slips().any() && model.is_explained(percept) {
            let next = model.next(percept, action);
            let next = next.filter(|&next| next != percept)?;
            return Some((next, model.slips().discount(known.gamma())));
        }
        let outcomes = model.outcomes(percept, action);
        let (next, share) = outcomes.likeliest_move(percept, self.step)?;
        Some((next, share * known.gamma()))
    }

    /// Returns the optimistic values of the untried actions of a percept, ignoring predicted
    /// returns.
    fn optimistic_values(&mut self, percept: usize, inputs: &Inputs<'_>) -> [f64; MAX_ACTIONS] {
        let length = self.forecasts.len().max(percept + 1);
        self.forecasts.resize(length, (0, [0.0; MAX_ACTIONS]));
        let (version, values) = &mut self.forecasts[percept];
        if *version != inputs.collisions.version() {
            *version = inputs.collisions.version();
            for action in Action::all(self.actions) {
                let percept = &inputs.model.percepts()[percept];
                let bump = inputs.collisions.belief(percept, action);
                values[action.index()] = (1.0 - bump) * self.goal + bump * self.collision;
            }
        }
        *values
    }
}

impl Search {
    fn begin(&mut self, from: usize, met: usize) {
        self.number = self.number.wrapping_add(1);
        self.reached.resize(met, Reached::default());
        self.open.clear();
        self.ends.clear();
        self.reached[from] = Reached {
            search: self.number,
            before: None,
            factor: 1.0,
        };
        self.open.push((1_f64.to_bits(), Reverse(from)));
    }

    /// Removes and returns the reached percept with the greatest factor.
    fn pop(&mut self) -> Option<(f64, usize)> {
        loop {
            let (bits, Reverse(percept)) = self.open.pop()?;
            let factor = f64::from_bits(bits);
            if self.reached[percept].factor == factor {
                // Settled: no later entry has this factor.
                return Some((factor, percept));
            }
        }
    }

    /// Records a step that leads to a percept.
    fn push(&mut self, factor: f64, to: usize, step: (usize, Action)) {
        let reached = &mut self.reached[to];
        if reached.search == self.number && reached.factor >= factor {
            return;
        }
        *reached = Reached {
            search: self.number,
            before: Some(step),
            factor,
        };
        self.open.push((factor.to_bits(), Reverse(to)));
    }

    /// Offers an end of a path with its value. Ends of equal value are collected.
    fn offer(&mut self, value: f64, end: (usize, Action), best: &mut f64) {
        if value > *best {
            *best = value;
            self.ends.clear();
        }
        if value == *best {
            self.ends.push(end);
        }
    }

    /// Appends the steps that lead to a percept, last step first.
    fn trace(&self, last: usize, path: &mut Vec<(usize, Action)>) {
        let mut percept = last;
        while let Some((before, action)) = self.reached[percept].before {
            path.push((before, action));
            percept = before;
        }
    }
}
