//! `xcscr config`: prints the settings and their origins.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Subcommand;
use toml::{Table, Value};
use xcscr::ErrorKind;
use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{ReadBy, Resolved, Scope, Settings};

use super::choices::{self, SettingsArgs};
use super::failure::Failure;
use super::output::print_json;
use super::results::Results;

/// Subcommands of `config`.
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
    /// Print the settings for this world, which determines the step limit unless it is set.
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,
    /// Print only the settings that affect this method [default, with --arena or --sensor:
    /// xcscr-plus].
    #[arg(long, value_parser = choices::method())]
    method: Option<Method>,
    /// Print only the settings that affect this arena [default, with --method or --sensor:
    /// physics].
    #[arg(long, value_parser = choices::arena())]
    arena: Option<ArenaKind>,
    /// Print only the settings that affect this percept [default, with --method or --arena: lidar
    /// in physics, neighbours on the grid].
    #[arg(long, value_parser = choices::sensor())]
    sensor: Option<Sensor>,
    /// Print each setting on its own line, with its origin.
    #[arg(long)]
    resolved: bool,
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
    read_by: String,
}

impl ShowArgs {
    /// Returns the scope of the settings to print; `None` for all settings.
    fn scope<'a>(&self, settings: &'a Settings) -> Option<Scope<'a>> {
        if (self.method, self.arena, self.sensor) == (None, None, None) {
            return None;
        }
        let arena = self.arena.unwrap_or(ArenaKind::Physics);
        Some(Scope {
            method: Some(self.method.unwrap_or(Method::XcscrPlus)),
            arena,
            sensor: self.sensor.unwrap_or(Sensor::usual_in(arena)),
            settings,
        })
    }
}

/// Runs one of the config commands.
pub fn run(command: &ConfigCommand, out: &mut Results) -> Result<(), Failure> {
    let ConfigCommand::Show(args) = command;
    let resolved = args.settings.resolve(&Settings::default())?;
    let resolved = match &args.world {
        Some(world) => resolved.in_maze(&choices::world(world)?),
        None => resolved,
    };
    let scope = args.scope(&resolved.settings);
    if let Some(scope) = scope {
        resolved.check_read(scope.method, scope.arena, scope.sensor)?;
    }
    let counts = |key: &str| scope.is_none_or(|scope| scope.reads(key));
    match (args.json, args.resolved) {
        (true, _) => print_entries(&resolved, counts, out),
        (_, true) => print_origins(&resolved, counts, out),
        _ => Ok(write!(out, "{}", as_file(&resolved, counts)?)?),
    }
}

/// Formats the settings that count as a settings file.
fn as_file(resolved: &Resolved, counts: impl Fn(&str) -> bool) -> Result<String, Failure> {
    let no_toml = |fault: toml::ser::Error| {
        Failure::new(
            ErrorKind::Internal,
            format!("no TOML for settings: {fault}"),
        )
    };
    let all = Table::try_from(&resolved.settings).map_err(no_toml)?;
    toml::to_string(&counting(all, "", &counts)).map_err(no_toml)
}

/// Returns the part of a settings table that counts. `section` is the prefix of its keys, with a
/// dot at the end.
fn counting(table: Table, section: &str, counts: &impl Fn(&str) -> bool) -> Table {
    let kept = table.into_iter().filter_map(|(name, value)| {
        let key = format!("{section}{name}");
        let value = match value {
            Value::Table(inner) => Value::Table(counting(inner, &format!("{key}."), counts)),
            value => return counts(&key).then_some((name, value)),
        };
        let is_empty = value.as_table().is_some_and(Table::is_empty);
        (!is_empty).then_some((name, value))
    });
    kept.collect()
}

fn print_origins(
    resolved: &Resolved,
    counts: impl Fn(&str) -> bool,
    out: &mut Results,
) -> Result<(), Failure> {
    for (key, value, origin) in resolved.entries().filter(|(key, ..)| counts(key)) {
        writeln!(out, "{key:34} = {value:<12} # {origin}")?;
    }
    Ok(())
}

fn print_entries(
    resolved: &Resolved,
    counts: impl Fn(&str) -> bool,
    out: &mut Results,
) -> Result<(), Failure> {
    let values = serde_json::to_value(&resolved.settings).expect("settings are plain data");
    let origins = resolved
        .entries()
        .map(|(key, _, origin)| (key, origin.to_string()));
    let origins: BTreeMap<&str, String> = origins.collect();
    let mut declared = Settings::declared();
    declared.retain(|setting| counts(setting.key));
    let entries = declared.iter().map(|setting| {
        let path = format!("/{}", setting.key.replace('.', "/"));
        let readers = ReadBy::of(setting.key);
        let entry = Entry {
            value: values.pointer(&path).cloned().unwrap_or_default(),
            origin: &origins[setting.key],
            range: setting.range.as_deref(),
            about: setting.about,
            read_by: readers.map(ToString::to_string).unwrap_or_default(),
        };
        (setting.key, entry)
    });
    let entries: BTreeMap<&str, Entry<'_>> = entries.collect();
    print_json(&entries, out)
}
