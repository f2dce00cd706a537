//! Rules as one HTML page.

use xcscr::page::{Block, Picture, Table, html};
use xcscr::picture::Scenes;
use xcscr::run::Rerun;
use xcscr::trial::{Plan, Why};
use xcscr::world::Cell;

use super::formats::{headline, table};
use super::listing::words;
use super::{Shown, predicted};
use crate::commands::failure::Failure;
use crate::commands::results::Results;

/// The most free cells of a maze that are listed.
const MOST_CELLS: usize = 400;

/// Prints the page. `is_run` is true if the run can be repeated, so that its policy can be drawn.
pub fn print(shown: &Shown<'_>, is_run: bool, out: &mut Results) -> Result<(), Failure> {
    let mut blocks = vec![Block::Text(headline(shown))];
    if let Some(percept) = &shown.here {
        blocks.push(Block::Text(format!("Only where the percept is {percept}.")));
    }
    if shown.plan.maze.is_too_large() {
        blocks.push(Block::Text(TOO_LARGE.to_owned()));
    } else if is_run {
        blocks.push(Block::Picture(policy(shown.plan)?));
    }
    blocks.push(Block::Heading("Rules".to_owned()));
    blocks.push(Block::Table(table(&shown.rows)));
    blocks.push(Block::Text(LEGEND.to_owned()));
    let predicted = predicted::lines(shown.knowledge, shown.plan);
    if !predicted.is_empty() {
        blocks.push(Block::Heading("Predicted".to_owned()));
        blocks.extend(predicted.into_iter().map(Block::Text));
    }
    add_cells(shown, &mut blocks);
    let title = format!("What was learned in {}", shown.plan.maze.name());
    Ok(write!(out, "{}", html(&title, &blocks))?)
}

/// The text that replaces the picture of the policy.
const TOO_LARGE: &str = "The maze has too many cells for a picture of its policy.";

/// The meaning of the columns.
const LEGEND: &str = "**if**: the condition; **covers**: percepts of this world that it matches; \
    **value**: the prediction of the reward; **error**: its mean absolute error; **fitness**: the \
    weight of its vote; **num**: numerosity, classifiers that the rule stands for; **exp**: how often \
    it was updated.";

/// Draws the policy over the maze after the last episode.
fn policy(plan: &Plan) -> Result<Picture, Failure> {
    Ok(Picture {
        name: "policy",
        caption: "The learned policy: arrows are the best actions, yellow far from the goal and purple near it",
        svg: Rerun::training(plan.clone()).animation(Scenes::Last)?.svg(),
    })
}

/// Adds the best actions in each cell, and the deciding rule.
fn add_cells(shown: &Shown<'_>, blocks: &mut Vec<Block>) {
    let maze = &shown.plan.maze;
    let cells: Vec<Cell> = maze
        .free_cells()
        .filter(|&cell| !maze.is_goal(cell))
        .collect();
    if shown.here.is_some() {
        return;
    }
    blocks.push(Block::Heading("In each cell".to_owned()));
    if cells.len() > MOST_CELLS {
        blocks.push(Block::Text(format!(
            "Not listed: this maze has {} free cells, and at most {MOST_CELLS} are listed. `xcscr rules RUN \
             --why COL,ROW` explains one cell.",
            cells.len()
        )));
        return;
    }
    let mut table = Table::new(["cell", "goes", "value", "because", "perceives"]);
    table.rows = cells.into_iter().map(|cell| row(shown, cell)).collect();
    blocks.push(Block::Table(table));
}

fn row(shown: &Shown<'_>, cell: Cell) -> Vec<String> {
    let (plan, knowledge) = (shown.plan, shown.knowledge);
    let why = Why::at(plan, knowledge, cell);
    let perceived = plan
        .config
        .sensor
        .words(&plan.maze, &|at| Some(why.percept.bit(at)));
    let best: Vec<String> = why
        .values
        .best_actions()
        .map(|action| plan.maze.action_name(action))
        .collect();
    vec![
        format!("{},{}", cell.col, cell.row),
        best.join(" or "),
        why.values
            .greatest()
            .map_or(String::new(), |values| format!("{values:.1}")),
        why.decisive().map_or("no rule matches".to_owned(), |rule| {
            words(rule, plan, knowledge)
        }),
        perceived,
    ]
}
