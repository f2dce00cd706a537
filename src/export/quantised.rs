//! Rules that vote in whole numbers.

use crate::agent::{CONTEXT_BITS, Knowledge, contexts};
use crate::streams::StreamName;
use xcs::random::Stream;
use xcs::{Action, Classifier, Condition, Params, Percept, Population, PredictionArray};

/// Percepts of at most this many bits are all looked at.
const ALL_OF_BITS: usize = 16;
/// Of wider percepts, so many drawn at random, and for each rule so many that it matches.
const DRAWN: usize = 100_000;
const DRAWN_PER_RULE: usize = 64;
/// The rules that a 16-bit number counts.
const MOST_RULES: usize = u16::MAX as usize;

/// The states that a 16-bit number counts, one number left for the goal.
pub(super) const MOST_STATES: usize = u16::MAX as usize;

/// How many bits a rule's figures take, fewest first: worth, then weight.
const SIZES: [Size; 3] = [Size::new(16, 8), Size::new(16, 16), Size::new(32, 32)];

/// The bits of a rule's figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

    /// The greatest value.
    fn most_value(self) -> f64 {
        f64::from(u32::MAX >> (32 - self.value))
    }

    /// The greatest weight: of 32 bits only 24 are used, so that sums fit.
    fn most_weight(self) -> f64 {
        f64::from(u32::MAX >> (32 - self.weight.min(24)))
    }
}

/// A rule that votes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedRule {
    /// Which percepts it matches.
    pub condition: Condition,
    /// What it votes for.
    pub action: Action,
    /// The value of its action, 0 for the least of all rules.
    pub value: u32,
    /// The weight of its vote; at least 1.
    pub weight: u32,
}

/// Rules as votes in whole numbers. The action of the greatest weighted mean value wins, the first
/// of equals.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantisedPolicy {
    votes: Vec<WeightedRule>,
    /// The same votes, with an index that finds those that match: worth as prediction, weight as
    /// fitness.
    index: Population,
    size: Size,
    width: usize,
    actions: usize,
    /// How many percepts it was compared in, or of what else.
    compared: usize,
    of: &'static str,
}

/// Rules that cannot be exported.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// Nothing was learned.
    #[error("nothing was learned, so there is no policy to export")]
    Empty,
    /// The maps that they go by have too many states.
    #[error(
        "the maps that the rules go by have {0} states, more than the {MOST_STATES} that can be \
         exported: train another method for export, such as xcscr-plus"
    )]
    Vast(usize),
    /// They are too many.
    #[error("{0} rules are more than the {MOST_RULES} that can be exported: {CONDENSE}")]
    Many(usize),
    /// The sums of their votes do not fit.
    #[error(
        "the values of two actions lie so close that votes of 32 bits are needed, and the sums of {0} \
         rules with such votes do not fit into 64 bits: {CONDENSE}"
    )]
    Sums(usize),
    /// Actions lie too close for whole numbers.
    #[error(
        "the values of two actions lie too close in percept {0} to be told apart in whole \
         numbers of 32 bits: {CONDENSE}"
    )]
    Close(Percept),
    /// The same with a memory.
    #[error(
        "the values of two actions lie too close in a context to be told apart in whole numbers of \
         32 bits: train with another seed"
    )]
    CloseInContext,
    /// Eq. 6 as it is printed.
    #[error("rules learned with `xcs.value_over_match_set` cannot be exported: {CONDENSE}")]
    OverMatchSet,
    /// A plan on maps.
    #[error(
        "what was learned is a plan on a map, which chooses without rules and cannot be exported: train xcscr-plus, which \
         distils rules from such a plan"
    )]
    Planned,
}

/// The way out.
const CONDENSE: &str = "condense them with `xcscr rules RUN --compact --json > few.json`, and \
                        export few.json";

