//! The exported policy: rules that vote with integers.

use serde::Serialize;

use crate::agent::Knowledge;
use crate::streams::StreamName;
use crate::{Error, ErrorKind};
use xcs::random::Stream;
use xcs::{
    Action, Classifier, Condition, NumberRange, Params, Percept, Population, PredictionArray,
};

/// The widest percepts, in bits, for which all percepts are compared.
const ALL_OF_BITS: usize = 16;
/// For wider percepts: the number of percepts drawn at random, and the number drawn for each rule
/// among those it matches.
const DRAWN: usize = 100_000;
const DRAWN_PER_RULE: usize = 64;
/// The most rules that a 16-bit number can count.
const MOST_RULES: usize = u16::MAX as usize;

/// The sizes that are tried, the smallest first. Each is the bits of the value and of the weight.
const SIZES: [Size; 3] = [Size::new(16, 8), Size::new(16, 16), Size::new(32, 32)];

/// The bits of a rule's value and weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Size {
    /// Bits of the value: 16 or 32.
    pub value: u32,
    /// Bits of the weight: 8, 16 or 32.
    pub weight: u32,
}

impl Size {
    const fn new(value: u32, weight: u32) -> Self {
        Self { value, weight }
    }

    /// Returns the greatest value.
    fn most_value(self) -> f64 {
        f64::from(u32::MAX >> (32 - self.value))
    }

    /// Returns the greatest weight. With 32 bits, only 24 are used, so that sums fit.
    fn most_weight(self) -> f64 {
        f64::from(u32::MAX >> (32 - self.weight.min(24)))
    }
}

/// A rule that votes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedRule {
    /// The percepts that the rule matches.
    pub condition: Condition,
    /// The action that the rule votes for.
    pub action: Action,
    /// The value of the action. The least value of all rules is 0.
    pub value: u32,
    /// The weight of its vote; at least 1.
    pub weight: u32,
}

/// Rules as votes with integers. The action with the greatest weighted mean value wins, the first
/// of equals.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    votes: Vec<WeightedRule>,
    /// The same votes with a search index. The prediction is the value, and the fitness is the
    /// weight.
    index: Population,
    size: Size,
    width: usize,
    actions: usize,
    /// The number of percepts that were compared.
    compared: usize,
}

/// The hint of several errors.
const COMPACT: &str =
    "train with another seed, or export the rules of a run in its own world, which are few";

/// Returns the error that there is no policy to export.
pub(super) fn nothing_learned() -> Error {
    ErrorKind::BadData.error("nothing was learned, so there is no policy to export")
}

impl Policy {
    /// Quantises what was learned about percepts of `width` bits and `actions` actions. Uses the
    /// fewest bits with which the votes choose a best action of `knowledge` wherever `knowledge`
    /// rates any action. Up to 16 bits, all percepts are compared. Wider percepts are compared in
    /// `of_world` and in many random percepts.
    ///
    /// # Errors
    /// When there is nothing to export, or the policy cannot be expressed exactly.
    pub fn new(
        knowledge: &Knowledge,
        width: usize,
        actions: usize,
        of_world: &[Percept],
    ) -> Result<Self, Error> {
        let rules = rules(knowledge, actions)?;
        let percepts = percepts(&rules, width, of_world);
        let mut unlike = None;
        for size in SIZES {
            let votes = votes(&rules, size);
            let quantised = Self {
                index: index(&votes),
                votes,
                size,
                width,
                actions,
                compared: percepts.len(),
            };
            // Sums that do not fit cannot be compared either.
            if !quantised.sums_fit() {
                return Err(ErrorKind::BadData.error(format!(
                    "the values of two actions are so close that 32-bit votes are needed, and the sums of {} \
                     rules with 32-bit votes do not fit into 64 bits: {COMPACT}",
                    rules.len()
                )));
            }
            let differs = |percept: &&Percept| {
                let value = knowledge.values(percept, actions);
                !agrees(quantised.decide(percept), &value)
            };
            unlike = percepts.iter().find(differs).copied();
            if unlike.is_none() {
                return Ok(quantised);
            }
        }
        let percept = unlike.map_or(String::new(), |percept| percept.to_string());
        Err(ErrorKind::BadData.error(format!(
            "the values of two actions are too close in percept {percept} to be distinguished with integers of 32 \
             bits: {COMPACT}"
        )))
    }

    /// Returns true if the sums of each action fit into 64 bits of value and 32 bits of weight,
    /// whichever rules match.
    fn sums_fit(&self) -> bool {
        Action::all(self.actions).all(|action| {
            let own = || self.votes.iter().filter(|vote| vote.action == action);
            let weight: u64 = own().map(|vote| u64::from(vote.weight)).sum();
            let value: u128 = own()
                .map(|v| u128::from(v.value) * u128::from(v.weight))
                .sum();
            weight <= u64::from(u32::MAX) && value <= u128::from(u64::MAX)
        })
    }

    /// Returns the action for a percept; `None` if no rule matches.
    pub fn decide(&self, percept: &Percept) -> Option<Action> {
        let mut sums = vec![(0_u64, 0_u64); self.actions];
        self.index.for_each_match(percept, |_, vote| {
            let (value, weight) = &mut sums[vote.action.index()];
            *value += vote.prediction as u64 * vote.fitness as u64;
            *weight += vote.fitness as u64;
        });
        let greater = |a: (u64, u64), b: (u64, u64)| {
            u128::from(a.0) * u128::from(b.1) > u128::from(b.0) * u128::from(a.1)
        };
        let voted = Action::all(self.actions).filter(|action| sums[action.index()].1 > 0);
        voted.reduce(|best, action| {
            if greater(sums[action.index()], sums[best.index()]) {
                action
            } else {
                best
            }
        })
    }

