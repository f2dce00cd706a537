//! Rule discovery from labelled examples by induction. The rules form a best-action map that is
//! general from the start.
//!
//! Each rule states that its action is one of the best wherever its condition matches. The best
//! action generalises further than action values, so a few rules suffice. The rules are kept
//! consistent with all examples, and complete as long as \[P\] has room:
//! 1. A rule that covers an example in which its action is not among the best is specialised until
//!    it covers no such example. It is removed if it would cover no correct example.
//! 2. For an example that no rule covers, a rule is grown from the most general condition. It
//!    requires only the alleles it needs.
//! 3. A rule whose examples are all covered by other rules is redundant and is removed, the least
//!    general first.
//!
//! A rule's prediction is the mean value of its examples. Its error is the mean deviation from the
//! prediction. Its experience and fitness are the number of its examples, so general rules weigh
//! more in the prediction array (Eq. 6). Alternatively, experience and fitness are the rule's
//! record of the steps in which it acted ([`Record::Steps`]).

mod search;

use std::collections::BTreeSet;

use fixedbitset::FixedBitSet;

use super::classifier::Classifier;
use super::labelled_examples::{LabelledExample, LabelledExamples};
use super::params::Params;
use super::population::Population;
use search::{Candidate, covering, right_in_groups};

/// The meaning of a rule's experience and fitness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Record {
    /// The number of examples that the rule covers.
    #[default]
    LabelledExamples,
    /// The number of steps in which the rule acted, and the share in which it was right: see
    /// [`Population::record`].
    Steps,
}

/// The examples covered by each rule of a population.
#[derive(Debug, Clone, Default)]
pub struct Induction {
    /// The ends of the feature groups of a percept. Rules use a later group only if the earlier
    /// ones do not suffice.
    groups: &'static [usize],
    record: Record,
    /// By the position of a rule in \[P\]: the examples it covers.
    covers: Vec<FixedBitSet>,
    /// By the position of a rule in \[P\]: true if its statistics are out of date.
    outdated: Vec<bool>,
    /// By example: the number of rules that cover it.
    covered: Vec<u32>,
    /// The examples that no rule covers.
    uncovered: BTreeSet<usize>,
}

impl Induction {
    /// Creates an induction whose rules use features after the first of these positions only if the
    /// features before it do not suffice, and so on. `record` sets the meaning of experience and
    /// fitness.
    pub fn in_parts(groups: &'static [usize], record: Record) -> Self {
        Self {
            groups,
            record,
            ..Self::default()
        }
    }

    /// Makes the rules of a population agree with all examples. The population holds at most
    /// `params.population_size` rules. Marks all changes in the examples as learned.
    pub fn learn(
        &mut self,
        population: &mut Population,
        labelled_examples: &mut LabelledExamples,
        params: &Params,
    ) {
        let changed = labelled_examples.take_changed();
        if self.covers.len() != population.len() {
            self.survey(population, labelled_examples);
        }
        self.admit(population, labelled_examples, &changed);
        let specialised = self.specialise(population, labelled_examples, &changed, params);
        let covered = self.cover(population, labelled_examples, params);
        if specialised || covered {
            self.drop_redundant(population);
        }
        self.rate(population, labelled_examples);
    }

    /// Recomputes which examples the rules cover, for a population from a file.
    fn survey(&mut self, population: &Population, labelled_examples: &LabelledExamples) {
        *self = Self::in_parts(self.groups, self.record);
        for rule in population.rules() {
            let numbers = labelled_examples
                .iter()
                .filter(|(_, l)| rule.condition.matches(&l.percept));
            let covers: FixedBitSet = numbers.map(|(number, _)| number).collect();
            self.count(&covers, 1);
            self.covers.push(covers);
            self.outdated.push(true);
        }
        let all = labelled_examples.iter().map(|(number, _)| number);
        let is_uncovered =
            |number: &usize| self.covered.get(*number).is_none_or(|&rules| rules == 0);
        self.uncovered = all.filter(is_uncovered).collect();
    }

    /// Adds `by` to the number of rules that cover each of these examples.
    fn count(&mut self, labelled_examples: &FixedBitSet, by: i32) {
        let len = self.covered.len().max(labelled_examples.len());
        self.covered.resize(len, 0);
        for number in labelled_examples.ones() {
            self.covered[number] = self.covered[number].wrapping_add_signed(by);
            self.note_uncovered(number);
        }
    }

    /// Updates the list of uncovered examples.
    fn note_uncovered(&mut self, number: usize) {
        match self.covered[number] {
            0 => self.uncovered.insert(number),
            _ => self.uncovered.remove(&number),
        };
    }

    /// Finds the rules that cover the changed examples.
    fn admit(
        &mut self,
        population: &Population,
        labelled_examples: &LabelledExamples,
        changed: &[usize],
    ) {
        for &number in changed {
            let Some(LabelledExample { percept, .. }) = labelled_examples.get(number) else {
                continue;
            };
            let len = self.covered.len().max(number + 1);
            self.covered.resize(len, 0);
            population.for_each_match(percept, |id, _| {
                let at = population
                    .position(id)
                    .expect("a rule that matches is in [P]");
                self.outdated[at] = true;
                self.covers[at].grow(number + 1);
                if !self.covers[at].put(number) {
                    self.covered[number] += 1;
                }
            });
            self.note_uncovered(number);
        }
    }

