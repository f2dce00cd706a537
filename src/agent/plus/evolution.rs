//! Discovery of rules by XCS: the genetic algorithm, paid for right answers.

use super::params::Discovery;
use xcs::Action;
use xcs::random::Stream;
use xcs::{Lessons, MatchSet, Params, Xcs};

/// What an action pays that is one of the best; all others pay nothing.
const RIGHT: f64 = 1000.0;
/// Rounds through all lessons, at most.
const MOST_ROUNDS: u32 = 1000;
/// P#, mu and the greatest N: general rules, and few.
const DONT_CARE: f64 = 0.8;
const MUTATION: f64 = 0.02;
const LARGEST_POPULATION: u32 = 250;

/// The parameters of XCS for a way of discovery; those that it does not name are as they are set.
pub(super) fn params(xcs: Params, discovery: Discovery) -> Params {
    let xcs = Params {
        worth_over_match_set: false,
        ..xcs
    };
    if discovery == Discovery::Induction {
        return xcs;
    }
    Params {
        population_size: xcs.population_size.min(LARGEST_POPULATION),
        dont_care: DONT_CARE,
        mu: MUTATION,
        ga: true,
        ..xcs
    }
}

/// Rehearses all lessons, each action with the same chance, until the rules agree with each.
pub(super) fn rehearse(xcs: &mut Xcs, lessons: &mut Lessons, stream: &mut Stream) {
    lessons.take_changed();
    let mut order: Vec<usize> = lessons.iter().map(|(number, _)| number).collect();
    let mut set = MatchSet::default();
    for _ in 0..MOST_ROUNDS {
        let right = |xcs: &Xcs| {
            lessons
                .iter()
                .all(|(_, l)| l.agrees_with(&xcs.worth(&l.percept)))
        };
        if right(xcs) {
            return;
        }
        stream.shuffle(&mut order);
        for lesson in order.iter().filter_map(|&number| lessons.get(number)) {
            xcs.form_match_set(&lesson.percept, &mut set);
            let action = Action::all(xcs.actions()).nth(stream.below(xcs.actions()));
            let Some(niche) = action.and_then(|action| set.action_set(action)) else {
                continue;
            };
            let payoff = if lesson.best[niche.action.index()] {
                RIGHT
            } else {
                0.0
            };
            xcs.update(&niche, payoff, xcs.params().beta);
            xcs.evolve(&niche);
        }
    }
}