    /// The votes, in the order of the rules.
    pub fn votes(&self) -> &[WeightedRule] {
        &self.votes
    }

    /// The bits of a vote's value and weight.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The number of bits of a percept.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// Describes the percepts in which the votes were compared with the learned policy.
    pub fn compared(&self) -> String {
        let all = if self.width <= ALL_OF_BITS {
            "all "
        } else {
            ""
        };
        format!("{all}{} percepts", self.compared)
    }
}

/// Returns true if the action is one of the best or nearly so, or if there is no action and no value is known.
fn agrees(action: Option<Action>, value: &PredictionArray) -> bool {
    match action {
        None => value.greatest().is_none(),
        Some(action) => value.is_nearly_best(action),
    }
}

/// Returns the learned policy as rules with condition, action, value and weight. Each row of a
/// table becomes a rule for one percept.
fn rules(knowledge: &Knowledge, actions: usize) -> Result<Vec<Classifier>, Error> {
    let rules: Vec<Classifier> = match knowledge {
        Knowledge::RulesOverMatchSet(_) => {
            return Err(ErrorKind::BadData.error(format!(
                "rules learned with `xcs.value_over_match_set` cannot be exported: {COMPACT}"
            )));
        }
        Knowledge::Table(table) => table
            .keys()
            .flat_map(|percept| best_of_row(percept, &knowledge.values(percept, actions)))
            .collect(),
        _ => knowledge
            .rules()
            .map_or(&[][..], Population::rules)
            .iter()
            .filter(|rule| rule.fitness > 0.0)
            .copied()
            .collect(),
    };
    match rules.len() {
        0 => Err(nothing_learned()),
        1..=MOST_RULES => Ok(rules),
        many => Err(ErrorKind::BadData.error(format!(
            "there are {many} rules, but at most {MOST_RULES} can be exported: {COMPACT}"
        ))),
    }
}

/// Returns one rule for each of the best actions in a row of a table.
fn best_of_row(percept: &Percept, value: &PredictionArray) -> Vec<Classifier> {
    let rule = |action| Classifier {
        fitness: 1.0,
        prediction: value.greatest().unwrap_or(0.0),
        ..Classifier::new(Condition::exactly(percept), action, 0, &Params::default())
    };
    value.best_actions().map(rule).collect()
}

/// Scales the rules to integers of this size. The least prediction becomes 0: a common shift
/// changes all weighted means equally.
fn votes(rules: &[Classifier], size: Size) -> Vec<WeightedRule> {
    let predictions = || rules.iter().map(|rule| rule.prediction);
    let least = predictions().fold(f64::INFINITY, f64::min);
    let range = predictions().fold(f64::NEG_INFINITY, f64::max) - least;
    let heaviest = rules.iter().map(|rule| rule.fitness).fold(0.0, f64::max);
    let value_scale = if range > 0.0 {
        size.most_value() / range
    } else {
        0.0
    };
    let weight_scale = size.most_weight() / heaviest;
    let vote = |rule: &Classifier| WeightedRule {
        condition: rule.condition,
        action: rule.action,
        value: ((rule.prediction - least) * value_scale).round() as u32,
        weight: ((rule.fitness * weight_scale).round() as u32).max(1),
    };
    rules.iter().map(vote).collect()
}

/// Stores the votes in a population, whose index finds the matching votes quickly. Integers of 32
/// bits stay exact.
fn index(votes: &[WeightedRule]) -> Population {
    let rule = |vote: &WeightedRule| Classifier {
        prediction: f64::from(vote.value),
        fitness: f64::from(vote.weight),
        ..Classifier::new(vote.condition, vote.action, 0, &Params::default())
    };
    let rules: Vec<Classifier> = votes.iter().map(rule).collect();
    let population = Population::try_from(rules);
    population.expect("rules of a population, or rows of a table, form a population")
}

/// Returns the percepts in which the votes are compared.
fn percepts(rules: &[Classifier], width: usize, of_world: &[Percept]) -> Vec<Percept> {
    if width <= ALL_OF_BITS {
        return (0..1 << width)
            .map(|word| Percept::from_word(word, width))
            .collect();
    }
    let mut stream = Stream::new(0, StreamName::Export);
    let mut percepts = of_world.to_vec();
    percepts.extend((0..DRAWN).map(|_| drawn(width, |_| None, &mut stream)));
    for rule in rules {
        percepts.extend((0..DRAWN_PER_RULE).map(|_| matched(&rule.condition, &mut stream)));
    }
    percepts
}

/// Returns a percept that a condition matches, drawn at random.
fn matched(condition: &Condition, stream: &mut Stream) -> Percept {
    let number = |range: &NumberRange| {
        let [least, most] = range.limits();
        let above = stream.below(usize::from(most - least) + 1);
        (range.bits(), usize::from(least) + above)
    };
    let numbers: Vec<_> = condition.ranges().map(number).collect();
    let of_number = |bit| {
        let (bits, number) = numbers.iter().find(|(bits, _)| bits.contains(&bit))?;
        Some(number >> (bits.end - 1 - bit) & 1 == 1)
    };
    let fixed = |bit| condition.allele(bit).or_else(|| of_number(bit));
    drawn(condition.width(), fixed, stream)
}

/// Returns a percept with some bits fixed and the others drawn at random.
fn drawn(width: usize, fixed: impl Fn(usize) -> Option<bool>, stream: &mut Stream) -> Percept {
    let bits = (0..width).map(|bit| fixed(bit).unwrap_or_else(|| stream.below(2) == 1));
    Percept::from_bits(bits).expect("no wider than percepts are")
}
