//! Earlier plans of a study, to which trials, methods or worlds were added.

use serde::{Deserialize, Serialize};

use super::record::TrialRecord;
use crate::study::protocol::Protocol;

/// An earlier plan of a study. Its journals stay as they are, with its numbers of trials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EarlierPlan {
    /// Its id, which is the first line of its journals.
    pub plan: String,
    /// Trials per arm.
    trials: usize,
    /// The place of each of its arms among the present ones.
    arms: Vec<usize>,
}

impl EarlierPlan {
    /// Creates the earlier plan with this id, whose arms are found in these places.
    pub fn new(plan: &str, protocol: &Protocol, places: &[usize]) -> Self {
        Self {
            plan: plan.to_owned(),
            trials: protocol.trials,
            arms: places.to_vec(),
        }
    }

    /// Returns the same for a later protocol, which has the arms in these places.
    pub fn moved(&self, places: &[usize]) -> Self {
        Self {
            arms: self.arms.iter().map(|&arm| places[arm]).collect(),
            ..self.clone()
        }
    }

    /// Checks that the present protocol has all these trials.
    ///
    /// # Errors
    /// Describes the fault.
    pub fn check(&self, protocol: &Protocol) -> Result<(), String> {
        let has_arms = self.arms.iter().all(|&arm| arm < protocol.arms.len());
        match has_arms && (1..=protocol.trials).contains(&self.trials) {
            true => Ok(()),
            false => Err("it has other trials than an earlier plan".to_owned()),
        }
    }

    /// Gives a record of this plan the number of its trial in the present protocol.
    ///
    /// # Errors
    /// Describes the fault if this plan has no such trial.
    pub fn renumber(&self, record: &mut TrialRecord, protocol: &Protocol) -> Result<(), String> {
        let (arm, replicate) = (record.trial / self.trials, record.trial % self.trials);
        let Some(place) = self.arms.get(arm) else {
            return Err(format!("its plan has no trial {}", record.trial));
        };
        record.trial = place * protocol.trials + replicate;
        Ok(())
    }
}
