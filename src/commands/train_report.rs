//! The report of `train`.

use std::path::{Path, PathBuf};

use serde::Serialize;
use xcscr::agent::{Chosen, Method, RuleUpdates};
use xcscr::disk;
use xcscr::episode::PolicyMap;
use xcscr::record::RecordSummary;
use xcscr::run::RunFolder;
use xcscr::trial::{Compacted, Plan, Trial};
use xcscr::world::{Cell, Facts, Maze};

use super::failure::Failure;
use super::results::Results;
use super::terminal::{file_link, print_maze, write_link, write_row};

/// The legend of the drawn maze.
const LEGEND: &str = "→ best action   + several are equally good   ? nothing known   G goal";

/// The result of a training run, as `--json` prints it.
#[derive(Debug, Serialize)]
pub struct TrainReport {
    world: String,
    method: &'static str,
    arena: &'static str,
    sensor: &'static str,
    seed: u64,
    episodes: u32,
    /// The number of steps of a shortest path; `null` if episodes start anywhere.
    optimal_steps: Option<u32>,
    /// The number of shortest paths; `null` if episodes start anywhere.
    optimal_paths: Option<u64>,
    /// The mean number of steps of a shortest path, over all starts.
    #[serde(skip)]
    mean_optimal_steps: f64,
    first_optimal_episode: Option<u32>,
    first_optimal_env_steps: Option<u64>,
    first_executed_optimal_episode: Option<u32>,
    /// The number of steps of the greedy policy from the start; `null` if it does not reach a goal,
    /// or if episodes start anywhere.
    greedy_steps: Option<u32>,
    /// True if the greedy policy is globally optimal at the end.
    retained: bool,
    /// Episodes after which the greedy policy was globally optimal.
    optimal_episodes: u32,
    /// Episodes that reached a goal.
    reached_goal: u32,
    steps: u64,
    collisions: u64,
    /// Contacts after which the short-term filter lowered a value.
    filter_firings: u64,
    /// Episodes after which a policy was imprinted.
    imprintings: u32,
    /// The number of updates of rules, by their source.
    updates: RuleUpdates,
    /// The step limit of the first episode, and of the next one.
    step_limit: [u32; 2],
    /// The number of steps by decision source.
    chosen: Chosen,
    /// The same, until the greedy policy was first globally optimal.
    chosen_before: Chosen,
    rules: usize,
    /// The unit of `rules`: rules, pairs of a table, or beliefs of a plan.
    #[serde(skip)]
    counted: &'static str,
    /// The number of the fewest rules that keep all decisions; `null` for a table, and in large worlds.
    fewest_rules: Option<usize>,
    run_dir: String,
    #[serde(skip)]
    folder: PathBuf,
}

impl TrainReport {
    /// Summarises a finished trial with its files in `folder`.
    pub fn new(trial: &Trial, folder: &Path) -> Self {
        let (plan, progress) = (trial.plan(), trial.progress());
        let (maze, config) = (&plan.maze, &plan.config);
        let facts = Facts::new(maze);
        let path = trial.greedy_path();
        let knowledge = trial.method().knowledge();
        Self {
            world: facts.world,
            method: config.method.name(),
            arena: config.arena.name(),
            sensor: config.sensor.name(),
            seed: config.seed,
            episodes: progress.episodes,
            optimal_steps: facts.optimal_steps,
            optimal_paths: facts.optimal_paths,
            mean_optimal_steps: facts.mean_optimal_steps,
            first_optimal_episode: progress.first_optimal_episode,
            first_optimal_env_steps: progress.first_optimal_env_steps,
            first_executed_optimal_episode: progress.first_executed_optimal_episode,
            greedy_steps: path
                .filter(|path| path.last().is_some_and(|&cell| maze.is_goal(cell)))
                .map(|path| path.len() as u32 - 1),
            retained: progress.optimal,
            optimal_episodes: progress.optimal_episodes,
            reached_goal: progress.reached_goal,
            steps: progress.steps,
            collisions: progress.collisions,
            filter_firings: progress.filter_firings,
            imprintings: progress.imprintings,
            updates: progress.rule_updates,
            step_limit: [
                config.settings.reward.step_threshold,
                trial.method().step_threshold(),
            ],
            chosen: progress.chosen,
            chosen_before: progress.chosen_before,
            rules: trial.method().rule_count(),
            counted: knowledge.counts(),
            fewest_rules: Compacted::new(&knowledge, config.perception(), maze, trial.paths())
                .map(|few| few.rules.len()),
            run_dir: disk::named(folder),
            folder: folder.to_owned(),
        }
    }

