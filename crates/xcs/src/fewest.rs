//! The fewest rules that keep all decisions.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use crate::classifier::Classifier;
use crate::population::Population;
use crate::prediction::PredictionSums;
use crate::representation::Representation;
use crate::signal::Action;

/// Returns rules of `population` that choose, in each percept, only actions that all rules together rate best there, or
/// nearly so ([`PredictionArray::is_nearly_best`](crate::PredictionArray::is_nearly_best)).
///
/// Chooses rules that are right wherever they match, the one that covers the most percepts first. Percepts without such
/// a rule get rules of a chosen action, the fittest first, or else all rules that match. Then drops every rule without which no
/// decision changes, least general first, and exchanges two rules or more for one where this changes no decision. A
/// percept in which no rule has a value is ignored. The rules keep their statistics. The result depends on the order of
/// the percepts.
pub fn fewest_rules<C: Representation>(
    population: &Population<C>,
    percepts: &[C::Percept],
    actions: usize,
) -> Population<C> {
    let decisions = percepts.iter().map(|percept| {
        let decision = population.sums(percept).nearly_best(actions);
        (percept, decision)
    });
    fewest_rules_for(population, decisions, actions)
}

/// Returns rules of `population` that choose, in each percept, only actions of its decision, as [`fewest_rules`] does for
/// the decisions of all rules. A percept whose decision its rules together do not make keeps all of them.
pub fn fewest_rules_for<'a, C: Representation + 'a>(
    population: &Population<C>,
    decisions: impl Iterator<Item = (&'a C::Percept, Vec<Action>)>,
    actions: usize,
) -> Population<C> {
    let mut task = Task::new(population, decisions, actions);
    let mut kept = task.cover();
    task.complete(&mut kept);
    task.drop_redundant(&mut kept, 0..population.rules().len());
    task.exchange(&mut kept);
    let rules = population.rules().iter().zip(kept);
    let rules: Vec<Classifier<C>> = rules
        .filter(|(_, kept)| *kept)
        .map(|(rule, _)| rule.clone())
        .collect();
    rules
        .try_into()
        .expect("rules of a population, none of them twice")
}

/// The decisions to keep.
struct Task<'a, C: Representation> {
    rules: &'a [Classifier<C>],
    actions: usize,
    /// By percept: the decision, which is one or more actions.
    decisions: Vec<Vec<Action>>,
    /// By percept: true if all rules that match do not make the decision.
    lost: Vec<bool>,
    /// By percept: the rules that match it.
    matching: Vec<Vec<usize>>,
    /// By rule: the percepts that it matches.
    matched: Vec<Vec<usize>>,
}

impl<'a, C: Representation> Task<'a, C> {
    fn new<'b>(
        population: &'a Population<C>,
        decisions: impl Iterator<Item = (&'b C::Percept, Vec<Action>)>,
        actions: usize,
    ) -> Self
    where
        C: 'b,
    {
        let rules = population.rules();
        let mut task = Self {
            rules,
            actions,
            decisions: Vec::new(),
            lost: Vec::new(),
            matching: Vec::new(),
            matched: vec![Vec::new(); rules.len()],
        };
        for (percept, decision) in decisions {
            if !decision.is_empty() {
                task.add(percept, decision);
            }
        }
        task
    }

