//! `xcscr rules`: prints the learned rules.

mod formats;
mod listing;
mod why;

use xcscr::ErrorKind;
use xcscr::trial::{Compacted, Plan};
use xcscr::world::{Cell, Maze, Paths};

use super::failure::Failure;
use super::learned::{Learned, LearnedArgs};
use super::results::Results;

/// Arguments of `rules`.
#[derive(Debug, clap::Args)]
pub struct RulesArgs {
    #[command(flatten)]
    learned: LearnedArgs,
    /// Explain the choice in this cell: the rules that match, and their values.
    #[arg(long, value_name = "COL,ROW", value_parser = cell, conflicts_with_all = ["all", "json", "csv"])]
    why: Option<Cell>,
    /// Print all rules of the population, not only the fewest that make the same decisions.
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
    let Learned {
        plan, knowledge, ..
    } = args.learned.load(None)?;
    let Plan { maze, config } = &plan;
    knowledge.check(config.perception(), maze)?;
    let Some(all) = knowledge.rules() else {
        let message = "what was learned is a table of a tabular method; it has no rules";
        return Err(Failure::new(ErrorKind::BadData, message));
    };
    if let Some(cell) = args.why {
        require_decision(maze, cell)?;
        let few = knowledge.with_fewest_rules(config.perception(), maze);
        return why::print(&plan, &few, cell, out);
    }
    let compacted = if args.all {
        None
    } else {
        let paths = Paths::with_slip(maze, config.settings.arena.slip);
        Compacted::new(&knowledge, config.perception(), maze, &paths)
    };
    let shown = compacted.as_ref().map_or(all, |few| &few.rules);
    let rows = listing::rows(shown.rules(), &plan, &knowledge);
    match (args.json, args.csv) {
        (true, _) => formats::json(&rows, &knowledge, out),
        (_, true) => formats::csv(rows, out),
        _ => {
            let headline = formats::headline(&plan, all.len(), compacted.as_ref());
            formats::text(&headline, &rows, out)
        }
    }
}

/// Requires a cell in which the robot decides: a free one that is not a goal.
fn require_decision(maze: &Maze, cell: Cell) -> Result<(), Failure> {
    let Cell { col, row } = cell;
    let message = match maze.is_wall(cell) {
        true => format!("there is no free cell {col},{row} in {}", maze.name()),
        false if maze.is_goal(cell) => format!("{col},{row} is a goal: an episode ends there"),
        false => return Ok(()),
    };
    Err(Failure::new(ErrorKind::Usage, message))
}
