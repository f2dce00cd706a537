//! The learner alone: cost against population size and against the width of the percept.

use divan::{Bencher, black_box};
use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;
use xcscr::xcs::{Action, Percept};
use xcscr::xcs::{ActionSet, MatchSet, Params, Xcs};

const SIZES: [u32; 4] = [800, 2000, 8000, 50_000];
const WIDTHS: [usize; 5] = [16, 32, 64, 128, 256];
const ACTIONS: usize = 8;

fn main() {
    divan::main();
}

/// A learner on a made-up problem: 26 random percepts, whose payoff depends on the action.
struct Work {
    xcs: Xcs,
    match_set: MatchSet,
    percepts: Vec<Percept>,
    stream: Stream,
}

impl Work {
    /// With a full population that the GA has turned over.
    fn settled(population_size: u32, width: usize, theta_ga: u32) -> Self {
        let params = Params {
            population_size,
            dont_care: 0.4,
            theta_ga,
            ga_subsumption: false,
            action_set_subsumption: false,
            ..Params::default()
        };
        let mut stream = Stream::new(1, StreamName::World);
        let mut percept = || Percept::from_bits((0..width).map(|_| stream.chance(0.5)));
        let percepts = (0..26).filter_map(|_| percept()).collect();
        let mut work = Self {
            xcs: Xcs::new(params, ACTIONS, Stream::new(1, StreamName::Evolution)),
            match_set: MatchSet::default(),
            percepts,
            stream,
        };
        (0..2 * population_size.max(10_000)).for_each(|_| work.step());
        work
    }

    fn form_match_set(&mut self) -> usize {
        let at = self.stream.below(self.percepts.len());
        self.xcs
            .form_match_set(&self.percepts[at], &mut self.match_set);
        at
    }

    fn action_set(&mut self) -> (ActionSet, f64) {
        let at = self.form_match_set();
        let action = self.stream.below(ACTIONS);
        let set = Action::new(action).and_then(|action| self.match_set.action_set(action));
        let set = set.expect("a match set was formed, and there are eight actions");
        (set, (at * ACTIONS + action) as f64)
    }

    /// A whole learning step: match, predict, select, update, evolve.
    fn step(&mut self) {
        let (set, payoff) = self.action_set();
        black_box(self.xcs.predict(&self.match_set));
        self.xcs.update(&set, payoff, 0.2);
        self.xcs.evolve(&set);
    }
}

#[divan::bench(args = SIZES)]
fn step_by_population(bencher: Bencher, population_size: u32) {
    let mut work = Work::settled(population_size, 16, 25);
    bencher.bench_local(|| work.step());
}

#[divan::bench(args = WIDTHS)]
fn step_by_percept_width(bencher: Bencher, width: usize) {
    let mut work = Work::settled(2000, width, 25);
    bencher.bench_local(|| work.step());
}

#[divan::bench(args = SIZES)]
fn match_set(bencher: Bencher, population_size: u32) {
    let mut work = Work::settled(population_size, 16, 25);
    bencher.bench_local(|| work.form_match_set());
}

/// The GA with its two deletions in every step, after the match set that it needs.
#[divan::bench(args = SIZES)]
fn match_evolve_and_delete(bencher: Bencher, population_size: u32) {
    let mut work = Work::settled(population_size, 16, 0);
    bencher.bench_local(|| {
        let (set, _) = work.action_set();
        work.xcs.evolve(&set);
    });
}

/// A hundred deletions from a population that is restored for each round.
#[divan::bench(args = SIZES)]
fn delete_hundred(bencher: Bencher, population_size: u32) {
    let xcs = Work::settled(population_size, 16, 25).xcs;
    let params = Params {
        population_size: population_size - 100,
        ..xcs.params().clone()
    };
    let population = xcs.population();
    let inputs = || {
        let stream = Stream::new(1, StreamName::Evolution);
        (
            Xcs::new(params.clone(), ACTIONS, stream),
            population.clone(),
        )
    };
    bencher
        .with_inputs(inputs)
        .bench_local_values(|(xcs, population)| xcs.with_population(population));
}
