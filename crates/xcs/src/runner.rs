//! The loop of perceiving, acting and learning in any [`Environment`].

use crate::action::Action;
use crate::agent::Agent;
use crate::bounds::OutOfRange;
use crate::condition::Condition;
use crate::learner::Xcs;
use crate::params::Params;
use crate::percept::Percept;
use crate::representation::Representation;

/// An environment: it returns percepts and rewards, and takes actions.
///
/// A classification task is an environment whose episodes end after one action (single-step). In
/// all other environments the reward is discounted and propagated back from step to step
/// (multistep).
pub trait Environment<C: Representation = Condition> {
    /// Returns the number of actions, 1 to [`Representation::MAX_ACTIONS`]; always the same.
    fn actions(&self) -> usize;

    /// Starts an episode and returns its first percept. All percepts have the same width.
    fn begin(&mut self) -> C::Percept;

    /// Carries out an action, one of the first [`actions`](Self::actions).
    fn act(&mut self, action: Action) -> Response<C::Percept>;
}

/// The result of an action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<P = Percept> {
    /// The reward, a finite number.
    pub reward: f64,
    /// The next percept; `None` when the episode has ended.
    pub next: Option<P>,
}

/// The result of an episode.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Episode {
    /// The number of actions carried out.
    pub steps: u32,
    /// The sum of the rewards.
    pub reward: f64,
    /// True if the environment ended the episode, false if the step limit did.
    pub ended: bool,
}

/// Standard XCS in an environment, one episode at a time (Butz and Wilson 2001, RUN EXPERIMENT).
///
/// The same environment, parameters and seed give the same rules on every machine.
#[derive(Debug, Clone)]
pub struct Runner<E, C: Representation = Condition> {
    /// The environment.
    pub environment: E,
    /// The learner, with its discount factor and its exploration rate.
    pub agent: Agent<C>,
    /// The maximum number of steps per episode; by default 1000.
    pub step_limit: u32,
}

impl<E: Environment> Runner<E> {
    /// Creates an untrained learner with ternary conditions.
    ///
    /// # Errors
    /// Returns an error if a parameter, or the environment's number of actions, is out of range.
    pub fn new(environment: E, params: Params, seed: u64) -> Result<Self, OutOfRange> {
        Self::with_settings(environment, params, (), seed)
    }
}

impl<C: Representation, E: Environment<C>> Runner<E, C> {
    /// Creates an untrained learner with any representation of conditions.
    ///
    /// # Errors
    /// Returns an error if a parameter, a setting or the environment's number of actions is out of
    /// range.
    pub fn with_settings(
        environment: E,
        params: Params,
        settings: C::Settings,
        seed: u64,
    ) -> Result<Self, OutOfRange> {
        let agent = Agent::new(params, settings, environment.actions(), seed)?;
        Ok(Self {
            environment,
            agent,
            step_limit: 1000,
        })
    }

    /// Returns the learner.
    pub fn xcs(&self) -> &Xcs<C> {
        self.agent.xcs()
    }

    /// Learns in one episode. Each action set is updated with its reward. Unless the episode ended
    /// there, gamma times the greatest value of the next percept is added, even at the step limit.
    pub fn learn(&mut self) -> Episode {
        let mut episode = Episode::default();
        let mut percept = self.environment.begin();
        while episode.steps < self.step_limit {
            let Some(action) = self.agent.act(&percept, true) else {
                break;
            };
            let response = self.act(action, &mut episode);
            self.agent.update(response.reward, response.next.as_ref());
            match response.next {
                Some(next) => percept = next,
                None => break,
            }
        }
        self.agent.end_episode();
        episode
    }

    /// Takes one of the best actions in each step of an episode, without learning. The episode also
    /// ends where no rule matches.
    pub fn test(&mut self) -> Episode {
        let mut episode = Episode::default();
        let mut percept = self.environment.begin();
        while episode.steps < self.step_limit {
            let Some(action) = self.agent.best_action(&percept) else {
                break;
            };
            match self.act(action, &mut episode).next {
                Some(next) => percept = next,
                None => break,
            }
        }
        episode
    }

