//! What is kept of a finished trial.

use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::{Deserialize, Serialize};

use super::plan::Plan;
use super::trial::{Progress, Trial};

/// The figures of a trial that reached its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// What happened.
    #[serde(flatten)]
    pub progress: Progress,
    /// Rules at the end.
    pub rules: usize,
}

/// A finished trial of a study: its number, and its figures or why it failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialRecord {
    /// The trial's number in the study, from 0.
    pub trial: usize,
    /// Its figures, or its error.
    pub result: Result<Figures, String>,
}

impl TrialRecord {
    /// Runs a trial to its end. A fault of the trial, even a panic, becomes part of the record.
    pub fn of(trial: usize, plan: Plan) -> Self {
        let result = catch_unwind(AssertUnwindSafe(|| figures(plan)));
        let result = result.unwrap_or_else(|panic| Err(words(&*panic)));
        Self { trial, result }
    }

    /// The figures, unless the trial failed.
    pub fn figures(&self) -> Option<&Figures> {
        self.result.as_ref().ok()
    }
}

fn figures(plan: Plan) -> Result<Figures, String> {
    let mut trial = Trial::new(plan).map_err(|fault| fault.to_string())?;
    // `()` never breaks off.
    let _ = trial.run(&mut ());
    let (progress, rules) = (trial.progress().clone(), trial.method().rule_count());
    Ok(Figures { progress, rules })
}

/// What a panic says.
fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!(
        "internal fault: {}",
        text.unwrap_or("a panic without words")
    )
}
