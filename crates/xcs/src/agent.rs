//! XCS as an agent, driven one action at a time.

use serde::{Deserialize, Serialize};

use crate::action::Action;
use crate::bounds::{OutOfRange, within};
use crate::condition::Condition;
use crate::learner::Xcs;
use crate::params::{GREATEST_POPULATION, Params};
use crate::population::{MOST_STEPS, Population};
use crate::random::Stream;
use crate::representation::Representation;
use crate::sets::{ActionSet, MatchSet};

/// The fewest micro-classifiers per action. With fewer, covering might never end.
const RULES_PER_ACTION: u32 = 4;

/// Standard XCS for a caller that carries out the actions: call `act`, then `update`, in each step.
///
/// [`Runner`](crate::Runner) does this for an [`Environment`](crate::Environment). The same calls,
/// parameters and seed give the same rules on every machine.
#[derive(Debug, Clone)]
pub struct Agent<C: Representation = Condition> {
    /// gamma: the discount factor of rewards, 0 to 1; 0.71 by default, as in Butz and Wilson. It
    /// has no effect in single-step problems.
    pub gamma: f64,
    /// p_explr: the probability that a learning step takes a random action instead of one of the
    /// best; 0 to 1. By default 0.5.
    pub exploration: f64,
    /// Lets epsilon_0 grow to this share of the largest absolute reward so far. It never falls below
    /// that of the parameters, where it begins. By default `None`: it does not grow.
    pub error_share: Option<f64>,
    xcs: Xcs<C>,
    match_set: MatchSet<C>,
    /// True if `update` formed \[M\] for the next call of `act`.
    is_formed: bool,
    /// The action set waiting for its reward.
    waiting: Option<ActionSet<C>>,
    choices: Stream,
}

/// The form of [`AgentState`]. Another number is another form, which is refused.
const VERSION: u32 = 1;

/// The state of an [`Agent`]. An agent with the same parameters continues from it exactly, even
/// within an episode.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound = "C: Representation")]
pub struct AgentState<C: Representation = Condition> {
    version: u32,
    rules: Population<C>,
    time: u64,
    evolves: bool,
    epsilon_0: f64,
    /// The streams of the classifier system and of the choices.
    streams: [Stream; 2],
    /// \[M\], if `update` formed it.
    formed: Option<MatchSet<C>>,
    waiting: Option<ActionSet<C>>,
}

/// The consumers of random numbers.
enum Draws {
    Evolution,
    Choices,
}

impl From<Draws> for u64 {
    fn from(who: Draws) -> Self {
        who as Self
    }
}

impl<C: Representation> Agent<C> {
    /// Creates an untrained agent for `actions` actions (1 to [`Representation::MAX_ACTIONS`]).
    ///
    /// # Errors
    /// Returns an error if a parameter, a setting or the number of actions is out of range. Also if
    /// the population has room for fewer than four micro-classifiers per action.
    pub fn new(
        params: Params,
        settings: C::Settings,
        actions: usize,
        seed: u64,
    ) -> Result<Self, OutOfRange> {
        params.check()?;
        C::check(&settings)?;
        within("actions", actions, 1..=C::MAX_ACTIONS)?;
        let fewest = RULES_PER_ACTION * actions as u32;
        let range = fewest..=GREATEST_POPULATION;
        within("xcs.population_size", params.population_size, range)?;
        let evolution = Stream::new(seed, Draws::Evolution);
        Ok(Self {
            gamma: 0.71,
            exploration: 0.5,
            error_share: None,
            xcs: Xcs::with_settings(params, settings, actions, evolution),
            match_set: MatchSet::default(),
            is_formed: false,
            waiting: None,
            choices: Stream::new(seed, Draws::Choices),
        })
    }

    /// Returns the learner.
    pub fn xcs(&self) -> &Xcs<C> {
        &self.xcs
    }

    /// Continues with rules made elsewhere in place of \[P\].
    pub fn start_from(&mut self, rules: &Population<C>) {
        self.end_episode();
        self.xcs.start_from(rules);
    }

    /// Returns whether an action waits for its reward.
    pub fn is_waiting(&self) -> bool {
        self.waiting.is_some()
    }

    /// Forms \[M\], with covering, and chooses an action. With `explores`, the action is random
    /// with probability `exploration`; otherwise it is one of the best. Discards an action that is
    /// still waiting for its reward.
    pub fn act(&mut self, percept: &C::Percept, explores: bool) -> Option<Action> {
        self.form_match_set(percept);
        let action = if explores && self.choices.chance(self.exploration) {
            Action::new(self.choices.below(self.xcs.actions()))
        } else {
            let sums = self.match_set.sums();
            let best = sums.best(self.xcs.actions(), self.over_match_set());
            self.choices.choose(&best).copied()
        };
        self.waiting = action.and_then(|action| self.match_set.action_set(action));
        action
    }

