//! `xcscr-plus` on any environment with discrete percepts: rewards are given, and no action is a move.
//!
//! The state is the percept. Transitions, plan, replay and rules are those of [`XcscrPlus`](super::XcscrPlus). Without a
//! goal that ends a success, rules are credited by the replay alone.
//! What only holds in mazes is left out: collisions, inverse actions, rotational symmetry and slips. Two
//! differences follow:
//! * Exploration is R-max (Brafman and Tennenholtz 2002). A second plan gives every unknown pair the greatest
//!   return seen so far, at least 0. It chooses as long as it has a greater value than the plan on known pairs.
//! * Once the results of a pair vary, a pair is known after several tries instead of one.
//!
//! Values have a floor, the value of an endless walk. Its reward per step is estimated: in every percept
//! whose actions are all known, some action pays at least that much.

use serde::{Deserialize, Serialize};

use crate::agent::Params;
use crate::agent::explorer::exploit;
use crate::agent::model::transitions::{Experience, Transitions};
use crate::agent::planner::sweeping::PlannedValues;
use crate::agent::plus::{Replay, ReplayParams};
use xcs::bounds::{OutOfRange, within};
use xcs::random::Stream;
use xcs::{Action, MAX_ACTIONS, Percept, Population, PredictionArray, Xcs, fewest_rules};
use xcscr_robot::streams::StreamName;

/// Optimistic values must exceed the known values by this share of the value of an unknown pair ...
const MARGIN: f64 = 1e-4;
/// ... or by this share once results have varied. Then the values are estimates.
const MARGIN_IF_VARYING: f64 = 1e-2;
/// The payoff of a best action in a replay; all other actions pay 0.
const SUCCESS: f64 = 1000.0;
/// P# of `xcscr-plus`.
const DONT_CARE: f64 = 0.5;
/// The greatest reward and return, positive or negative.
const GREATEST_REWARD: f64 = 1e12;

/// Parameters of an [`EnvironmentLearner`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EnvironmentParams {
    /// gamma: the discount per step.
    pub gamma: f64,
    /// The return that an unknown action may bring. `None`: the greatest return seen so far, at least 0. A greater one
    /// behind costs may then stay unknown.
    pub best_return: Option<f64>,
    /// The tries that make a pair known, once different percepts have followed some pair: 2 to 10,000.
    pub tries: u32,
    /// N: the maximum number of micro-classifiers in \[P\].
    pub population_size: u32,
}

impl Default for EnvironmentParams {
    fn default() -> Self {
        Self {
            gamma: 0.99,
            best_return: None,
            tries: 20,
            population_size: 5000,
        }
    }
}

impl EnvironmentParams {
    /// Checks all ranges.
    ///
    /// # Errors
    /// The first parameter out of range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("gamma", self.gamma, 0.0..=0.9999)?;
        within("tries", self.tries, 2..=10_000)?;
        within("population_size", self.population_size, 32..=1_000_000)?;
        let range = -GREATEST_REWARD..=GREATEST_REWARD;
        self.best_return
            .map_or(Ok(()), |best| within("best_return", best, range))
    }
}

/// What changes in an episode, and the estimates of the learner.
#[derive(Debug, Clone)]
struct Progress {
    /// Breaks ties between equally good actions.
    stream: Stream,
    /// The percept and the action that wait for a reward.
    waiting: Option<(Percept, Action)>,
    /// The rewards of this episode.
    rewards: Vec<f64>,
    /// The greatest return seen so far, from any step to the end of its episode.
    best_seen: Option<f64>,
    /// The reward per step of an endless walk.
    step: f64,
    /// True once the results of some pair have varied.
    varies: bool,
}

/// Model, plan and rules over the percepts of any environment.
///
/// Call [`act`](Self::act) and [`update`](Self::update) in each step.
#[derive(Debug, Clone)]
pub struct EnvironmentLearner {
    actions: usize,
    params: EnvironmentParams,
    model: Transitions,
    /// Values over known pairs, which are replayed.
    known: PlannedValues,
    /// Upper bounds of the values, which exploration follows.
    optimistic: PlannedValues,
    xcs: Xcs,
    replay: Replay,
    progress: Progress,
}

