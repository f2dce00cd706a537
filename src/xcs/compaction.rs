//! Condensing \[P\]: few general rules that decide as all of them do.
//!
//! Once payoffs are known, most rules never decide anything, and many say the same of percepts
//! that differ only where it does not matter. What is left here is a set of rules of which each
//! advocates, wherever it matches, an action that \[P\] rates best: rules that never decide are
//! removed, the others made as general as that allows, and the fewest are kept that cover every
//! percept.

use fixedbitset::FixedBitSet;

use super::classifier::Classifier;
use super::condition::Condition;
use super::population::Population;
use super::prediction::{PredictionArray, PredictionSums};
use crate::signal::{Action, Percept};

/// The condensed rules of `population`, in the order in which they were chosen: those that cover
/// the most percepts first. In each of `percepts` of which `population` says anything, every
/// action they advocate is one that `population` rates best of `actions` actions, and there is
/// one. Percepts may repeat; all are of the same width.
///
/// A rule predicts the mean worth of its action where it matches; its error is the mean deviation
/// from that.
pub fn compact(population: &Population, percepts: &[Percept], actions: usize) -> Population {
    let task = Task::new(population, percepts, actions);
    let chosen = without_superfluous(cover(task.candidates(), task.known.len()));
    let rules: Vec<Classifier> = chosen.iter().map(|one| task.classifier(one)).collect();
    rules
        .try_into()
        .expect("rules of one width, none of them twice")
}

/// What has to be preserved.
struct Task<'a> {
    population: &'a Population,
    /// The percepts of which the population says something, each once, with the worth of actions.
    known: Vec<(Percept, PredictionArray)>,
    /// By action: the known percepts in which it is one of the best.
    right: Vec<FixedBitSet>,
    /// By allele: the known percepts in which it is 1.
    ones: Vec<FixedBitSet>,
}

/// A rule that could be kept.
#[derive(Clone)]
struct Candidate {
    condition: Condition,
    action: Action,
    /// The known percepts that it matches.
    covers: FixedBitSet,
}

impl<'a> Task<'a> {
    fn new(population: &'a Population, percepts: &[Percept], actions: usize) -> Self {
        let mut percepts = percepts.to_vec();
        percepts.sort_unstable();
        percepts.dedup();
        let worth = |percept: Percept| {
            let mut sums = PredictionSums::default();
            population.for_each_match(&percept, |_, rule| sums.add(rule));
            (percept, sums.array(actions, false))
        };
        let known: Vec<_> = percepts.into_iter().map(worth).collect();
        let known: Vec<_> = known
            .into_iter()
            .filter(|(_, w)| w.greatest().is_some())
            .collect();
        let width = known.first().map_or(0, |(percept, _)| percept.width());
        let where_it = |holds: &dyn Fn(&Percept, &PredictionArray) -> bool| {
            let all = known.iter().enumerate();
            let mut set = FixedBitSet::with_capacity(known.len());
            set.extend(
                all.filter(|(_, (p, worth))| holds(p, worth))
                    .map(|(at, _)| at),
            );
            set
        };
        let is_best = |action| where_it(&|_, worth| worth.best_actions().any(|a| a == action));
        Self {
            population,
            right: Action::all(actions).map(is_best).collect(),
            ones: (0..width)
                .map(|allele| where_it(&|p, _| p.bit(allele)))
                .collect(),
            known,
        }
    }

    /// For each known percept and best action, the rules grown from it.
    fn candidates(&self) -> Vec<Candidate> {
        let mut candidates: Vec<Candidate> = Vec::new();
        for (at, (_, worth)) in self.known.iter().enumerate() {
            for action in worth.best_actions() {
                for greed in [Greed::FewestWrong, Greed::GreatestShare] {
                    candidates.push(self.grow(at, action, greed));
                }
            }
        }
        candidates.sort_by_key(|one| (one.condition, one.action));
        candidates.dedup_by_key(|one| (one.condition, one.action));
        candidates
    }

