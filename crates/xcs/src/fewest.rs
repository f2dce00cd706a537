//! The fewest rules that keep all decisions.

use crate::classifier::Classifier;
use crate::population::Population;
use crate::prediction::{PredictionArray, PredictionSums};
use crate::signal::{Action, Percept};

/// Returns rules of `population` that choose, in each percept, only actions that all rules together rate best there, or
/// nearly so ([`PredictionArray::is_nearly_best`]).
///
/// Chooses rules that are right wherever they match, the one that covers the most percepts first. Percepts without such
/// a rule get the fittest rule of a chosen action, or else all rules that match. Then drops every rule without which no
/// decision changes, least fit first. A percept in which no rule has a value is ignored. The rules keep their statistics.
pub fn fewest_rules(population: &Population, percepts: &[Percept], actions: usize) -> Population {
    let task = Task::new(population, percepts, actions);
    let mut kept = task.cover();
    task.complete(&mut kept);
    task.drop_redundant(&mut kept);
    let rules = population.rules().iter().zip(kept);
    let rules: Vec<Classifier> = rules
        .filter(|(_, kept)| *kept)
        .map(|(rule, _)| *rule)
        .collect();
    rules
        .try_into()
        .expect("rules of a population, none of them twice")
}

/// The decisions to keep.
struct Task<'a> {
    rules: &'a [Classifier],
    actions: usize,
    /// By percept: the decisions of all rules.
    decisions: Vec<PredictionArray>,
    /// By percept: the rules that match it.
    matching: Vec<Vec<usize>>,
    /// By rule: the percepts that it matches.
    matched: Vec<Vec<usize>>,
}

impl<'a> Task<'a> {
    fn new(population: &'a Population, percepts: &[Percept], actions: usize) -> Self {
        let rules = population.rules();
        let mut percepts = percepts.to_vec();
        percepts.sort_unstable();
        percepts.dedup();
        let mut task = Self {
            rules,
            actions,
            decisions: Vec::new(),
            matching: Vec::new(),
            matched: vec![Vec::new(); rules.len()],
        };
        for percept in percepts {
            let decision = population.sums(&percept).array(actions, false);
            if decision.greatest().is_some() {
                task.add(&percept, decision);
            }
        }
        task
    }

    fn add(&mut self, percept: &Percept, decision: PredictionArray) {
        let rules = self.rules.iter().enumerate();
        let matching = rules.filter(|(_, rule)| rule.condition.matches(percept));
        let matching: Vec<usize> = matching.map(|(rule, _)| rule).collect();
        for &rule in &matching {
            self.matched[rule].push(self.decisions.len());
        }
        self.decisions.push(decision);
        self.matching.push(matching);
    }

    /// Chooses rules that are right wherever they match, the one that covers the most percepts first.
    fn cover(&self) -> Vec<bool> {
        let right: Vec<usize> = (0..self.rules.len())
            .filter(|&rule| self.is_right(rule))
            .collect();
        let mut open = vec![true; self.decisions.len()];
        let mut kept = vec![false; self.rules.len()];
        loop {
            let gain = |rule: usize| self.matched[rule].iter().filter(|&&at| open[at]).count();
            let gains = right.iter().map(|&rule| (gain(rule), rule));
            let best = gains.max_by(|a, b| {
                let fitness = |rule: usize| self.rules[rule].fitness;
                a.0.cmp(&b.0).then(fitness(a.1).total_cmp(&fitness(b.1)))
            });
            let Some((1.., best)) = best else {
                return kept;
            };
            kept[best] = true;
            self.matched[best].iter().for_each(|&at| open[at] = false);
        }
    }

    /// Adds rules until all decisions are kept: the fittest rule of a chosen action of a percept, then all that match it.
    fn complete(&self, kept: &mut [bool]) {
        for at in 0..self.decisions.len() {
            if !self.keeps_decision(at, kept) {
                let chosen = self.matching[at].iter().copied();
                let chosen = chosen.filter(|&rule| self.chooses(at, self.rules[rule].action));
                let fittest =
                    chosen.max_by(|&a, &b| self.rules[a].fitness.total_cmp(&self.rules[b].fitness));
                fittest.into_iter().for_each(|rule| kept[rule] = true);
            }
        }
        while let Some(at) = (0..self.decisions.len()).find(|&at| !self.keeps_decision(at, kept)) {
            self.matching[at].iter().for_each(|&rule| kept[rule] = true);
        }
    }

    /// Drops every rule without which no decision changes, least fit first.
    fn drop_redundant(&self, kept: &mut [bool]) {
        let mut order: Vec<usize> = (0..self.rules.len()).filter(|&rule| kept[rule]).collect();
        order.sort_by(|&a, &b| {
            let by_percepts = self.matched[a].len().cmp(&self.matched[b].len());
            by_percepts.then(self.rules[a].fitness.total_cmp(&self.rules[b].fitness))
        });
        for rule in order {
            kept[rule] = false;
            kept[rule] = !self.matched[rule]
                .iter()
                .all(|&at| self.keeps_decision(at, kept));
        }
    }

    /// Returns true if the action of a rule is one of the chosen ones in each percept that the rule matches.
    fn is_right(&self, rule: usize) -> bool {
        let action = self.rules[rule].action;
        self.matched[rule]
            .iter()
            .all(|&at| self.chooses(at, action))
    }

    fn chooses(&self, at: usize, action: Action) -> bool {
        self.decisions[at].is_nearly_best(action)
    }

    /// Returns true if the kept rules choose only actions in a percept that all rules choose there.
    fn keeps_decision(&self, at: usize, kept: &[bool]) -> bool {
        let mut sums = PredictionSums::default();
        let rules = self.matching[at].iter().filter(|&&rule| kept[rule]);
        rules.for_each(|&rule| sums.add(&self.rules[rule]));
        let values = sums.array(self.actions, false);
        let mut chosen = values.best_actions();
        values.greatest().is_some() && chosen.all(|action| self.chooses(at, action))
    }
}
