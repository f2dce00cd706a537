//! The learner against what is known of XCS: the problems of the literature, with its parameters.
//!
//! Sources: M. V. Butz and S. W. Wilson, "An algorithmic description of XCS" (2001) for the
//! multiplexer; S. W. Wilson, "Classifier fitness based on accuracy" (1995) for Woods1; P. L.
//! Lanzi, "An analysis of generalization in the XCS classifier system" (1999) for Maze4. One
//! problem is one explore and one exploit trial. Seeds are fixed and margins wide.

#![allow(clippy::unwrap_used, reason = "a test ends there")]

use std::ops::ControlFlow;
use std::path::Path;

use xcscr::episode::{self, Episode, Learned, Observer};
use xcscr::random::{Stream, StreamName};
use xcscr::reward::{self, Method};
use xcscr::sensor::Sensor;
use xcscr::signal::{Action, Percept};
use xcscr::study::{ArenaKind, Config, Plan, Settings, Trial};
use xcscr::world::Maze;
use xcscr::xcs::{self, MatchSet, Xcs};

const SEEDS: [u64; 3] = [1, 2, 3];

/// The 6-multiplexer: the first two bits address one of the other four, which is the answer.
struct Multiplexer {
    xcs: Xcs,
    match_set: MatchSet,
    inputs: Stream,
}

impl Multiplexer {
    fn new(seed: u64) -> Self {
        let params = xcs::Params {
            population_size: 400,
            dont_care: 0.33,
            initial_prediction: 10.0,
            ..xcs::Params::default()
        };
        params.check().unwrap();
        Self {
            xcs: Xcs::new(params, 2, Stream::new(seed, StreamName::Evolution)),
            match_set: MatchSet::default(),
            inputs: Stream::new(seed, StreamName::Start),
        }
    }

    fn answer(input: &Percept) -> Action {
        let address = 2 * usize::from(input.bit(0)) + usize::from(input.bit(1));
        Action::new(usize::from(input.bit(2 + address))).unwrap()
    }

    /// One explore problem, learned, and one exploit problem: was it answered correctly?
    fn problem(&mut self) -> bool {
        let input = self.input();
        self.xcs.form_match_set(&input, &mut self.match_set);
        let guess = Action::new(self.inputs.below(2)).unwrap();
        let set = self.match_set.action_set(guess).unwrap();
        let reward = if guess == Self::answer(&input) {
            1000.0
        } else {
            0.0
        };
        self.xcs.update(&set, reward, 0.2);
        self.xcs.evolve(&set);
        let input = self.input();
        let worth = self.xcs.worth(&input);
        worth.best_actions().next() == Some(Self::answer(&input))
    }

    fn input(&mut self) -> Percept {
        let bits = self.inputs.bits();
        Percept::from_bits((0..6).map(|bit| bits >> bit & 1 == 1)).unwrap()
    }
}

#[test]
fn the_6_multiplexer_is_learned_and_generalised() {
    for seed in SEEDS {
        let mut multiplexer = Multiplexer::new(seed);
        let correct: Vec<bool> = (0..6000).map(|_| multiplexer.problem()).collect();
        let share = |problems: &[bool]| {
            problems.iter().filter(|&&correct| correct).count() as f64 / problems.len() as f64
        };
        let rules = multiplexer.xcs.population().len();
        let found = (share(&correct[1500..2000]), share(&correct[3500..]), rules);
        assert!(
            found.0 >= 0.95,
            "seed {seed}, problems 1501 to 2000: {found:?}"
        );
        assert!(
            found.1 >= 0.99,
            "seed {seed}, problems from 3501: {found:?}"
        );
        assert!(found.2 <= 60, "seed {seed}, rules: {found:?}");
    }
}

/// Notes the steps of the exploit episodes.
#[derive(Default)]
struct Exploits(Vec<u32>);

impl Observer for Exploits {
    fn ended(&mut self, episode: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        if episode.explored == 0 {
            self.0.push(episode.steps);
        }
        ControlFlow::Continue(())
    }
}

/// The steps of each exploit episode in a classic maze, with the literature's parameters.
fn exploit_steps(world: &str, xcs: xcs::Params, problems: u32, seed: u64) -> Vec<u32> {
    let path = format!("{}/worlds/{world}.json", env!("CARGO_MANIFEST_DIR"));
    let reward = reward::Params {
        goal: 1000.0,
        step: 0.0,
        collision: 0.0,
        gamma: 0.71,
        step_threshold: 50,
        ..reward::Params::default()
    };
    let episode = episode::Params {
        alternate: true,
        ..episode::Params::default()
    };
    let config = Config {
        version: String::new(),
        method: Method::Xcs,
        arena: ArenaKind::Grid,
        sensor: Sensor::Neighbours,
        episodes: 2 * problems,
        seed,
        settings: Settings {
            xcs,
            reward,
            episode,
            ..Settings::default()
        },
        initial: None,
    };
    let maze = Maze::load(Path::new(&path)).unwrap();
    let mut exploits = Exploits::default();
    let flow = Trial::new(Plan { maze, config })
        .unwrap()
        .run(&mut exploits);
    assert_eq!(flow, ControlFlow::Continue(()));
    assert_eq!(exploits.0.len(), problems as usize);
    exploits.0
}

fn mean(steps: &[u32]) -> f64 {
    f64::from(steps.iter().sum::<u32>()) / steps.len() as f64
}

/// The parameters of the classic mazes.
fn classic(population_size: u32, dont_care: f64) -> xcs::Params {
    xcs::Params {
        population_size,
        dont_care,
        epsilon_0: 1.0,
        ga_subsumption: false,
        action_set_subsumption: false,
        ..xcs::Params::default()
    }
}

#[test]
fn woods1_is_walked_in_the_fewest_steps() {
    for seed in SEEDS {
        let steps = exploit_steps("woods1", classic(800, 0.5), 2000, seed);
        // The shortest paths of Woods1 are 1.6875 steps long on average.
        let found = mean(&steps[1000..]);
        assert!(found <= 1.80, "seed {seed}: {found} steps");
    }
}

#[test]
fn maze4_is_walked_in_the_fewest_steps() {
    for seed in SEEDS {
        let steps = exploit_steps("maze4-classic", classic(2000, 0.4), 3000, seed);
        // The shortest paths of Maze4 are 3.5 steps long on average.
        let found = mean(&steps[2500..]);
        assert!(found <= 3.75, "seed {seed}: {found} steps");
    }
}
