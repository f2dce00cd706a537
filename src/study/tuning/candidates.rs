//! The candidates of a search: combinations of settings, each in all worlds of a study.

use crate::error::Error;
use crate::study::error;
use crate::study::protocol::{Arm, Protocol, refuse_duplicates};
use crate::study::store::StudyFolder;

/// A combination of method, arena, sensor and settings.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    /// A name that is unique in the study.
    pub name: String,
    /// Its arms, one in each world, in the order of the study.
    pub arms: Vec<usize>,
}

impl Candidate {
    /// Returns all candidates of a study, in the order of the study.
    ///
    /// # Errors
    /// When there are fewer than two candidates, two are the same, or one is not in all worlds.
    pub fn all(protocol: &Protocol) -> Result<Vec<Self>, Error> {
        refuse_duplicates(&protocol.name, &protocol.arms)?;
        let mut all: Vec<Self> = Vec::new();
        for (i, arm) in protocol.arms.iter().enumerate() {
            let name = name(arm);
            match all.iter_mut().find(|one| one.name == name) {
                Some(one) => one.arms.push(i),
                None => all.push(Self {
                    name,
                    arms: vec![i],
                }),
            }
        }
        let fault = |fault: &str| Err(error::file(&protocol.name, fault));
        if all.len() < 2 {
            return fault(
                "there is nothing to choose from: give several values under `sweep` or `variants`, or several methods",
            );
        }
        let worlds = |one: &Self| -> Vec<&str> {
            let arms = one.arms.iter().map(|arm| &protocol.arms[*arm]);
            arms.map(|arm| &arm.world[..]).collect()
        };
        match all.iter().all(|one| worlds(one) == worlds(&all[0])) {
            true => Ok(all),
            false => fault("all candidates must run in the same worlds: remove `world-sensors`"),
        }
    }

    /// Returns the number of episodes that each trial needed until its policy was optimal, in the
    /// order of worlds and seeds. A trial that failed or was never optimal scores the number of
    /// episodes plus one.
    pub fn scores(&self, rung: &StudyFolder) -> Vec<f64> {
        let protocol = rung.protocol();
        let is_own = |arm: &&usize| name(&protocol.arms[**arm]) == self.name;
        let arms: Vec<usize> = (0..protocol.arms.len()).collect();
        let own = arms.iter().filter(is_own);
        let trials =
            own.flat_map(|arm| rung.records_of(arm * protocol.trials..(arm + 1) * protocol.trials));
        let first = trials.map(|record| record.result.ok()?.progress.first_optimal_episode);
        first
            .map(|first| f64::from(first.unwrap_or(protocol.episodes + 1)))
            .collect()
    }
}

fn name(arm: &Arm) -> String {
    let after = arm.after.iter().map(|world| format!(" after {world}"));
    let words = [arm.method.name(), arm.arena.name(), arm.sensor.name()];
    let variant = arm.variant.to_string();
    let name = format!("{} {variant}", words.join(" "));
    name.trim_end().to_owned() + &after.collect::<String>()
}
