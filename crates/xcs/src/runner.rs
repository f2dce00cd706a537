//! The loop of perceiving, acting and learning, for any [`Environment`].

use crate::bounds::{OutOfRange, within};
use crate::learner::Xcs;
use crate::params::Params;
use crate::prediction::PredictionArray;
use crate::random::Stream;
use crate::sets::{ActionSet, MatchSet};
use crate::signal::{Action, MAX_ACTIONS, Percept};

/// Something to act in: it shows percepts, takes actions and gives rewards.
///
/// A classification task is an environment whose episodes end after one action (single-step); in
/// all others the reward travels back from step to step, discounted (multistep).
pub trait Environment {
    /// The number of actions, 1 to [`MAX_ACTIONS`]; always the same.
    fn actions(&self) -> usize;

    /// Opens an episode and shows its first percept. All percepts are of the same width.
    fn begin(&mut self) -> Percept;

    /// Carries out an action, one of the first [`actions`](Self::actions).
    fn act(&mut self, action: Action) -> Response;
}

/// What comes of an action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// The reward, a finite number.
    pub reward: f64,
    /// What is perceived now; `None` when the episode has ended.
    pub next: Option<Percept>,
}

/// What came of an episode.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Episode {
    /// Actions carried out.
    pub steps: u32,
    /// The sum of the rewards.
    pub reward: f64,
    /// Did the environment end it? Otherwise the step limit did.
    pub ended: bool,
}

/// Standard XCS in an environment, episode by episode (Butz and Wilson 2001, RUN EXPERIMENT).
///
/// The same environment, parameters and seed give the same rules, on every machine.
#[derive(Debug, Clone)]
pub struct Runner<E> {
    /// The environment.
    pub environment: E,
    /// gamma: how much a reward is worth one step earlier; 0 to 1. Without effect in single-step
    /// environments. By default 0.71, as in Butz and Wilson.
    pub gamma: f64,
    /// p_explr: the probability with which a step of learning takes any action instead of one of
    /// the best; 0 to 1. By default 0.5.
    pub exploration: f64,
    /// The most steps of an episode; by default 1000.
    pub step_limit: u32,
    xcs: Xcs,
    match_set: MatchSet,
    choices: Stream,
}

/// Who draws random numbers.
enum Draws {
    Evolution,
    Choices,
}

impl From<Draws> for u64 {
    fn from(who: Draws) -> Self {
        who as Self
    }
}

impl<E: Environment> Runner<E> {
    /// A learner that knows nothing yet.
    ///
    /// # Errors
    /// When a parameter, or the environment's number of actions, lies outside its range.
    pub fn new(environment: E, params: Params, seed: u64) -> Result<Self, OutOfRange> {
        params.check()?;
        within("actions", environment.actions(), 1..=MAX_ACTIONS)?;
        let evolution = Stream::new(seed, Draws::Evolution);
        let xcs = Xcs::new(params, environment.actions(), evolution);
        Ok(Self {
            environment,
            gamma: 0.71,
            exploration: 0.5,
            step_limit: 1000,
            xcs,
            match_set: MatchSet::default(),
            choices: Stream::new(seed, Draws::Choices),
        })
    }

    /// The learner.
    pub fn xcs(&self) -> &Xcs {
        &self.xcs
    }

    /// Learns in one episode. Each action set is updated with its reward and, unless the episode
    /// ended there, gamma times the greatest value of what was perceived next, also at the step limit.
    pub fn learn(&mut self) -> Episode {
        let mut episode = Episode::default();
        let mut percept = self.environment.begin();
        let mut waiting: Option<(ActionSet, f64)> = None;
        loop {
            self.xcs.form_match_set(&percept, &mut self.match_set);
            let values = self.xcs.predict(&self.match_set);
            if let Some((set, reward)) = waiting.take() {
                let followed = self.gamma * values.greatest().unwrap_or(0.0);
                self.credit(&set, reward + followed);
            }
            if episode.steps == self.step_limit {
                return episode;
            }
            let Some(set) = self
                .choose(&values)
                .and_then(|it| self.match_set.action_set(it))
            else {
                return episode;
            };
            let response = self.act(set.action, &mut episode);
            match response.next {
                Some(next) => percept = next,
                None => {
                    self.credit(&set, response.reward);
                    return episode;
                }
            }
            waiting = Some((set, response.reward));
        }
    }

    /// Takes one of the best actions in each step of an episode, and learns nothing. An episode
    /// ends, too, where no rule matches.
    pub fn test(&mut self) -> Episode {
        let mut episode = Episode::default();
        let mut percept = self.environment.begin();
        while episode.steps < self.step_limit {
            let values = self.xcs.values(&percept);
            let Some(action) = self.best(&values) else {
                break;
            };
            match self.act(action, &mut episode).next {
                Some(next) => percept = next,
                None => break,
            }
        }
        episode
    }

    fn act(&mut self, action: Action, episode: &mut Episode) -> Response {
        let response = self.environment.act(action);
        episode.steps += 1;
        episode.reward += response.reward;
        episode.ended = response.next.is_none();
        response
    }

    fn credit(&mut self, set: &ActionSet, payoff: f64) {
        self.xcs.update(set, payoff, self.xcs.params().beta);
        self.xcs.evolve(set);
    }

    fn choose(&mut self, values: &PredictionArray) -> Option<Action> {
        if self.choices.chance(self.exploration) {
            Action::new(self.choices.below(self.xcs.actions()))
        } else {
            self.best(values)
        }
    }

    fn best(&mut self, values: &PredictionArray) -> Option<Action> {
        let best: Vec<Action> = values.best_actions().collect();
        self.choices.choose(&best).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `length` cells in a row, perceived exactly; action 1 leads on, action 0 back, and only the
    /// far end is rewarded.
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

    /// Specific rules of one corridor, so that the value is what Q-learning would reach.
    fn specific() -> Params {
        Params {
            dont_care: 0.0,
            ga: false,
            ..Params::default()
        }
    }

    #[test]
    fn the_worth_of_each_cell_is_the_discounted_reward() {
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
    fn control_without_discounted_rewards_only_the_last_cell_is_worth_something() {
        let mut runner = runner(specific());
        runner.gamma = 0.0;
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