impl EnvironmentLearner {
    /// Creates an untrained learner.
    ///
    /// # Errors
    /// A parameter or the number of actions (1 to 8) is out of range.
    pub fn new(params: EnvironmentParams, actions: usize, seed: u64) -> Result<Self, OutOfRange> {
        params.check()?;
        within("actions", actions, 1..=MAX_ACTIONS)?;
        let of_rules = xcs::Params {
            population_size: params.population_size,
            dont_care: DONT_CARE,
            ..xcs::Params::default()
        };
        let of_replay = ReplayParams {
            replays: true,
            covers: true,
            success: SUCCESS,
            failure: 0.0,
            beta: of_rules.beta,
        };
        let replay_stream = Stream::new(seed, StreamName::Replay);
        let rewards = Params {
            gamma: params.gamma,
            step: 0.0,
            ..Params::default()
        };
        let plan = PlannedValues::new(actions, &rewards);
        let mut learner = Self {
            actions,
            params,
            model: Transitions::default(),
            known: plan.clone(),
            optimistic: plan,
            xcs: Xcs::new(of_rules, actions, Stream::new(seed, StreamName::Evolution)),
            replay: Replay::new(of_replay, xcs::Layout::default(), replay_stream),
            progress: Progress {
                stream: Stream::new(seed, StreamName::Exploration),
                waiting: None,
                rewards: Vec::new(),
                best_seen: None,
                step: 0.0,
                varies: false,
            },
        };
        learner.replan();
        Ok(learner)
    }

    /// Chooses an action, which waits for [`update`](Self::update): with `explores`, an action with a greater optimistic
    /// value than all known ones, if there is one. Otherwise the rules choose.
    pub fn act(&mut self, percept: &Percept, explores: bool) -> Action {
        let optimistic = if explores {
            self.optimistic_values(percept)
        } else {
            None
        };
        let values = match optimistic {
            Some(values) => values,
            None => self.values(percept),
        };
        let action = exploit(&values, &mut self.progress.stream);
        self.take(percept, action);
        action
    }

    /// Takes the given action as if [`act`](Self::act) had chosen it.
    pub fn take(&mut self, percept: &Percept, action: Action) {
        self.meet(percept);
        self.progress.waiting = (action.index() < self.actions).then_some((*percept, action));
    }

    /// Returns true if an action waits for its reward.
    pub fn is_waiting(&self) -> bool {
        self.progress.waiting.is_some()
    }

    /// Learns from the reward of the last action and the next percept, which is `None` if the episode has ended.
    pub fn update(&mut self, reward: f64, next: Option<&Percept>) {
        let Some((percept, action)) = self.progress.waiting.take() else {
            return;
        };
        self.progress.rewards.push(reward);
        let number = self.meet(&percept);
        let next_number = next.map(|next| self.meet(next));
        let step = Experience {
            percept,
            action,
            reward,
            next: next.copied(),
        };
        let required = self.model.required_tries();
        let changed = self.model.learn(&step, required);
        let tries = self.model.outcomes(number, action).tries();
        let revises = self.revises_estimates(number, action);
        for plan in [&mut self.known, &mut self.optimistic] {
            plan.link(&self.model, (number, action), next_number);
            // Plans follow the counts of varying results at each doubling.
            if changed && (tries <= required || tries.is_power_of_two()) {
                plan.learn(&self.model, (number, action), next_number);
            } else {
                plan.settle(&self.model);
            }
            plan.tidy();
        }
        if revises {
            self.replan();
        }
        // Estimates change in every step, so that they are replayed once in an episode.
        if !self.progress.varies {
            self.replay.learn(self.known.news(&self.model));
            self.replay.after_step(&mut self.xcs, next);
        }
        if next.is_none() {
            self.end_episode();
        }
    }

