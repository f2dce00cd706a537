//! The population \[P\].

use std::collections::HashMap;

use foldhash::fast::FixedState;
use serde::{Deserialize, Serialize};

use super::classifier::Classifier;
use super::condition::Condition;
use super::deletion::DeletionVotes;
use super::handles::{ClassifierId, Handles};
use super::match_index::MatchIndex;
use super::params::{GREATEST_POPULATION, Params};
use super::prediction::PredictionSums;
use crate::random::Stream;
use crate::signal::{Action, Percept};

/// More steps than any run can reach; counters up to here leave room for arithmetic.
pub(super) const MOST_STEPS: u64 = 1 << 40;
/// Figures of rules from files lie below this, so that no sum or product of two is infinite.
const GREATEST_FIGURE: f64 = 1e100;

/// \[P\]: all rules, each with an id that outlives it.
///
/// Rules lie densely in a vector; a removed rule's place is taken by the last one. The order is
/// part of the state, because roulettes walk along it: a restored population goes on exactly as
/// the saved one would have.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(into = "Vec<Classifier>", try_from = "Vec<Classifier>")]
pub struct Population {
    rules: Vec<Classifier>,
    handles: Handles,
    index: MatchIndex,
    votes: DeletionVotes,
    /// The rule of a condition and action. Never iterated over.
    twins: HashMap<(Condition, Action), ClassifierId, FixedState>,
    micro: u32,
}

impl Population {
    /// The number of macro-classifiers.
    pub fn len(&self) -> usize {
        self.rules.len()
    }

    /// Is there no rule at all?
    pub fn is_empty(&self) -> bool {
        self.rules.is_empty()
    }

    /// The sum of all numerosities.
    pub fn micro(&self) -> u32 {
        self.micro
    }

    /// All rules, in the order of the population.
    pub fn rules(&self) -> &[Classifier] {
        &self.rules
    }

    /// The rule that an id names; `None` once it was deleted.
    pub fn get(&self, id: ClassifierId) -> Option<&Classifier> {
        self.handles.position(id).map(|at| &self.rules[at])
    }

    /// Where a rule lies in [`Self::rules`]; `None` once it was deleted.
    pub(super) fn position(&self, id: ClassifierId) -> Option<usize> {
        self.handles.position(id)
    }

    /// The id of the rule at a position in [`Self::rules`].
    pub(super) fn id_at(&self, position: usize) -> ClassifierId {
        self.handles.id_at(position)
    }

