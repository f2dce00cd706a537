//! Labelled examples: the best actions in a percept.

use super::action::{Action, ByAction, MAX_ACTIONS};
use super::layout::{Feature, Layout};
use super::percept::Percept;
use super::prediction::PredictionArray;
use fixedbitset::FixedBitSet;

/// The label of one percept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LabelledExample {
    /// The percept.
    pub percept: Percept,
    /// By action: true if it is one of the best.
    pub best: ByAction<bool>,
}

impl LabelledExample {
    /// Returns the best actions; at least one.
    pub fn best_actions(&self) -> impl Iterator<Item = Action> + '_ {
        Action::all(MAX_ACTIONS).filter(|action| self.best[action.index()])
    }

    /// Returns true if any action has a value and all actions that are
    /// [nearly best](PredictionArray::is_nearly_best) by the values are among the best.
    pub fn agrees_with(&self, values: &PredictionArray) -> bool {
        let mut chosen = Action::all(MAX_ACTIONS).filter(|&action| values.is_nearly_best(action));
        values.greatest().is_some() && chosen.all(|action| self.best[action.index()])
    }
}

/// All examples, by the number assigned to a percept. Also stored in columns, one for each feature of a
/// percept, so that what sets of examples have in common is counted 64 examples at a time.
#[derive(Debug, Clone, Default)]
pub struct LabelledExamples {
    all: Vec<Option<LabelledExample>>,
    layout: Layout,
    /// The width of the percepts.
    width: usize,
    /// The numbers of the examples that exist.
    given: FixedBitSet,
    /// By feature: the examples in whose percept the feature is true.
    ones: Vec<FixedBitSet>,
    /// By action: the examples in which the action is one of the best.
    best: ByAction<FixedBitSet>,
}

impl LabelledExamples {
    /// Creates an empty set of examples, whose percepts have this layout.
    pub fn new(layout: Layout) -> Self {
        Self {
            layout,
            ..Self::default()
        }
    }

    /// Adds or changes an example. A number always refers to the same percept, and all percepts
    /// have the same width.
    pub fn give(&mut self, number: usize, labelled_example: LabelledExample) {
        let len = self.all.len().max(number + 1);
        self.all.resize(len, None);
        let before = self.all[number].replace(labelled_example);
        if before == Some(labelled_example) {
            return;
        }
        if before.is_none() {
            self.given.grow_and_insert(number);
            let percept = &labelled_example.percept;
            self.width = percept.width();
            for feature in self.layout.true_in(percept) {
                let at = self.layout.place(feature, self.width);
                let len = self.ones.len().max(at + 1);
                self.ones.resize(len, FixedBitSet::new());
                self.ones[at].grow_and_insert(number);
            }
        }
        for (labelled_examples, is_best) in self.best.iter_mut().zip(labelled_example.best) {
            labelled_examples.grow(number + 1);
            labelled_examples.set(number, is_best);
        }
    }

    /// Returns the example with this number.
    pub fn get(&self, number: usize) -> Option<&LabelledExample> {
        self.all.get(number)?.as_ref()
    }

    /// Returns the numbers of all examples, as a set.
    pub(super) fn given(&self) -> &FixedBitSet {
        &self.given
    }

    /// Returns the examples in which an action is one of the best.
    pub(super) fn given_where(&self, action: Action) -> &FixedBitSet {
        &self.best[action.index()]
    }

    /// Returns all features of the percepts that are true in any example.
    pub(super) fn features(&self) -> impl Iterator<Item = Feature> + '_ {
        let all = self.layout.features(self.width);
        all.filter(|&feature| self.is_ever_true(feature))
    }

    /// Returns the value of a number in the percept of an example.
    pub(super) fn number_in(&self, example: usize, number: usize) -> Option<u16> {
        self.get(example)
            .map(|example| self.layout.number(&example.percept, number))
    }

    /// Counts the given examples with this value of a feature: those that do not contradict, and those that do.
    pub(super) fn count(
        &self,
        some: &FixedBitSet,
        contradicting: &FixedBitSet,
        feature: Feature,
        value: bool,
    ) -> [u32; 2] {
        let flip = if value { 0 } else { usize::MAX };
        let ones = self.ones(feature).map_or(&[][..], FixedBitSet::as_slice);
        let at = |words: &[usize], i: usize| words.get(i).copied().unwrap_or(0);
        let mut counts = [0; 2];
        for (i, &word) in some.as_slice().iter().enumerate() {
            let with = word & (at(ones, i) ^ flip);
            let wrong = with & at(contradicting.as_slice(), i);
            counts[0] += (with & !wrong).count_ones();
            counts[1] += wrong.count_ones();
        }
        counts
    }

    /// Returns the layout of the percepts.
    pub(super) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the examples in whose percept a feature is true; `None` if there are none.
    fn ones(&self, feature: Feature) -> Option<&FixedBitSet> {
        let ones = self.ones.get(self.layout.place(feature, self.width))?;
        (!ones.is_clear()).then_some(ones)
    }

    /// Returns true if a feature is true in the percept of any example.
    fn is_ever_true(&self, feature: Feature) -> bool {
        self.ones(feature).is_some()
    }

    /// Returns the given examples in whose percept a feature has a value.
    pub(super) fn with_feature(
        &self,
        some: &FixedBitSet,
        feature: Feature,
        value: bool,
    ) -> FixedBitSet {
        let mut with = some.clone();
        match (value, self.ones(feature)) {
            (true, Some(ones)) => with.intersect_with(ones),
            (true, None) => with.clear(),
            (false, ones) => ones.into_iter().for_each(|ones| with.difference_with(ones)),
        }
        with
    }
}