    /// The rule that demands of percept number `at` only what keeps it from advocating `action`
    /// where that is not best.
    fn grow(&self, at: usize, action: Action, greed: Greed) -> Candidate {
        let right = &self.right[action.index()];
        let mut alleles = Vec::new();
        let mut covers = self.matching(at, &alleles);
        while !covers.is_subset(right) {
            let with = |&allele: &usize| greed.rate(&self.narrowed(at, allele, &covers), right);
            let left = (0..self.ones.len()).filter(|allele| !alleles.contains(allele));
            // The first of the best ones.
            let best = left
                .rev()
                .max_by(|a, b| with(a).partial_cmp(&with(b)).expect("no NaN"));
            let best = best.expect("all alleles together match one percept only");
            covers = self.narrowed(at, best, &covers);
            alleles.push(best);
        }
        self.without_needless(at, action, alleles)
    }

    /// Drops each allele that later ones made needless.
    fn without_needless(&self, at: usize, action: Action, mut alleles: Vec<usize>) -> Candidate {
        let right = &self.right[action.index()];
        for place in (0..alleles.len()).rev() {
            let dropped = alleles.remove(place);
            if !self.matching(at, &alleles).is_subset(right) {
                alleles.insert(place, dropped);
            }
        }
        Candidate {
            condition: Condition::of_alleles(&self.known[at].0, alleles.iter().copied()),
            action,
            covers: self.matching(at, &alleles),
        }
    }

    /// The known percepts that agree with percept number `at` in some alleles.
    fn matching(&self, at: usize, alleles: &[usize]) -> FixedBitSet {
        let mut all = FixedBitSet::with_capacity(self.known.len());
        all.insert_range(..);
        let narrow = |covers, &allele: &usize| self.narrowed(at, allele, &covers);
        alleles.iter().fold(all, narrow)
    }

    /// Those of some percepts that agree with percept number `at` in an allele.
    fn narrowed(&self, at: usize, allele: usize, covers: &FixedBitSet) -> FixedBitSet {
        let mut covers = covers.clone();
        match self.ones[allele].contains(at) {
            true => covers.intersect_with(&self.ones[allele]),
            false => covers.difference_with(&self.ones[allele]),
        }
        covers
    }

    /// The rule with its figures, from those that it takes over.
    fn classifier(&self, one: &Candidate) -> Classifier {
        let worth = |at: usize| self.known[at].1.get(one.action).unwrap_or(0.0);
        let count = one.covers.count_ones(..).max(1) as f64;
        let prediction = one.covers.ones().map(worth).sum::<f64>() / count;
        let deviation = |at| (worth(at) - prediction).abs();
        let rules = self.population.rules().iter();
        let absorbed = rules.filter(|rule| {
            rule.action == one.action
                && (rule.condition == one.condition
                    || one.condition.is_more_general_than(&rule.condition))
        });
        let (numerosity, experience) = absorbed.fold((0, 0), |(numerosity, experience), rule| {
            (
                numerosity + rule.numerosity,
                rule.experience.max(experience),
            )
        });
        Classifier {
            condition: one.condition,
            action: one.action,
            prediction,
            error: one.covers.ones().map(deviation).sum::<f64>() / count,
            fitness: 1.0,
            numerosity: numerosity.max(1),
            experience,
            time_stamp: 0,
            set_size: f64::from(numerosity.max(1)),
            eam: 1.0,
        }
    }
}

/// By what the next allele of a growing condition is chosen.
#[derive(Clone, Copy)]
enum Greed {
    /// What leaves the fewest percepts in which the action is wrong, then the most others.
    FewestWrong,
    /// What leaves the greatest share of percepts in which the action is right, then the most.
    GreatestShare,
}

impl Greed {
    fn rate(self, covers: &FixedBitSet, right: &FixedBitSet) -> (f64, f64) {
        let fine = covers.intersection_count(right) as f64;
        let wrong = covers.difference_count(right) as f64;
        match self {
            Self::FewestWrong => (-wrong, fine),
            Self::GreatestShare => (fine / (fine + wrong), fine),
        }
    }
}

