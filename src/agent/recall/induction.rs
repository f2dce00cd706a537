//! Rules for the best actions, induced from lessons: few, general, and none that errs.

use fixedbitset::FixedBitSet;

use super::lessons::Lessons;
use xcs::{Action, Percept};
use xcs::{Classifier, Condition, Params};

/// What rules are induced from, as bit sets over the lessons.
struct Table {
    contexts: Vec<Percept>,
    weights: Vec<f64>,
    /// By lesson: what the best action costs.
    costs: Vec<f64>,
    /// By bit of a context: the lessons in which it is set.
    bits: Vec<FixedBitSet>,
    /// By action: the lessons in which it is good.
    good: Vec<FixedBitSet>,
}

/// A condition in the making, and what it covers.
#[derive(Clone)]
struct Draft {
    action: Action,
    /// The bits that it demands, with their values.
    demands: Vec<(usize, bool)>,
    cover: FixedBitSet,
}

/// Rules that advocate only actions that cost at most `tolerance` more than the best, and cover all
/// lessons that came at least `least_weight` times.
pub fn induce(
    lessons: &Lessons,
    actions: usize,
    tolerance: f64,
    least_weight: f64,
) -> Vec<Classifier> {
    let table = Table::new(lessons, actions, tolerance, least_weight);
    let mut uncovered = FixedBitSet::with_capacity(table.contexts.len());
    uncovered.insert_range(..);
    let mut drafts: Vec<Draft> = Vec::new();
    while let Some(draft) = table.best_draft(&uncovered) {
        uncovered.difference_with(&draft.cover);
        drafts.push(draft);
    }
    table.drop_superfluous(&mut drafts);
    drafts.iter().map(|draft| table.rule(draft)).collect()
}

impl Table {
    fn new(lessons: &Lessons, actions: usize, tolerance: f64, least_weight: f64) -> Self {
        let kept = || {
            lessons
                .iter()
                .filter(|(_, lesson)| lesson.weight >= least_weight)
        };
        let contexts: Vec<Percept> = kept().map(|(context, _)| *context).collect();
        let set = |is: &dyn Fn(usize) -> bool| {
            let mut set = FixedBitSet::with_capacity(contexts.len());
            (0..contexts.len())
                .filter(|&at| is(at))
                .for_each(|at| set.insert(at));
            set
        };
        let width = contexts.first().map_or(0, Percept::width);
        let lessons: Vec<_> = kept().map(|(_, lesson)| *lesson).collect();
        Self {
            bits: (0..width)
                .map(|bit| set(&|at| contexts[at].bit(bit)))
                .collect(),
            good: Action::all(actions)
                .map(|action| set(&|at| lessons[at].regret(action, actions) <= tolerance))
                .collect(),
            weights: lessons.iter().map(|lesson| lesson.weight).collect(),
            costs: lessons.iter().map(|lesson| lesson.least(actions)).collect(),
            contexts,
        }
    }

    /// The rule that covers most of what is not covered yet, of those that cover the heaviest of it.
    fn best_draft(&self, uncovered: &FixedBitSet) -> Option<Draft> {
        let heavier = |best: usize, at: usize| {
            if self.weights[at] > self.weights[best] {
                at
            } else {
                best
            }
        };
        let seed = uncovered.ones().reduce(heavier)?;
        let good = (0..self.good.len()).filter(|&action| self.good[action].contains(seed));
        let drafts = good.filter_map(|action| self.draft(seed, Action::new(action)?, uncovered));
        let gain = |draft: &Draft| draft.cover.intersection_count(uncovered);
        drafts.reduce(|best, one| if gain(&one) > gain(&best) { one } else { best })
    }