    /// Those of some rules that have not been deleted.
    pub(super) fn living<'a>(
        &'a self,
        ids: &'a [ClassifierId],
    ) -> impl Iterator<Item = (ClassifierId, &'a Classifier)> + Clone {
        ids.iter().filter_map(|&id| Some((id, self.get(id)?)))
    }

    /// A rule to be changed in anything but its condition, action and numerosity. If that moves
    /// its deletion vote, [`Self::modify`] must be called on it afterwards.
    pub(super) fn get_mut(&mut self, id: ClassifierId) -> Option<&mut Classifier> {
        self.handles.position(id).map(|at| &mut self.rules[at])
    }

    /// Changes a rule; does nothing once it was deleted. Condition and action must stay.
    pub(super) fn modify(&mut self, id: ClassifierId, change: impl FnOnce(&mut Classifier)) {
        let Some(at) = self.handles.position(id) else {
            return;
        };
        let rule = &mut self.rules[at];
        self.micro -= rule.numerosity;
        change(rule);
        self.micro += rule.numerosity;
        self.votes.touch(at);
    }

    /// Adds a rule, or its numerosity to the rule that has the same condition and action.
    pub(super) fn insert(&mut self, rule: Classifier) -> ClassifierId {
        let key = (rule.condition, rule.action);
        if let Some(&twin) = self.twins.get(&key) {
            self.modify(twin, |twin| twin.numerosity += rule.numerosity);
            return twin;
        }
        self.micro += rule.numerosity;
        self.index.push(&rule.condition);
        self.votes.touch(self.rules.len());
        self.rules.push(rule);
        let id = self.handles.push();
        self.twins.insert(key, id);
        id
    }

    /// Removes a rule with all its numerosity and returns it.
    pub(super) fn remove(&mut self, id: ClassifierId) -> Option<Classifier> {
        let at = self.handles.position(id)?;
        self.handles.swap_remove(at);
        self.index.swap_remove(at);
        let rule = self.rules.swap_remove(at);
        self.twins.remove(&(rule.condition, rule.action));
        self.micro -= rule.numerosity;
        self.votes.touch(at);
        self.votes.touch(self.rules.len());
        Some(rule)
    }

    /// Deletes micro-classifiers by roulette over their deletion votes until at most N are left.
    pub(super) fn delete_surplus(&mut self, params: &Params, stream: &mut Stream) {
        while self.micro > params.population_size {
            let ball = stream.unit();
            let at = self.votes.roulette(&self.rules, self.micro, params, ball);
            let id = self.handles.id_at(at);
            if self.rules[at].numerosity > 1 {
                self.modify(id, |rule| rule.numerosity -= 1);
            } else {
                self.remove(id);
            }
        }
    }

    /// What the worth of each action under a percept comes from: the rules that match it.
    pub fn sums(&self, percept: &Percept) -> PredictionSums {
        let mut sums = PredictionSums::default();
        self.for_each_match(percept, |_, rule| sums.add(rule));
        sums
    }

    /// The same rules, whose records begin anew.
    pub fn without_records(&self) -> Self {
        let mut fresh = self.clone();
        for at in 0..fresh.len() {
            fresh.modify(fresh.id_at(at), |rule| {
                (rule.experience, rule.fitness) = (0, 1.0);
            });
        }
        fresh
    }

    /// Notes in the rules of \[A\] that they acted once more, and whether that was right. Experience counts
    /// the steps; fitness is the share that was right, with one right step to begin with, as the accuracy of
    /// UCS (Bernadó-Mansilla and Garrell, 2003). Tells whether there are any.
    pub fn record(&mut self, percept: &Percept, action: Action, right: bool) -> bool {
        let mut acted = Vec::new();
        self.for_each_match(percept, |id, rule| {
            if rule.action == action {
                acted.push(id);
            }
        });
        for &id in &acted {
            self.modify(id, |rule| {
                rule.experience = rule.experience.saturating_add(1);
                let steps = f64::from(rule.experience) + 1.0;
                rule.fitness += (f64::from(u8::from(right)) - rule.fitness) / steps;
            });
        }
        !acted.is_empty()
    }

    /// The same rules, all with the time stamp `time` and the effect of mapping `eam`.
    pub(super) fn stamped(&self, time: u64, eam: f32) -> Self {
        let mut stamped = Self::default();
        for rule in &self.rules {
            stamped.insert(Classifier {
                time_stamp: time,
                eam,
                ..*rule
            });
        }
        stamped
    }

    /// The same rules, each with its eam; `None` unless there is one for each.
    pub(super) fn with_eams(mut self, eams: &[f32]) -> Option<Self> {
        for (at, (rule, &eam)) in self.rules.iter_mut().zip(eams).enumerate() {
            rule.eam = eam;
            self.votes.touch(at);
        }
        (self.rules.len() == eams.len()).then_some(self)
    }

    /// Calls `found` with each rule that matches, in the order of the population.
    pub fn for_each_match(
        &self,
        percept: &Percept,
        mut found: impl FnMut(ClassifierId, &Classifier),
    ) {
        self.index
            .for_each_match(percept, |at| found(self.handles.id_at(at), &self.rules[at]));
    }
}

impl PartialEq for Population {
    fn eq(&self, other: &Self) -> bool {
        self.rules == other.rules
    }
}

impl From<Population> for Vec<Classifier> {
    fn from(population: Population) -> Self {
        population.rules
    }
}

/// Rules that cannot form a population.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("rule {number} ({condition}) {fault}")]
pub struct PopulationError {
    /// The rule's place in the list, from 1.
    pub number: usize,
    /// Its condition.
    pub condition: Condition,
    /// What is wrong with it.
    pub fault: &'static str,
}

impl TryFrom<Vec<Classifier>> for Population {
    type Error = PopulationError;

    fn try_from(rules: Vec<Classifier>) -> Result<Self, PopulationError> {
        let width = rules.first().map_or(0, |rule| rule.condition.width());
        let mut population = Self::default();
        for (at, rule) in rules.into_iter().enumerate() {
            let fault = |fault| PopulationError {
                number: at + 1,
                condition: rule.condition,
                fault,
            };
            fault_of(&rule, width).map_or(Ok(()), |text| Err(fault(text)))?;
            if population.micro.saturating_add(rule.numerosity) > GREATEST_POPULATION {
                return Err(fault("makes the sum of numerosities larger than 1,000,000"));
            }
            population.insert(rule);
            if population.len() != at + 1 {
                return Err(fault("is listed twice with the same action"));
            }
        }
        Ok(population)
    }
}