/// Chooses candidates until all of `count` percepts are covered, each time one that covers the
/// most percepts not yet covered; of equals the one that demands the least, then the first.
fn cover(candidates: Vec<Candidate>, count: usize) -> Vec<Candidate> {
    let mut open = FixedBitSet::with_capacity(count);
    open.insert_range(..);
    let mut chosen = Vec::new();
    let rate = |one: &Candidate, open: &FixedBitSet| {
        let specificity = one.condition.specificity();
        (
            one.covers.intersection_count(open),
            std::cmp::Reverse(specificity),
        )
    };
    while let Some(best) = candidates.iter().rev().max_by_key(|one| rate(one, &open))
        && !open.is_clear()
    {
        open.difference_with(&best.covers);
        chosen.push(best.clone());
    }
    chosen
}

/// Removes rules whose percepts the others cover, the last chosen first.
fn without_superfluous(mut chosen: Vec<Candidate>) -> Vec<Candidate> {
    for at in (0..chosen.len()).rev() {
        let one = chosen.remove(at);
        let mut open = one.covers.clone();
        chosen
            .iter()
            .for_each(|other| open.difference_with(&other.covers));
        if !open.is_clear() {
            chosen.insert(at, one);
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::xcs::Params;

    fn rule(condition: &str, action: usize, prediction: f64) -> Classifier {
        let (condition, action) = (condition.parse().unwrap(), Action::new(action).unwrap());
        Classifier {
            prediction,
            ..Classifier::new(condition, action, 0, &Params::default())
        }
    }

    fn population(rules: &[(String, usize, f64)]) -> Population {
        let mut rules: Vec<_> = rules.iter().map(|(c, a, p)| rule(c, *a, *p)).collect();
        rules.sort_by_key(|rule| (rule.condition, rule.action));
        rules.dedup_by_key(|rule| (rule.condition, rule.action));
        rules.try_into().unwrap()
    }

    fn all_percepts(width: usize) -> Vec<Percept> {
        (0..1 << width)
            .map(|word| Percept::from_word(word, width))
            .collect()
    }

    fn best(population: &Population, percept: &Percept) -> Vec<usize> {
        let mut sums = PredictionSums::default();
        population.for_each_match(percept, |_, rule| sums.add(rule));
        sums.array(3, false)
            .best_actions()
            .map(Action::index)
            .collect()
    }

    #[test]
    fn a_table_of_a_simple_concept_becomes_one_rule_for_each_answer() {
        // The answer is the second bit.
        let table: Vec<_> = all_percepts(4)
            .into_iter()
            .flat_map(|percept| {
                let answer = usize::from(percept.bit(1));
                [0, 1].map(|a| {
                    (
                        percept.to_string(),
                        a,
                        if a == answer { 1000.0 } else { 0.0 },
                    )
                })
            })
            .collect();
        let condensed = compact(&population(&table), &all_percepts(4), 2);
        let shown = condensed.rules().iter();
        let mut shown: Vec<_> = shown
            .map(|r| (r.condition.to_string(), r.action.index(), r.prediction))
            .collect();
        shown.sort_by_key(|a| a.1);
        assert_eq!(
            shown,
            [("#0##".into(), 0, 1000.0), ("#1##".into(), 1, 1000.0)]
        );
    }

    #[test]
    fn nothing_is_made_of_nothing() {
        assert!(compact(&Population::default(), &all_percepts(3), 2).is_empty());
        let rules = population(&[("111".into(), 0, 1.0)]);
        assert!(compact(&rules, &["000".parse().unwrap()], 2).is_empty());
    }

    proptest! {
        #[test]
        fn condensed_rules_choose_what_all_rules_choose_in_every_percept(
            rules in prop::collection::vec(("[01#]{5}", 0_usize..3, -1_i32..2), 0..40),
        ) {
            // Few different predictions, so that there are ties.
            let rules: Vec<_> =
                rules.into_iter().map(|(c, a, p)| (c, a, f64::from(p))).collect();
            let full = population(&rules);
            let condensed = compact(&full, &all_percepts(5), 3);
            prop_assert!(condensed.len() <= 32);
            for percept in all_percepts(5) {
                let (wanted, chosen) = (best(&full, &percept), best(&condensed, &percept));
                if wanted.is_empty() {
                    continue;
                }
                prop_assert!(!chosen.is_empty(), "{}", percept);
                for action in chosen {
                    prop_assert!(wanted.contains(&action), "{}: {} of {:?}", percept, action, wanted);
                }
            }
        }
    }
}