impl QuantisedPolicy {
    /// The votes of what was learned about percepts of `width` bits and `actions` actions, in the
    /// fewest bits with which they choose an action that `knowledge` rates best, wherever it rates
    /// any: in all percepts of up to 16 bits, otherwise in those `of_world` and in many drawn at
    /// random; with a memory in the contexts that two moves on the maps make.
    ///
    /// # Errors
    /// When there is nothing to export, or it cannot be expressed exactly.
    pub fn new(
        knowledge: &Knowledge,
        width: usize,
        actions: usize,
        of_world: &[Percept],
    ) -> Result<Self, ExportError> {
        let rules = rules(knowledge, actions)?;
        let (width, percepts, of) = match knowledge {
            Knowledge::Remembering { map, .. } => (CONTEXT_BITS, contexts(map, DRAWN), "contexts"),
            _ => (width, percepts(&rules, width, of_world), "percepts"),
        };
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
                of,
            };
            // Sums that do not fit cannot be compared either.
            if !quantised.sums_fit() {
                return Err(ExportError::Sums(rules.len()));
            }
            let differs = |percept: &&Percept| {
                let value = knowledge.values_in(percept, actions);
                !agrees(quantised.decide(percept), &value)
            };
            unlike = percepts.iter().find(differs).copied();
            if unlike.is_none() {
                return Ok(quantised);
            }
        }
        Err(match unlike {
            Some(percept) if !knowledge.remembers() => ExportError::Close(percept),
            _ => ExportError::CloseInContext,
        })
    }

    /// Do the sums of one action fit into 64 bits of worth and 32 of weight, whatever matches?
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

    /// The action for a percept; `None` where no rule matches.
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
        voted.reduce(
            |best, action| match greater(sums[action.index()], sums[best.index()]) {
                true => action,
                false => best,
            },
        )
    }

    /// The votes, in the order of the rules.
    pub fn votes(&self) -> &[WeightedRule] {
        &self.votes
    }

    /// The bits of a vote's figures.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The bits of a percept.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The bytes of a percept; bit `i` is bit `i % 8` of byte `i / 8`.
    pub fn bytes(&self) -> usize {
        self.width.div_ceil(8)
    }

    /// The number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// In what it was compared with what was learned.
    pub fn compared(&self) -> String {
        let all = if self.width <= ALL_OF_BITS {
            "all "
        } else {
            ""
        };
        format!("{all}{} {}", self.compared, self.of)
    }

    /// Bytes of a condition: the values demanded, and where any is.
    pub(super) fn condition_bytes(&self, condition: &Condition) -> (Vec<u8>, Vec<u8>) {
        let bits = |byte: usize, set: &dyn Fn(usize) -> bool| {
            let own = (8 * byte..(8 * byte + 8).min(self.width)).enumerate();
            own.fold(0, |bits, (at, bit)| bits | u8::from(set(bit)) << at)
        };
        let demanded = |bit| condition.allele(bit) == Some(true);
        let cared = |bit| condition.allele(bit).is_some();
        (0..self.bytes())
            .map(|byte| (bits(byte, &demanded), bits(byte, &cared)))
            .unzip()
    }
}

/// Is the action one of the best, or is there none and nothing known?
fn agrees(action: Option<Action>, value: &PredictionArray) -> bool {
    match action {
        None => value.greatest().is_none(),
        Some(action) => value.best_actions().any(|best| best == action),
    }
}

/// What was learned as rules: condition, action, worth, weight. A table's rows become rules that
/// match one percept each.
fn rules(knowledge: &Knowledge, actions: usize) -> Result<Vec<Classifier>, ExportError> {
    let rules: Vec<Classifier> = match knowledge {
        Knowledge::RulesOverMatchSet(_) => return Err(ExportError::OverMatchSet),
        Knowledge::Planned(_) => return Err(ExportError::Planned),
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
        0 => Err(ExportError::Empty),
        1..=MOST_RULES => Ok(rules),
        many => Err(ExportError::Many(many)),
    }
}

/// One rule for each of the best actions in a row of a table.
fn best_of_row(percept: &Percept, value: &PredictionArray) -> Vec<Classifier> {
    let rule = |action| Classifier {
        fitness: 1.0,
        prediction: value.greatest().unwrap_or(0.0),
        ..Classifier::new(Condition::exactly(percept), action, 0, &Params::default())
    };
    value.best_actions().map(rule).collect()
}

/// The rules with figures of this size. The least prediction becomes 0: where the mean is
/// weighted, a shift of all of them moves every value alike.
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

/// The votes as a population, which finds those that match without looking at each. Whole numbers of
/// 32 bits stay exact.
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

/// What the votes are compared on.
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
        let allele = |bit| rule.condition.allele(bit);
        percepts.extend((0..DRAWN_PER_RULE).map(|_| drawn(width, allele, &mut stream)));
    }
    percepts
}

/// A percept with the bits that are fixed, and the others drawn.
fn drawn(width: usize, fixed: impl Fn(usize) -> Option<bool>, stream: &mut Stream) -> Percept {
    let bits = (0..width).map(|bit| fixed(bit).unwrap_or_else(|| stream.below(2) == 1));
    Percept::from_bits(bits).expect("no wider than percepts are")
}
