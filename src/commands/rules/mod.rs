//! `xcscr rules`: what was learned, to be read.

mod diff;
mod why;

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;

use clap::ValueEnum;
use serde::Serialize;
use xcscr::agent::{CollisionRule, Foresight, Knowledge, PERCEPT_BITS, ReturnRule, memory_words};
use xcscr::sensor::{Sensor, action_name};
use xcscr::study::Table;
use xcscr::trial::{Condensed, MOST_PERCEPTS, Plan};
use xcscr::world::{Cell, Paths};
use xcscr::xcs::{Action, Percept};
use xcscr::xcs::{Classifier, Condition, Population};

use super::failure::{Exit, Failure};
use super::learned::LearnedArgs;

/// Arguments of `rules`.
#[derive(Debug, clap::Args)]
pub struct RulesArgs {
    #[command(flatten)]
    learned: LearnedArgs,
    /// Only the rules that match what the robot perceives in this cell.
    #[arg(long, value_name = "COL,ROW", value_parser = cell)]
    cell: Option<Cell>,
    /// Why the robot goes where it goes in this cell: the rules that vote, what would have to be
    /// different, and the episodes that made the strongest rule what it is.
    #[arg(long, value_name = "COL,ROW", value_parser = cell, conflicts_with_all = ["cell", "compact", "json", "csv"])]
    why: Option<Cell>,
    /// The rules that only one of the two has, and the cells in which they go different ways.
    #[arg(long, value_name = "RUN|RULES", conflicts_with_all = ["why", "cell", "compact", "json", "csv"])]
    diff: Option<PathBuf>,
    /// Order of the rules: largest first, except by error and action.
    #[arg(long, value_name = "BY", default_value = "covers")]
    sort: Order,
    /// Condense to few general rules that choose the same action for every percept of the world.
    #[arg(long)]
    compact: bool,
    /// Print a rules.json file, which `evaluate` and `train --init-rules` read.
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print a CSV table.
    #[arg(long)]
    csv: bool,
}

/// By what rules are ordered.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Order {
    /// Percepts of the world that it matches.
    Covers,
    Action,
    Worth,
    Error,
    Fitness,
    Numerosity,
    Experience,
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
pub fn run(args: &RulesArgs, out: &mut impl Write) -> Result<(), Failure> {
    let (plan, knowledge) = load(&args.learned)?;
    if let Some(cell) = args.why {
        perceived(&plan, cell)?;
        if plan.maze.is_goal(cell) {
            let message = format!("{},{} is a goal: an episode ends there", cell.col, cell.row);
            return Err(Failure::new(Exit::Usage, message));
        }
        return why::print(
            (&plan, &knowledge),
            cell,
            args.learned.can_be_repeated(),
            out,
        );
    }
    if let Some(other) = &args.diff {
        return diff::print((&plan, &knowledge), other, args.sort, out);
    }
    let here = args.cell.map(|cell| perceived(&plan, cell)).transpose()?;
    let condensed = args
        .compact
        .then(|| condense(&knowledge, &plan))
        .transpose()?;
    let all = knowledge.rules().map_or(&[][..], Population::rules);
    let shown = condensed
        .as_ref()
        .map_or(all, |condensed| condensed.rules.rules());
    let rows = rows(shown, (&plan, &knowledge), here.as_ref(), args.sort);
    if args.json {
        return print_json(&knowledge, condensed.is_some(), &rows, out);
    }
    if args.csv {
        return print_csv(rows, out);
    }
    writeln!(out, "{}", headline(&plan, &knowledge, condensed.as_ref()))?;
    if let Some(percept) = &here {
        writeln!(out, "  where the percept is {percept}")?;
    }
    writeln!(out, "\n{}", table(&rows).text().trim_end())?;
    match knowledge.foresight() {
        Some(foresight) => print_foresight(foresight, &plan, out),
        None => Ok(()),
    }
}

/// What was learned, if it is rules about the world of the plan.
fn load(learned: &LearnedArgs) -> Result<(Plan, Knowledge), Failure> {
    let (plan, knowledge) = learned.load(None)?;
    checked(&plan, &knowledge)?;
    Ok((plan, knowledge))
}

