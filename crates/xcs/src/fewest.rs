//! The fewest rules that keep all decisions.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use crate::action::{Action, ByAction, MAX_ACTIONS};
use crate::classifier::Classifier;
use crate::condition::Condition;
use crate::labelled_examples::{LabelledExample, LabelledExamples};
use crate::layout::Layout;
use crate::percept::Percept;
use crate::population::Population;
use crate::prediction::PredictionSums;
use crate::random::Stream;
use crate::representation::Representation;

/// Returns rules that choose, in each percept, only actions that all rules of `population` together rate best there.
///
/// Candidates are the rules of `population`, and rules with the most general conditions that guided covering finds for
/// the percepts: those match no percept in which their action is not one of the best, and none without a decision. A rule
/// with a general condition has the statistics of the fittest rule from which it was made.
///
/// Chooses candidates that are right wherever they match, the one that covers the most percepts first. Then drops every
/// rule without which no decision changes, least general first, and exchanges two rules or more for one where this changes
/// no decision. In small tasks, drops some rules at random and chooses anew, as long as the set does not grow (iterated
/// greedy). The result depends on the order of the percepts.
pub fn fewest_rules(
    population: &Population,
    percepts: &[Percept],
    actions: usize,
    layout: &Layout,
    over_match_set: bool,
) -> Population {
    let actions = actions.min(MAX_ACTIONS);
    let decisions = percepts.iter().map(|percept| {
        let sums = population.sums(percept);
        (percept, sums.best(actions, over_match_set))
    });
    let decisions: Vec<(&Percept, Vec<Action>)> = decisions.collect();
    let general = general_rules(population, &decisions, layout);
    let rules = population.rules().iter().chain(&general).collect();
    Task::new(rules, decisions, actions, over_match_set).fewest()
}

