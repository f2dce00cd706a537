//! Compaction of \[P\] into a few general rules that choose the same actions.
//!
//! Once payoffs are known, most rules never decide anything, and many state the same for percepts
//! that differ only in irrelevant bits. Compaction creates rules that each advocate, wherever they
//! match, an action that \[P\] rates best. Deleting or subsuming rules cannot make more general
//! rules than \[P\] contains. Conditions are therefore grown anew from the percepts, as general as
//! possible, and the smallest set found that covers every percept is returned.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use fixedbitset::FixedBitSet;

use super::classifier::Classifier;
use super::condition::Condition;
use super::layout::{Feature, Layout};
use super::population::Population;
use super::prediction::PredictionArray;
use crate::signal::{Action, Percept};

/// The beam width: conditions retained in each step of growing.
const WIDEST_STAR: usize = 8;
/// The number of rules tried as the first choice of the cover.
const BEGINNINGS: usize = 32;

/// Returns compacted rules of `population`, those that cover the most percepts first.
///
/// The rules cover each of `percepts` in which `values` gives any action a value. Every action that
/// they advocate there has the greatest value. Percepts may repeat; all have the same width.
/// Conditions require ranges of the numbers in `layout`, and values of other bits.
///
/// A rule's prediction and error are the mean value of its action where it matches, and the mean
/// deviation from it. Its experience is the greatest of the rules that it replaces.
pub fn compact(
    population: &Population,
    layout: &Layout,
    percepts: &[Percept],
    values: impl Fn(&Percept) -> PredictionArray,
) -> Population {
    let task = Task::new(population, layout, percepts, values);
    let chosen = fewest(task.candidates(), task.known.len());
    let rules: Vec<Classifier> = chosen.iter().map(|one| task.classifier(one)).collect();
    rules
        .try_into()
        .expect("rules of one width, none of them twice")
}

/// The decisions to preserve.
struct Task<'a> {
    population: &'a Population,
    layout: &'a Layout,
    /// The percepts in which the population gives any action a value, each once, with the values.
    known: Vec<(Percept, PredictionArray)>,
    /// By action: the known percepts in which the action is one of the best.
    right: Vec<FixedBitSet>,
    /// The features of percepts, each with the known percepts in which it is true.
    features: Vec<(Feature, FixedBitSet)>,
}

/// A candidate for the compacted rules.
#[derive(Clone)]
struct Candidate {
    condition: Condition,
    action: Action,
    /// The known percepts that the rule matches.
    covers: FixedBitSet,
}

/// A partially grown condition.
#[derive(Clone)]
struct Partial {
    /// The places of the required features, in ascending order.
    features: Vec<usize>,
    /// The known percepts that the condition matches.
    covers: FixedBitSet,
}

impl<'a> Task<'a> {
    fn new(
        population: &'a Population,
        layout: &'a Layout,
        percepts: &[Percept],
        values: impl Fn(&Percept) -> PredictionArray,
    ) -> Self {
        let mut percepts = percepts.to_vec();
        percepts.sort_unstable();
        percepts.dedup();
        let with_value = percepts
            .into_iter()
            .map(|percept| (percept, values(&percept)));
        let known: Vec<_> = with_value.filter(|(_, w)| w.greatest().is_some()).collect();
        let first = known.first();
        let (width, actions) = first.map_or((0, 0), |(p, w)| (p.width(), w.as_slice().len()));
        let where_it = |holds: &dyn Fn(&Percept, &PredictionArray) -> bool| {
            let all = known.iter().enumerate();
            let mut set = FixedBitSet::with_capacity(known.len());
            set.extend(
                all.filter(|(_, (p, values))| holds(p, values))
                    .map(|(at, _)| at),
            );
            set
        };
        let is_best = |action| where_it(&|_, values| values.best_actions().any(|a| a == action));
        Self {
            population,
            right: Action::all(actions).map(is_best).collect(),
            features: layout
                .features(width)
                .map(|feature| (feature, where_it(&|p, _| layout.is_true(feature, p))))
                .collect(),
            layout,
            known,
        }
    }

    /// Grows rules from each known percept and each of its best actions.
    fn candidates(&self) -> Vec<Candidate> {
        let mut candidates: Vec<Candidate> = Vec::new();
        for (at, (_, values)) in self.known.iter().enumerate() {
            for action in values.best_actions() {
                let grown = self.star(at, action).into_iter();
                candidates.extend(grown.map(|one| self.without_needless(at, action, one.features)));
            }
        }
        candidates.sort_by_key(|one| (one.condition, one.action));
        candidates.dedup_by_key(|one| (one.condition, one.action));
        candidates
    }

    /// Grows conditions from percept number `at` that do not match where `action` is not the best.
    /// One wrong percept after the other is excluded in every possible way. The conditions that
    /// match the most correct percepts are retained (the star of the AQ algorithm, Michalski 1969).
    fn star(&self, at: usize, action: Action) -> Vec<Partial> {
        let right = &self.right[action.index()];
        let mut star = vec![self.everything()];
        while star.iter().any(|one| !one.covers.is_subset(right)) {
            let grown = star
                .iter()
                .flat_map(|one| self.ruling_out_one(one, at, right));
            let mut grown: Vec<Partial> = grown.collect();
            grown.sort_by_cached_key(|one| {
                let fine = one.covers.intersection_count(right);
                let wrong = one.covers.difference_count(right);
                (Reverse(fine), wrong, one.features.clone())
            });
            grown.dedup_by(|a, b| a.features == b.features);
            grown.truncate(WIDEST_STAR);
            star = grown;
        }
        star
    }

    fn everything(&self) -> Partial {
        let mut covers = FixedBitSet::with_capacity(self.known.len());
        covers.insert_range(..);
        Partial {
            features: Vec::new(),
            covers,
        }
    }

