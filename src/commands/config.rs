//! `xcscr config`: prints the settings and their origins.

use std::collections::BTreeMap;
use std::path::PathBuf;

use xcscr::agent::Method;
use xcscr::trial::{Resolved, Settings};

use super::choices::{self, SettingsArgs};
use super::failure::Failure;
use super::output::print_json;
use super::results::Results;

/// Print all settings as a file for --config, each one with its origin.
#[derive(Debug, clap::Args)]
pub struct ConfigArgs {
    #[command(flatten)]
    settings: SettingsArgs,
    /// Print the settings for this world, which determines the step limit unless it is set.
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,
    /// Print the settings of this method: defaults belong to a method.
    #[arg(long, value_name = "METHOD", default_value = Method::default().name(), value_parser = choices::method())]
    method: Method,
    /// Print one JSON document: each setting with its value, origin, range and description.
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

/// Runs `config show`.
pub fn run(args: &ConfigArgs, out: &mut Results) -> Result<(), Failure> {
    let resolved = args.settings.resolve(&Settings::of(args.method))?;
    let resolved = match &args.world {
        Some(world) => resolved.in_maze(&choices::world(world)?),
        None => resolved,
    };
    match args.json {
        true => print_entries(&resolved, out),
        false => print_origins(&resolved, out),
    }
}

/// Prints a settings file with dotted keys and the origins as comments.
fn print_origins(resolved: &Resolved, out: &mut Results) -> Result<(), Failure> {
    for (key, value, origin) in resolved.entries() {
        writeln!(out, "{key:34} = {value:<12} # {origin}")?;
    }
    Ok(())
}

fn print_entries(resolved: &Resolved, out: &mut Results) -> Result<(), Failure> {
    let values = serde_json::to_value(&resolved.settings).expect("settings are plain data");
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
    print_json(&entries, out)
}
