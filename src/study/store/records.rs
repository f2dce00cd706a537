//! The finished trials of a study in memory, packed: a million trials take less than 100 MB.

use super::record::{Figures, TrialRecord};

/// Finished trials by number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Records {
    packed: Vec<u8>,
    /// The offset of each trial's record plus one; 0 when there is none.
    places: Vec<usize>,
    count: usize,
}

impl Records {
    /// Adds a record, unless it is already there. Returns false if the trial already has a
    /// different result.
    #[must_use]
    pub fn insert(&mut self, record: &TrialRecord) -> bool {
        if let Some(known) = self.get(record.trial) {
            return known == *record;
        }
        if self.places.len() <= record.trial {
            self.places.resize(record.trial + 1, 0);
        }
        self.places[record.trial] = self.packed.len() + 1;
        let packed = postcard::to_stdvec(&record.result).expect("plain data can be packed");
        self.packed.extend(packed);
        self.count += 1;
        true
    }

    /// Returns the record of a trial.
    pub fn get(&self, trial: usize) -> Option<TrialRecord> {
        let place = self.places.get(trial)?.checked_sub(1)?;
        let (result, _) =
            postcard::take_from_bytes::<Result<Figures, String>>(&self.packed[place..])
                .expect("what was packed can be unpacked");
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
