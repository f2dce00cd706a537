//! `xcscr export`: exports the policy as source code or data.

use std::io::Write;
use std::path::PathBuf;

use clap::builder::TypedValueParser;
use xcscr::export::{Policy, Provenance, Target};

use super::choices;
use super::failure::Failure;
use super::learned::LearnedArgs;
use super::output::OutputFile;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
pub struct ExportArgs {
    #[command(flatten)]
    learned: LearnedArgs,
    /// Format: source code that chooses the same actions as `evaluate`, including the maps of rules
    /// that use maps, or the rules as data.
    #[arg(long, value_parser = target())]
    target: Target,
    /// File to write [default: standard output].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the file if it exists.
    #[arg(long, requires = "output")]
    force: bool,
}

fn target() -> impl TypedValueParser<Value = Target> {
    choices::one_of(Target::ALL, Target::name)
}

/// Exports the policy.
pub fn run(args: &ExportArgs, out: &mut impl Write) -> Result<(), Failure> {
    let asked = args.output.as_deref();
    let file = asked.map(|path| OutputFile::free(path, args.force));
    let file = file.transpose()?;
    let text = text(args)?;
    match file {
        Some(file) => file.write(text.as_bytes()),
        None => Ok(out.write_all(text.as_bytes())?),
    }
}

fn text(args: &ExportArgs) -> Result<String, Failure> {
    let (plan, knowledge) = args.learned.load(None)?;
    let (maze, sensor) = (&plan.maze, plan.config.sensor);
    let (width, actions) = (sensor.width(maze), maze.action_count());
    knowledge.check(width, actions)?;
    let policy = Policy::new(&knowledge, width, actions, &sensor.percepts(maze))?;
    let origin = Provenance::new(&plan, &knowledge, args.learned.is_a_run());
    Ok(args.target.text(&policy, &origin))
}