    fn add(&mut self, percept: &C::Percept, decision: Vec<Action>) {
        let rules = self.rules.iter().enumerate();
        let matching = rules.filter(|(_, rule)| rule.condition.matches(percept));
        let matching: Vec<usize> = matching.map(|(rule, _)| rule).collect();
        for &rule in &matching {
            self.matched[rule].push(self.decisions.len());
        }
        self.decisions.push(decision);
        self.lost.push(false);
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

    /// Adds rules to percepts whose decision is not kept, one by one: first those of a chosen action, the fittest first.
    fn complete(&mut self, kept: &mut [bool]) {
        while let Some(at) = (0..self.decisions.len()).find(|&at| !self.keeps_decision(at, kept)) {
            let missing = self.matching[at]
                .iter()
                .copied()
                .filter(|&rule| !kept[rule]);
            let next = missing.max_by(|&a, &b| {
                let [a, b] = [a, b].map(|rule| &self.rules[rule]);
                let by_choice = self.chooses(at, a.action).cmp(&self.chooses(at, b.action));
                by_choice.then(a.fitness.total_cmp(&b.fitness))
            });
            // With all rules that match, a decision of the population is kept but for rounding.
            match next {
                Some(next) => kept[next] = true,
                None => self.lost[at] = true,
            }
        }
    }

    /// Adds one more rule wherever at least two others become redundant by it.
    fn exchange(&self, kept: &mut Vec<bool>) {
        let mut candidates: Vec<usize> = (0..self.rules.len())
            .filter(|&rule| self.is_right(rule))
            .collect();
        candidates.sort_by_key(|&rule| Reverse(self.matched[rule].len()));
        for rule in candidates {
            let among = self.matched[rule].iter().flat_map(|&at| &self.matching[at]);
            let overlapping: BTreeSet<usize> =
                among.copied().filter(|&other| kept[other]).collect();
            if kept[rule] || overlapping.len() < 2 {
                continue;
            }
            let mut tried = kept.clone();
            tried[rule] = true;
            if self.drop_redundant(&mut tried, overlapping) > 1 {
                *kept = tried;
            }
        }
    }

    /// Drops every one of `rules` without which no decision changes: the one that matches the fewest percepts first,
    /// then the least fit. Returns their number.
    fn drop_redundant(&self, kept: &mut [bool], rules: impl IntoIterator<Item = usize>) -> usize {
        let mut order: Vec<usize> = rules.into_iter().filter(|&rule| kept[rule]).collect();
        order.sort_by(|&a, &b| {
            let by_percepts = self.matched[a].len().cmp(&self.matched[b].len());
            by_percepts.then(self.rules[a].fitness.total_cmp(&self.rules[b].fitness))
        });
        let mut dropped = 0;
        for rule in order {
            kept[rule] = false;
            kept[rule] = !self.matched[rule]
                .iter()
                .all(|&at| self.keeps_decision(at, kept));
            dropped += usize::from(!kept[rule]);
        }
        dropped
    }

    /// Returns true if the action of a rule is one of the chosen ones in each percept that the rule matches.
    fn is_right(&self, rule: usize) -> bool {
        let action = self.rules[rule].action;
        self.matched[rule]
            .iter()
            .all(|&at| self.chooses(at, action))
    }

    fn chooses(&self, at: usize, action: Action) -> bool {
        self.decisions[at].contains(&action)
    }

    /// Returns true if the kept rules choose only actions of the decision in a percept. Where no rules do, they must be
    /// all rules that match.
    fn keeps_decision(&self, at: usize, kept: &[bool]) -> bool {
        let mut sums = PredictionSums::default();
        let rules = self.matching[at].iter().filter(|&&rule| kept[rule]);
        rules.for_each(|&rule| sums.add(&self.rules[rule]));
        let chosen = sums.best(self.actions, false);
        let is_kept = !chosen.is_empty() && chosen.iter().all(|&action| self.chooses(at, action));
        let has_all = || self.matching[at].iter().all(|&rule| kept[rule]);
        is_kept || self.lost[at] && has_all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;
    use crate::signal::Percept;

    /// Returns a rule that matches the percepts whose bit `at` of `width` bits is set.
    fn rule(at: usize, width: usize, fitness: f64) -> Classifier {
        let condition: String = (0..width)
            .map(|bit| if bit == at { '1' } else { '#' })
            .collect();
        let action = Action::new(0).unwrap();
        let rule = Classifier::new(condition.parse().unwrap(), action, 0, &Params::default());
        Classifier {
            prediction: 1000.0,
            fitness,
            ..rule
        }
    }

    /// The first rule covers the most percepts, so that it is chosen first, and the second is fitter than the fourth.
    /// With the first two rules, four rules are needed; with the fourth in place of them, three are enough.
    #[test]
    fn one_rule_replaces_two_where_no_decision_changes() {
        let matched: [&[usize]; 5] = [
            &[1, 2, 3, 4, 5],
            &[4, 6, 7],
            &[1, 2, 8],
            &[4, 5, 6, 7],
            &[3, 9, 10],
        ];
        let fitness = [1.0, 0.9, 0.8, 0.1, 0.8];
        let rules: Vec<Classifier> = (0..5).map(|at| rule(at, 5, fitness[at])).collect();
        let population = Population::try_from(rules).unwrap();
        let percept =
            |number: usize| Percept::from_bits(matched.map(|set| set.contains(&number))).unwrap();
        let percepts: Vec<Percept> = (1..=10).map(percept).collect();

        let fewest = fewest_rules(&population, &percepts, 1);
        let kept: Vec<String> = fewest
            .rules()
            .iter()
            .map(|rule| rule.condition.to_string())
            .collect();
        assert_eq!(kept, ["##1##", "###1#", "####1"]);

        let decision = vec![Action::new(0).unwrap()];
        let decisions = percepts.iter().map(|percept| (percept, decision.clone()));
        let mut task = Task::new(&population, decisions, 1);
        let mut kept = task.cover();
        task.complete(&mut kept);
        task.drop_redundant(&mut kept, 0..5);
        assert_eq!(
            kept,
            [true, true, true, false, true],
            "control: without exchanges"
        );
    }
}