    /// Ends the episode. Discards an action that waits for its reward.
    pub fn end_episode(&mut self) {
        self.progress.waiting = None;
        let mut total = 0.0;
        let mut best = self.progress.best_seen;
        for reward in self.progress.rewards.drain(..).rev() {
            total = reward + self.params.gamma * total;
            best = Some(best.map_or(total, |best| best.max(total)));
        }
        if best != self.progress.best_seen {
            self.progress.best_seen = best;
            self.assume();
            self.optimistic.restart(&self.model);
        }
        self.replay.learn(self.known.news(&self.model));
        self.replay.after_episode(&mut self.xcs);
    }

    /// Returns the value of each action by the rules, without changing anything.
    pub fn values(&self, percept: &Percept) -> PredictionArray {
        self.xcs.values(percept)
    }

    /// Returns the fewest rules that keep all decisions in the percepts from which a path to a
    /// goal is known.
    pub fn rules(&self) -> Population {
        let known = self.model.sorted();
        let known = known.filter(|&(_, number)| self.known.value(number) > 0.0);
        let percepts: Vec<Percept> = known.map(|(percept, _)| *percept).collect();
        fewest_rules(
            self.population(),
            &percepts,
            self.actions,
            &xcs::Layout::default(),
            false,
        )
    }

    /// Returns \[P\].
    pub fn population(&self) -> &Population {
        self.xcs.population()
    }

    /// Returns the number of a percept, and adds it if it is new.
    fn meet(&mut self, percept: &Percept) -> usize {
        let number = self.model.meet(percept);
        self.known.meet(&self.model);
        self.optimistic.meet(&self.model);
        number
    }

    /// Returns the optimistic values of the actions, if they exceed the known values.
    fn optimistic_values(&mut self, percept: &Percept) -> Option<PredictionArray> {
        let number = self.meet(percept);
        let margin = match self.progress.varies {
            true => MARGIN_IF_VARYING,
            false => MARGIN,
        };
        let known = self.known.value(number) + margin * self.unknown();
        (self.optimistic.value(number) > known).then(|| {
            let mut values = PredictionArray::new(self.actions);
            let optimistic = self.optimistic.action_values(&self.model, number);
            optimistic.for_each(|(action, value)| values.set(action, value));
            values
        })
    }

    /// Returns the value of an unknown pair above the floor.
    fn unknown(&self) -> f64 {
        let floor = self.progress.step / (1.0 - self.params.gamma);
        let seen = self.progress.best_seen.map_or(0.0, |seen| seen.max(0.0));
        let above = self.params.best_return.unwrap_or(seen) - floor;
        // Before any return is better than an endless walk, all unknown pairs are equally good.
        if above > 0.0 { above } else { 1.0 }
    }

    /// Updates the estimates after a transition. Returns true if one changed, so that all values do.
    fn revises_estimates(&mut self, number: usize, action: Action) -> bool {
        let varies = self.progress.varies || self.model.outcomes(number, action).vary();
        let step = self.surest_reward(number).min(self.progress.step);
        let changed = varies != self.progress.varies || step != self.progress.step;
        (self.progress.varies, self.progress.step) = (varies, step);
        self.require();
        changed
    }

    /// Returns the greatest reward that some action of a percept paid at least; 0 if it has an unknown action.
    fn surest_reward(&self, number: usize) -> f64 {
        let least = |action| self.model.outcomes(number, action).least_reward();
        let least: Option<Vec<f64>> = Action::all(self.actions).map(least).collect();
        least.map_or(0.0, |least| {
            least.into_iter().fold(f64::NEG_INFINITY, f64::max)
        })
    }

    fn require(&mut self) {
        let tries = if self.progress.varies {
            self.params.tries
        } else {
            1
        };
        self.model.require(tries);
    }

    /// Gives both plans the estimates.
    fn assume(&mut self) {
        let (step, unknown) = (self.progress.step, self.unknown());
        self.known.assume(step, None);
        self.optimistic.assume(step, Some(unknown));
    }

    /// Computes the values of both plans anew.
    fn replan(&mut self) {
        self.assume();
        self.known.restart(&self.model);
        self.optimistic.restart(&self.model);
    }
}

#[cfg(test)]
mod tests;
