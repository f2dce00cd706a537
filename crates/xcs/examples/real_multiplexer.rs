//! The real-valued 6-multiplexer (Wilson 2000). Each input is a number from 0 to 1; 0.5 and more
//! stands for 1. Two address inputs select one of four data inputs, and the right answer is that
//! input's bit.
//!
//! `cargo run --release -p xcs --example real_multiplexer` prints the share of right answers after
//! learning, and the rules with the highest numerosities.

use xcs::random::Stream;
use xcs::{
    Action, Classifier, Environment, IntervalSettings, Intervals, Params, RealPercept, Response,
    Runner,
};

const ADDRESSES: usize = 2;
const INPUTS: usize = ADDRESSES + (1 << ADDRESSES);

struct Multiplexer {
    numbers: Stream,
    input: [f64; INPUTS],
}

impl Multiplexer {
    fn new(seed: u64) -> Self {
        Self {
            numbers: Stream::new(seed, 2_u64),
            input: [0.0; INPUTS],
        }
    }

    /// Returns the data input selected by the address inputs.
    fn answer(&self) -> bool {
        let is_one = |at: usize| self.input[at] >= 0.5;
        let address = (0..ADDRESSES).fold(0, |sum, at| 2 * sum + usize::from(is_one(at)));
        is_one(ADDRESSES + address)
    }
}

impl Environment<Intervals> for Multiplexer {
    fn actions(&self) -> usize {
        2
    }

    fn begin(&mut self) -> RealPercept {
        self.input = std::array::from_fn(|_| self.numbers.unit());
        RealPercept::new(&self.input).expect("numbers from 0 to 1")
    }

    fn act(&mut self, action: Action) -> Response<RealPercept> {
        let right = action.index() == usize::from(self.answer());
        Response {
            reward: if right { 1000.0 } else { 0.0 },
            next: None,
        }
    }
}

type Learner = Runner<Multiplexer, Intervals>;

/// Learns from 40,000 inputs. Returns the runner and the share of right answers to 1,000 more
/// inputs.
fn learn(seed: u64, ga: bool) -> Result<(Learner, f64), xcs::bounds::OutOfRange> {
    let params = Params {
        population_size: 800,
        theta_ga: 12,
        ga,
        ..Params::default()
    };
    let settings = IntervalSettings::default();
    let mut runner = Runner::with_settings(Multiplexer::new(seed), params, settings, seed)?;
    runner.agent.exploration = 1.0;
    for _ in 0..40_000 {
        runner.learn();
    }
    let right = (0..1000).filter(|_| runner.test().reward > 0.0).count();
    Ok((runner, right as f64 / 1000.0))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (runner, right) = learn(1, true)?;
    println!("{:.1} % right after 40,000 inputs", 100.0 * right);
    let rules = runner.xcs().population().rules().iter();
    let mut rules: Vec<&Classifier<Intervals>> = rules.collect();
    rules.sort_by_key(|rule| std::cmp::Reverse(rule.numerosity));
    for rule in rules.iter().take(8) {
        println!(
            "{} -> {}  predicts {:4.0}  numerosity {}",
            rule.condition,
            rule.action.index(),
            rule.prediction,
            rule.numerosity
        );
    }
    Ok(())
}

#[test]
fn xcsr_learns_the_real_multiplexer() {
    for seed in 1..=3 {
        let (_, right) = learn(seed, true).unwrap();
        assert!(right > 0.95, "seed {seed}: {right}");
    }
}

#[test]
fn control_without_the_genetic_algorithm_it_is_not_learned() {
    let (_, right) = learn(1, false).unwrap();
    assert!(right < 0.85, "{right}");
}