    /// Prints the report as text.
    pub fn print(
        &self,
        trial: &Trial,
        recording: &RecordSummary,
        out: &mut Results,
    ) -> Result<(), Failure> {
        // The picture comes first, so that the rest stays visible on a terminal of 24 lines.
        let maze = &trial.plan().maze;
        match maze.is_too_large() {
            true => writeln!(out, "The maze is too large to be drawn.\n")?,
            false => {
                out.flush()?;
                let drawn = picture(maze, &trial.policy());
                print_maze(&format!("{drawn}{LEGEND}\n"))?;
            }
        }
        writeln!(out, "{}", self.headline())?;
        write_row(out, "shortest path", self.shortest_path())?;
        write_row(out, "first optimal", self.first_optimal())?;
        write_row(out, "policy optimal", self.optimal_after())?;
        write_row(out, "greedy policy", self.greedy())?;
        self.print_failure(trial, out)?;
        write_row(out, "reached the goal", self.arrivals())?;
        let counts = format!("{}, {}", self.steps, self.collisions);
        write_row(out, "steps, contacts", counts)?;
        self.print_mechanisms(out)?;
        write_row(out, "steps chosen by", self.chosen)?;
        write_row(out, self.counted, self.rule_counts())?;
        if let Some(advice) = self.advice(trial) {
            write_row(out, "what helps", advice)?;
        }
        self.print_files(recording, out)
    }

    /// Prints what the mechanisms of the paper did, if the method has them.
    fn print_mechanisms(&self, out: &mut Results) -> Result<(), Failure> {
        let [first, next] = self.step_limit;
        let firings = self.filter_firings;
        let RuleUpdates { experience, model } = self.updates;
        let rows = [
            (
                firings > 0,
                "short-term filter",
                format!("lowered a value after {firings} contacts"),
            ),
            (
                self.imprintings > 0,
                "imprinting",
                format!("after {} failures", self.imprintings),
            ),
            (first != next, "step limit", format!("{first} -> {next}")),
            (
                experience + model > 0,
                "updates of rules",
                format!("{experience} from experience, {model} from the model"),
            ),
        ];
        for (_, name, text) in rows.into_iter().filter(|(shown, ..)| *shown) {
            write_row(out, name, text)?;
        }
        Ok(())
    }

    /// Returns what to try if the policy is not optimal at the end.
    fn advice(&self, trial: &Trial) -> Option<String> {
        if self.retained {
            return None;
        }
        let Plan { maze, config } = trial.plan();
        if config.settings.sensor.history == 0 && config.sensor.misleads(maze, trial.paths()) {
            let sensor = config.sensor.with_position().name();
            return Some(format!("`--sensor {sensor}`: some cells share a percept"));
        }
        let plus = Method::XcscrPlus.name();
        Some(match self.reached_goal {
            _ if self.chosen.planner > 0 => "more episodes".to_owned(),
            0 => format!("`--method {plus}`: the way is too long for chance"),
            _ => {
                format!("`--method {plus}`, or more episodes")
            }
        })
    }

    fn optimal_after(&self) -> String {
        format!(
            "after {} of {} episodes",
            self.optimal_episodes, self.episodes
        )
    }

    /// Describes how many episodes reached a goal. Exploring steps lead away from it, so a reader must see them together.
    fn arrivals(&self) -> String {
        let arrivals = format!("in {} of {} episodes", self.reached_goal, self.episodes);
        let explored = self.chosen.planner + self.chosen.chance;
        if explored == 0 {
            return arrivals;
        }
        let share = 100.0 * explored as f64 / self.steps as f64;
        format!("{arrivals}, exploring in {share:.0} % of the steps")
    }

    fn rule_counts(&self) -> String {
        match self.fewest_rules {
            Some(few) => format!("{few} of {} are enough for all decisions", self.rules),
            None => self.rules.to_string(),
        }
    }

    fn headline(&self) -> String {
        let Self {
            world,
            method,
            arena,
            sensor,
            seed,
            episodes,
            ..
        } = self;
        let s = if *episodes == 1 { "" } else { "s" };
        format!(
            "{world}: method {method}, arena {arena}, sensor {sensor}, seed {seed}, {episodes} episode{s}"
        )
    }

