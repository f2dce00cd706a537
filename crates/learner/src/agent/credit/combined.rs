//! XCSCR: the combined reward method of the paper.
//!
//! Four mechanisms run in a fixed order. Each has its own file and its own switch:
//! 1. [`short_term_filter`](crate::agent::credit::short_term_filter): a collision lowers the value of the rules that
//!    caused it, at once;
//! 2. [`learning_rate`](crate::agent::credit::learning_rate): successes are learned fast, failures slowly;
//! 3. [`imprinting`](crate::agent::credit::imprinting): after a failure, one of the best policies so far is replayed.
//!    [`without_loops`] shortens each policy before it is stored;
//! 4. [`step_threshold`](crate::agent::credit::step_threshold): the time allowed shrinks toward the best policy.

use crate::agent::credit::experts::Experts;
use crate::agent::credit::imprinting::{self, Imprinting, ReplayedStep};
use crate::agent::credit::learning_rate::LearningRate;
use crate::agent::credit::short_term_filter::ShortTermFilter;
use crate::agent::credit::step_threshold::StepThreshold;

use crate::agent::credit::params::Params;
use crate::agent::credit::policy::{Place, Policy, without_loops};
use crate::agent::credit::stack::{RewardStack, Shares};
use crate::agent::credit::step_credit;
use crate::agent::knowledge::Knowledge;
use crate::agent::{Agent, EndCredit, RuleUpdates, StepCredit, Transition};
use xcs::Percept;
use xcs::random::Stream;
use xcs::{MatchSet, Population, PredictionArray, Xcs};

/// The method `xcscr` (paper, section III and figure 1.c). With all four mechanisms switched off it
/// is `adapted-even` or `adapted-discounted`; with [`Experts`] it is `xcscr-coevolved`.
#[derive(Debug, Clone)]
pub struct Combined {
    xcs: Xcs,
    match_set: MatchSet,
    params: Params,
    stack: RewardStack,
    /// Length of the shortest success so far; `usize::MAX` before the first.
    shortest: usize,
    filter: ShortTermFilter,
    learning_rate: LearningRate,
    imprinting: Imprinting,
    /// The experts that choose what is replayed, in `xcscr-coevolved`.
    experts: Option<Experts>,
    step_threshold: StepThreshold,
}

impl Combined {
    /// Wraps an XCS. `stream` drives the random choices of imprinting. The parameters must have been checked.
    pub fn new(xcs: Xcs, params: Params, stream: Stream) -> Self {
        Self {
            filter: ShortTermFilter::new(&params),
            learning_rate: LearningRate::new(&params, xcs.params().beta),
            imprinting: Imprinting::new(&params, stream),
            experts: None,
            step_threshold: StepThreshold::new(&params),
            xcs,
            match_set: MatchSet::default(),
            params,
            stack: RewardStack::default(),
            shortest: usize::MAX,
        }
    }

    /// Adds co-evolving experts. The streams are for their choices, the policy selector and the
    /// behaviour cloner.
    pub fn with_experts(mut self, streams: [Stream; 3]) -> Self {
        let (xcs, goal) = (&self.xcs, self.params.goal);
        self.experts = Some(Experts::new(xcs.params(), xcs.actions(), goal, streams));
        self
    }

    /// Returns \[P\].
    pub fn rules(&self) -> &Population {
        self.xcs.population()
    }

    /// Returns the classifier system.
    pub fn xcs_mut(&mut self) -> &mut Xcs {
        &mut self.xcs
    }

    /// Returns the steps to replay after an episode, if any (Alg. 2): one of the best policies, each step with its
    /// share of the reward of a success (Alg. 4).
    fn replay(&mut self, reached_goal: bool, policy: &Policy) -> Option<Vec<ReplayedStep>> {
        let (shortest, params) = (self.shortest, &self.params);
        let succeeded = |policy: &Policy| {
            let reward = params.long_term(true, policy.len());
            imprinting::replayed_steps(policy, &Shares::new(reward, policy.len(), shortest, params))
        };
        let imprinting = &mut self.imprinting;
        match &mut self.experts {
            None => imprinting.after(reached_goal, policy).map(succeeded),
            Some(experts) => experts.after(reached_goal, policy, imprinting, succeeded),
        }
    }
}

impl Agent for Combined {
    fn begin_episode(&mut self, evolves: bool) {
        self.xcs.let_evolve(evolves);
    }

    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.xcs.form_match_set(percept, &mut self.match_set);
        self.xcs.predict(&self.match_set)
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        let set = self.match_set.action_set(step.action);
        let set = set.expect("`observe` is called before `update` and forms [M]");
        let reward = self.params.short_term(step.outcome);
        let mut credit = step_credit(&self.xcs, &self.match_set, &set, reward);
        let beta = self.learning_rate.after_collision();
        credit.filtered = self.filter.apply(&mut self.xcs, &set, reward, beta);
        let evolution = self.params.stack_evolution;
        self.stack
            .push(&mut self.xcs, set, Place::of(step), evolution);
        credit
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        let steps = self.stack.len();
        if reached_goal {
            self.shortest = self.shortest.min(steps);
        }
        let mut policy = self.stack.policy();
        if reached_goal && self.params.loop_erasure {
            policy = without_loops(policy);
        }
        let long_term_reward = self.params.long_term(reached_goal, steps);
        let learning_rate = self.learning_rate.after(reached_goal);
        let shares = Shares::new(long_term_reward, steps, self.shortest, &self.params);
        let evolution = self.params.stack_evolution;
        self.stack
            .unwind(&mut self.xcs, &shares, learning_rate, evolution);
        let replayed = self.replay(reached_goal, &policy);
        if let Some(replayed_steps) = &replayed {
            let beta = self.learning_rate.after(true);
            imprinting::clone_behaviour(&mut self.xcs, replayed_steps, beta);
        }
        if reached_goal {
            self.step_threshold.learn(steps);
        }
        EndCredit {
            long_term_reward,
            learning_rate,
            imprinted: replayed.is_some(),
        }
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold.steps()
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
