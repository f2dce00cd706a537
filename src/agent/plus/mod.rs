//! XCSCR-plus: the paper's architecture with each mechanism repaired.
//!
//! Rules are learned specific, from Bellman targets over remembered transitions; exploration is
//! planned; collisions are foretold by general rules. The mechanisms, each with its switch in
//! [`PlusParams`], in the order in which they come into play:
//! 1. `curiosity`: exploration heads for the least-tried actions;
//! 2. `collision_rules`: general rules learned from bumps spare later ones, with `turned_rules`
//!    those of all actions at once;
//! 3. `return_rules`: general rules about ways back spare trying them;
//! 4. `sweep`: Bellman targets, replayed by frequency and swept backward;
//! 5. `imprinting`: loop-erased successes, where they returned more than expected;
//! 6. `step_threshold`: tightens with slack.
//!
//! The study `repairs` switches each off in turn. In the paper's mazes imprinting, the bounded
//! short-term target and the step-threshold make no difference beside the others.

mod bumps;
mod collision_rules;
mod curiosity;
mod imprinting;
mod params;
mod return_rules;
mod step_threshold;
mod sweep;

pub use params::PlusParams;

use serde::{Deserialize, Serialize};

use collision_rules::CollisionRules;
use curiosity::Curiosity;
use imprinting::Path;
use return_rules::ReturnRules;
use step_threshold::StepThreshold;

use super::credit::Params;
use super::credit::mind::Mind;
use super::explorer::Explorer;
use super::knowledge::Knowledge;
use super::memory::{self, MemoryError};
use super::model::Foresight;
use super::model::transitions::{Transition, Transitions};
use super::{Agent, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::random::Stream;
use xcs::{Action, Percept};
use xcs::{Params as XcsParams, PredictionArray, Xcs};

/// The method `xcscr-plus`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Plus {
    mind: Mind,
    params: Params,
    own: PlusParams,
    memory: Transitions,
    collisions: CollisionRules,
    returns: ReturnRules,
    curiosity: Curiosity,
    step_threshold: StepThreshold,
    /// Draws what is replayed.
    stream: Stream,
    /// The number of the percept under consideration.
    percept: usize,
    /// The steps of this episode.
    #[serde(skip)]
    path: Path,
    /// Did the last step bump? Then what comes after it is known at once.
    bumped: bool,
    /// Was anything learned since values last settled?
    unsettled: bool,
}

impl Plus {
    /// A learner for `actions` actions and percepts whose first `ring` bits lie in a ring around the
    /// robot. Its rules draw from `evolution` and its replays from `replay`. The parameters must
    /// have been checked.
    pub fn new(
        xcs: XcsParams,
        [actions, ring]: [usize; 2],
        params: Params,
        own: PlusParams,
        [evolution, replay]: [Stream; 2],
    ) -> Self {
        let ring = if own.turned_rules { ring } else { 0 };
        // Eq. 6 is that of XCS.
        // Specific rules while learning: the GA and subsumption would mix what is not yet known
        // to be alike. Generalisation comes last, when the rules are condensed.
        let xcs = XcsParams {
            dont_care: own.dont_care,
            worth_over_match_set: false,
            ga: false,
            ga_subsumption: false,
            action_set_subsumption: false,
            ..xcs
        };
        Self {
            mind: Mind::new(Xcs::new(xcs, actions, evolution)),
            memory: Transitions::default(),
            collisions: CollisionRules::new(actions, ring),
            returns: ReturnRules::new(actions),
            curiosity: Curiosity::new(actions, &params, own.certainty),
            step_threshold: StepThreshold::new(
                params.step_threshold,
                params.beta_step_threshold,
                &own,
            ),
            stream: replay,
            percept: 0,
            path: Path::new(),
            bumped: false,
            unsettled: false,
            params,
            own,
        }
    }

    /// Can this method, read from a file, stand for one that began as `fresh`?
    fn descends_from(&self, fresh: &Self) -> bool {
        (&self.params, &self.own) == (&fresh.params, &fresh.own)
            && self.mind.descends_from(&fresh.mind)
            && self.memory.is_sound()
            && self.percept < self.memory.percepts().len().max(1)
            && self.collisions.descends_from(&fresh.collisions)
            && self.returns.descends_from(&fresh.returns)
            && self.curiosity.descends_from(&fresh.curiosity)
            && self.step_threshold.descends_from(&fresh.step_threshold)
    }

    /// Learns the last step, now that it is known what came after it.
    fn learn_last_step(&mut self, next: Option<Percept>) {
        let Some(&(percept, action, reward)) = self.path.last() else {
            return;
        };
        let step = Transition {
            percept,
            action,
            reward,
            next,
        };
        self.learn_return(next);
        if self.memory.learn(&step, 1) {
            self.curiosity.wake();
            self.unsettled = true;
        }
        if !self.own.bellman {
            return;
        }
        if !self.bumped || self.own.short_term_target {
            let number = self.memory.meet(&percept);
            self.update((number, action));
        }
        for _ in 0..self.own.replays {
            if let Some(&pair) = self.stream.choose(self.memory.tried()) {
                self.update(pair);
            }
        }
    }

