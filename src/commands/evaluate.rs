//! `xcscr evaluate`: evaluates the greedy policy.

use xcscr::agent::Knowledge;
use xcscr::arena::ArenaKind;
use xcscr::run;
use xcscr::study::{ConditionResult, Robustness};
use xcscr::trial::{Evaluation, Plan};
use xcscr::{Error, ErrorKind};

use super::choices::{self, SettingsArgs};
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::learned::{Learned, LearnedArgs};
use super::output::print_json;
use super::results::Results;
use super::terminal::write_row;

/// Arguments of `evaluate`.
#[derive(Debug, clap::Args)]
pub struct EvaluateArgs {
    #[command(flatten)]
    learned: LearnedArgs,
    /// Arena to use instead of the run's own.
    #[arg(long, value_parser = choices::arena())]
    arena: Option<ArenaKind>,
    /// Number of episodes; with `--robustness`, in each condition.
    #[arg(long, default_value_t = 100, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    episodes: u32,
    /// Root seed of start cells and noise.
    #[arg(long, default_value_t = 1, value_name = "S", value_parser = choices::seed)]
    seed: u64,
    #[command(flatten)]
    settings: SettingsArgs,
    /// Exit with code 1 unless every episode takes a shortest path. Where moves slip, exit with
    /// code 1 unless every chosen action is one of the best.
    #[arg(long)]
    require_optimal: bool,
    /// Evaluate under noise 0 to 5, action slip, observation noise, slippery floors, sensor faults,
    /// and in worlds from maps with a box on the route. Print one table.
    #[arg(long, conflicts_with = "require_optimal")]
    robustness: bool,
    /// Print one JSON document instead of the report.
    #[arg(long)]
    json: bool,
}

impl EvaluateArgs {
    fn plan(&self) -> Result<(Plan, Knowledge), Failure> {
        let Learned {
            mut plan,
            knowledge,
            ..
        } = self.learned.load(self.arena)?;
        let config = &mut plan.config;
        config.seed = self.seed;
        config.arena = self.arena.unwrap_or(config.arena);
        let resolved = self.settings.resolve(&config.settings)?;
        config.settings = resolved.settings;
        Ok((plan, knowledge))
    }
}

/// Evaluates the policy and reports the result.
pub fn run(args: &EvaluateArgs, out: &mut Results) -> Result<(), Failure> {
    let (plan, knowledge) = args.plan()?;
    let interrupt = Interrupt::watch(interrupted)?;
    let stop = || interrupt.came();
    if args.robustness {
        let found = Robustness::run(&plan, &knowledge, args.episodes, &stop);
        let found = found.map_err(again)?;
        return if args.json {
            print_json(&found, out)
        } else {
            print_robustness(&found, &knowledge, out)
        };
    }
    let evaluation = run::evaluate(&plan, &knowledge, args.episodes, &stop).map_err(again)?;
    if args.json {
        print_json(&evaluation, out)?
    } else {
        print(&evaluation, &plan, &knowledge, out)?
    }
    if args.require_optimal && !evaluation.is_optimal() {
        let (optimal, episodes) = (evaluation.optimal, evaluation.episodes);
        let how = if plan.config.settings.arena.slip > 0.0 {
            "chose only best actions"
        } else {
            "took a shortest path"
        };
        let message = format!("{optimal} of {episodes} episodes {how}");
        return Err(Failure::new(ErrorKind::Refuted, message));
    }
    Ok(())
}

fn interrupted() -> Failure {
    let message = "interrupted; run the same command again";
    Failure::new(ErrorKind::Interrupted, message)
}

/// Adds what to do to the error of an evaluation.
fn again(error: Error) -> Failure {
    match error.kind() {
        ErrorKind::Interrupted => interrupted(),
        _ => error.into(),
    }
}

fn print(
    e: &Evaluation,
    plan: &Plan,
    knowledge: &Knowledge,
    out: &mut Results,
) -> Result<(), Failure> {
    // Where moves slip, the fewest steps are not a meaningful reference.
    let (optimally, best) = if plan.config.settings.arena.slip > 0.0 {
        ("only best actions", "expected at best")
    } else {
        ("by a shortest path", "shortest")
    };
    let (world, arena, noise, seed) = (&e.world, &e.arena, e.noise, e.seed);
    let (count, counted, episodes) = (knowledge.len(), knowledge.counts(), e.episodes);
    writeln!(
        out,
        "{world}: greedy policy of {count} {counted} on {arena}, noise {noise}, seed {seed}, {episodes} episodes"
    )?;
    let share = |count: u32| {
        let percent = 100.0 * f64::from(count) / f64::from(episodes);
        format!("{count} ({percent:.1} %)")
    };
    write_row(out, "reached the goal", share(e.successes))?;
    write_row(out, optimally, share(e.optimal))?;
    let (steps, fewest) = (e.mean_steps, e.mean_optimal_steps);
    let steps = format!("{steps:.2} ({best} {fewest:.2})");
    write_row(out, "steps per episode", steps)?;
    write_row(out, "collisions", e.collisions)?;
    let seconds = format!("{:.2} s simulated", e.mean_seconds);
    Ok(write_row(out, "time per episode", seconds)?)
}

fn print_robustness(
    found: &Robustness,
    knowledge: &Knowledge,
    out: &mut Results,
) -> Result<(), Failure> {
    let (count, counted) = (knowledge.len(), knowledge.counts());
    let (world, arena, seed) = (&found.world, found.arena, found.seed);
    writeln!(
        out,
        "{world}: greedy policy of {count} {counted} on {arena}, seed {seed}"
    )?;
    writeln!(
        out,
        "condition               episodes   reached the goal    steps  collisions  lost"
    )?;
    for result in &found.conditions {
        print_condition(result, out)?;
    }
    writeln!(
        out,
        "Reached the goal: % of the episodes, with Wilson's 95 % interval. Steps and\n\
         collisions: means of an episode. Lost: episodes in which the robot was in\n\
         another cell than its estimate."
    )?;
    let mut left_out = found.left_out.as_slice();
    while let Some(first) = left_out.first() {
        let same = left_out.iter().take_while(|l| l.reason == first.reason);
        let names: Vec<String> = same.map(|l| l.condition.to_string()).collect();
        left_out = &left_out[names.len()..];
        writeln!(out, "Left out, because {}:", first.reason)?;
        for line in names.chunks(4) {
            writeln!(out, "  {}", line.join(", "))?;
        }
    }
    Ok(())
}

fn print_condition(result: &ConditionResult, out: &mut Results) -> Result<(), Failure> {
    let [share, low, high] = [
        result.success.value,
        result.success.low,
        result.success.high,
    ]
    .map(|s| 100.0 * s);
    let lost = result
        .mislocalised_episodes
        .map_or("-".to_owned(), |episodes| episodes.to_string());
    let (condition, episodes) = (result.condition, result.episodes);
    let (steps, collisions) = (result.mean_steps, result.collisions_per_episode);
    writeln!(
        out,
        "{condition:<24}{episodes:>8}  {share:>5.1} ({low:>5.1}-{high:>5.1})  {steps:>7.2}  \
         {collisions:>10.2}  {lost:>4}"
    )?;
    Ok(())
}