    /// A general rule for an action that covers a lesson and errs in none: demands bits one by one
    /// until it errs nowhere, and then drops those that are not needed.
    fn draft(&self, seed: usize, action: Action, uncovered: &FixedBitSet) -> Option<Draft> {
        let good = &self.good[action.index()];
        let mut draft = Draft {
            action,
            demands: Vec::new(),
            cover: FixedBitSet::with_capacity(self.contexts.len()),
        };
        draft.cover.insert_range(..);
        while !draft.cover.is_subset(good) {
            let demand = self.best_demand(&draft, seed, good, uncovered)?;
            draft.cover = self.covered(&draft.cover, demand);
            draft.demands.push(demand);
        }
        self.generalise(&mut draft, good);
        Some(draft)
    }

    /// The bit whose value in the seed keeps what is good and rules out what is not.
    fn best_demand(
        &self,
        draft: &Draft,
        seed: usize,
        good: &FixedBitSet,
        uncovered: &FixedBitSet,
    ) -> Option<(usize, bool)> {
        let before = draft.cover.count_ones(..);
        let mut best: Option<(f64, (usize, bool))> = None;
        for bit in 0..self.bits.len() {
            let value = self.contexts[seed].bit(bit);
            let cover = self.covered(&draft.cover, (bit, value));
            let all = cover.count_ones(..);
            if all == before {
                continue;
            }
            let mut right = cover;
            right.intersect_with(good);
            let wrong = all - right.count_ones(..);
            let gain = right.intersection_count(uncovered);
            let score = (gain as f64 + 1.0) / (gain + wrong + 2) as f64;
            if best.is_none_or(|best| score > best.0 + 1e-12) {
                best = Some((score, (bit, value)));
            }
        }
        best.map(|best| best.1)
    }

    fn covered(&self, cover: &FixedBitSet, (bit, value): (usize, bool)) -> FixedBitSet {
        let mut covered = cover.clone();
        match value {
            true => covered.intersect_with(&self.bits[bit]),
            false => covered.difference_with(&self.bits[bit]),
        }
        covered
    }

    /// Drops the demands without which the rule errs nowhere either, the first ones first.
    fn generalise(&self, draft: &mut Draft, good: &FixedBitSet) {
        let mut all = FixedBitSet::with_capacity(self.contexts.len());
        all.insert_range(..);
        let mut at = 0;
        while at < draft.demands.len() {
            let others = draft
                .demands
                .iter()
                .enumerate()
                .filter(|other| other.0 != at);
            let cover = others.fold(all.clone(), |cover, (_, &demand)| {
                self.covered(&cover, demand)
            });
            if cover.is_subset(good) {
                draft.demands.remove(at);
                draft.cover = cover;
            } else {
                at += 1;
            }
        }
    }

    /// Drops rules whose lessons others cover, the least general first.
    fn drop_superfluous(&self, drafts: &mut Vec<Draft>) {
        drafts.sort_by_key(|draft| draft.cover.count_ones(..));
        let mut at = 0;
        while at < drafts.len() {
            let mut others = FixedBitSet::with_capacity(self.contexts.len());
            for (other, draft) in drafts.iter().enumerate() {
                if other != at {
                    others.union_with(&draft.cover);
                }
            }
            if drafts[at].cover.is_subset(&others) {
                drafts.remove(at);
            } else {
                at += 1;
            }
        }
    }

    /// The rule of a draft: its prediction is what the steps from its lessons to the goal cost on
    /// average, its experience how many lessons it covers.
    fn rule(&self, draft: &Draft) -> Classifier {
        let first = draft.cover.ones().next().expect("a draft covers its seed");
        let bits = draft.demands.iter().map(|demand| demand.0);
        let condition = Condition::of_alleles(&self.contexts[first], bits);
        let sum = |of: &dyn Fn(usize) -> f64| -> f64 { draft.cover.ones().map(of).sum() };
        let weight = sum(&|at| self.weights[at]);
        let prediction = -sum(&|at| self.weights[at] * self.costs[at]) / weight;
        let error = sum(&|at| self.weights[at] * (self.costs[at] + prediction).abs()) / weight;
        Classifier {
            prediction,
            error,
            fitness: 1.0,
            experience: draft.cover.count_ones(..) as u32,
            ..Classifier::new(condition, draft.action, 0, &Params::default())
        }
    }
}