    /// Returns all specialisations of a condition by one feature of percept number `at` that exclude
    /// the first wrong percept. Returns the condition itself if it matches no wrong percept.
    fn ruling_out_one(&self, one: &Partial, at: usize, right: &FixedBitSet) -> Vec<Partial> {
        let Some(wrong) = one.covers.difference(right).next() else {
            return vec![one.clone()];
        };
        let ones = |place: usize| &self.features[place].1;
        let differs = |place: &usize| ones(*place).contains(at) != ones(*place).contains(wrong);
        let with = |feature| {
            let mut features = one.features.clone();
            features.insert(features.partition_point(|&other| other < feature), feature);
            Partial {
                features,
                covers: self.narrowed(at, feature, &one.covers),
            }
        };
        (0..self.features.len()).filter(differs).map(with).collect()
    }

    /// Drops each feature that later features made unnecessary.
    fn without_needless(&self, at: usize, action: Action, mut features: Vec<usize>) -> Candidate {
        let right = &self.right[action.index()];
        for place in (0..features.len()).rev() {
            let dropped = features.remove(place);
            if !self.matching(at, &features).is_subset(right) {
                features.insert(place, dropped);
            }
        }
        let required = features.iter().map(|&place| self.features[place].0);
        Candidate {
            condition: self.layout.condition(&self.known[at].0, required),
            action,
            covers: self.matching(at, &features),
        }
    }

    /// Returns the known percepts that agree with percept number `at` in these features.
    fn matching(&self, at: usize, features: &[usize]) -> FixedBitSet {
        let all = self.everything().covers;
        let narrow = |covers, &feature: &usize| self.narrowed(at, feature, &covers);
        features.iter().fold(all, narrow)
    }

    /// Returns the percepts in `covers` that agree with percept number `at` in a feature.
    fn narrowed(&self, at: usize, feature: usize, covers: &FixedBitSet) -> FixedBitSet {
        let (mut covers, (_, ones)) = (covers.clone(), &self.features[feature]);
        match ones.contains(at) {
            true => covers.intersect_with(ones),
            false => covers.difference_with(ones),
        }
        covers
    }

    /// Returns the rule with its statistics, computed from the rules that it replaces.
    fn classifier(&self, one: &Candidate) -> Classifier {
        let values = |at: usize| self.known[at].1.get(one.action).unwrap_or(0.0);
        let count = one.covers.count_ones(..).max(1) as f64;
        let prediction = one.covers.ones().map(values).sum::<f64>() / count;
        let deviation = |at| (values(at) - prediction).abs();
        let rules = self.population.rules().iter();
        let taken_over = rules.filter(|rule| {
            rule.action == one.action
                && (rule.condition == one.condition
                    || one.condition.is_more_general_than(&rule.condition))
        });
        Classifier {
            condition: one.condition,
            action: one.action,
            prediction,
            error: one.covers.ones().map(deviation).sum::<f64>() / count,
            fitness: 1.0,
            numerosity: 1,
            experience: taken_over.map(|rule| rule.experience).max().unwrap_or(0),
            time_stamp: 0,
            set_size: 1.0,
            eam: 1.0,
        }
    }
}

/// Returns the smallest set of candidates found that covers all of `count` percepts. Tries each of
/// the candidates that cover the most percepts as the first choice.
fn fewest(mut candidates: Vec<Candidate>, count: usize) -> Vec<Candidate> {
    candidates.sort_by_cached_key(|one| {
        let covered = one.covers.count_ones(..);
        (Reverse(covered), one.condition.specificity())
    });
    let beginnings = candidates.iter().take(BEGINNINGS);
    let choices =
        beginnings.map(|first| without_redundant(cover(first, &candidates, count), count));
    choices.min_by_key(Vec::len).unwrap_or_default()
}

/// Chooses `first`, then repeatedly the first candidate that covers the most uncovered percepts,
/// until all of `count` percepts are covered.
///
/// The gain of a candidate never grows while others are chosen. A queue ordered by the last
/// computed gain therefore recomputes only the candidate at its head (lazy greedy cover, Minoux
/// 1978).
fn cover(first: &Candidate, candidates: &[Candidate], count: usize) -> Vec<Candidate> {
    let mut open = FixedBitSet::with_capacity(count);
    open.insert_range(..);
    let sizes = candidates.iter().map(|one| one.covers.count_ones(..));
    let mut queue: BinaryHeap<_> = sizes.zip((0..).map(Reverse)).collect();
    open.difference_with(&first.covers);
    let mut chosen = vec![first.clone()];
    while let Some((claimed, Reverse(at))) = queue.pop() {
        let one = &candidates[at];
        let adds = one.covers.intersection_count(&open);
        if adds == claimed && adds > 0 {
            open.difference_with(&one.covers);
            chosen.push(one.clone());
        } else if adds > 0 {
            queue.push((adds, Reverse(at)));
        }
    }
    chosen
}

/// Removes rules whose percepts are covered by the others, the last chosen first.
fn without_redundant(mut chosen: Vec<Candidate>, count: usize) -> Vec<Candidate> {
    let mut times_covered = vec![0_u32; count];
    for percept in chosen.iter().flat_map(|one| one.covers.ones()) {
        times_covered[percept] += 1;
    }
    for at in (0..chosen.len()).rev() {
        if chosen[at]
            .covers
            .ones()
            .all(|percept| times_covered[percept] > 1)
        {
            let redundant = chosen.remove(at);
            redundant
                .covers
                .ones()
                .for_each(|percept| times_covered[percept] -= 1);
        }
    }
    chosen
}

#[cfg(test)]
mod tests;
