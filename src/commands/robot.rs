//! `xcscr robot`: lists, shows and checks robot profiles.

use std::path::PathBuf;

use clap::Subcommand;
use xcscr::arena::PhysicsArena;
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, PlanError, RobotProfile, Settings};
use xcscr::world::Maze;

use super::choices;
use super::failure::Failure;
use super::results::Results;
use super::terminal::write_words;

/// Subcommands of `robot`.
#[derive(Debug, Subcommand)]
pub enum RobotCommand {
    /// List the bundled profiles.
    List,
    /// Print a profile with the source of each value, as a file for `--robot`.
    Show {
        /// A bundled profile or a TOML file.
        #[arg(value_name = "NAME|FILE")]
        robot: String,
    },
    /// Check a profile, and whether the robot fits into a world.
    Check {
        /// A bundled profile or a TOML file.
        #[arg(value_name = "NAME|FILE")]
        robot: String,
        /// A world file.
        #[arg(long, value_name = "FILE")]
        world: Option<PathBuf>,
    },
}

/// Runs a subcommand of `robot`.
pub fn run(command: &RobotCommand, out: &mut Results) -> Result<(), Failure> {
    match command {
        RobotCommand::List => list(out),
        RobotCommand::Show { robot } => show(&RobotProfile::load(robot)?, out),
        RobotCommand::Check { robot, world } => {
            let profile = RobotProfile::load(robot)?;
            let maze = world
                .as_ref()
                .map(|file| choices::world(file))
                .transpose()?;
            check(&profile, maze, out)
        }
    }
}

fn list(out: &mut Results) -> Result<(), Failure> {
    for name in RobotProfile::bundled_names() {
        let profile = RobotProfile::load(name)?;
        writeln!(out, "{name:22} {}", profile.title())?;
    }
    Ok(())
}

fn show(profile: &RobotProfile, out: &mut Results) -> Result<(), Failure> {
    writeln!(out, "title = {}", profile.title_toml())?;
    for (key, value, source) in profile.entries() {
        let setting = format!("{key} = {value}");
        match source {
            // One line each, even if the file contains line breaks.
            Some(source) => {
                let source = source.replace(char::is_control, " ");
                writeln!(out, "{setting:42} # {source}")?;
            }
            None => writeln!(out, "{setting}")?,
        }
    }
    Ok(())
}

fn check(profile: &RobotProfile, maze: Option<Maze>, out: &mut Results) -> Result<(), Failure> {
    let physics = profile.settings_over(&Settings::default())?.physics;
    let least_m = physics.least_cell_m();
    let mut warnings = Vec::new();
    let fits = match maze {
        None => format!("it fits into cells of at least {least_m:.3} m"),
        Some(maze) => {
            // A plan with a sensor; the learner does not matter here.
            let plan = Plan::new(maze.clone()).sensor(Sensor::Lidar);
            let settings = Settings {
                physics: physics.clone(),
                ..Settings::default()
            };
            warnings = plan.settings(settings).robot_warnings();
            let size_m = maze.cell_size_m();
            let name = maze.name().to_owned();
            PhysicsArena::new(maze, physics.clone(), 1).map_err(PlanError::from)?;
            format!(
                "it fits into `{name}`, whose cells of {size_m:.3} m leave {:.3} m on each side; a move takes about {:.1} s",
                size_m / 2.0 - physics.radius_m,
                physics.move_time_s(size_m)
            )
        }
    };
    write_words(out, &format!("{} is valid: {fits}", profile.name()))?;
    for warning in warnings {
        write_words(out, &format!("warning: {warning}"))?;
    }
    Ok(())
}
