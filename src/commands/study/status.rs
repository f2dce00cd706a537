//! `xcscr study status`: lists missing and failed trials.

use serde::Serialize;
use xcscr::study::{Arm, Shard, Slurm, StudyFolder};

use crate::commands::failure::Failure;
use crate::commands::output::print_json;
use crate::commands::results::Results;

/// The most arms with all trials listed that get a line each.
const MANY_ARMS: usize = 8;

/// The status of a study, as `study status --json` prints it.
#[derive(Debug, Serialize)]
pub(super) struct Status {
    study: String,
    plan: String,
    trials: usize,
    finished: usize,
    failed: Vec<usize>,
    missing: Vec<usize>,
    /// The names of the arms, and the number of trials in each.
    #[serde(skip)]
    arms: (Vec<String>, usize),
    /// The shards with trials left to run.
    #[serde(skip_serializing_if = "Option::is_none")]
    shards: Option<Vec<String>>,
}

impl Status {
    /// Lists trials, numbered as in trials.csv, with one line for each arm. If there are many arms
    /// of which every trial is listed, they share one line.
    fn listed(&self, trials: &[usize]) -> Vec<String> {
        let (names, per_arm) = &self.arms;
        let arms = trials.chunk_by(|a, b| a / per_arm == b / per_arm);
        let (whole, part): (Vec<_>, Vec<_>) = arms.partition(|own| own.len() == *per_arm);
        let line = |own: &&[usize]| {
            let numbers: Vec<usize> = own.iter().map(|trial| trial % per_arm + 1).collect();
            let numbers = Slurm::ranges(&numbers).replace(',', " ");
            format!("{}: {numbers}", names[own[0] / per_arm])
        };
        let mut lines: Vec<String> = part.iter().map(line).collect();
        match whole.len() {
            0..=MANY_ARMS => lines.extend(whole.iter().map(line)),
            many => lines.push(format!("all {per_arm} trials of each of {many} arms")),
        }
        lines
    }

    pub fn new(folder: &StudyFolder, shards: Option<usize>) -> Self {
        let (protocol, missing) = (folder.protocol(), folder.missing());
        let open = |count| {
            let shards = Shard::all(count);
            let open = shards.filter(|shard| missing.iter().any(|trial| shard.holds(*trial)));
            open.map(|shard| shard.to_string()).collect()
        };
        Self {
            study: protocol.name.clone(),
            plan: folder.plan().to_owned(),
            trials: protocol.len(),
            finished: protocol.len() - missing.len(),
            failed: folder.failed(),
            shards: shards.map(open),
            arms: (
                protocol.arms.iter().map(Arm::name).collect(),
                protocol.trials,
            ),
            missing,
        }
    }

    pub fn print(&self, json: bool, out: &mut Results) -> Result<(), Failure> {
        if json {
            return print_json(self, out);
        }
        let head = head(&self.study, &self.plan, self.finished, self.trials);
        writeln!(out, "{head}")?;
        for (name, trials) in [("missing", &self.missing), ("failed", &self.failed)] {
            if !trials.is_empty() {
                writeln!(out, "  {name} ({}):", trials.len())?;
            }
            for line in self.listed(trials) {
                writeln!(out, "    {line}")?;
            }
        }
        if let Some(shards) = &self.shards {
            writeln!(
                out,
                "  shards to run ({}): {}",
                shards.len(),
                shards.join(" ")
            )?;
        }
        Ok(())
    }
}

/// Returns the first line of a status.
pub(super) fn head(study: &str, plan: &str, finished: usize, trials: usize) -> String {
    format!("study {study}, plan {plan}: {finished} of {trials} trials finished")
}