    fn act(&mut self, action: Action, episode: &mut Episode) -> Response<C::Percept> {
        let response = self.environment.act(action);
        episode.steps += 1;
        episode.reward += response.reward;
        episode.ended = response.next.is_none();
        response
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `length` cells in a row, perceived exactly. Action 1 moves forward, action 0 back. Only
    /// reaching the far end is rewarded.
    struct Corridor {
        length: u64,
        at: u64,
    }

    impl Corridor {
        fn percept(&self) -> Percept {
            Percept::from_word(1 << self.at, self.length as usize)
        }
    }

    impl Environment for Corridor {
        fn actions(&self) -> usize {
            2
        }

        fn begin(&mut self) -> Percept {
            self.at = 0;
            self.percept()
        }

        fn act(&mut self, action: Action) -> Response {
            self.at = match action.index() {
                0 => self.at.saturating_sub(1),
                _ => self.at + 1,
            };
            let arrived = self.at == self.length;
            Response {
                reward: if arrived { 1000.0 } else { 0.0 },
                next: (!arrived).then(|| self.percept()),
            }
        }
    }

    fn runner(params: Params) -> Runner<Corridor> {
        let corridor = Corridor { length: 4, at: 0 };
        Runner::new(corridor, params, 1).unwrap()
    }

    /// Fully specific rules, so that the values converge to those of Q-learning.
    fn specific() -> Params {
        Params {
            dont_care: 0.0,
            ga: false,
            ..Params::default()
        }
    }

    #[test]
    fn the_value_of_each_cell_is_the_discounted_reward() {
        let mut runner = runner(specific());
        (0..300).for_each(|_| assert!(runner.learn().ended));
        for (cell, steps_left) in [(0_u64, 3), (1, 2), (2, 1), (3, 0)] {
            let values = runner.xcs().values(&Percept::from_word(1_u64 << cell, 4));
            let (found, expected) = (
                values.greatest().unwrap(),
                1000.0 * 0.71_f64.powi(steps_left),
            );
            assert!(
                (found - expected).abs() < 0.01 * expected,
                "{cell}: {values:?}"
            );
        }
        assert_eq!(runner.test().steps, 4);
    }

    #[test]
    fn control_without_discounted_rewards_only_the_last_cell_has_a_value() {
        let mut runner = runner(specific());
        runner.agent.gamma = 0.0;
        (0..300).for_each(|_| assert!(runner.learn().ended));
        let values = |cell| {
            runner
                .xcs()
                .values(&Percept::from_word(1_u64 << cell, 4))
                .greatest()
        };
        assert_eq!([0_u64, 1, 2].map(values), [Some(0.0); 3]);
        assert!(values(3) > Some(900.0), "{:?}", values(3));
    }

    #[test]
    fn an_episode_stops_at_the_step_limit_and_says_so() {
        let mut runner = runner(Params::default());
        runner.step_limit = 3;
        let expected = Episode {
            steps: 3,
            reward: 0.0,
            ended: false,
        };
        assert_eq!(runner.learn(), expected);
    }

    #[test]
    fn testing_learns_nothing_and_needs_rules() {
        let mut runner = runner(Params::default());
        assert_eq!(runner.test().steps, 0);
        runner.learn();
        let before = runner.xcs().clone();
        runner.test();
        assert_eq!(*runner.xcs(), before);
    }

    #[test]
    fn a_parameter_outside_its_range_is_refused() {
        let params = Params {
            beta: 2.0,
            ..Params::default()
        };
        let error = Runner::new(Corridor { length: 4, at: 0 }, params, 1).err();
        assert_eq!(error.unwrap().key, "xcs.beta");
    }
}
