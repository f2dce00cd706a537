//! `xcscr rules --diff`: compares the rules of two learners.

use std::path::Path;

use xcscr::agent::Knowledge;
use xcscr::trial::Plan;
use xcscr::world::Cell;
use xcscr::xcs::{Action, Classifier, Condition};

use super::checked;
use super::formats::table;
use super::listing::{Order, rows};
use crate::commands::choices;
use crate::commands::failure::Failure;
use crate::commands::results::Results;

/// The most rules of each learner that are shown.
const MOST_RULES: usize = 20;
/// The most cells that are listed.
const MOST_CELLS: usize = 20;

/// Prints the rules that only one of the two has, and the cells in which their best actions differ.
pub fn print(
    (plan, first): (&Plan, &Knowledge),
    other: &Path,
    order: Order,
    out: &mut Results,
) -> Result<(), Failure> {
    let second = choices::read_rules(other)?;
    checked(plan, &second)?;
    let [first_only, second_only] = [only_in(first, &second), only_in(&second, first)];
    let both = first.len() - first_only.len();
    let (world, sensor) = (plan.maze.name(), plan.config.sensor.name());
    let (one, two) = (first.len(), second.len());
    writeln!(
        out,
        "{world}, {sensor}: {one} and {two} rules, {both} in common"
    )?;
    let parts = [
        ("first", first, first_only),
        ("second", &second, second_only),
    ];
    for (which, knowledge, rules) in parts {
        if rules.is_empty() {
            continue;
        }
        let mut rows = rows(&rules, (plan, knowledge), None, order);
        let more = rows.len().saturating_sub(MOST_RULES);
        rows.truncate(MOST_RULES);
        let text = table(&rows).text();
        writeln!(out, "\nOnly in the {which}:\n\n{}", text.trim_end())?;
        if more > 0 {
            writeln!(out, "and {more} more")?;
        }
    }
    print_differences(plan, first, &second, out)
}

/// Returns the rules that the other learner does not have.
fn only_in(knowledge: &Knowledge, other: &Knowledge) -> Vec<Classifier> {
    let rules = |knowledge: &Knowledge| knowledge.rules().map_or(vec![], |r| r.rules().to_vec());
    let key = |rule: &Classifier| (rule.condition, rule.action);
    let known: Vec<(Condition, Action)> = rules(other).iter().map(key).collect();
    let mut own = rules(knowledge);
    own.retain(|rule| !known.contains(&key(rule)));
    own
}

/// Prints the cells in which the best actions differ.
fn print_differences(
    plan: &Plan,
    first: &Knowledge,
    second: &Knowledge,
    out: &mut Results,
) -> Result<(), Failure> {
    let cells = plan
        .maze
        .free_cells()
        .filter(|&cell| !plan.maze.is_goal(cell));
    let pairs = cells.map(|cell| {
        (
            cell,
            [first, second].map(|knowledge| best_actions(plan, knowledge, cell)),
        )
    });
    let differing: Vec<_> = pairs.filter(|(_, [one, two])| one != two).collect();
    match differing.len() {
        0 => writeln!(out, "\nThe best actions are the same in every cell.")?,
        1 => writeln!(out, "\nThe best actions differ in 1 cell:")?,
        count => writeln!(out, "\nThe best actions differ in {count} cells:")?,
    }
    for (Cell { col, row }, [one, two]) in differing.iter().take(MOST_CELLS) {
        writeln!(
            out,
            "  {:<8} the first {one}, the second {two}",
            format!("{col},{row}")
        )?;
    }
    match differing.len().saturating_sub(MOST_CELLS) {
        0 => Ok(()),
        more => Ok(writeln!(out, "  and {more} more")?),
    }
}

/// Returns the best actions in a cell, in words.
fn best_actions(plan: &Plan, knowledge: &Knowledge, cell: Cell) -> String {
    let percept = plan.config.sensor.perceive_at(&plan.maze, cell);
    let values = knowledge.values(&percept, plan.maze.action_count());
    if values.greatest().is_none() {
        return "no action".to_owned();
    }
    let best = values
        .best_actions()
        .map(|action| plan.maze.action_name(action));
    best.collect::<Vec<_>>().join(" or ")
}
