//! Discovery of rules by induction from examples: a best-action map, general while it is learned.
//!
//! Each rule says "wherever my condition matches, my action is one of the best". Which action is
//! best generalises further than what actions are worth, so a few rules suffice. They are kept
//! consistent with all examples, and complete as long as \[P\] has room:
//! 1. a rule that covers a example in which its action is not among the best demands more alleles,
//!    until it covers none, or goes when nothing good is left;
//! 2. for a example that no rule covers, a rule is grown from the most general condition, and
//!    demands what it must and no more;
//! 3. a rule whose examples others cover is superfluous and goes, the least general first.
//!
//! A rule's prediction is the mean value of its examples, its error the mean deviation from that,
//! its experience their number, and so is its fitness: in the prediction array (Eq. 6) general
//! rules weigh more. Or its experience and fitness are its own record of the steps in which it acted
//! ([`Record::Steps`]).

use std::collections::BTreeSet;

use fixedbitset::FixedBitSet;

use super::classifier::Classifier;
use super::condition::Condition;
use super::labelled_examples::{LabelledExample, LabelledExamples};
use super::params::Params;
use super::population::Population;
use super::signal::{Action, Percept};

/// What the experience and the fitness of a rule tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Record {
    /// How many examples it covers.
    #[default]
    LabelledExamples,
    /// In how many steps it acted, and in which share it was right: see [`Population::record`].
    Steps,
}

/// Which examples the rules of a population cover.
#[derive(Debug, Clone, Default)]
pub struct Induction {
    /// Where parts of a percept end, if rules look at later ones only where earlier ones do not suffice.
    parts: &'static [usize],
    record: Record,
    /// By the position of a rule in \[P\]: the examples that it covers.
    covers: Vec<FixedBitSet>,
    /// By the position of a rule in \[P\]: are its figures those of other examples than it covers?
    outdated: Vec<bool>,
    /// By example: how many rules cover it.
    covered: Vec<u32>,
    /// The examples that no rule covers.
    bare: BTreeSet<usize>,
}

/// A rule that may join \[P\], and the examples that it covers.
#[derive(Clone)]
struct Candidate {
    condition: Condition,
    action: Action,
    covers: FixedBitSet,
}

impl Induction {
    /// Of rules that look at what comes after the first of these positions only where what is before it does
    /// not suffice, and so on, and that keep such a record.
    pub fn in_parts(parts: &'static [usize], record: Record) -> Self {
        Self {
            parts,
            record,
            ..Self::default()
        }
    }