    /// Specialises the rules that are wrong in a changed example. Returns true if there were any.
    fn specialise(
        &mut self,
        population: &mut Population,
        labelled_examples: &LabelledExamples,
        changed: &[usize],
        params: &Params,
    ) -> bool {
        let mut wrong = Vec::new();
        for labelled_example in changed
            .iter()
            .filter_map(|&number| labelled_examples.get(number))
        {
            population.for_each_match(&labelled_example.percept, |id, rule| {
                if !labelled_example.best[rule.action.index()] {
                    wrong.push(id);
                }
            });
        }
        for &id in &wrong {
            let Some(at) = population.position(id) else {
                continue;
            };
            let rule = population.rules()[at];
            let covers = self.remove(population, at);
            let general = Candidate {
                condition: rule.condition,
                action: rule.action,
                covers,
            };
            if let Some(special) = right_in_groups(labelled_examples, &general, None, self.groups) {
                self.insert(population, special, params);
            }
        }
        !wrong.is_empty()
    }

    /// Adds rules until each example is covered or \[P\] is full. Returns true if any was added.
    fn cover(
        &mut self,
        population: &mut Population,
        labelled_examples: &LabelledExamples,
        params: &Params,
    ) -> bool {
        let before = population.len();
        let mut from = 0;
        while population.len() < params.population_size as usize
            && let Some(&number) = self.uncovered.range(from..).next()
        {
            from = number + 1;
            let labelled_example = labelled_examples.get(number);
            if let Some(best) = labelled_example
                .and_then(|labelled_example| self.most_general(labelled_examples, labelled_example))
            {
                self.insert(population, best, params);
            }
        }
        population.len() > before
    }

    /// Returns the rule for an example that covers the most otherwise uncovered examples.
    fn most_general(
        &self,
        labelled_examples: &LabelledExamples,
        labelled_example: &LabelledExample,
    ) -> Option<Candidate> {
        let candidates = labelled_example.best_actions().filter_map(|action| {
            covering(labelled_examples, labelled_example, action, self.groups)
        });
        let gain = |one: &Candidate| {
            let new = one
                .covers
                .ones()
                .filter(|&n| self.covered.get(n) == Some(&0));
            (new.count(), one.covers.count_ones(..))
        };
        candidates.fold(None, |best: Option<Candidate>, next| match best {
            Some(best) if gain(&best) >= gain(&next) => Some(best),
            _ => Some(next),
        })
    }

    /// Removes rules whose examples are all covered by others, the least general first. Keeps a
    /// rule that covers no example, because no other rule can replace it.
    fn drop_redundant(&mut self, population: &mut Population) {
        let mut order: Vec<_> = (0..population.len()).collect();
        order.sort_by_key(|&at| self.covers[at].count_ones(..));
        let ids: Vec<_> = order.iter().map(|&at| population.id_at(at)).collect();
        for id in ids {
            let at = population
                .position(id)
                .expect("only rules seen before were removed");
            let covers = &self.covers[at];
            let is_covered = |number| self.covered[number] > 1;
            if !covers.is_clear() && covers.ones().all(is_covered) {
                self.remove(population, at);
            }
        }
    }

    /// Recomputes outdated statistics of the rules.
    fn rate(&mut self, population: &mut Population, labelled_examples: &LabelledExamples) {
        let record = self.record;
        let rules = self.covers.iter().zip(&mut self.outdated);
        for (at, (covers, outdated)) in rules.enumerate() {
            let number = covers.count_ones(..) as f64;
            if !std::mem::take(outdated) || number == 0.0 {
                continue;
            }
            let value = |number| {
                labelled_examples
                    .get(number)
                    .map_or(0.0, |labelled_example| labelled_example.value)
            };
            let prediction = covers.ones().map(value).sum::<f64>() / number;
            let deviations = covers
                .ones()
                .map(|number| (value(number) - prediction).abs());
            let error = deviations.sum::<f64>() / number;
            population.modify(population.id_at(at), |rule| {
                rule.prediction = prediction;
                rule.error = error;
                if record == Record::LabelledExamples {
                    rule.experience = number as u32;
                    rule.fitness = number;
                }
            });
        }
    }

    fn insert(&mut self, population: &mut Population, one: Candidate, params: &Params) {
        let before = population.len();
        let mut rule = Classifier::new(one.condition, one.action, 0, params);
        if self.record == Record::Steps {
            rule.fitness = 1.0;
        }
        let id = population.insert(rule);
        if population.len() == before {
            // The rule existed already; it remains one micro-classifier.
            population.modify(id, |rule| rule.numerosity = 1);
            return;
        }
        self.count(&one.covers, 1);
        self.covers.push(one.covers);
        self.outdated.push(true);
    }

    fn remove(&mut self, population: &mut Population, at: usize) -> FixedBitSet {
        population.remove(population.id_at(at));
        let covers = self.covers.swap_remove(at);
        self.outdated.swap_remove(at);
        self.count(&covers, -1);
        covers
    }
}

#[cfg(test)]
mod tests;
