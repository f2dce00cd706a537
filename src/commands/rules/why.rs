//! `xcscr rules --why`: explains the choice in a cell.

use xcscr::page::Table;
use xcscr::trial::{Plan, WeightedRule, Why};
use xcscr::world::Cell;
use xcscr::xcs::{Action, Classifier};

use crate::commands::failure::Failure;
use crate::commands::results::Results;
use crate::commands::terminal::write_words;
use xcscr::agent::Knowledge;

/// The most rules that are shown for one action.
const MOST_VOTES: usize = 5;

/// Prints the explanation.
pub fn print(
    plan: &Plan,
    knowledge: &Knowledge,
    cell: Cell,
    out: &mut Results,
) -> Result<(), Failure> {
    let Plan { maze, config } = plan;
    let why = Why::at(plan, knowledge, cell);
    let (world, sensor) = (maze.name(), config.sensor);
    writeln!(
        out,
        "{world}, {}, cell {},{}",
        sensor.name(),
        cell.col,
        cell.row
    )?;
    let perceived = sensor.words(maze, &why.percept);
    write_words(out, &format!("  perceives   {perceived}"))?;
    write_words(out, &format!("  goes        {}", choice(plan, &why)))?;
    print_votes(plan, &why, out)
}

/// Formats the best actions, and the value of each action.
fn choice(plan: &Plan, why: &Why) -> String {
    let name = |action| plan.maze.action_name(action);
    let best: Vec<String> = why.values.best_actions().map(name).collect();
    let all = Action::all(plan.maze.action_count());
    let mut known: Vec<(f64, Action)> = all
        .filter_map(|action| Some((why.values.get(action)?, action)))
        .collect();
    known.sort_by(|a, b| b.0.total_cmp(&a.0));
    let rated = known
        .iter()
        .map(|&(values, action)| format!("{} {values:.1}", name(action)));
    let rated: Vec<String> = rated.collect();
    if rated.is_empty() {
        "anywhere, because no rule matches".to_owned()
    } else {
        format!("{}   (values: {})", best.join(" or "), rated.join(", "))
    }
}

/// Prints the strongest matching rules.
fn print_votes(plan: &Plan, why: &Why, out: &mut Results) -> Result<(), Failure> {
    let (mut shown, mut more): (Vec<&WeightedRule>, Vec<String>) = Default::default();
    for votes in why.votes.chunk_by(|a, b| a.rule.action == b.rule.action) {
        let (first, rest) = votes.split_at(votes.len().min(MOST_VOTES));
        shown.extend(first);
        if let [vote, ..] = rest {
            let name = plan.maze.action_name(vote.rule.action);
            more.push(format!("{} for {name}", rest.len()));
        }
    }
    if shown.is_empty() {
        return Ok(());
    }
    let table = Table::of(
        shown,
        &[
            ("if", &|vote| words(&vote.rule, plan)),
            ("go", &|vote| plan.maze.action_name(vote.rule.action)),
            ("value", &|vote| format!("{:.1}", vote.rule.prediction)),
            ("share", &|vote| format!("{:.0} %", 100.0 * vote.share)),
            ("error", &|vote| format!("{:.1}", vote.rule.error)),
            ("num", &|vote| vote.rule.numerosity.to_string()),
            ("exp", &|vote| vote.rule.experience.to_string()),
        ],
    );
    writeln!(
        out,
        "\nRules that match, and their share in the value of their action:"
    )?;
    writeln!(out, "\n{}", table.text().trim_end())?;
    if more.is_empty() {
        Ok(())
    } else {
        Ok(writeln!(
            out,
            "and with smaller shares {}",
            more.join(", ")
        )?)
    }
}

/// Describes the demands of a rule in words.
fn words(rule: &Classifier, plan: &Plan) -> String {
    plan.config.sensor.words(&plan.maze, &rule.condition)
}
