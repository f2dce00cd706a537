//! Tests of compaction.

use proptest::prelude::*;

use super::*;
use crate::Params;

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
    let values = population.sums(percept).array(3, false);
    values.best_actions().map(Action::index).collect()
}

/// Compacts a population for some percepts.
fn compacted(population: &Population, percepts: &[Percept]) -> Population {
    let values = |p: &Percept| population.sums(p).array(3, false);
    compact(population, &Layout::default(), percepts, values)
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
    let compacted = compacted(&population(&table), &all_percepts(4));
    let shown = compacted.rules().iter();
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
fn without_known_percepts_there_are_no_rules() {
    assert!(compacted(&Population::default(), &all_percepts(3)).is_empty());
    let rules = population(&[("111".into(), 0, 1.0)]);
    assert!(compacted(&rules, &["000".parse().unwrap()]).is_empty());
}

#[test]
fn a_rule_has_the_experience_of_the_most_experienced_rule_that_it_replaces() {
    // The answer is the first bit; the last rule gives another one.
    let rules = [
        ("00", 0, 5),
        ("01", 0, 3),
        ("10", 1, 7),
        ("11", 1, 9),
        ("11", 0, 50),
    ];
    let rules = rules.map(|(condition, action, experience)| {
        let answer = usize::from(condition.starts_with('1'));
        Classifier {
            experience,
            ..rule(
                condition,
                action,
                if action == answer { 1000.0 } else { 0.0 },
            )
        }
    });
    let full = Population::try_from(rules.to_vec()).unwrap();
    let compacted = compacted(&full, &all_percepts(2));
    let shown = compacted.rules().iter();
    let mut shown: Vec<_> = shown
        .map(|r| (r.condition.to_string(), r.experience))
        .collect();
    shown.sort();
    assert_eq!(shown, [("0#".into(), 5), ("1#".into(), 9)]);
}

proptest! {
    #[test]
    fn compacted_rules_choose_what_all_rules_choose_in_every_percept(
        rules in prop::collection::vec(("[01#]{5}", 0_usize..3, -1_i32..2), 0..40),
    ) {
        // Few distinct predictions, so that ties occur.
        let rules: Vec<_> =
            rules.into_iter().map(|(c, a, p)| (c, a, f64::from(p))).collect();
        let full = population(&rules);
        let known = all_percepts(5).iter().filter(|p| !best(&full, p).is_empty()).count();
        let compacted = compacted(&full, &all_percepts(5));
        prop_assert!(compacted.len() <= known, "{} for {known}", compacted.len());
        for percept in all_percepts(5) {
            let (wanted, chosen) = (best(&full, &percept), best(&compacted, &percept));
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