    /// Makes the rules of a population agree with all examples; it holds at most
    /// `params.population_size` of them. What changed in `examples` counts as learned then.
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
            self.drop_superfluous(population);
        }
        self.rate(population, labelled_examples);
    }

    /// Looks up from scratch which examples the rules cover, for a population from a file.
    fn survey(&mut self, population: &Population, labelled_examples: &LabelledExamples) {
        *self = Self::in_parts(self.parts, self.record);
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
        let is_bare = |number: &usize| self.covered.get(*number).is_none_or(|&rules| rules == 0);
        self.bare = all.filter(is_bare).collect();
    }

    /// Counts that some examples are covered by one rule more, or less.
    fn count(&mut self, labelled_examples: &FixedBitSet, by: i32) {
        let room = self.covered.len().max(labelled_examples.len());
        self.covered.resize(room, 0);
        for number in labelled_examples.ones() {
            self.covered[number] = self.covered[number].wrapping_add_signed(by);
            self.note_bare(number);
        }
    }

    /// Keeps the list of examples that no rule covers.
    fn note_bare(&mut self, number: usize) {
        match self.covered[number] {
            0 => self.bare.insert(number),
            _ => self.bare.remove(&number),
        };
    }

    /// Finds the rules that cover the examples that are new.
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
            let room = self.covered.len().max(number + 1);
            self.covered.resize(room, 0);
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
            self.note_bare(number);
        }
    }

    /// Makes the rules that are wrong in a changed example demand more; true if there were any.
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
            if let Some(special) = right_in_part(labelled_examples, &general, None, self.parts) {
                self.insert(population, special, params);
            }
        }
        !wrong.is_empty()
    }

    /// Adds rules until each example is covered or \[P\] is full; true if any was added.
    fn cover(
        &mut self,
        population: &mut Population,
        labelled_examples: &LabelledExamples,
        params: &Params,
    ) -> bool {
        let before = population.len();
        let mut from = 0;
        while population.len() < params.population_size as usize
            && let Some(&number) = self.bare.range(from..).next()
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

    /// The rule for a example that covers the most examples that no other rule does.
    fn most_general(
        &self,
        labelled_examples: &LabelledExamples,
        labelled_example: &LabelledExample,
    ) -> Option<Candidate> {
        let candidates = labelled_example
            .best_actions()
            .filter_map(|action| covering(labelled_examples, labelled_example, action, self.parts));
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

    /// Removes rules whose examples are all covered by others, the least general first. A rule that covers no
    /// example stays: nothing else says what it says.
    fn drop_superfluous(&mut self, population: &mut Population) {
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

    /// Sets the figures of the rules of which they are outdated.
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
            // It was there already: still one rule.
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

/// The most general rule for a example that is found step by step; `None` if another example with
/// the same percept contradicts it.
fn covering(
    labelled_examples: &LabelledExamples,
    labelled_example: &LabelledExample,
    action: Action,
    parts: &[usize],
) -> Option<Candidate> {
    let general = Candidate {
        condition: Condition::of_alleles(&labelled_example.percept, []),
        action,
        covers: labelled_examples.given().clone(),
    };
    let found = right_in_part(
        labelled_examples,
        &general,
        Some(&labelled_example.percept),
        parts,
    )?;
    let mut alleles: Vec<usize> = demanded(&found.condition).collect();
    for allele in demanded(&found.condition) {
        let fewer: Vec<usize> = alleles.iter().copied().filter(|&a| a != allele).collect();
        let covers = with_alleles(labelled_examples, &labelled_example.percept, &fewer);
        if labelled_examples.verdicts(&covers, action)[1] == 0 {
            alleles = fewer;
        }
    }
    Some(Candidate {
        condition: Condition::of_alleles(&labelled_example.percept, alleles.iter().copied()),
        action,
        covers: with_alleles(labelled_examples, &labelled_example.percept, &alleles),
    })
}

fn demanded(condition: &Condition) -> impl Iterator<Item = usize> {
    let condition = *condition;
    (0..condition.width()).filter(move |&bit| condition.allele(bit).is_some())
}

/// The examples whose percept shares some alleles with this one.
fn with_alleles(
    labelled_examples: &LabelledExamples,
    percept: &Percept,
    alleles: &[usize],
) -> FixedBitSet {
    let given = labelled_examples.given().clone();
    let narrow = |some, &bit: &usize| labelled_examples.with_allele(&some, bit, percept.bit(bit));
    alleles.iter().fold(given, narrow)
}

/// The same with alleles of as few parts as will do.
fn right_in_part(
    labelled_examples: &LabelledExamples,
    rule: &Candidate,
    like: Option<&Percept>,
    parts: &[usize],
) -> Option<Candidate> {
    let ends = parts.iter().copied().chain([rule.condition.width()]);
    ends.into_iter()
        .find_map(|end| right(labelled_examples, rule.clone(), like, end))
}

/// Demands more alleles, those of a percept if one is given, until the rule covers only examples in
/// which its action is among the best: each time the allele that leaves the highest share of
/// these, (good + 1) / (all + 2). `None` when no good one would be left.
fn right(
    labelled_examples: &LabelledExamples,
    mut rule: Candidate,
    like: Option<&Percept>,
    end: usize,
) -> Option<Candidate> {
    loop {
        let [good, bad] = labelled_examples.verdicts(&rule.covers, rule.action);
        match (good, bad) {
            (0, _) => return None,
            (_, 0) => return Some(rule),
            _ => {}
        }
        let mut best: Option<((usize, bool), [u64; 2])> = None;
        let free = (0..end).filter(|&bit| rule.condition.allele(bit).is_none());
        for bit in free {
            for value in [false, true] {
                if like.is_some_and(|percept| percept.bit(bit) != value) {
                    continue;
                }
                let [left, wrong] =
                    labelled_examples.count(&rule.covers, (bit, value), rule.action);
                let share = [u64::from(left) + 1, u64::from(left + wrong) + 2];
                let is_better = |&(_, [a, b]): &(_, [u64; 2])| share[0] * b > a * share[1];
                if left > 0 && wrong < bad && best.as_ref().is_none_or(is_better) {
                    best = Some(((bit, value), share));
                }
            }
        }
        let ((bit, value), _) = best?;
        rule.condition = rule.condition.demanding(bit, value);
        rule.covers = labelled_examples.with_allele(&rule.covers, bit, value);
    }
}

#[cfg(test)]
mod tests;
