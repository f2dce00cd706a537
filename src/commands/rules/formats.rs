//! Output formats of rules: text for a terminal, rules.json, and CSV.

use xcscr::ErrorKind;
use xcscr::agent::Knowledge;
use xcscr::page::Table;
use xcscr::trial::{Compacted, Plan};
use xcscr::xcs::{Classifier, Population};

use super::listing::{COLUMNS, Row};
use crate::commands::failure::Failure;
use crate::commands::output::print_json;
use crate::commands::results::Results;

/// Prints the rules for a terminal.
pub fn text(headline: &str, rows: &[Row], out: &mut Results) -> Result<(), Failure> {
    writeln!(out, "{headline}\n\n{}", table(rows).text().trim_end())?;
    Ok(())
}

/// Prints a rules.json file: the knowledge with these rules.
pub fn json(rows: &[Row], knowledge: &Knowledge, out: &mut Results) -> Result<(), Failure> {
    let rules: Vec<Classifier> = rows.iter().map(|row| row.rule).collect();
    let rules: Population = rules
        .try_into()
        .expect("some rules of a population form one");
    print_json(&knowledge.with_rules(rules), out)
}

/// Prints a CSV table.
pub fn csv(rows: Vec<Row>, out: &mut Results) -> Result<(), Failure> {
    let table = csv_table(rows).map_err(|fault| {
        let message = format!("no CSV for the rules: {fault}");
        Failure::new(ErrorKind::Internal, message)
    })?;
    Ok(out.write_all(&table)?)
}

/// Returns the bytes of a CSV table.
fn csv_table(rows: Vec<Row>) -> Result<Vec<u8>, csv::Error> {
    let mut table = csv::WriterBuilder::new();
    let mut table = table.has_headers(false).from_writer(Vec::new());
    table.write_record(COLUMNS)?;
    for row in rows {
        table.serialize(row)?;
    }
    Ok(table.into_inner().map_err(|fault| fault.into_error())?)
}

/// Describes the list of rules, of which there are `all` in \[P\], in one or two lines.
pub fn headline(plan: &Plan, all: usize, compacted: Option<&Compacted>) -> String {
    let (world, sensor) = (plan.maze.name(), plan.config.sensor.name());
    let Some(compacted) = compacted else {
        return format!("{world}, {sensor}: {all} rules");
    };
    let optimal = if compacted.optimal { "" } else { "not " };
    format!(
        "{world}, {sensor}: {} of {all} rules are enough for all decisions (`--all` prints all)\n  their policy is \
         {optimal}globally optimal",
        compacted.rules.len(),
    )
}

/// Returns the rules as a table.
fn table(rows: &[Row]) -> Table {
    Table::of(
        rows,
        &[
            ("if", &|row| row.words.clone()),
            ("go", &|row| row.go.clone()),
            ("covers", &|row| row.covers.to_string()),
            ("value", &|row| format!("{:.1}", row.prediction)),
            ("error", &|row| format!("{:.1}", row.error)),
            ("fitness", &|row| format!("{:.2}", row.fitness)),
            ("num", &|row| row.numerosity.to_string()),
            ("exp", &|row| row.experience.to_string()),
        ],
    )
}
