//! The fewest interval rules that keep the right decisions of a table.

use fixedbitset::FixedBitSet;

use crate::classifier::Classifier;
use crate::fewest::fewest_for;
use crate::intervals::{Intervals, RealPercept};
use crate::params::Params;
use crate::population::Population;
use crate::representation::Representation;
use crate::signal::Action;

/// Returns few rules that choose the right action in each row of a table. A row is a percept with its right action, which
/// was rewarded by `reward`; every other action was rewarded by 0. Rows with equal percepts must have the same action.
///
/// Uses the rules of `population` that predict more than half of the reward and match no row of another action. Each
/// keeps only the bounds that exclude such rows, chosen as in guided covering (CN2, Clark and Niblett 1989). A row that
/// no such rule matches gets one made from its own values in the same way. Of these rules, it keeps the fewest, as
/// [`fewest_rules`](crate::fewest_rules) does. A rule that matches n rows has the prediction `reward (n + 1) / (n + 2)`, and n
/// is its experience and its fitness.
pub fn compacted(
    population: &Population<Intervals>,
    rows: &[(RealPercept, Action)],
    actions: usize,
    reward: f64,
) -> Population<Intervals> {
    let mut general = Population::default();
    for action in Action::wide_all(actions) {
        let table = Table::new(rows, action);
        let rules = population.rules().iter();
        let advising = rules.filter(|rule| rule.action == action && rule.prediction > reward / 2.0);
        let mut conditions: Vec<Intervals> = advising
            .filter_map(|rule| table.general(&rule.condition))
            .collect();
        for &row in &table.own {
            if !conditions.iter().any(|condition| condition.matches(row)) {
                conditions.extend(table.general(&only(row)));
            }
        }
        for condition in conditions {
            let matched = table.own.iter().filter(|row| condition.matches(row));
            let count = matched.count() as u32;
            if count > 0 {
                general.insert(measured(condition, action, count, reward));
            }
        }
    }
    let decisions = rows.iter().map(|row| (&row.0, vec![row.1]));
    fewest_for(&general, decisions, actions)
}

/// Returns the condition that matches only percepts equal to this one.
fn only(percept: &RealPercept) -> Intervals {
    let bounds: Vec<[f64; 2]> = percept.values().iter().map(|&value| [value; 2]).collect();
    Intervals::new(&bounds).expect("values of a percept are from 0 to 1")
}

/// Returns a rule that matches so many rows, all of them of its action.
fn measured(
    condition: Intervals,
    action: Action,
    count: u32,
    reward: f64,
) -> Classifier<Intervals> {
    let rows = f64::from(count);
    let prediction = reward * (rows + 1.0) / (rows + 2.0);
    Classifier {
        prediction,
        error: reward - prediction,
        fitness: rows,
        experience: count,
        ..Classifier::new(condition, action, 0, &Params::default())
    }
}

/// The rows of one action, and all others.
struct Table<'a> {
    own: Vec<&'a RealPercept>,
    others: Vec<&'a RealPercept>,
}

/// One bound of a condition, and the rows within it.
struct Test {
    attribute: usize,
    /// 0 for the lower bound, 1 for the upper one.
    side: usize,
    own: FixedBitSet,
    others: FixedBitSet,
}

impl<'a> Table<'a> {
    fn new(rows: &'a [(RealPercept, Action)], action: Action) -> Self {
        let percepts = |own: bool| {
            let some = rows.iter().filter(|row| (row.1 == action) == own);
            some.map(|row| &row.0).collect()
        };
        Self {
            own: percepts(true),
            others: percepts(false),
        }
    }

    /// Returns the condition with few of its bounds, which matches no other rows. `None` if it matches some.
    fn general(&self, condition: &Intervals) -> Option<Intervals> {
        if self.others.iter().any(|row| condition.matches(row)) {
            return None;
        }
        let tests = self.tests(condition);
        let mut chosen = self.sufficient(&tests);
        for test in chosen.clone() {
            let fewer: Vec<usize> = chosen.iter().copied().filter(|&at| at != test).collect();
            if self.left(&tests, &fewer).1.is_clear() {
                chosen = fewer;
            }
        }
        let mut bounds = vec![[0.0, 1.0]; condition.bounds().len()];
        for &at in &chosen {
            let Test {
                attribute, side, ..
            } = tests[at];
            bounds[attribute][side] = condition.bounds()[attribute][side];
        }
        Some(Intervals::new(&bounds).expect("bounds of a condition, or 0 and 1"))
    }

    /// Returns the bounds of a condition that exclude something.
    fn tests(&self, condition: &Intervals) -> Vec<Test> {
        let mut tests = Vec::new();
        for (attribute, bounds) in condition.bounds().iter().enumerate() {
            for (side, end) in [0.0, 1.0].into_iter().enumerate() {
                let bound = bounds[side];
                let passes = |percept: &RealPercept| match side {
                    0 => percept.values()[attribute] >= bound,
                    _ => percept.values()[attribute] <= bound,
                };
                let passing = |rows: &[&RealPercept]| {
                    let numbers = (0..rows.len()).filter(|&row| passes(rows[row]));
                    let mut set = FixedBitSet::with_capacity(rows.len());
                    set.extend(numbers);
                    set
                };
                if bound != end {
                    let (own, others) = (passing(&self.own), passing(&self.others));
                    tests.push(Test {
                        attribute,
                        side,
                        own,
                        others,
                    });
                }
            }
        }
        tests
    }