/// What keeps a rule from a file out of a population with conditions of `width`.
fn fault_of(rule: &Classifier, width: usize) -> Option<&'static str> {
    let figures = [rule.prediction, rule.error, rule.fitness];
    if rule.condition.width() != width {
        Some("has a condition of another width than the first rule")
    } else if rule.numerosity == 0 {
        Some("has numerosity 0, but must have at least 1")
    } else if !figures.iter().all(|figure| figure.abs() <= GREATEST_FIGURE) {
        Some("has a prediction, error or fitness that is not a number up to 1e100")
    } else if rule.fitness < 0.0 || rule.error < 0.0 {
        Some("has a fitness or an error below 0")
    } else if !(1.0..=f64::from(GREATEST_POPULATION)).contains(&rule.set_size) {
        Some("has a set size outside of 1 to 1,000,000")
    } else if rule.time_stamp > MOST_STEPS {
        Some("has a time stamp later than any run can reach")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn rule(condition: &str, numerosity: u32) -> Classifier {
        let params = Params::default();
        let action = Action::new(0).unwrap();
        Classifier {
            numerosity,
            ..Classifier::new(condition.parse().unwrap(), action, 0, &params)
        }
    }

    #[test]
    fn a_twin_adds_its_numerosity() {
        let mut population = Population::default();
        let first = population.insert(rule("01#", 2));
        assert_eq!(population.insert(rule("01#", 3)), first);
        assert_eq!((population.len(), population.micro()), (1, 5));
        assert_eq!(population.get(first).unwrap().numerosity, 5);
    }

    #[test]
    fn a_record_is_kept_by_the_rules_that_match_and_have_the_action() {
        let params = Params::default();
        let new = |condition: &str, action| Classifier {
            fitness: 1.0,
            ..Classifier::new(
                condition.parse().unwrap(),
                Action::new(action).unwrap(),
                0,
                &params,
            )
        };
        let mut population = Population::default();
        let acting = population.insert(new("01#", 0));
        let others = [new("01#", 1), new("1##", 0)].map(|rule| population.insert(rule));
        let (percept, action) = ("010".parse().unwrap(), Action::new(0).unwrap());
        for right in [true, false, true] {
            population.record(&percept, action, right);
        }
        let record = |id| {
            population
                .get(id)
                .map(|rule| (rule.experience, rule.fitness))
        };
        // One right step to begin with, and two of three.
        assert_eq!(record(acting), Some((3, 0.75)));
        assert_eq!(others.map(record), [Some((0, 1.0)); 2]);
    }

    #[test]
    fn a_removed_rule_neither_matches_nor_blocks_a_twin() {
        let mut population = Population::default();
        let first = population.insert(rule("0##", 1));
        population.insert(rule("1##", 1));
        population.remove(first);
        let mut found = Vec::new();
        let percept = "000".parse().unwrap();
        population.for_each_match(&percept, |_, r| found.push(r.condition));
        assert!(found.is_empty(), "{found:?}");
        assert_ne!(population.insert(rule("0##", 1)), first);
    }

    #[test]
    fn rules_that_contradict_each_other_are_refused_with_their_place() {
        let refuse = |rules: Vec<Classifier>| Population::try_from(rules).unwrap_err().to_string();
        assert_eq!(
            refuse(vec![rule("01", 1), rule("0", 1)]),
            "rule 2 (0) has a condition of another width than the first rule"
        );
        assert_eq!(
            refuse(vec![rule("01", 1), rule("01", 1)]),
            "rule 2 (01) is listed twice with the same action"
        );
        let broken = Classifier {
            prediction: f64::NAN,
            ..rule("01", 1)
        };
        assert!(refuse(vec![broken]).contains("not a number up to 1e100"));
        for set_size in [f64::NAN, 0.0, 1e7] {
            let broken = Classifier {
                set_size,
                ..rule("01", 1)
            };
            let fault = refuse(vec![broken]);
            assert!(fault.contains("set size"), "{set_size}: {fault}");
        }
        assert!(refuse(vec![rule("01", 0)]).contains("numerosity 0"));
    }

    proptest! {
        #[test]
        fn deletion_keeps_the_sum_of_numerosities_at_n(
            rules in prop::collection::vec(("[01#]{6}", 1_u32..9), 1..80), seed in any::<u64>(),
        ) {
            let params = Params { population_size: 32, ..Params::default() };
            let mut stream = Stream::new(seed, 0_u64);
            let mut population = Population::default();
            for (condition, numerosity) in &rules {
                population.insert(rule(condition, *numerosity));
                population.delete_surplus(&params, &mut stream);
                let sum: u32 = population.rules().iter().map(|r| r.numerosity).sum();
                prop_assert_eq!(sum, population.micro());
                prop_assert!(sum <= 32, "{} micro-classifiers", sum);
            }
        }

        #[test]
        fn a_population_survives_json_to_the_bit(
            figures in prop::collection::vec((any::<f64>(), 1e-300_f64..1.0), 1..20),
        ) {
            let rules = figures.iter().enumerate().filter(|(_, (p, _))| p.abs() <= 1e100);
            let rules: Vec<Classifier> = rules
                .map(|(i, &(prediction, fitness))| Classifier {
                    prediction,
                    fitness,
                    ..rule(&format!("{i:05b}"), 1)
                })
                .collect();
            let population = Population::try_from(rules).unwrap();
            let text = serde_json::to_string(&population).unwrap();
            let restored: Population = serde_json::from_str(&text).unwrap();
            for (a, b) in population.rules().iter().zip(restored.rules()) {
                prop_assert_eq!(a.prediction.to_bits(), b.prediction.to_bits());
                prop_assert_eq!(a.fitness.to_bits(), b.fitness.to_bits());
            }
            prop_assert_eq!(population, restored);
        }
    }
}
