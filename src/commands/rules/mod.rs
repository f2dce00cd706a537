//! `xcscr rules`: prints the learned rules.

mod formats;
mod listing;
mod why;

use xcscr::ErrorKind;
use xcscr::agent::Knowledge;
use xcscr::trial::{Compacted, Plan};
use xcscr::world::{Cell, Paths};
use xcscr::xcs::{Percept, Population};

use listing::Order;

use super::failure::Failure;
use super::learned::LearnedArgs;
use super::results::Results;

/// Arguments of `rules`.
#[derive(Debug, clap::Args)]
pub struct RulesArgs {
    #[command(flatten)]
    learned: LearnedArgs,
    /// Print only the rules that match the percept in this cell.
    #[arg(long, value_name = "COL,ROW", value_parser = cell)]
    cell: Option<Cell>,
    /// Explain the choice in this cell: the rules that match, the changes of the percept that
    /// would change the choice, and the episodes that shaped the strongest rule.
    #[arg(long, value_name = "COL,ROW", value_parser = cell, conflicts_with_all = ["cell", "all", "json", "csv"])]
    why: Option<Cell>,
    /// Sort the rules by this column: largest first, except error and action.
    #[arg(long, value_name = "BY", default_value = "covers")]
    sort: Order,
    /// Print all rules of the population, not only the fewest that keep all decisions.
    #[arg(long)]
    all: bool,
    /// Print a rules.json file, which `evaluate` and `train --init-rules` read.
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print a CSV table.
    #[arg(long)]
    csv: bool,
}

fn cell(text: &str) -> Result<Cell, String> {
    let numbers = text.split_once(',').and_then(|(col, row)| {
        let cell = Cell {
            col: col.trim().parse().ok()?,
            row: row.trim().parse().ok()?,
        };
        Some(cell)
    });
    numbers.ok_or_else(|| "expected column and row from 0, such as 3,1".to_owned())
}

/// Prints the rules.
pub fn run(args: &RulesArgs, out: &mut Results) -> Result<(), Failure> {
    let (plan, knowledge) = load(&args.learned)?;
    if let Some(cell) = args.why {
        perceived(&plan, cell)?;
        if plan.maze.is_goal(cell) {
            let message = format!("{},{} is a goal: an episode ends there", cell.col, cell.row);
            return Err(Failure::new(ErrorKind::Usage, message));
        }
        let few = knowledge.with_fewest_rules(plan.config.perception(), &plan.maze);
        return why::print((&plan, &few), cell, args.learned.can_be_repeated(), out);
    }
    let here = args.cell.map(|cell| perceived(&plan, cell)).transpose()?;
    let compacted = if args.all {
        None
    } else {
        compact(&knowledge, &plan)
    };
    let all = knowledge.rules().map_or(&[][..], Population::rules);
    let rules = compacted
        .as_ref()
        .map_or(all, |compacted| compacted.rules.rules());
    let shown = Shown {
        rows: listing::rows(rules, (&plan, &knowledge), here.as_ref(), args.sort),
        plan: &plan,
        knowledge: &knowledge,
        compacted: compacted.as_ref(),
        here,
    };
    match (args.json, args.csv) {
        (true, _) => formats::json(&shown, out),
        (_, true) => formats::csv(shown.rows, out),
        _ => formats::text(&shown, out),
    }
}

/// The content to print.
struct Shown<'a> {
    plan: &'a Plan,
    knowledge: &'a Knowledge,
    compacted: Option<&'a Compacted>,
    /// The percept that the rules must match, if any.
    here: Option<Percept>,
    rows: Vec<listing::Row>,
}

/// Loads rules that fit the world of the plan.
fn load(learned: &LearnedArgs) -> Result<(Plan, Knowledge), Failure> {
    let (plan, knowledge) = learned.load(None)?;
    checked(&plan, &knowledge)?;
    Ok((plan, knowledge))
}

/// Accepts only rules that fit the world of the plan.
fn checked(plan: &Plan, knowledge: &Knowledge) -> Result<(), Failure> {
    let Plan { maze, config } = plan;
    knowledge.check(config.perception(), maze)?;
    let message = match knowledge {
        _ if knowledge.rules().is_some() => return Ok(()),
        _ => "what was learned is a table of a tabular method; it has no rules",
    };
    Err(Failure::new(ErrorKind::BadData, message))
}

/// Returns the fewest rules that keep all decisions; `None` if the world has too many percepts.
fn compact(knowledge: &Knowledge, plan: &Plan) -> Option<Compacted> {
    let Plan { maze, config } = plan;
    let paths = Paths::with_slip(maze, config.settings.arena.slip);
    Compacted::new(knowledge, config.perception(), maze, &paths)
}

fn perceived(plan: &Plan, cell: Cell) -> Result<Percept, Failure> {
    let Plan { maze, config } = plan;
    if maze.is_wall(cell) {
        let message = format!(
            "there is no free cell {},{} in {}",
            cell.col,
            cell.row,
            maze.name()
        );
        return Err(Failure::new(ErrorKind::Usage, message));
    }
    Ok(config.perception().at(maze, cell))
}
