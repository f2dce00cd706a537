//! What is chosen among: combinations of settings, each in all worlds of a study.

use crate::study::error::StudyError;
use crate::study::protocol::{Arm, Protocol, refuse_twins};
use crate::study::store::folder::StudyFolder;

/// One combination of settings, method, arena and percept.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    /// What tells it from the others.
    pub name: String,
    /// Its arms, one in each world, in the order of the study.
    pub arms: Vec<usize>,
}

impl Candidate {
    /// All candidates of a study, in its order.
    ///
    /// # Errors
    /// When there are less than two, two of them are the same, or one of them is not in all worlds.
    pub fn all(protocol: &Protocol) -> Result<Vec<Self>, StudyError> {
        refuse_twins(&protocol.name, &protocol.arms)?;
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
        let fault = |fault: &str| Err(StudyError::file(&protocol.name, fault));
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
            false => {
                fault("candidates must be tried in the same worlds: leave out `world-sensors`")
            }
        }
    }

    /// The episodes that each trial needed until its policy was optimal, in the order of worlds and
    /// seeds; one more than there were when it never was, or failed.
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