/// Returns rules of `population` that choose, in each percept, only actions of its decision. A percept whose decision its
/// rules together do not make keeps all of them.
///
/// Chooses, drops and exchanges as [`fewest_rules`] does, but creates no rules. Percepts without a rule that is right
/// wherever it matches get rules of a chosen action, the fittest first, or else all rules that match.
pub fn fewest_rules_for<'a, C: Representation + 'a>(
    population: &Population<C>,
    decisions: impl IntoIterator<Item = (&'a C::Percept, Vec<Action>)>,
    actions: usize,
    over_match_set: bool,
) -> Population<C> {
    let rules = population.rules().iter().collect();
    Task::new(rules, decisions, actions, over_match_set).fewest()
}

/// The greatest number of percepts for which rules are exchanged. In larger tasks it takes long, and saves one rule in 40.
const MOST_EXCHANGED: usize = 512;
/// The share of the chosen rules that are dropped at random, before others are chosen in their place.
const DROPPED: f64 = 0.4;
/// The maximum number of times that this is done, and the same times the number of rules and of percepts.
const MOST_ROUNDS: usize = 50;
const WORK: usize = 5_000_000;

/// The only consumer of random numbers.
enum Draws {
    Dropped,
}

impl From<Draws> for u64 {
    fn from(who: Draws) -> Self {
        who as Self
    }
}

/// The number of searches for a general condition in each round, times the number of percepts.
const SEARCHES: usize = 4096;
/// The greatest number of percepts for which conditions are also grown.
const MOST_GROWN: usize = 128;
/// The least number of percepts in a round for which a general condition is searched.
const FEWEST_SEARCHES: usize = 1;

/// Returns rules with general conditions that make these decisions. Each round searches a condition for some percepts
/// that are not covered yet, and covers those of the rule that matches the most.
fn general_rules(
    population: &Population,
    decisions: &[(&Percept, Vec<Action>)],
    layout: &Layout,
) -> Vec<Classifier> {
    let examples = examples(decisions, layout);
    let decided = decisions.iter().map(|(_, decision)| !decision.is_empty());
    let mut open: Vec<bool> = decided.collect();
    let searches = (SEARCHES / decisions.len().max(1)).max(FEWEST_SEARCHES);
    let mut seen = BTreeSet::new();
    let mut all = Vec::new();
    loop {
        let left: Vec<usize> = (0..open.len()).filter(|&at| open[at]).collect();
        let seeds = left.iter().step_by(left.len().div_ceil(searches).max(1));
        let pairs = seeds.flat_map(|&at| decisions[at].1.iter().map(move |&action| (at, action)));
        let mut best: Option<Vec<usize>> = None;
        for (at, action) in pairs {
            let wanted = left.iter().filter(|&&at| decisions[at].1.contains(&action));
            let wanted = wanted.copied().collect();
            let narrowed = examples.condition_matching(at, action, &wanted);
            let grown = (decisions.len() <= MOST_GROWN)
                .then(|| examples.grown_condition(at, action, &wanted))
                .flatten();
            for condition in narrowed.into_iter().chain(grown) {
                let matches = |&at: &usize| condition.matches(decisions[at].0);
                let covered: Vec<usize> = left.iter().copied().filter(matches).collect();
                if seen.insert((condition, action)) && !population.contains(&condition, action) {
                    all.extend(general_rule(population, decisions[at].0, condition, action));
                }
                if best.as_ref().is_none_or(|best| covered.len() > best.len()) {
                    best = Some(covered);
                }
            }
        }
        let Some(covered) = best else {
            return all;
        };
        covered.into_iter().for_each(|at| open[at] = false);
    }
}

/// Returns the percepts with the actions of their decisions as labels.
fn examples(decisions: &[(&Percept, Vec<Action>)], layout: &Layout) -> LabelledExamples {
    let mut examples = LabelledExamples::new(layout.clone());
    for (number, (percept, decision)) in decisions.iter().enumerate() {
        let mut best = ByAction::default();
        decision
            .iter()
            .for_each(|action| best[action.index()] = true);
        let percept = **percept;
        examples.give(number, LabelledExample { percept, best });
    }
    examples
}

/// Returns a rule with a condition and the statistics of the fittest rule for a percept and an action.
fn general_rule(
    population: &Population,
    percept: &Percept,
    condition: Condition,
    action: Action,
) -> Option<Classifier> {
    let mut fittest: Option<Classifier> = None;
    population.for_each_match(percept, |_, rule| {
        let is_fitter = fittest.is_none_or(|fittest| rule.fitness > fittest.fitness);
        if rule.action == action && is_fitter {
            fittest = Some(*rule);
        }
    });
    Some(Classifier {
        condition,
        numerosity: 1,
        ..fittest?
    })
}

/// The decisions to keep.
struct Task<'a, C: Representation> {
    rules: Vec<&'a Classifier<C>>,
    actions: usize,
    over_match_set: bool,
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
    /// Lists which rules match which percepts. Percepts without a decision are ignored.
    fn new<'b>(
        rules: Vec<&'a Classifier<C>>,
        decisions: impl IntoIterator<Item = (&'b C::Percept, Vec<Action>)>,
        actions: usize,
        over_match_set: bool,
    ) -> Self
    where
        C: 'b,
    {
        let mut task = Self {
            matched: vec![Vec::new(); rules.len()],
            rules,
            actions,
            over_match_set,
            decisions: Vec::new(),
            lost: Vec::new(),
            matching: Vec::new(),
        };
        for (percept, decision) in decisions {
            if !decision.is_empty() {
                task.add(percept, decision);
            }
        }
        task
    }

    /// Returns the fewest rules that were found.
    fn fewest(mut self) -> Population<C> {
        let right: Vec<usize> = (0..self.rules.len())
            .filter(|&rule| self.is_right(rule))
            .collect();
        let mut best = vec![false; self.rules.len()];
        self.choose(&right, &mut best);
        let mut stream = Stream::new(0, Draws::Dropped);
        let size = self.rules.len() * self.decisions.len();
        for _ in 0..(WORK / size.max(1)).min(MOST_ROUNDS) {
            let mut kept = best.clone();
            let chosen = kept.iter_mut().filter(|kept| **kept);
            chosen.for_each(|kept| *kept = !stream.chance(DROPPED));
            self.choose(&right, &mut kept);
            let count = |kept: &[bool]| kept.iter().filter(|&&kept| kept).count();
            if count(&kept) <= count(&best) {
                best = kept;
            }
        }
        let rules = self.rules.iter().zip(best);
        let rules = rules.filter(|(_, kept)| *kept);
        let rules: Vec<Classifier<C>> = rules.map(|(&rule, _)| rule.clone()).collect();
        rules
            .try_into()
            .expect("rules of a population or made of them, none of them twice")
    }

    /// Adds rules to the kept ones until all decisions are kept, then drops and exchanges those that are not needed.
    fn choose(&mut self, right: &[usize], kept: &mut Vec<bool>) {
        self.cover(right, kept);
        self.complete(kept);
        self.drop_redundant(kept, 0..self.rules.len());
        if self.decisions.len() <= MOST_EXCHANGED {
            self.exchange(right, kept);
        }
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

    /// Keeps rules that are right wherever they match, the one that covers the most percepts first.
    fn cover(&self, right: &[usize], kept: &mut [bool]) {
        let all = 0..self.decisions.len();
        let mut open: Vec<bool> = all.map(|at| !self.keeps_decision(at, kept)).collect();
        loop {
            let gain = |rule: usize| self.matched[rule].iter().filter(|&&at| open[at]).count();
            let gains = right.iter().map(|&rule| (gain(rule), rule));
            let best = gains.max_by(|a, b| {
                let fitness = |rule: usize| self.rules[rule].fitness;
                a.0.cmp(&b.0).then(fitness(a.1).total_cmp(&fitness(b.1)))
            });
            let Some((1.., best)) = best else {
                return;
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
                let [a, b] = [a, b].map(|rule| self.rules[rule]);
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
    fn exchange(&self, right: &[usize], kept: &mut Vec<bool>) {
        let mut candidates = right.to_vec();
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
        rules.for_each(|&rule| sums.add(self.rules[rule]));
        let chosen = sums.best(self.actions, self.over_match_set);
        let is_kept = !chosen.is_empty() && chosen.iter().all(|&action| self.chooses(at, action));
        let has_all = || self.matching[at].iter().all(|&rule| kept[rule]);
        is_kept || self.lost[at] && has_all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;
    use crate::percept::Percept;

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

        let decision = vec![Action::new(0).unwrap()];
        let decisions = || percepts.iter().map(|percept| (percept, decision.clone()));
        let fewest = fewest_rules_for(&population, decisions(), 1, false);
        let kept: Vec<String> = fewest
            .rules()
            .iter()
            .map(|rule| rule.condition.to_string())
            .collect();
        assert_eq!(kept, ["##1##", "###1#", "####1"]);

        let rules = population.rules().iter().collect();
        let mut task = Task::new(rules, decisions(), 1, false);
        let mut kept = vec![false; 5];
        task.cover(&[0, 1, 2, 3, 4], &mut kept);
        task.complete(&mut kept);
        task.drop_redundant(&mut kept, 0..5);
        assert_eq!(
            kept,
            [true, true, true, false, true],
            "control: without exchanges"
        );
    }

    /// Returns rules that match one percept each, of action 0 where the first of three bits is set, and of action 1
    /// elsewhere.
    fn specific() -> (Population, Vec<Percept>) {
        let percepts: Vec<Percept> = (0..8).map(|word| Percept::from_word(word, 3)).collect();
        let rule = |percept: &Percept| Classifier {
            condition: Condition::exactly(percept),
            action: Action::new(usize::from(!percept.bit(0))).unwrap(),
            ..rule(0, 3, 1.0)
        };
        let rules: Vec<Classifier> = percepts.iter().map(rule).collect();
        (rules.try_into().unwrap(), percepts)
    }

    fn conditions(population: &Population) -> Vec<String> {
        let rules = population.rules().iter();
        let mut all: Vec<String> = rules.map(|rule| rule.condition.to_string()).collect();
        all.sort();
        all
    }

    #[test]
    fn conditions_become_as_general_as_no_decision_changes() {
        let (population, percepts) = specific();
        let layout = Layout::default();
        let few = fewest_rules(&population, &percepts, 2, &layout, false);
        assert_eq!(conditions(&few), ["0##", "1##"]);
        let decisions = percepts.iter().map(|percept| {
            let action = Action::new(usize::from(!percept.bit(0))).unwrap();
            (percept, vec![action])
        });
        let control = fewest_rules_for(&population, decisions, 2, false);
        assert_eq!(control.len(), 8, "without general conditions");
    }

    #[test]
    fn a_percept_without_a_decision_stays_without_one() {
        let (population, percepts) = specific();
        let mut rules = population.rules().to_vec();
        rules.retain(|rule| !rule.condition.matches(&percepts[0]));
        let population = Population::try_from(rules).unwrap();
        let few = fewest_rules(&population, &percepts, 2, &Layout::default(), false);
        let decided = |at: usize| !few.sums(&percepts[at]).best(2, false).is_empty();
        assert_eq!((0..8).map(decided).filter(|&decided| decided).count(), 7);
        assert!(!decided(0));
    }

    /// One rule of action 0 is better than two of action 1 by its own fitness. Divided by the fitness of all rules, the two
    /// together are better.
    #[test]
    fn decisions_are_those_of_the_reading_of_the_action_value() {
        let percept: Percept = "1".parse().unwrap();
        let rule = |condition: &str, action: usize, prediction: f64, fitness: f64| Classifier {
            condition: condition.parse().unwrap(),
            action: Action::new(action).unwrap(),
            prediction,
            ..rule(0, 1, fitness)
        };
        let rules = vec![
            rule("1", 0, 1000.0, 0.1),
            rule("1", 1, 900.0, 0.2),
            rule("#", 1, 900.0, 0.2),
        ];
        let population = Population::try_from(rules).unwrap();
        for over_match_set in [false, true] {
            let few = fewest_rules(
                &population,
                &[percept],
                2,
                &Layout::default(),
                over_match_set,
            );
            let best = |rules: &Population| rules.sums(&percept).best(2, over_match_set);
            assert_eq!(best(&few), best(&population), "{over_match_set}");
            let other = population.sums(&percept).best(2, !over_match_set);
            assert_ne!(best(&few), other, "control");
        }
    }
}
