//! `xcscr config`: the settings, and where each came from.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;
use xcscr::trial::{Resolved, Settings};
use xcscr::world::Maze;

use super::choices::SettingsArgs;
use super::failure::{Exit, Failure};

/// What to do with settings.
#[derive(Debug, Subcommand)]
pub enum ConfigCommand {
    /// Print all settings as a file for --config, or each one with its origin.
    Show(ShowArgs),
}

/// Arguments of `config show`.
#[derive(Debug, clap::Args)]
pub struct ShowArgs {
    #[command(flatten)]
    settings: SettingsArgs,
    /// As they are in this world, which decides the step-threshold unless it is set.
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,
    /// Print each setting on a line of its own, with where it came from.
    #[arg(long)]
    resolved: bool,
    /// Print one JSON document: each setting with its value, its origin, its range and what it is.
    #[arg(long)]
    json: bool,
}

/// A setting, as `--json` prints it.
#[derive(serde::Serialize)]
struct Entry<'a> {
    value: serde_json::Value,
    origin: &'a str,
    range: Option<&'a str>,
    about: &'a str,
}

/// Runs one of the config commands.
pub fn run(command: &ConfigCommand, out: &mut impl Write) -> Result<(), Failure> {
    let ConfigCommand::Show(args) = command;
    let resolved = args.settings.resolve(&Settings::default())?;
    let resolved = match &args.world {
        Some(world) => resolved.in_maze(&Maze::load(world)?),
        None => resolved,
    };
    match (args.json, args.resolved) {
        (true, _) => print_json(&resolved, out),
        (_, true) => print_origins(&resolved, out),
        _ => Ok(write!(out, "{}", as_file(&resolved)?)?),
    }
}

/// A settings file that gives these settings again.
fn as_file(resolved: &Resolved) -> Result<String, Failure> {
    toml::to_string(&resolved.settings)
        .map_err(|fault| Failure::new(Exit::Internal, format!("no TOML for settings: {fault}")))
}

fn print_origins(resolved: &Resolved, out: &mut impl Write) -> Result<(), Failure> {
    for (key, value, origin) in resolved.entries() {
        writeln!(out, "{key:34} = {value:<12} # {origin}")?;
    }
    Ok(())
}

fn print_json(resolved: &Resolved, out: &mut impl Write) -> Result<(), Failure> {
    let values = serde_json::to_value(&resolved.settings)?;
    let origins = resolved
        .entries()
        .map(|(key, _, origin)| (key, origin.to_string()));
    let origins: BTreeMap<&str, String> = origins.collect();
    let declared = Settings::declared();
    let entries = declared.iter().map(|setting| {
        let path = format!("/{}", setting.key.replace('.', "/"));
        let entry = Entry {
            value: values.pointer(&path).cloned().unwrap_or_default(),
            origin: &origins[setting.key],
            range: setting.range.as_deref(),
            about: setting.about,
        };
        (setting.key, entry)
    });
    let entries: BTreeMap<&str, Entry<'_>> = entries.collect();
    Ok(writeln!(
        out,
        "{}",
        serde_json::to_string_pretty(&entries)?
    )?)
}
