//! The finished trials of a study in memory.

use std::collections::BTreeMap;

use super::record::{Figures, TrialRecord};

/// Finished trials by number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Records(BTreeMap<usize, Result<Figures, String>>);

impl Records {
    /// Adds a record, unless it is already there. A result replaces a failure, which was repeated. Returns false if
    /// the trial already has a different result.
    #[must_use]
    pub fn insert(&mut self, record: &TrialRecord) -> bool {
        match (self.0.get(&record.trial), &record.result) {
            (Some(Ok(known)), Ok(figures)) => known == figures,
            (Some(Ok(_)), Err(_)) | (Some(Err(_)), Err(_)) => true,
            (Some(Err(_)), Ok(_)) | (None, _) => {
                self.0.insert(record.trial, record.result.clone());
                true
            }
        }
    }

    /// Removes the failed trials. Returns true if there were any.
    pub fn remove_failed(&mut self) -> bool {
        let all = self.0.len();
        self.0.retain(|_, result| result.is_ok());
        self.0.len() < all
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
