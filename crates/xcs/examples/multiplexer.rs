//! The 11-multiplexer, the classic single-step problem. Three address bits select one of eight data
//! bits, and the right answer is that bit.
//!
//! `cargo run --release -p xcs --example multiplexer` prints the share of right answers during
//! learning, and finally the rules with the highest numerosities.

use xcs::random::Stream;
use xcs::{Action, Classifier, Environment, Params, Percept, Response, Runner};

const ADDRESS_BITS: usize = 3;
const BITS: usize = ADDRESS_BITS + (1 << ADDRESS_BITS);

struct Multiplexer {
    inputs: Stream,
    input: Percept,
}

impl Multiplexer {
    fn new(seed: u64) -> Self {
        Self {
            inputs: Stream::new(seed, 2_u64),
            input: Percept::from_word(0, BITS),
        }
    }

    /// Returns the data bit selected by the address bits.
    fn answer(&self) -> bool {
        let address =
            (0..ADDRESS_BITS).fold(0, |sum, at| 2 * sum + usize::from(self.input.bit(at)));
        self.input.bit(ADDRESS_BITS + address)
    }
}

impl Environment for Multiplexer {
    fn actions(&self) -> usize {
        2
    }

    fn begin(&mut self) -> Percept {
        self.input = Percept::from_word(self.inputs.bits(), BITS);
        self.input
    }

    fn act(&mut self, action: Action) -> Response {
        let right = action.index() == usize::from(self.answer());
        Response {
            reward: if right { 1000.0 } else { 0.0 },
            next: None,
        }
    }
}

/// Learns from 10,000 inputs. Returns the runner and the share of right answers to 1,000 more
/// inputs.
fn learn(seed: u64) -> Result<(Runner<Multiplexer>, f64), xcs::bounds::OutOfRange> {
    let params = Params {
        population_size: 800,
        dont_care: 0.5,
        ..Params::default()
    };
    let mut runner = Runner::new(Multiplexer::new(seed), params, seed)?;
    runner.agent.exploration = 1.0;
    for _ in 0..10_000 {
        runner.learn();
    }
    let right = (0..1000).filter(|_| runner.test().reward > 0.0).count();
    Ok((runner, right as f64 / 1000.0))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (runner, right) = learn(1)?;
    println!("{:.1} % right after 10,000 inputs", 100.0 * right);
    let mut rules: Vec<&Classifier> = runner.xcs().population().rules().iter().collect();
    rules.sort_by_key(|rule| std::cmp::Reverse(rule.numerosity));
    for rule in rules.iter().take(16) {
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
fn xcs_learns_the_multiplexer() {
    let (_, right) = learn(1).unwrap();
    assert!(right > 0.98, "{right}");
}

#[test]
fn control_without_the_genetic_algorithm_it_is_not_learned() {
    let multiplexer = Multiplexer::new(1);
    let params = Params {
        population_size: 800,
        dont_care: 0.5,
        ga: false,
        ..Params::default()
    };
    let mut runner = Runner::new(multiplexer, params, 1).unwrap();
    (0..10_000).for_each(|_| {
        runner.learn();
    });
    let right = (0..1000).filter(|_| runner.test().reward > 0.0).count();
    assert!(right < 850, "{right}");
}
