//! Operators of the genetic algorithm: selection and reproduction (Butz and Wilson 2001, RUN GA).

use super::classifier::Classifier;
use super::handles::ClassifierId;
use super::params::Params;
use super::representation::Representation;
use crate::action::Action;
use crate::random::Stream;

/// Fraction of the parents' error that a child inherits.
const ERROR_INHERITANCE: f64 = 0.25;
/// Fraction of the parents' fitness that a child inherits.
const FITNESS_INHERITANCE: f64 = 0.1;

/// A rule of a niche and its id in \[P\].
pub(super) type Parent<C> = (ClassifierId, Classifier<C>);

/// Selects a parent by roulette over fitness. `total` is the sum of the niche's fitness. Returns
/// `None` for an empty niche.
pub(super) fn select<'a, C: Representation + 'a>(
    niche: impl Iterator<Item = (ClassifierId, &'a Classifier<C>)>,
    total: f64,
    stream: &mut Stream,
) -> Option<Parent<C>> {
    let mut left = stream.unit() * total;
    let mut last = None;
    for (id, rule) in niche {
        left -= rule.fitness;
        last = Some((id, rule));
        if left < 0.0 {
            break;
        }
    }
    last.map(|(id, rule)| (id, rule.clone()))
}

/// Creates two children of two parents in one niche by crossover and niche mutation. The children
/// have no experience. `actions` is the number of actions.
///
/// A child always inherits only a part of the error, and of the fitness of one micro-classifier, as
/// in JavaXCSF (Stalph and Butz 2009). The pseudo-code of Butz and Wilson (2001) takes these parts,
/// and the means of both parents, only after a crossover.
pub(super) fn children<C: Representation>(
    parents: &[Parent<C>; 2],
    percept: &C::Percept,
    actions: usize,
    params: &Params,
    settings: &C::Settings,
    stream: &mut Stream,
) -> [Classifier<C>; 2] {
    let [mut first, mut second] = [&parents[0].1, &parents[1].1].map(|parent| Classifier {
        numerosity: 1,
        experience: 0,
        fitness: parent.fitness / f64::from(parent.numerosity),
        ..parent.clone()
    });
    if stream.chance(params.chi) {
        cross(&mut first, &mut second, stream);
    }
    [first, second].map(|mut child| {
        child.error *= ERROR_INHERITANCE;
        child.fitness *= FITNESS_INHERITANCE;
        child.condition.mutate(percept, params, settings, stream);
        if stream.chance(params.mu) {
            child.action = other_action(child.action, actions, stream);
        }
        child
    })
}

/// Two-point crossover of the conditions. The children's prediction, error and fitness are the
/// means of the parents'.
fn cross<C: Representation>(
    first: &mut Classifier<C>,
    second: &mut Classifier<C>,
    stream: &mut Stream,
) {
    let alleles = first.condition.width();
    let [x, y] = [0; 2].map(|_| stream.below(alleles + 1));
    first
        .condition
        .exchange(&mut second.condition, x.min(y), x.max(y));
    average(&mut first.prediction, &mut second.prediction);
    average(&mut first.error, &mut second.error);
    average(&mut first.fitness, &mut second.fitness);
}

fn average(a: &mut f64, b: &mut f64) {
    let mean = f64::midpoint(*a, *b);
    (*a, *b) = (mean, mean);
}

/// Returns one of the other actions, each with equal probability.
fn other_action(action: Action, actions: usize, stream: &mut Stream) -> Action {
    let mut others = Action::all(actions).filter(|&other| other != action);
    match others.clone().count() {
        0 => action,
        count => others.nth(stream.below(count)).unwrap_or(action),
    }
}
