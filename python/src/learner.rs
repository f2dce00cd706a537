//! Learners with any representation, whose percepts and rules are numbers.

use xcs::{Action, Condition, Intervals, Percept, Population, RealPercept, Representation};

/// The fault of a state that cannot be restored.
const REFUSED: &str = "the state is damaged, or from a learner with other arguments";

/// The attributes tested by a condition, each with its lower and upper bound.
pub type Tests = Vec<(usize, f64, f64)>;
/// Tests, action, prediction, error, fitness, numerosity, experience, set size, time stamp.
pub type Rule = (Tests, usize, f64, f64, f64, u32, u32, f64, u64);

/// A representation with conversions for Python. Percepts are arrays of numbers.
pub trait Numeric: Representation {
    fn percept(values: &[f64]) -> Result<Self::Percept, String>;
    fn tests(&self) -> Tests;
}

impl Numeric for Condition {
    fn percept(values: &[f64]) -> Result<Percept, String> {
        let bits = Percept::from_bits(values.iter().map(|&value| value >= 0.5));
        bits.ok_or_else(|| "the percept has more bits than a ternary condition".into())
    }

    fn tests(&self) -> Tests {
        let value = |bit| Some(f64::from(u8::from(self.allele(bit)?)));
        (0..self.width())
            .filter_map(|bit| value(bit).map(|value| (bit, value, value)))
            .collect()
    }
}

impl Numeric for Intervals {
    fn percept(values: &[f64]) -> Result<RealPercept, String> {
        RealPercept::new(values).map_err(|fault| fault.to_string())
    }

    fn tests(&self) -> Tests {
        let all = self.bounds().iter().enumerate();
        all.filter(|(_, bounds)| **bounds != [0.0, 1.0])
            .map(|(attribute, &[lower, upper])| (attribute, lower, upper))
            .collect()
    }
}

/// A learner with any representation.
pub trait Learner: Send + Sync {
    fn act(&mut self, values: &[f64], explores: bool) -> Result<Option<Action>, String>;
    fn take(&mut self, values: &[f64], action: Action) -> Result<(), String>;
    fn update(&mut self, reward: f64, next: Option<&[f64]>) -> Result<(), String>;
    fn end_episode(&mut self);
    fn is_waiting(&self) -> bool;
    fn values(&self, values: &[f64]) -> Result<Vec<Option<f64>>, String>;
    fn rules(&self) -> Vec<Rule>;
    fn micro(&self) -> u32;

    /// Drops rules that are not needed to choose these actions in the rows of a table.
    fn compact(&mut self, rows: &[(&[f64], Action)]) -> Result<(), String>;

    fn state(&self) -> Result<Vec<u8>, String>;
    fn restore(&mut self, state: &[u8], width: usize) -> Result<(), String>;
}

/// Converts the rules of a population.
pub fn rules_of<C: Numeric>(population: &Population<C>) -> Vec<Rule> {
    let rules = population.rules().iter();
    rules
        .map(|rule| {
            (
                rule.condition.tests(),
                rule.action.index(),
                rule.prediction,
                rule.error,
                rule.fitness,
                rule.numerosity,
                rule.experience,
                rule.set_size,
                rule.time_stamp,
            )
        })
        .collect()
}

impl<C> Learner for xcs::Agent<C>
where
    C: Numeric + Send + Sync,
    C::Percept: Send + Sync,
    C::Index: Send + Sync,
    C::Settings: Send + Sync,
{
    fn act(&mut self, values: &[f64], explores: bool) -> Result<Option<Action>, String> {
        Ok(self.act(&C::percept(values)?, explores))
    }

    fn take(&mut self, values: &[f64], action: Action) -> Result<(), String> {
        self.take(&C::percept(values)?, action);
        Ok(())
    }

    fn update(&mut self, reward: f64, next: Option<&[f64]>) -> Result<(), String> {
        let next = next.map(C::percept).transpose()?;
        self.update(reward, next.as_ref());
        Ok(())
    }

    fn end_episode(&mut self) {
        self.end_episode();
    }

    fn is_waiting(&self) -> bool {
        self.is_waiting()
    }

    fn values(&self, values: &[f64]) -> Result<Vec<Option<f64>>, String> {
        Ok(self.xcs().action_values(&C::percept(values)?))
    }

    fn rules(&self) -> Vec<Rule> {
        rules_of(self.xcs().population())
    }

    fn micro(&self) -> u32 {
        self.xcs().population().micro()
    }

    fn compact(&mut self, rows: &[(&[f64], Action)]) -> Result<(), String> {
        let pair = |&(values, answer)| Ok::<_, String>((C::percept(values)?, vec![answer]));
        let rows = rows.iter().map(pair).collect::<Result<Vec<_>, String>>()?;
        let decisions = rows.iter().map(|(row, answer)| (row, answer.clone()));
        let over_match_set = self.xcs().params().value_over_match_set;
        let (population, actions) = (self.xcs().population(), self.xcs().actions());
        let few = xcs::fewest_rules_for(population, decisions, actions, over_match_set);
        self.start_from(&few);
        Ok(())
    }

    fn state(&self) -> Result<Vec<u8>, String> {
        postcard::to_allocvec(&self.state()).map_err(|fault| fault.to_string())
    }

    fn restore(&mut self, state: &[u8], width: usize) -> Result<(), String> {
        let state = postcard::from_bytes(state).map_err(|_| REFUSED)?;
        let mut restored = self.clone();
        let fits = restored.restore(state)
            && (restored.xcs().population().rules().iter())
                .all(|rule| rule.condition.width() == width);
        if fits {
            *self = restored;
        }
        fits.then_some(()).ok_or_else(|| REFUSED.into())
    }
}
