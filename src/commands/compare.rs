//! `xcscr drive --compare`: compares the robot's profile with a recorded drive.

use std::collections::BTreeMap;
use std::path::Path;

use xcscr::ErrorKind;
use xcscr::drive::{Compared, DriveRecording, DriveSetup, compare};
use xcscr::trial::RobotProfile;

use super::failure::Failure;
use super::output::OutputFile;
use super::results::Results;
use super::robot;

/// Prints each value of the profile beside that of the drive. Writes a profile with the values of the
/// drive where they differ.
pub fn run(
    setup: DriveSetup,
    bag: &Path,
    fitted: Option<(RobotProfile, OutputFile<'_>)>,
    out: &mut Results,
) -> Result<(), Failure> {
    let rows = compare(setup, &DriveRecording::read(bag)?);
    print(&rows, out)?;
    if let Some((profile, file)) = fitted {
        file.write(robot::text(&profile, &values(&rows, bag)).as_bytes())?;
    }
    match rows.iter().filter(|row| row.differs).count() {
        0 => Ok(()),
        count => {
            let message = format!(
                "{count} of {} values of the profile differ from the drive",
                rows.len()
            );
            Err(Failure::new(ErrorKind::Refuted, message))
        }
    }
}

fn print(rows: &[Compared], out: &mut Results) -> Result<(), Failure> {
    writeln!(
        out,
        "{:32} {:>8} {:>8}  {:<18}",
        "value", "profile", "drive", "interval"
    )?;
    for row in rows {
        let Compared { name, profile, .. } = row;
        let Some(found) = row.found else {
            writeln!(
                out,
                "{name:32} {profile:8.4} {:>8}  {:<18} not seen",
                "-", ""
            )?;
            continue;
        };
        let [least, most] = [-1.0, 1.0].map(|side| found.value + side * found.within);
        let interval = format!("{least:.4} to {most:.4}");
        let verdict = if row.differs { "differs" } else { "agrees" };
        writeln!(
            out,
            "{name:32} {profile:8.4} {:8.4}  {interval:<18} {verdict}",
            found.value
        )?;
    }
    Ok(out.flush()?)
}

/// Returns the settings that differ, with their values in the drive and where these come from.
fn values<'a>(rows: &'a [Compared], bag: &Path) -> BTreeMap<&'a str, (String, String)> {
    let is_setting = |row: &&Compared| row.differs && row.name.starts_with("physics.");
    let value = |row: &'a Compared| {
        let found = row.found?;
        let source = format!("fitted to {}: within {:.2e}", bag.display(), found.within);
        Some((row.name, (format!("{:.6}", found.value.max(0.0)), source)))
    };
    rows.iter().filter(is_setting).filter_map(value).collect()
}
