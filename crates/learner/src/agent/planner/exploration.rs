//! Planned exploration: the way to the nearest action that promises more than what is known.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::agent::model::collision_rules::CollisionRules;
use crate::agent::model::transitions::Transitions;
use crate::agent::params::Params;
use crate::agent::planner::sweeping::PlannedValues;
use xcs::random::Stream;
use xcs::{Action, MAX_ACTIONS};

/// A promise must exceed what is known by this share of it.
const NEGLIGIBLE: f64 = 1e-9;
/// Percepts among which a way is looked for that was left by a slip.
const NEAR: usize = 50;

/// What exploration is planned on.
pub(in crate::agent) struct Model<'a> {
    pub memory: &'a Transitions,
    pub known: &'a PlannedValues,
    pub collisions: &'a CollisionRules,
}

/// Searches forward from the present percept, in the belief that an untried action leads straight
/// to the goal unless a collision or a way back is predicted. The way that is found is followed
/// until there is news.
#[derive(Debug, Clone)]
pub(in crate::agent) struct Exploration {
    actions: usize,
    /// What an untried action is believed to be worth above the floor, and one that bumps; that is
    /// never worth trying.
    goal: f64,
    collision: f64,
    step: f64,
    /// What is left of the way, the next step last.
    way: Vec<(usize, Action)>,
    /// Counts what was learned that may change a promise, from 1.
    version: u64,
    /// By percept: the version in which nothing promised more than what is known.
    content: Vec<u64>,
    forecasts: Forecasts,
    search: Search,
}

/// By percept: what its untried actions are believed to be worth, and when that was looked up.
#[derive(Debug, Clone, Default)]
struct Forecasts(Vec<(u64, [f64; MAX_ACTIONS])>);

/// A search, kept so that its memory is used again.
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
    /// The share of a promise that is left of it on the way.
    factor: f64,
}

impl Exploration {
    pub fn new(actions: usize, params: &Params, floor: f64) -> Self {
        Self {
            actions,
            goal: params.goal - floor,
            collision: (params.collision - floor).min(0.0),
            step: params.step,
            way: Vec::new(),
            version: 1,
            content: Vec::new(),
            forecasts: Forecasts::default(),
            search: Search::default(),
        }
    }

    /// What learning has changed between two episodes: the version, and what is content.
    pub fn kept(&self) -> (u64, &[u64]) {
        (self.version, &self.content)
    }

    /// Goes on from what was kept.
    pub fn resume(&mut self, (version, content): (u64, Vec<u64>)) {
        (self.version, self.content) = (version, content);
    }

    /// Something was learned that may change a promise.
    pub fn wake(&mut self) {
        self.version += 1;
        self.way.clear();
    }

    /// Forgets where it was going: the robot was put elsewhere.
    pub fn begin(&mut self) {
        self.way.clear();
    }

    /// The way was left: what follows a best action of a percept that promises nothing new does
    /// not, either.
    pub fn follow(&mut self, from: usize, to: usize) {
        if self.is_content(from) {
            self.set_content(to);
        }
    }

    fn is_content(&self, percept: usize) -> bool {
        self.content.get(percept) == Some(&self.version)
    }

    fn set_content(&mut self, percept: usize) {
        let room = self.content.len().max(percept + 1);
        self.content.resize(room, 0);
        self.content[percept] = self.version;
    }

    /// The next step of exploration; `None` where nothing promises more than what is known.
    pub fn next(&mut self, from: usize, model: &Model<'_>, stream: &mut Stream) -> Option<Action> {
        let is_on_the_way = self.way.last().is_some_and(|&(percept, _)| percept == from);
        if !is_on_the_way && !self.rejoin(from, model) {
            self.way.clear();
            if self.is_content(from) {
                return None;
            }
            self.find(from, model, stream);
            if self.way.is_empty() {
                self.set_content(from);
            }
        }
        self.way.pop().map(|(_, action)| action)
    }

