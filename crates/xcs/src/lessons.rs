//! Lessons: in which percept which actions are best, and what they are worth.

use fixedbitset::FixedBitSet;
use serde::{Deserialize, Serialize};

use super::prediction::PredictionArray;
use super::signal::{Action, ByAction, MAX_ACTIONS, Percept};

/// What a teacher says of one percept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Lesson {
    /// The percept.
    pub percept: Percept,
    /// By action: is it one of the best?
    pub best: ByAction<bool>,
    /// What the best actions are worth.
    pub value: f64,
}

impl Lesson {
    /// The best actions; at least one.
    pub fn best_actions(&self) -> impl Iterator<Item = Action> + '_ {
        Action::all(MAX_ACTIONS).filter(|action| self.best[action.index()])
    }

    /// Is every action of the greatest worth one of the best, and is there one?
    pub fn agrees_with(&self, worth: &PredictionArray) -> bool {
        let mut chosen = worth.best_actions();
        worth.greatest().is_some() && chosen.all(|action| self.best[action.index()])
    }
}

/// All lessons, by the number that the teacher gives to a percept, and once more in columns: what
/// sets of lessons have in common is counted 64 at a time.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(into = "Vec<Option<Lesson>>", from = "Vec<Option<Lesson>>")]
pub struct Lessons {
    all: Vec<Option<Lesson>>,
    /// The numbers of those that are given.
    given: FixedBitSet,
    /// By allele: the lessons in whose percept it is 1.
    ones: Vec<FixedBitSet>,
    /// By action: the lessons in which it is one of the best.
    best: ByAction<FixedBitSet>,
    /// Those that are new or were changed since they were last asked for, in that order.
    changed: Vec<usize>,
}

impl Lessons {
    /// Gives or changes a lesson; a number always means the same percept, and all percepts are of
    /// one width.
    pub fn give(&mut self, number: usize, lesson: Lesson) {
        let room = self.all.len().max(number + 1);
        self.all.resize(room, None);
        let before = self.all[number].replace(lesson);
        if before == Some(lesson) {
            return;
        }
        self.changed.push(number);
        if before.is_none() {
            self.given.grow_and_insert(number);
            let width = self.ones.len().max(lesson.percept.width());
            self.ones.resize(width, FixedBitSet::new());
            for bit in (0..lesson.percept.width()).filter(|&bit| lesson.percept.bit(bit)) {
                self.ones[bit].grow_and_insert(number);
            }
        }
        for (lessons, is_best) in self.best.iter_mut().zip(lesson.best) {
            lessons.grow(number + 1);
            lessons.set(number, is_best);
        }
    }

    /// The lesson of this number.
    pub fn get(&self, number: usize) -> Option<&Lesson> {
        self.all.get(number)?.as_ref()
    }

    /// All lessons, in the order of their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &Lesson)> {
        let all = self.all.iter().enumerate();
        all.filter_map(|(number, lesson)| Some((number, lesson.as_ref()?)))
    }

    /// Is there something that was not yet learned?
    pub fn have_changed(&self) -> bool {
        !self.changed.is_empty()
    }

    /// The numbers of the lessons that are new or were changed, in that order; they may repeat.
    pub fn take_changed(&mut self) -> Vec<usize> {
        std::mem::take(&mut self.changed)
    }

    /// The numbers of all lessons, as a set.
    pub(super) fn given(&self) -> &FixedBitSet {
        &self.given
    }

    /// Those of some lessons in whose percept an allele has a value.
    pub(super) fn with_allele(&self, some: &FixedBitSet, bit: usize, value: bool) -> FixedBitSet {
        let mut with = some.clone();
        match value {
            true => with.intersect_with(&self.ones[bit]),
            false => with.difference_with(&self.ones[bit]),
        }
        with
    }

    /// How many of some lessons have an allele of this value, `[with, without]` the action among
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

    /// How many of some lessons have the action among the best, and how many have not.
    pub(super) fn verdicts(&self, some: &FixedBitSet, action: Action) -> [u32; 2] {
        let right = some.intersection_count(&self.best[action.index()]);
        [right as u32, (some.count_ones(..) - right) as u32]
    }
}

impl From<Lessons> for Vec<Option<Lesson>> {
    fn from(lessons: Lessons) -> Self {
        lessons.all
    }
}

impl From<Vec<Option<Lesson>>> for Lessons {
    /// Lessons that were learned already.
    fn from(all: Vec<Option<Lesson>>) -> Self {
        let mut lessons = Self::default();
        for (number, lesson) in all.into_iter().enumerate() {
            lesson
                .into_iter()
                .for_each(|lesson| lessons.give(number, lesson));
        }
        lessons.changed.clear();
        lessons
    }
}
