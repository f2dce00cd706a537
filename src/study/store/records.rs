//! The finished trials of a study in memory.

use std::collections::BTreeMap;

use super::record::{Figures, TrialRecord};

/// Finished trials by number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Records(BTreeMap<usize, Result<Figures, String>>);

impl Records {
    /// Adds a record, unless it is already there. Returns false if the trial already has a
    /// different result.
    #[must_use]
    pub fn insert(&mut self, record: &TrialRecord) -> bool {
        if let Some(known) = self.get(record.trial) {
            return known.equals(record);
        }
        self.0.insert(record.trial, record.result.clone());
        true
    }

    /// Returns the record of a trial.
    pub fn get(&self, trial: usize) -> Option<TrialRecord> {
        let result = self.0.get(&trial)?.clone();
        Some(TrialRecord { trial, result })
    }

    /// Returns true if there is a record of this trial.
    pub fn holds(&self, trial: usize) -> bool {
        self.0.contains_key(&trial)
    }

    /// Returns the number of records.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns all records, in the order of their trials.
    pub fn iter(&self) -> impl Iterator<Item = TrialRecord> + Clone + '_ {
        self.0.iter().map(|(trial, result)| TrialRecord {
            trial: *trial,
            result: result.clone(),
        })
    }
}
