//! The finished trials of a study in memory, packed: a million trials take less than 100 MB.

use serde::{Deserialize, Serialize};

use super::record::{Driven, Figures, TrialRecord};
use crate::trial::Progress;

/// Finished trials by number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Records {
    packed: Vec<u8>,
    /// The offset of each trial's record plus one; 0 when there is none.
    places: Vec<usize>,
    count: usize,
}

/// The packed form of a trial's result.
#[derive(Serialize, Deserialize)]
struct Packed(Result<PackedFigures, String>);

#[derive(Serialize, Deserialize)]
struct PackedFigures {
    progress: Progress,
    rules: usize,
    compacted_rules: Option<usize>,
    greedy_steps: Option<f64>,
    greedy_ratio: Option<f64>,
    driven: Option<Driven>,
}

/// The error when a trial already has a different result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DifferentResult;

impl Records {
    /// Adds a record, unless it is already there.
    ///
    /// # Errors
    /// When the trial already has a different result.
    pub fn insert(&mut self, record: &TrialRecord) -> Result<(), DifferentResult> {
        if let Some(known) = self.get(record.trial) {
            return if known == *record {
                Ok(())
            } else {
                Err(DifferentResult)
            };
        }
        if self.places.len() <= record.trial {
            self.places.resize(record.trial + 1, 0);
        }
        self.places[record.trial] = self.packed.len() + 1;
        self.packed.extend(packed(record));
        self.count += 1;
        Ok(())
    }

    /// Returns the record of a trial.
    pub fn get(&self, trial: usize) -> Option<TrialRecord> {
        let place = self.places.get(trial)?.checked_sub(1)?;
        let result = unpacked(&self.packed[place..]);
        Some(TrialRecord { trial, result })
    }

    /// Returns true if there is a record of this trial.
    pub fn holds(&self, trial: usize) -> bool {
        self.places.get(trial).is_some_and(|place| *place > 0)
    }

    /// Returns the number of records.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Returns all records, in the order of their trials.
    pub fn iter(&self) -> impl Iterator<Item = TrialRecord> + Clone + '_ {
        (0..self.places.len()).filter_map(|trial| self.get(trial))
    }
}

fn packed(record: &TrialRecord) -> Vec<u8> {
    let figures = |figures: &Figures| PackedFigures {
        progress: figures.progress.clone(),
        rules: figures.rules,
        compacted_rules: figures.compacted_rules,
        greedy_steps: figures.greedy_steps,
        greedy_ratio: figures.greedy_ratio,
        driven: figures.driven,
    };
    let packed = Packed(record.result.as_ref().map(figures).map_err(Clone::clone));
    postcard::to_stdvec(&packed).expect("plain data can be packed")
}

fn unpacked(bytes: &[u8]) -> Result<Figures, String> {
    let (Packed(result), _) =
        postcard::take_from_bytes(bytes).expect("what was packed can be unpacked");
    result.map(|figures: PackedFigures| Figures {
        progress: figures.progress,
        rules: figures.rules,
        compacted_rules: figures.compacted_rules,
        greedy_steps: figures.greedy_steps,
        greedy_ratio: figures.greedy_ratio,
        driven: figures.driven,
    })
}
