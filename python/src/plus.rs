//! `xcscr-plus` as a learner for Python environments.

use xcs::{Action, Condition};
use xcscr_learner::agent::EnvironmentLearner;

use crate::learner::{Learner, Numeric, Rule, rules_of};

impl Learner for EnvironmentLearner {
    fn act(&mut self, values: &[f64], explores: bool) -> Result<Option<Action>, String> {
        Ok(Some(self.act(&Condition::percept(values)?, explores)))
    }

    fn take(&mut self, values: &[f64], action: Action) -> Result<(), String> {
        self.take(&Condition::percept(values)?, action);
        Ok(())
    }

    fn update(&mut self, reward: f64, next: Option<&[f64]>) -> Result<(), String> {
        let next = next.map(Condition::percept).transpose()?;
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
        let array = self.values(&Condition::percept(values)?);
        Ok(array.as_slice().to_vec())
    }

    fn rules(&self) -> Vec<Rule> {
        rules_of(&self.rules())
    }

    fn micro(&self) -> u32 {
        self.population().micro()
    }
}
