//! `trials.csv`, for other programs.

use std::io;

use serde_json::Value;

use crate::study::protocol::{Arm, Protocol};
use crate::study::statistics::rounded;
use crate::study::store::StudyFolder;
use crate::study::store::outputs::io_error;
use crate::study::store::{Driven, Figures, TrialRecord};
use crate::trial::Progress;

/// A finished trial, as in a row of `trials.csv`.
struct Row<'a> {
    protocol: &'a Protocol,
    arm: &'a Arm,
    record: &'a TrialRecord,
}

impl Row<'_> {
    fn figure<T: Into<Value>>(&self, figure: impl FnOnce(&Figures) -> T) -> Value {
        self.record
            .figures()
            .map(figure)
            .map_or(Value::Null, T::into)
    }

    fn progress<T: Into<Value>>(&self, figure: impl FnOnce(&Progress) -> T) -> Value {
        self.figure(|one| figure(&one.progress))
    }

    fn driven<T: Into<Value>>(&self, figure: impl FnOnce(&Driven) -> T) -> Value {
        self.figure(|one| one.driven.as_ref().map(figure).map_or(Value::Null, T::into))
    }
}

/// The name of a column, and the function that returns its cell.
type Column = (&'static str, fn(&Row<'_>) -> Value);

/// The columns of `trials.csv`; cells without a value are empty.
const COLUMNS: [Column; 30] = [
    ("world", |r| r.arm.world.as_str().into()),
    ("method", |r| r.arm.method_name().into()),
    ("arena", |r| r.arm.arena.name().into()),
    ("sensor", |r| r.arm.sensor.name().into()),
    ("variant", |r| r.arm.variant.to_string().into()),
    ("trial", |r| r.protocol.replicate(r.record.trial).into()),
    ("seed", |r| r.protocol.trial_seed(r.record.trial).into()),
    ("first_optimal_episode", |r| {
        r.progress(|p| p.first_optimal_episode)
    }),
    ("first_optimal_env_steps", |r| {
        r.progress(|p| p.first_optimal_env_steps)
    }),
    ("first_executed_optimal_episode", |r| {
        r.progress(|p| p.first_executed_optimal_episode)
    }),
    ("retained", |r| r.progress(|p| p.optimal)),
    ("optimal_share_after_first", |r| {
        r.progress(|p| p.optimal_share_after_first().map(rounded))
    }),
    ("steps", |r| r.progress(|p| p.steps)),
    ("collisions", |r| r.progress(|p| p.collisions)),
    ("observation_errors", |r| {
        r.progress(|p| p.mistakes.observation_error)
    }),
    ("mislocalised", |r| r.progress(|p| p.mistakes.mislocalised)),
    ("chosen_by_rules", |r| r.progress(|p| p.chosen.rules)),
    ("chosen_by_table", |r| r.progress(|p| p.chosen.table)),
    ("chosen_by_planner", |r| r.progress(|p| p.chosen.planner)),
    ("chosen_by_chance", |r| r.progress(|p| p.chosen.chance)),
    ("most_rules", |r| r.progress(|p| p.most_rules)),
    ("rules", |r| r.figure(|p| p.rules)),
    ("compacted_rules", |r| r.figure(|p| p.compacted_rules)),
    ("greedy_steps", |r| {
        r.figure(|p| p.greedy_steps.map(rounded))
    }),
    ("greedy_ratio", |r| {
        r.figure(|p| p.greedy_ratio.map(rounded))
    }),
    ("greedy_score", |r| {
        r.figure(|p| p.greedy_score.map(rounded))
    }),
    ("driven_goals", |r| r.driven(|p| p.goals)),
    ("driven_optimal", |r| r.driven(|p| p.optimal)),
    ("driven_steps", |r| r.driven(|one| rounded(one.steps))),
    ("error", |r| {
        let fault = r.record.result.as_ref().err();
        fault.map_or("".into(), |fault| plain(fault).into())
    }),
];

/// Replaces control characters, which could control a terminal: journals may come from elsewhere.
fn plain(message: &str) -> String {
    let letters = message.chars();
    letters
        .map(|letter| if letter.is_control() { ' ' } else { letter })
        .collect()
}

/// Writes a row for each finished trial of a study.
pub fn write_trials(folder: &StudyFolder, file: &mut dyn io::Write) -> io::Result<()> {
    let protocol = folder.protocol();
    let mut table = csv::Writer::from_writer(file);
    let names = COLUMNS.map(|(name, _)| name);
    table.write_record(names).map_err(io_error)?;
    for record in folder.records() {
        let row = Row {
            protocol,
            arm: protocol.arm(record.trial),
            record,
        };
        let cells = COLUMNS.map(|(_, cell)| cell(&row));
        table.serialize(cells.as_slice()).map_err(io_error)?;
    }
    table.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_in_a_message_are_replaced_in_the_table() {
        assert_eq!(plain("a \u{1b}[31mred\n\u{9b}2J ü"), "a  [31mred  2J ü");
    }
}