/// Accepts rules about the world of the plan.
fn checked(plan: &Plan, knowledge: &Knowledge) -> Result<(), Failure> {
    let Plan { maze, config } = plan;
    knowledge
        .check(config.sensor.width(maze), maze.action_count())
        .map_err(|misfit| Failure::new(Exit::BadData, misfit.to_string()))?;
    match knowledge.rules() {
        Some(_) => Ok(()),
        None => {
            let message = "what was learned is a table of a tabular method; it has no rules";
            Err(Failure::new(Exit::BadData, message))
        }
    }
}

fn condense(knowledge: &Knowledge, plan: &Plan) -> Result<Condensed, Failure> {
    let Plan { maze, config } = plan;
    let paths = Paths::with_slip(maze, config.settings.arena.slip);
    Condensed::new(knowledge, config.sensor, maze, &paths).ok_or_else(|| {
        let name = maze.name();
        let message = match knowledge.remembers() {
            true => "rules with a memory are condensed while they are learned".to_owned(),
            false => format!(
                "{name} has more than {MOST_PERCEPTS} percepts: too many to condense rules for"
            ),
        };
        Failure::new(Exit::BadData, message)
    })
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
        return Err(Failure::new(Exit::Usage, message));
    }
    Ok(config.sensor.perceive_at(maze, cell))
}

/// A rule as it is shown.
#[derive(Debug, Serialize)]
struct Row {
    condition: Condition,
    action: Action,
    #[serde(rename = "if")]
    words: String,
    go: String,
    covers: usize,
    prediction: f64,
    error: f64,
    fitness: f64,
    numerosity: u32,
    experience: u32,
    #[serde(skip)]
    rule: Classifier,
}

/// The rules that match a percept, or all, in the wanted order.
fn rows(
    rules: &[Classifier],
    (plan, knowledge): (&Plan, &Knowledge),
    here: Option<&Percept>,
    by: Order,
) -> Vec<Row> {
    let Plan { maze, config } = plan;
    // What rules with a memory look at where an episode begins.
    let percepts: Vec<Percept> = config.sensor.percepts(maze);
    let percepts: Vec<Percept> = percepts.iter().map(|p| knowledge.looked_at(p)).collect();
    let here = here.map(|percept| knowledge.looked_at(percept));
    let here = here.as_ref();
    let matches = |rule: &&Classifier| here.is_none_or(|percept| rule.condition.matches(percept));
    let row = |rule: &Classifier| Row {
        condition: rule.condition,
        action: rule.action,
        words: words(rule, plan, knowledge),
        go: action_name(maze, rule.action),
        covers: percepts
            .iter()
            .filter(|p| rule.condition.matches(p))
            .count(),
        prediction: rule.prediction,
        error: rule.error,
        fitness: rule.fitness,
        numerosity: rule.numerosity,
        experience: rule.experience,
        rule: *rule,
    };
    let mut rows: Vec<Row> = rules.iter().filter(matches).map(row).collect();
    match by {
        Order::Covers => rows.sort_by_key(|row| Reverse(row.covers)),
        Order::Action => rows.sort_by_key(|row| row.action),
        Order::Worth => rows.sort_by(|a, b| b.prediction.total_cmp(&a.prediction)),
        Order::Error => rows.sort_by(|a, b| a.error.total_cmp(&b.error)),
        Order::Fitness => rows.sort_by(|a, b| b.fitness.total_cmp(&a.fitness)),
        Order::Numerosity => rows.sort_by_key(|row| Reverse(row.numerosity)),
        Order::Experience => rows.sort_by_key(|row| Reverse(row.experience)),
    }
    rows
}

/// What a rule demands; of one with a memory also of the place and of the last steps.
fn words(rule: &Classifier, plan: &Plan, knowledge: &Knowledge) -> String {
    let Plan { maze, config } = plan;
    let allele = |at| rule.condition.allele(at);
    if !knowledge.remembers() {
        return config.sensor.words(maze, &allele);
    }
    let percept = |at| allele(at).filter(|_| at < PERCEPT_BITS);
    let mut words = vec![Sensor::Neighbours.words(maze, &percept)];
    let remembered = memory_words(&allele);
    if !remembered.is_empty() {
        words.retain(|word| word != "anything");
    }
    words.extend(remembered);
    words.join(", ")
}