    /// Forms \[M\], with covering, and takes the given action as if `act` had chosen it. Does
    /// nothing if the agent does not have the action.
    pub fn take(&mut self, percept: &C::Percept, action: Action) {
        if action.index() < self.xcs.actions() {
            self.form_match_set(percept);
            self.waiting = self.match_set.action_set(action);
        }
    }

    fn form_match_set(&mut self, percept: &C::Percept) {
        if !(self.is_formed && self.match_set.percept() == Some(percept)) {
            self.xcs.form_match_set(percept, &mut self.match_set);
        }
        self.is_formed = false;
    }

    /// Updates the last action set with its reward plus gamma times the greatest value of the next
    /// percept, and runs the GA in it. `next` is `None` at the end of an episode. Does nothing if
    /// no action is waiting for its reward.
    pub fn update(&mut self, reward: f64, next: Option<&C::Percept>) {
        let Some(set) = self.waiting.take() else {
            return;
        };
        if let Some(share) = self.error_share {
            let epsilon_0 = &mut self.xcs.params.epsilon_0;
            *epsilon_0 = (share * reward.abs()).max(*epsilon_0);
        }
        let mut payoff = reward;
        if let Some(next) = next {
            self.xcs.form_match_set(next, &mut self.match_set);
            self.is_formed = true;
            let values = |action| self.match_set.sums().value(action, self.over_match_set());
            let all = Action::all(self.xcs.actions()).filter_map(values);
            payoff += self.gamma * all.reduce(f64::max).unwrap_or(0.0);
        }
        self.xcs.update(&set, payoff, self.xcs.params().beta);
        self.xcs.evolve(&set);
    }

    /// Discards the action waiting for its reward, and the percept after it.
    pub fn end_episode(&mut self) {
        self.waiting = None;
        self.is_formed = false;
    }

    /// Returns one of the best actions without learning; `None` if no rule matches. Draws a random
    /// number if several actions are best.
    pub fn best_action(&mut self, percept: &C::Percept) -> Option<Action> {
        let sums = self.xcs.population().sums(percept);
        let best = sums.best(self.xcs.actions(), self.over_match_set());
        self.choices.choose(&best).copied()
    }

    /// Returns the state, from which an agent with the same parameters continues exactly.
    pub fn state(&self) -> AgentState<C> {
        let xcs = &self.xcs;
        let (mut formed, mut waiting) = (None, self.waiting.clone());
        if self.is_formed {
            formed = Some(self.match_set.clone());
        }
        formed
            .iter_mut()
            .for_each(|set| set.renumber(&xcs.population));
        waiting
            .iter_mut()
            .for_each(|set| set.renumber(&xcs.population));
        AgentState {
            version: VERSION,
            rules: xcs.population.changed(|_| ()),
            time: xcs.time,
            evolves: xcs.evolves,
            epsilon_0: xcs.params.epsilon_0,
            streams: [&xcs.stream, &self.choices].map(Stream::clone),
            formed,
            waiting,
        }
    }

    /// Continues from the state of an agent with the same parameters. Returns `false`, and changes
    /// nothing, if the state cannot come from such an agent.
    pub fn restore(&mut self, state: AgentState<C>) -> bool {
        if !self.could_have(&state) {
            return false;
        }
        let xcs = &mut self.xcs;
        xcs.population = state.rules;
        (xcs.time, xcs.evolves) = (state.time, state.evolves);
        xcs.params.epsilon_0 = state.epsilon_0;
        [xcs.stream, self.choices] = state.streams;
        self.is_formed = state.formed.is_some();
        self.match_set = state.formed.unwrap_or_default();
        self.waiting = state.waiting;
        true
    }

    /// Returns true if a state can come from an agent with these parameters.
    fn could_have(&self, state: &AgentState<C>) -> bool {
        let actions = self.xcs.actions();
        let rules = state.rules.rules().iter().map(|rule| rule.action);
        let mut used = rules.chain(state.waiting.iter().map(|set| set.action));
        let formed = state.formed.as_ref();
        state.version == VERSION
            && state.epsilon_0 > 0.0
            && state.time <= MOST_STEPS
            && state.rules.micro() <= self.xcs.params().population_size
            && used.all(|action| action.index() < actions)
            && formed.is_none_or(|set| set.percept().is_some() && set.members().len() <= actions)
    }

