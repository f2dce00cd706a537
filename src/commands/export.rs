//! `xcscr export`: exports the policy as source code or data.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use xcscr::ErrorKind;
use xcscr::export::{Policy, Provenance, Target};

use super::failure::Failure;
use super::learned::{Learned, LearnedArgs};
use super::output::OutputFile;
use super::results::Results;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
pub struct ExportArgs {
    #[command(flatten)]
    learned: LearnedArgs,
    /// Format: source code that chooses the same actions as `evaluate`, or the rules as data.
    #[arg(long, value_parser = target())]
    target: Target,
    /// File to write [default: standard output].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the file if it exists.
    #[arg(long, requires = "output")]
    force: bool,
}

/// Parses a target by its name, or by the usual name of C.
fn target() -> impl TypedValueParser<Value = Target> {
    let value = |target: &Target| {
        let value = PossibleValue::new(target.name());
        if *target == Target::C99 {
            value.alias("c")
        } else {
            value
        }
    };
    PossibleValuesParser::new(Target::ALL.iter().map(value)).map(|text| {
        let named = Target::ALL.iter().find(|target| target.name() == text);
        named.copied().unwrap_or(Target::C99)
    })
}

/// Exports the policy.
pub fn run(args: &ExportArgs, out: &mut Results) -> Result<(), Failure> {
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
    let Learned {
        plan,
        knowledge,
        trained_cell_m,
    } = args.learned.load(None)?;
    let (maze, sensor) = (&plan.maze, plan.config.sensor);
    let cell_m = trained_cell_m.unwrap_or(maze.cell_size_m());
    if cell_m != maze.cell_size_m() {
        let message = format!(
            "the policy was trained in cells of {cell_m} m, but {} has cells of {} m: export it without `--world`",
            maze.name(),
            maze.cell_size_m()
        );
        return Err(Failure::new(ErrorKind::BadData, message));
    }
    if plan.config.settings.sensor.history > 0 {
        let message = "an exported policy does not keep the earlier steps (`sensor.history`): train without it, or use \
                       `evaluate`, which keeps them";
        return Err(Failure::new(ErrorKind::BadData, message));
    }
    let (width, actions) = (sensor.width(maze), maze.action_count());
    knowledge.check(sensor, maze)?;
    let knowledge = knowledge.with_fewest_rules(sensor, maze);
    let policy = Policy::new(&knowledge, width, actions, &sensor.percepts(maze))?;
    let origin = Provenance::new(&plan, &knowledge, args.learned.is_a_run());
    Ok(args.target.text(&policy, &origin))
}