    /// Learns whether the last two steps led there and back.
    fn learn_return(&mut self, next: Option<Percept>) {
        let [.., (from, there, _), (middle, back, _)] = self.path[..] else {
            return;
        };
        if self.own.return_rules && from != middle && !self.bumped {
            self.returns.learn(there, back, next == Some(from));
        }
    }

    fn update(&mut self, pair: (usize, Action)) {
        let (gamma, beta) = (self.params.gamma, self.own.beta);
        sweep::update(&mut self.mind.xcs, &self.memory, pair, gamma, beta);
    }

    /// Without Bellman targets: every step takes the return that followed it, as in Eq. 9.
    fn learn_returns(&mut self, path: &[(Percept, Action, f64)]) {
        let mut return_ = 0.0;
        for (percept, action, reward) in path.iter().rev() {
            return_ = reward + self.params.gamma * return_;
            let set = self.mind.xcs.matching_action_set(percept, *action);
            let beta = self.mind.xcs.params().beta;
            self.mind.xcs.update(&set, return_, beta);
        }
    }

    /// Learns from the whole episode; true if a policy was imprinted.
    fn learn_episode(&mut self, path: &[(Percept, Action, f64)], reached_goal: bool) -> bool {
        let (gamma, beta) = (self.params.gamma, self.own.beta);
        if !self.own.bellman {
            self.learn_returns(path);
        }
        let imprinted = self.own.imprinting && reached_goal && {
            let erased = imprinting::loop_erased(path);
            imprinting::imprint(&mut self.mind.xcs, &erased, gamma, beta)
        };
        let unsettled = std::mem::take(&mut self.unsettled) || imprinted;
        if self.own.bellman && self.own.sweep && unsettled {
            sweep::sweep(&mut self.mind.xcs, &self.memory, gamma, beta);
        }
        imprinted
    }
}

impl Agent for Plus {
    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        let met = self.memory.percepts().len();
        self.percept = self.memory.meet(percept);
        if self.percept == met {
            self.curiosity.wake();
        }
        self.learn_last_step(Some(*percept));
        self.mind.consider(percept);
        self.mind.xcs.experienced_worth(percept)
    }

    fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> (Action, bool) {
        if !self.own.least_tried_first {
            return explorer.choose(worth);
        }
        let promise =
            self.curiosity
                .promise(self.percept, &self.memory, &self.collisions, &self.returns);
        let action = explorer.exploit(&promise);
        let explores = !worth.best_actions().any(|best| best == action);
        (action, explores)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let set = self.mind.action_set(action);
        let short_term_reward = self.params.short_term(outcome);
        let credit = self.mind.step_credit(&set, short_term_reward);
        self.bumped = matches!(outcome, Outcome::Collided { .. });
        let costless = !self.own.step_cost && !self.bumped;
        let reward = if costless { 0.0 } else { short_term_reward };
        if self.own.collision_rules && self.collisions.learn(&set.percept, action, self.bumped) {
            self.curiosity.wake();
        }
        self.path.push((set.percept, action, reward));
        credit
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        let steps = self.path.len();
        let long_term_reward = if reached_goal { self.params.goal } else { 0.0 };
        if let Some((percept, _, reward)) = self.path.last_mut() {
            *reward += long_term_reward;
            let percept = *percept;
            if reached_goal {
                self.learn_last_step(None);
                self.step_threshold.learn(steps);
            } else if self.bumped {
                self.learn_last_step(Some(percept));
            }
        }
        let path = std::mem::take(&mut self.path);
        let imprinted = self.learn_episode(&path, reached_goal);
        EndCredit {
            long_term_reward,
            learning_rate: match self.own.bellman {
                true => self.own.beta,
                false => self.mind.xcs.params().beta,
            },
            imprinted,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold.steps()
    }

    /// Only rules with experience count: the others say what was assumed, not what was learned.
    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.mind.xcs.experienced_worth(percept)
    }

    fn knowledge(&self) -> Knowledge {
        let rules = self.mind.xcs.population().rules().iter();
        let experienced: Vec<_> = rules.filter(|rule| rule.experience > 0).copied().collect();
        Knowledge::Foresighted {
            rules: experienced
                .try_into()
                .expect("rules of a population form one"),
            foresight: Foresight {
                collisions: self.collisions.rules(),
                returns: self.returns.rules().collect(),
            },
        }
    }

    /// Only the foresight: what actions are worth in one maze says nothing of the next.
    fn bring(&mut self, knowledge: &Knowledge) -> bool {
        let Knowledge::Foresighted { foresight, .. } = knowledge else {
            return false;
        };
        if self.own.collision_rules {
            self.collisions.bring(&foresight.collisions);
        }
        if self.own.return_rules {
            self.returns.bring(&foresight.returns);
        }
        true
    }

    fn rule_count(&self) -> usize {
        let rules = self.mind.xcs.population().rules().iter();
        rules.filter(|rule| rule.experience > 0).count()
    }

    fn memory(&self) -> Vec<u8> {
        memory::of(self)
    }

    fn restored(&self, saved: &[u8]) -> Result<Box<dyn Agent>, MemoryError> {
        let method = memory::recall(saved, |it: &Self| it.descends_from(self))?;
        Ok(Box::new(method))
    }
}