    /// After a slip: finds the way again, if it is near; false if it is not.
    fn rejoin(&mut self, from: usize, model: &Model<'_>) -> bool {
        if self.way.is_empty() || !model.memory.slips().any() {
            return false;
        }
        self.search.begin(from, model.memory.percepts().len());
        for _ in 0..NEAR {
            let Some((factor, percept)) = self.search.pop() else {
                return false;
            };
            if let Some(at) = self.way.iter().position(|&(on_it, _)| on_it == percept) {
                self.way.truncate(at + 1);
                self.search.trace(percept, &mut self.way);
                return true;
            }
            for action in Action::all(self.actions) {
                if let Some((next, left)) = self.step(percept, action, model) {
                    self.search.push(factor * left, next, (percept, action));
                }
            }
        }
        false
    }

    /// Finds the most promising way.
    fn find(&mut self, from: usize, model: &Model<'_>, stream: &mut Stream) {
        let mut best = model.known.value(from) * (1.0 + NEGLIGIBLE);
        self.search.begin(from, model.memory.percepts().len());
        while let Some((factor, percept)) = self.search.pop() {
            if factor * self.goal < best {
                break;
            }
            let values = self.believed_values(percept, model);
            for action in Action::all(self.actions) {
                let moves = values[action.index()] > 0.0;
                let is_doubtful = model.memory.is_doubtful(percept, action, moves);
                if model.memory.is_known(percept, action) && !is_doubtful {
                    if let Some((next, left)) = self.step(percept, action, model) {
                        self.search.push(factor * left, next, (percept, action));
                    }
                } else if let Some(next) = model.known.way_back(model.memory, percept, action) {
                    let slips = model.memory.slips();
                    let factor = factor * slips.discount(model.known.gamma());
                    self.search.push(factor, next, (percept, action));
                } else {
                    let value = factor * values[action.index()];
                    self.search.offer(value, (percept, action), &mut best);
                }
            }
        }
        if let Some(&(last, action)) = stream.choose(&self.search.ends) {
            self.way.push((last, action));
            self.search.trace(last, &mut self.way);
        }
    }

    /// Where a known pair leads, and what is left of a promise on the way; `None` if it leads nowhere
    /// else.
    fn step(&self, percept: usize, action: Action, model: &Model<'_>) -> Option<(usize, f64)> {
        let Model { memory, known, .. } = model;
        if memory.slips().any() && memory.is_explained(percept) {
            let next = memory.next(percept, action);
            let next = next.filter(|&next| next != percept)?;
            return Some((next, memory.slips().discount(known.gamma())));
        }
        let outcomes = memory.outcomes(percept, action);
        let (next, share) = outcomes.likeliest_move(percept, self.step)?;
        Some((next, share * known.gamma()))
    }

    /// What the untried actions of a percept are believed to be worth, where no way back is.
    fn believed_values(&mut self, percept: usize, model: &Model<'_>) -> [f64; MAX_ACTIONS] {
        let room = self.forecasts.0.len().max(percept + 1);
        self.forecasts.0.resize(room, (0, [0.0; MAX_ACTIONS]));
        let (version, values) = &mut self.forecasts.0[percept];
        if *version != model.collisions.version() {
            *version = model.collisions.version();
            for action in Action::all(self.actions) {
                let percept = &model.memory.percepts()[percept];
                let bump = model.collisions.belief(percept, action);
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

    /// The reached percept with the greatest factor.
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

    /// A step leads to a percept.
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

    /// A way may end here, with this value; ways of equal value are collected.
    fn offer(&mut self, value: f64, end: (usize, Action), best: &mut f64) {
        if value > *best {
            *best = value;
            self.ends.clear();
        }
        if value == *best {
            self.ends.push(end);
        }
    }

    /// The steps that lead to a percept, the last one first.
    fn trace(&self, last: usize, way: &mut Vec<(usize, Action)>) {
        let mut percept = last;
        while let Some((before, action)) = self.reached[percept].before {
            way.push((before, action));
            percept = before;
        }
    }
}