fn print_json(
    knowledge: &Knowledge,
    condensed: bool,
    rows: &[Row],
    out: &mut impl Write,
) -> Result<(), Failure> {
    let rules: Vec<Classifier> = rows.iter().map(|row| row.rule).collect();
    let rules: Population = rules
        .try_into()
        .expect("some rules of a population form one");
    let shown = match knowledge {
        Knowledge::RulesOverMatchSet(_) if !condensed => Knowledge::RulesOverMatchSet(rules),
        Knowledge::Remembering { map, .. } => Knowledge::Remembering {
            rules,
            map: map.clone(),
        },
        _ => match knowledge.foresight().cloned() {
            Some(foresight) => Knowledge::Foresighted { rules, foresight },
            None => Knowledge::Rules(rules),
        },
    };
    Ok(writeln!(out, "{}", serde_json::to_string_pretty(&shown)?)?)
}

fn print_csv(rows: Vec<Row>, out: &mut impl Write) -> Result<(), Failure> {
    let mut table = csv::Writer::from_writer(out);
    for row in rows {
        table.serialize(row).map_err(std::io::Error::from)?;
    }
    Ok(table.flush()?)
}

fn headline(plan: &Plan, knowledge: &Knowledge, condensed: Option<&Condensed>) -> String {
    let (world, sensor, all) = (plan.maze.name(), plan.config.sensor.name(), knowledge.len());
    let Some(condensed) = condensed else {
        return format!("{world}, {sensor}: {all} rules");
    };
    let Condensed {
        rules,
        percepts,
        agreeing,
        optimal,
    } = condensed;
    let optimal = if *optimal {
        "globally optimal"
    } else {
        "not globally optimal"
    };
    format!(
        "{world}, {sensor}: {} rules, condensed from {all}\n  the same choice in {agreeing} of the \
         {percepts} percepts of the world that they know; the policy is {optimal}",
        rules.len()
    )
}

fn table(rows: &[Row]) -> Table {
    let mut table = Table::new([
        "if", "go", "covers", "worth", "error", "fitness", "num", "exp",
    ]);
    let cells = |row: &Row| {
        vec![
            row.words.clone(),
            row.go.clone(),
            row.covers.to_string(),
            format!("{:.1}", row.prediction),
            format!("{:.1}", row.error),
            format!("{:.2}", row.fitness),
            row.numerosity.to_string(),
            row.experience.to_string(),
        ]
    };
    table.rows = rows.iter().map(cells).collect();
    table
}

fn print_foresight(
    foresight: &Foresight,
    plan: &Plan,
    out: &mut impl Write,
) -> Result<(), Failure> {
    writeln!(out, "\nForeseen:")?;
    // Rules can differ in bits that no percept has, and read the same.
    let mut told = BTreeSet::new();
    let collisions = foresight
        .collisions
        .iter()
        .map(|rule| collision(rule, plan));
    for line in collisions.filter(|line| told.insert(line.clone())) {
        writeln!(out, "  {line}")?;
    }
    for ReturnRule { turn, hits, misses } in &foresight.returns {
        let (turn, all) = (turn.index(), hits + misses);
        let actions = plan.maze.action_count();
        let undoing = match 2 * turn == actions {
            true => "the opposite action".to_owned(),
            false => format!("the action {turn} places further round"),
        };
        writeln!(out, "  {undoing} undoes a move ({hits} of {all})")?;
    }
    Ok(())
}

fn collision(rule: &CollisionRule, plan: &Plan) -> String {
    let Plan { maze, config } = plan;
    let allele = |at| rule.condition.allele(at);
    let (who, when) = match rule.action {
        Some(action) => (
            action_name(maze, action),
            config.sensor.words(maze, &allele),
        ),
        None => (
            "any action".to_owned(),
            config.sensor.words_facing(maze, &allele),
        ),
    };
    let (hits, all) = (rule.hits, rule.hits + rule.misses);
    format!("{who} collides if {when} ({hits} of {all} percepts)")
}
