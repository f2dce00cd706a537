//! Standard XCS and XCSAM: the reward propagates back one step at a time, as in Q-learning.

use crate::agent::credit::params::{Params, StepLimitUpdate, XcsPayment};
use crate::agent::credit::step_credit;
use crate::agent::explorer::Explorer;
use crate::agent::knowledge::Knowledge;
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, RuleUpdates, StepCredit, Transition};
use xcs::Percept;
use xcs::{ActionSet, MatchSet, PredictionArray, Xcs};

/// The methods `xcs` and, with an adaptive mapping, `xcsam`. The previous \[A\] is updated with its
/// reward plus gamma times the greatest value of the present percept. The last \[A\] of an episode
/// is updated with its reward alone.
///
/// [`XcsPayment`] selects the rewards, [`StepLimitUpdate`] the treatment of the step limit.
#[derive(Debug, Clone)]
pub struct Standard {
    xcs: Xcs,
    match_set: MatchSet,
    params: Params,
    /// The greatest value of the present percept.
    greatest: f64,
    previous: Option<Waiting>,
    /// Steps of this episode so far.
    steps: usize,
}

/// An action set whose payoff is not known yet.
#[derive(Debug, Clone)]
struct Waiting {
    set: ActionSet,
    /// Its immediate reward.
    reward: f64,
    /// The greatest value of its percept when the action was chosen.
    greatest: f64,
}

impl Standard {
    /// Wraps an XCS. The parameters must have been checked.
    pub fn new(xcs: Xcs, params: Params) -> Self {
        Self {
            xcs,
            match_set: MatchSet::default(),
            params,
            greatest: 0.0,
            previous: None,
            steps: 0,
        }
    }

    /// Updates an action set with its reward plus the discounted value of the next percept.
    fn learn(&mut self, waiting: &Waiting, followed: f64) {
        let Waiting { set, greatest, .. } = waiting;
        let payoff = waiting.reward + followed;
        let xcs = &mut self.xcs;
        xcs.adapt_mapping(set, payoff, *greatest);
        xcs.update(set, payoff, xcs.params().beta);
        xcs.evolve(set);
    }
}

impl Agent for Standard {
    fn begin_episode(&mut self, evolves: bool) {
        self.xcs.let_evolve(evolves);
    }

    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.xcs.form_match_set(percept, &mut self.match_set);
        let values = self.xcs.predict(&self.match_set);
        self.greatest = values.greatest().unwrap_or(0.0);
        values
    }

    /// Explores only actions that rules of \[M\] advocate, as Butz and Wilson do.
    fn choose(&mut self, _: &Percept, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (action, explores) = explorer.choose_advocated(values);
        Choice::by(DecisionSource::Rules, action, explores)
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        let set = self.match_set.action_set(step.action);
        let set = set.expect("`observe` is called before `update` and forms [M]");
        let reward = self.params.short_term(step.outcome);
        let credit = step_credit(&self.xcs, &self.match_set, &set, reward);
        let greatest = self.greatest;
        let paid = match self.params.xcs_payment {
            XcsPayment::All => reward,
            XcsPayment::Final => 0.0,
        };
        self.steps += 1;
        let waiting = Waiting {
            set,
            reward: paid,
            greatest,
        };
        if let Some(previous) = self.previous.replace(waiting) {
            self.learn(&previous, self.params.gamma * greatest);
        }
        credit
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        let steps = std::mem::take(&mut self.steps);
        let long_term_reward = match self.params.xcs_payment {
            XcsPayment::All if reached_goal => self.params.goal,
            _ => self.params.long_term(reached_goal, steps),
        };
        let counts = reached_goal || self.params.xcs_step_limit == StepLimitUpdate::Failure;
        if let Some(last) = self.previous.take().filter(|_| counts) {
            self.learn(&last, long_term_reward);
        }
        EndCredit::new(long_term_reward, self.xcs.params().beta)
    }

    fn step_threshold(&self) -> u32 {
        self.params.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.xcs.values(percept)
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::of(&self.xcs)
    }

    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        knowledge.initialise(&mut self.xcs)
    }

    fn rule_count(&self) -> usize {
        self.xcs.population().len()
    }

    fn rule_updates(&self) -> RuleUpdates {
        RuleUpdates {
            experience: self.xcs.updates(),
            model: 0,
        }
    }
}
