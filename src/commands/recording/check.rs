//! `xcscr recording check`: checks recordings for damage.

use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::record;

use crate::commands::failure::Failure;
use crate::commands::output::print_json;
use crate::commands::results::Results;
use crate::commands::source;
use crate::commands::terminal::write_words;

/// Arguments of `recording check`.
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    /// Recordings (.mcap), or folders of runs.
    #[arg(required = true, value_name = "FILE|RUN")]
    files: Vec<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// The findings in one file, as `--json` prints them.
#[derive(serde::Serialize)]
struct Checked {
    file: String,
    sound: bool,
    findings: Vec<String>,
}

/// Checks every file and reports the findings.
pub fn run(args: &CheckArgs, out: &mut Results) -> Result<(), Failure> {
    let mut checked = Vec::new();
    for file in source::all_recordings(&args.files)? {
        checked.push(check(&file)?);
    }
    if args.json {
        print_json(&checked, out)?;
    } else {
        print(&checked, out)?;
    }
    match checked.iter().filter(|file| !file.sound).count() {
        0 => Ok(()),
        bad => {
            let message = format!("{bad} of {} recordings failed the check", checked.len());
            Err(Failure::new(ErrorKind::BadData, message))
        }
    }
}

fn check(file: &Path) -> Result<Checked, Failure> {
    let findings = record::check(file)?;
    Ok(Checked {
        file: file.display().to_string(),
        sound: findings.is_empty(),
        findings,
    })
}

fn print(checked: &[Checked], out: &mut Results) -> Result<(), Failure> {
    for Checked { file, findings, .. } in checked {
        if findings.is_empty() {
            writeln!(out, "{file}: sound")?;
        }
        for finding in findings {
            write_words(out, &format!("{file}: {finding}"))?;
        }
    }
    Ok(())
}
