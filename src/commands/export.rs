//! `xcscr export`: the policy as source code or data.

use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::builder::TypedValueParser;
use xcscr::disk;
use xcscr::export::{Ballot, ExportError, Origin, Target};

use super::choices;
use super::failure::{Exit, Failure};
use super::learned::LearnedArgs;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
pub struct ExportArgs {
    #[command(flatten)]
    learned: LearnedArgs,
    /// What to write: source code that decides as `evaluate` does, or a table of the rules.
    #[arg(long, value_parser = target())]
    target: Target,
    /// The file to write [default: standard output].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the file if it exists.
    #[arg(long, requires = "output")]
    force: bool,
}

fn target() -> impl TypedValueParser<Value = Target> {
    choices::one_of(&Target::ALL, Target::name)
}

/// Writes the policy.
pub fn run(args: &ExportArgs, out: &mut impl Write) -> Result<(), Failure> {
    if let Some(file) = &args.output {
        disk::require_free(file, args.force).map_err(|cause| unwritten(file, &cause))?;
    }
    let text = text(args)?;
    match &args.output {
        Some(file) => write(file, &text, args.force).map_err(|cause| unwritten(file, &cause)),
        None => Ok(out.write_all(text.as_bytes())?),
    }
}

fn text(args: &ExportArgs) -> Result<String, Failure> {
    let (plan, knowledge) = args.learned.load(None)?;
    let (maze, sensor) = (&plan.maze, plan.config.sensor);
    let (width, actions) = (sensor.width(maze), maze.action_count());
    knowledge
        .check(width, actions)
        .map_err(|misfit| Failure::new(Exit::BadData, misfit.to_string()))?;
    let ballot = Ballot::new(&knowledge, width, actions, &sensor.percepts(maze))?;
    let origin = Origin::new(&plan, &knowledge, args.learned.is_a_run());
    Ok(args.target.text(&ballot, &origin))
}

/// Writes the file aside, and gives it its name when it is whole.
fn write(file: &Path, text: &str, force: bool) -> io::Result<()> {
    let mut aside = disk::aside(file)?;
    aside.write_all(text.as_bytes())?;
    disk::persist(aside, file, force)
}

fn unwritten(file: &Path, cause: &io::Error) -> Failure {
    let exit = match cause.kind() {
        ErrorKind::StorageFull | ErrorKind::FileTooLarge => Exit::Io,
        _ => Exit::CannotCreate,
    };
    let (name, way_out) = (file.display(), disk::way_out(cause));
    Failure::new(exit, format!("cannot write {name}: {cause}{way_out}"))
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        Self::new(Exit::BadData, error.to_string())
    }
}
