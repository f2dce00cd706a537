//! Examples: in which percept which actions are best, and what they are worth.

use fixedbitset::FixedBitSet;
use serde::{Deserialize, Serialize};

use super::prediction::PredictionArray;
use super::signal::{Action, ByAction, MAX_ACTIONS, Percept};

/// What a teacher says of one percept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LabelledExample {
    /// The percept.
    pub percept: Percept,
    /// By action: is it one of the best?
    pub best: ByAction<bool>,
    /// What the best actions are worth.
    pub value: f64,
}

impl LabelledExample {
    /// The best actions; at least one.
    pub fn best_actions(&self) -> impl Iterator<Item = Action> + '_ {
        Action::all(MAX_ACTIONS).filter(|action| self.best[action.index()])
    }

    /// Is every action of the greatest value one of the best, and is there one?
    pub fn agrees_with(&self, values: &PredictionArray) -> bool {
        let mut chosen = values.best_actions();
        values.greatest().is_some() && chosen.all(|action| self.best[action.index()])
    }
}

/// All examples, by the number that the teacher gives to a percept, and once more in columns: what
/// sets of examples have in common is counted 64 at a time.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(
    into = "Vec<Option<LabelledExample>>",
    from = "Vec<Option<LabelledExample>>"
)]
pub struct LabelledExamples {
    all: Vec<Option<LabelledExample>>,
    /// The numbers of those that are given.
    given: FixedBitSet,
    /// By allele: the examples in whose percept it is 1.
    ones: Vec<FixedBitSet>,
    /// By action: the examples in which it is one of the best.
    best: ByAction<FixedBitSet>,
    /// Those that are new or were changed since they were last asked for, in that order.
    changed: Vec<usize>,
}

impl LabelledExamples {
    /// Gives or changes a example; a number always means the same percept, and all percepts are of
    /// one width.
    pub fn give(&mut self, number: usize, labelled_example: LabelledExample) {
        let room = self.all.len().max(number + 1);
        self.all.resize(room, None);
        let before = self.all[number].replace(labelled_example);
        if before == Some(labelled_example) {
            return;
        }
        self.changed.push(number);
        if before.is_none() {
            self.given.grow_and_insert(number);
            let width = self.ones.len().max(labelled_example.percept.width());
            self.ones.resize(width, FixedBitSet::new());
            for bit in (0..labelled_example.percept.width())
                .filter(|&bit| labelled_example.percept.bit(bit))
            {
                self.ones[bit].grow_and_insert(number);
            }
        }
        for (labelled_examples, is_best) in self.best.iter_mut().zip(labelled_example.best) {
            labelled_examples.grow(number + 1);
            labelled_examples.set(number, is_best);
        }
    }

    /// The example of this number.
    pub fn get(&self, number: usize) -> Option<&LabelledExample> {
        self.all.get(number)?.as_ref()
    }

    /// All examples, in the order of their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &LabelledExample)> {
        let all = self.all.iter().enumerate();
        all.filter_map(|(number, labelled_example)| Some((number, labelled_example.as_ref()?)))
    }

    /// Is there something that was not yet learned?
    pub fn have_changed(&self) -> bool {
        !self.changed.is_empty()
    }

    /// The numbers of the examples that are new or were changed, in that order; they may repeat.
    pub fn take_changed(&mut self) -> Vec<usize> {
        std::mem::take(&mut self.changed)
    }

    /// The numbers of all examples, as a set.
    pub(super) fn given(&self) -> &FixedBitSet {
        &self.given
    }

    /// Those of some examples in whose percept an allele has a value.
    pub(super) fn with_allele(&self, some: &FixedBitSet, bit: usize, value: bool) -> FixedBitSet {
        let mut with = some.clone();
        match value {
            true => with.intersect_with(&self.ones[bit]),
            false => with.difference_with(&self.ones[bit]),
        }
        with
    }

    /// How many of some examples have an allele of this value, `[with, without]` the action among
    /// the best.
    pub(super) fn count(
        &self,
        some: &FixedBitSet,
        (bit, value): (usize, bool),
        action: Action,
    ) -> [u32; 2] {
        let flip = if value { 0 } else { usize::MAX };
        let (ones, best) = (
            self.ones[bit].as_slice(),
            self.best[action.index()].as_slice(),
        );
        let at = |words: &[usize], i: usize| words.get(i).copied().unwrap_or(0);
        let mut counts = [0; 2];
        for (i, &word) in some.as_slice().iter().enumerate() {
            let with = word & (at(ones, i) ^ flip);
            let right = with & at(best, i);
            counts[0] += right.count_ones();
            counts[1] += (with & !right).count_ones();
        }
        counts
    }

    /// How many of some examples have the action among the best, and how many have not.
    pub(super) fn verdicts(&self, some: &FixedBitSet, action: Action) -> [u32; 2] {
        let right = some.intersection_count(&self.best[action.index()]);
        [right as u32, (some.count_ones(..) - right) as u32]
    }
}

impl From<LabelledExamples> for Vec<Option<LabelledExample>> {
    fn from(labelled_examples: LabelledExamples) -> Self {
        labelled_examples.all
    }
}

impl From<Vec<Option<LabelledExample>>> for LabelledExamples {
    /// Examples that were learned already.
    fn from(all: Vec<Option<LabelledExample>>) -> Self {
        let mut labelled_examples = Self::default();
        for (number, labelled_example) in all.into_iter().enumerate() {
            labelled_example
                .into_iter()
                .for_each(|labelled_example| labelled_examples.give(number, labelled_example));
        }
        labelled_examples.changed.clear();
        labelled_examples
    }
}