    fn over_match_set(&self) -> bool {
        self.xcs.params().value_over_match_set
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{IntervalSettings, Intervals, Percept, RealPercept};

    fn agent<C: Representation>(actions: usize, settings: C::Settings) -> Agent<C> {
        Agent::new(Params::default(), settings, actions, 1).unwrap()
    }

    #[test]
    fn a_reward_is_discounted_by_the_next_percepts_greatest_value() {
        let params = Params {
            dont_care: 0.0,
            ..Params::default()
        };
        let mut agent: Agent = Agent::new(params, (), 2, 1).unwrap();
        let [first, second]: [Percept; 2] = ["01", "10"].map(|text| text.parse().unwrap());
        agent.exploration = 0.0;
        let last = agent.act(&second, true).unwrap();
        agent.update(100.0, None);
        let action = agent.act(&first, true).unwrap();
        agent.update(5.0, Some(&second));
        // The first update of a rule sets its prediction: 100, and 5 + 0.71 * 100.
        let value = |percept, action: Action| agent.xcs().action_values(percept)[action.index()];
        assert_eq!(value(&second, last), Some(100.0));
        assert_eq!(value(&first, action), Some(76.0));
    }

    #[test]
    fn epsilon_0_follows_the_largest_reward_and_is_restored() {
        let mut agent: Agent = agent(2, ());
        agent.xcs.params.epsilon_0 = 1e-9;
        agent.error_share = Some(0.01);
        let percept = "01".parse().unwrap();
        let mut learned = |reward| {
            agent.act(&percept, true);
            agent.update(reward, None);
            agent.xcs().params().epsilon_0
        };
        assert_eq!(
            [0.0, 1.0, -100.0, 5.0].map(&mut learned),
            [1e-9, 0.01, 1.0, 1.0]
        );
        let state = agent.state();
        let mut other: Agent = super::Agent::new(Params::default(), (), 2, 1).unwrap();
        assert!(other.restore(state));
        assert_eq!(other.xcs().params().epsilon_0, 1.0);
    }

    #[test]
    fn a_given_action_is_rewarded_and_one_beyond_the_last_does_nothing() {
        let mut agent: Agent = agent(3, ());
        let percept = "01".parse().unwrap();
        let [given, beyond] = [2, 3].map(|index| Action::new(index).unwrap());
        agent.take(&percept, given);
        agent.update(10.0, None);
        assert_eq!(agent.xcs().action_values(&percept)[2], Some(10.0));
        agent.take(&percept, beyond);
        assert!(!agent.is_waiting());
    }

    #[test]
    fn a_restored_agent_continues_bit_for_bit_within_an_episode() {
        let mut agent: Agent<Intervals> = agent(12, IntervalSettings::default());
        let percept = |at: usize| RealPercept::new(&[(at % 7) as f64 / 6.0, 0.5]).unwrap();
        let step = |agent: &mut Agent<Intervals>, at: usize| {
            let action = agent.act(&percept(at), true).unwrap();
            let reward = if action.index() == at % 7 {
                1000.0
            } else {
                0.0
            };
            agent.update(reward, Some(&percept(at + 1)));
        };
        (0..2000).for_each(|at| step(&mut agent, at));
        agent.act(&percept(2000), true).unwrap();
        let bytes = postcard::to_allocvec(&agent.state()).unwrap();
        let mut restored = agent.clone();
        restored.end_episode();
        let state = postcard::from_bytes(&bytes).unwrap();
        assert!(restored.restore(state));
        for agent in [&mut agent, &mut restored] {
            agent.update(1.0, Some(&percept(2001)));
        }
        // Between `update` and `act`, \[M\] is part of the state.
        let bytes = postcard::to_allocvec(&agent.state()).unwrap();
        assert!(restored.restore(postcard::from_bytes(&bytes).unwrap()));
        for agent in [&mut agent, &mut restored] {
            (2001..2500).for_each(|at| step(agent, at));
        }
        assert_eq!(agent.state(), restored.state());
    }

    #[test]
    fn a_state_of_an_agent_with_more_actions_is_refused() {
        let mut wide: Agent<Intervals> = agent(12, IntervalSettings::default());
        wide.act(&RealPercept::new(&[0.5]).unwrap(), true);
        let mut narrow: Agent<Intervals> = agent(2, IntervalSettings::default());
        let before = narrow.state();
        assert!(!narrow.restore(wide.state()));
        assert_eq!(narrow.state(), before);
    }

    #[test]
    fn a_population_too_small_for_all_actions_is_refused() {
        let params = Params {
            population_size: 399,
            ..Params::default()
        };
        let settings = IntervalSettings::default();
        let error = Agent::<Intervals>::new(params, settings, 100, 1).err();
        assert_eq!(
            error.unwrap().to_string(),
            "`xcs.population_size` is 399, but must be from 400 to 1000000"
        );
    }
}
