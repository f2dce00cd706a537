//! `xcscr robot`: lists and shows robot profiles.

use xcscr::trial::{RobotProfile, Settings};

use super::failure::Failure;
use super::results::Results;

/// Print a profile with the source of each value, as a file for `--robot`, or list the bundled profiles.
#[derive(Debug, clap::Args)]
pub struct RobotArgs {
    /// A bundled profile or a TOML file. Without it, the bundled profiles are listed.
    #[arg(value_name = "NAME|FILE")]
    robot: Option<String>,
}

/// Runs `robot show`.
pub fn run(args: &RobotArgs, out: &mut Results) -> Result<(), Failure> {
    match &args.robot {
        None => list(out),
        Some(robot) => show(&RobotProfile::load(robot)?, out),
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
    let least_m = profile
        .settings_over(&Settings::default())?
        .physics
        .least_cell_m();
    writeln!(out, "# It fits into cells of at least {least_m:.3} m.")?;
    Ok(write!(out, "{}", text(profile))?)
}

/// Returns a profile as a file for `--robot`.
fn text(profile: &RobotProfile) -> String {
    let mut text = profile.head_toml();
    for (key, value, source) in profile.entries() {
        let setting = format!("{key} = {value}");
        text += &match source {
            // One line each, even if the file contains line breaks.
            Some(source) => format!("{setting:42} # {}\n", source.replace(char::is_control, " ")),
            None => setting + "\n",
        };
    }
    text
}