    fn shortest_path(&self) -> String {
        let fixed = self.optimal_steps.zip(self.optimal_paths);
        let Some((steps, paths)) = fixed else {
            let mean = self.mean_optimal_steps;
            return format!("{mean:.2} steps on average; episodes start in random cells");
        };
        match paths {
            1 => format!("{steps} steps, 1 such path"),
            u64::MAX => format!("{steps} steps, countless such paths"),
            _ => format!("{steps} steps, {paths} such paths"),
        }
    }

    fn first_optimal(&self) -> String {
        let first = self.first_optimal_episode.zip(self.first_optimal_env_steps);
        first.map_or("never globally optimal".to_owned(), |(episode, steps)| {
            format!("after episode {episode} ({steps} steps)")
        })
    }

    fn greedy(&self) -> String {
        let steps = self.greedy_steps.map(|steps| format!("{steps} steps"));
        let globally = if self.retained {
            "globally optimal"
        } else {
            "not globally optimal"
        };
        steps.map_or(globally.to_owned(), |steps| format!("{steps}, {globally}"))
    }

    /// Prints where the greedy policy leads if it is not optimal and episodes start in one cell, and
    /// what to try.
    fn print_failure(&self, trial: &Trial, out: &mut Results) -> Result<(), Failure> {
        if self.retained {
            return Ok(());
        }
        let maze = &trial.plan().maze;
        if let Some(path) = trial.greedy_path() {
            write_row(out, "it takes", course(&path, maze))?;
        }
        if let Some((one, other)) = aliased_cells(trial) {
            let cells = format!("{one} and {other}; `world info` lists all");
            write_row(out, "same percept", cells)?;
        }
        Ok(())
    }

    fn print_files(&self, recording: &RecordSummary, out: &mut Results) -> Result<(), Failure> {
        let files = recording.files.len();
        if files == 0 {
            return Ok(writeln!(
                out,
                "Saved in {}; nothing was recorded.",
                self.run_dir
            )?);
        }
        let megabytes = recording.bytes as f64 / 1e6;
        let (dir, typed) = (&self.run_dir, disk::typed(&self.folder));
        writeln!(out, "Recorded {files} files, {megabytes:.1} MB, in {dir}.")?;
        if let Some(page) = RunFolder::open(&self.folder).page() {
            writeln!(out, "Watch how it learned, in a browser:")?;
            write_link("", &file_link(&page), out)?;
        }
        if let Some(picture) = RunFolder::open(&self.folder).picture() {
            writeln!(
                out,
                "The value of every action, at three stages of learning:"
            )?;
            write_link("", &file_link(&picture), out)?;
        }
        Ok(writeln!(
            out,
            "In Foxglove or Lichtblick:\n  xcscr replay {typed}"
        )?)
    }
}

/// Returns the first two cells with the same percept.
fn aliased_cells(trial: &Trial) -> Option<(String, String)> {
    let Plan { maze, config } = trial.plan();
    let has_history = config.settings.sensor.history > 0;
    let groups = match maze.is_too_large() || has_history {
        true => Vec::new(),
        false => config.sensor.aliased_cells(maze),
    };
    let named = |cell: &Cell| format!("{},{}", cell.col, cell.row);
    let cells = &groups.first()?.cells;
    Some((named(&cells[0]), named(&cells[1])))
}

/// Describes where the greedy policy leads.
fn course(path: &[Cell], maze: &Maze) -> String {
    let (steps, end) = (path.len() - 1, path[path.len() - 1]);
    let Cell { col, row } = end;
    let s = if steps == 1 { "" } else { "s" };
    match () {
        () if maze.is_goal(end) => format!("{steps} step{s} to the goal"),
        () if path[..steps].contains(&end) => format!("{steps} steps, then goes in circles"),
        () => format!("{steps} step{s}, then is stuck at ({col},{row})"),
    }
}

/// Draws the best actions of a policy as arrows over the maze: `+` where several tie, `?` where
/// nothing is known.
fn picture(maze: &Maze, policy: &PolicyMap) -> String {
    maze.drawn(|cell| {
        let mut best = policy.values(cell)?.best_actions();
        let arrow = best.next().and_then(|action| maze.direction(action));
        let ties = best.next().is_some();
        Some(arrow.map_or('?', |direction| if ties { '+' } else { direction.arrow() }))
    })
}