    /// Chooses tests until no other rows pass all of them. Each step takes the test that leaves the highest share of own
    /// rows, (own + 1) / (all + 2).
    fn sufficient(&self, tests: &[Test]) -> Vec<usize> {
        let mut chosen = Vec::new();
        loop {
            let (own, others) = self.left(tests, &chosen);
            let bad = others.count_ones(..);
            let mut best: Option<(usize, [u64; 2])> = None;
            for (at, test) in tests.iter().enumerate() {
                let good = test.own.intersection_count(&own) as u64;
                let wrong = test.others.intersection_count(&others);
                let share = [good + 1, good + wrong as u64 + 2];
                let is_better = |&(_, [a, b]): &(_, [u64; 2])| share[0] * b > a * share[1];
                if wrong < bad && best.as_ref().is_none_or(is_better) {
                    best = Some((at, share));
                }
            }
            // Some test excludes each of the other rows.
            let Some((best, _)) = best else {
                return chosen;
            };
            chosen.push(best);
        }
    }

    /// Returns the own rows and the others that pass the chosen tests.
    fn left(&self, tests: &[Test], chosen: &[usize]) -> (FixedBitSet, FixedBitSet) {
        let all = |count: usize| {
            let mut set = FixedBitSet::with_capacity(count);
            set.insert_range(..);
            set
        };
        let (mut own, mut others) = (all(self.own.len()), all(self.others.len()));
        for &at in chosen {
            own.intersect_with(&tests[at].own);
            others.intersect_with(&tests[at].others);
        }
        (own, others)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rule(bounds: [[f64; 2]; 2], action: usize, prediction: f64) -> Classifier<Intervals> {
        let (condition, action) = (
            Intervals::new(&bounds).unwrap(),
            Action::wide(action).unwrap(),
        );
        Classifier {
            prediction,
            experience: 5,
            ..Classifier::new(condition, action, 0, &Params::default())
        }
    }

    /// Returns rows of two attributes. Action 9 is right where the first is at least 0.5, and action 0 elsewhere.
    fn table() -> Vec<(RealPercept, Action)> {
        let values = [0.1, 0.3, 0.4, 0.6, 0.8, 0.9];
        let rows = values
            .iter()
            .flat_map(|&x| values.iter().map(move |&y| [x, y]));
        let action = |x: f64| Action::wide(if x >= 0.5 { 9 } else { 0 }).unwrap();
        rows.map(|[x, y]| (RealPercept::new(&[x, y]).unwrap(), action(x)))
            .collect()
    }

    #[test]
    fn few_rules_with_few_bounds_decide_as_all_did() {
        let rules = vec![
            rule([[0.5, 0.95], [0.0, 0.7]], 9, 1000.0),
            rule([[0.55, 1.0], [0.35, 1.0]], 9, 1000.0),
            rule([[0.05, 0.45], [0.0, 1.0]], 0, 1000.0),
            // Says that action 9 is wrong, and advises against action 0.
            rule([[0.0, 0.45], [0.0, 0.5]], 9, 0.0),
            rule([[0.55, 1.0], [0.0, 1.0]], 0, 0.0),
        ];
        let population = Population::try_from(rules).unwrap();
        let few = compacted(&population, &table(), 10, 1000.0);
        let shown: Vec<String> = few
            .rules()
            .iter()
            .map(|one| format!("{} {}", one.condition, one.action.index()))
            .collect();
        assert_eq!(shown, ["[0.00, 0.45] # 0", "[0.55, 1.00] # 9"]);
        assert!(
            few.rules()
                .iter()
                .all(|one| one.experience == 18 && one.prediction == 950.0)
        );
        for (percept, action) in table() {
            assert_eq!(few.sums(&percept).best(10, false), [action]);
        }
    }

    #[test]
    fn rows_that_only_a_wrong_rule_or_none_matches_get_a_rule_from_their_own_values() {
        let rules = vec![
            rule([[0.2, 1.0], [0.0, 1.0]], 9, 700.0),
            rule([[0.0, 0.35], [0.0, 1.0]], 0, 1000.0),
        ];
        let population = Population::try_from(rules).unwrap();
        let few = compacted(&population, &table(), 10, 1000.0);
        let shown: Vec<String> = few
            .rules()
            .iter()
            .map(|one| {
                format!(
                    "{} {} {}",
                    one.condition,
                    one.action.index(),
                    one.experience
                )
            })
            .collect();
        assert_eq!(shown, ["[0.00, 0.40] # 0 18", "[0.60, 1.00] # 9 18"]);
        for (percept, action) in table() {
            let before = population.sums(&percept).best(10, false);
            assert_eq!(before == [action], percept.values()[0] != 0.4, "control");
            assert_eq!(few.sums(&percept).best(10, false), [action]);
        }
    }
}
