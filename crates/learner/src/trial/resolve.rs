//! Resolution of settings: default, then file, then the command line.

use std::collections::BTreeMap;

use toml::{Table, Value};

use super::settings::Settings;
use super::settings_error::{SettingOrigin, SettingsError};
use super::toml_text::shortened;
use xcs::bounds::OutOfRange;
use xcscr_robot::world::Maze;

/// The setting that is taken from the maze by default.
pub const STEP_THRESHOLD: &str = "reward.step_threshold";
/// The setting that takes the step-threshold from the maze.
pub const FROM_MAZE: &str = "reward.step_threshold_from_maze";

/// Settings and their origins.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolved {
    /// The checked settings.
    pub settings: Settings,
    values: BTreeMap<String, (Value, SettingOrigin)>,
    /// The settings set by hand: by `--set`, or to a different value by a settings file.
    pub(super) given: Vec<(String, SettingOrigin)>,
}

impl Resolved {
    /// Applies settings files (name and text of each) and then `--set` arguments (`section.key=value`) to `base`, and
    /// checks the result. Later ones win.
    ///
    /// # Errors
    /// The first fault, with its place and a hint.
    pub fn new(
        base: &Settings,
        files: &[(&str, &str)],
        sets: &[String],
    ) -> Result<Self, SettingsError> {
        Self::on(base, None, files, sets)
    }

    /// Like [`new`](Self::new), with the name and settings of a robot between `base` and the files.
    pub(super) fn on(
        base: &Settings,
        robot: Option<(&str, &Table)>,
        files: &[(&str, &str)],
        sets: &[String],
    ) -> Result<Self, SettingsError> {
        let defaults = Table::try_from(base).expect("settings are plain data");
        let mut values = BTreeMap::new();
        for (key, value) in flatten(defaults) {
            values.insert(key, (value, SettingOrigin::Default));
        }
        if let Some((name, table)) = robot {
            let origin = SettingOrigin::Robot(name.to_owned());
            for (key, value) in flatten(table.clone()) {
                overlay(&mut values, key, value, &origin)?;
            }
        }
        let mut given = Vec::new();
        for (name, text) in files {
            let origin = SettingOrigin::File((*name).to_owned());
            let table: Table = text.parse().map_err(|fault: toml::de::Error| {
                let (origin, fault) = (origin.clone(), shortened(&fault.to_string()));
                SettingsError::Syntax { origin, fault }
            })?;
            for (key, value) in flatten(table) {
                if overlay(&mut values, key.clone(), value, &origin)? {
                    given.push((key, origin.clone()));
                }
            }
        }
        for set in sets {
            let assigned = set.split_once('=');
            let (key, text) = assigned.ok_or_else(|| SettingsError::NoValue(set.clone()))?;
            let key = key.trim().to_owned();
            let value = value_of(text.trim());
            overlay(&mut values, key.clone(), value, &SettingOrigin::Set)?;
            given.push((key, SettingOrigin::Set));
        }
        Ok(Self {
            settings: checked(&values)?,
            values,
            given,
        })
    }

    /// Returns the settings with the values that depend on the maze filled in.
    pub fn in_maze(mut self, maze: &Maze) -> Self {
        let before = self.settings.reward.step_threshold;
        self.settings = self.settings.settled_in(maze);
        let settled = self.settings.reward.step_threshold;
        if settled != before {
            let value = Value::Integer(settled.into());
            let entry = (value, SettingOrigin::Maze);
            self.values.insert(STEP_THRESHOLD.to_owned(), entry);
        }
        self
    }

    /// Returns each setting by its full name, with its value in TOML syntax and its origin.
    pub fn entries(&self) -> impl Iterator<Item = (&str, String, &SettingOrigin)> {
        let entries = self.values.iter();
        entries.map(|(key, (value, origin))| (key.as_str(), value.to_string(), origin))
    }
}

/// Parses a value after `=` outside of a TOML file: as TOML, or else as a plain string.
pub fn value_of(text: &str) -> Value {
    let read = format!("value = {text}").parse::<Table>().ok();
    // A text of several lines could contain more than the value.
    let alone = read.filter(|table| table.len() == 1);
    let value = alone.and_then(|mut table| table.remove("value"));
    value.unwrap_or_else(|| Value::String(text.to_owned()))
}

/// Flattens nested tables to a list with full names.
pub fn flatten(table: Table) -> Vec<(String, Value)> {
    let mut flat = Vec::new();
    for (key, value) in table {
        match value {
            Value::Table(inner) => {
                let inner = flatten(inner).into_iter();
                flat.extend(inner.map(|(name, value)| (format!("{key}.{name}"), value)));
            }
            value => flat.push((key, value)),
        }
    }
    flat
}

/// Replaces a value by one of the same type, and returns true if they differ. Whole numbers are
/// accepted as fractions. Setting the step-threshold turns off the threshold from the maze.
fn overlay(
    values: &mut BTreeMap<String, (Value, SettingOrigin)>,
    key: String,
    value: Value,
    origin: &SettingOrigin,
) -> Result<bool, SettingsError> {
    let Some((present, _)) = values.get(&key) else {
        return Err(SettingsError::Unknown {
            suggestion: similar(&key, values.keys().map(String::as_str)),
            key: shortened(&key),
            origin: origin.clone(),
        });
    };
    let value = match (present, value) {
        (Value::Float(_), Value::Integer(whole)) => Value::Float(whole as f64),
        (_, value) => value,
    };
    if !present.same_type(&value) {
        return Err(SettingsError::Type {
            origin: origin.clone(),
            given: shortened(&value.to_string()),
            wanted: kind(&key, present),
            key,
        });
    }
    let differs = *present != value;
    if key == STEP_THRESHOLD {
        let no = (Value::Boolean(false), origin.clone());
        values.insert(FROM_MAZE.to_owned(), no);
    }
    values.insert(key, (value, origin.clone()));
    Ok(differs)
}

/// Describes the values of a setting, given its present value.
fn kind(key: &str, value: &Value) -> String {
    let number = match value {
        Value::Integer(_) => "a whole number",
        Value::Float(_) => "a number",
        Value::Boolean(_) => return "true or false".to_owned(),
        _ => return "a string".to_owned(),
    };
    match range_of(key, value) {
        Some(OutOfRange { allowed, .. }) => format!("{number} {allowed}"),
        None => number.to_owned(),
    }
}

/// Returns the most similar known key, if any is similar enough.
pub fn similar<'a>(key: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    // All known keys are shorter, and comparing an extremely long line would take seconds.
    let short: String = key.chars().take(64).collect();
    let known: Vec<&str> = known.collect();
    // A setting without its section.
    let named = |name: &&&str| name.rsplit('.').next() == Some(short.as_str());
    if let Some(name) = known.iter().find(named) {
        return Some((*name).to_owned());
    }
    let ranked = known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&short, name), name));
    let best = ranked.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > 0.8).then(|| best.1.to_owned())
}

/// Returns the settings with these values, after checking the ranges.
fn checked(values: &BTreeMap<String, (Value, SettingOrigin)>) -> Result<Settings, SettingsError> {
    let mut all = Table::new();
    for (key, (value, origin)) in values {
        // Each value is read on its own first, so that the message can name the setting.
        let mut alone = Table::new();
        put(&mut alone, key, value.clone());
        alone
            .try_into::<Settings>()
            .map_err(|fault| unreadable(key, value, origin, fault.message()))?;
        put(&mut all, key, value.clone());
    }
    let settings: Settings = all.try_into().expect("each value was read on its own");
    settings
        .check()
        .map(|()| settings.clone())
        .map_err(|fault| {
            let origin = values
                .get(fault.key)
                .map_or(SettingOrigin::Default, |(_, origin)| origin.clone());
            SettingsError::Range { origin, fault }
        })
}

/// Inserts a value into nested tables under its full name.
fn put(table: &mut Table, key: &str, value: Value) {
    match key.split_once('.') {
        None => {
            table.insert(key.to_owned(), value);
        }
        Some((section, name)) => {
            let inner = table
                .entry(section)
                .or_insert_with(|| Value::Table(Table::new()));
            let inner = inner.as_table_mut();
            put(inner.expect("no setting is a section"), name, value);
        }
    }
}

/// Explains why a value of the right type cannot be read: a whole number out of range, or a name
/// that is not allowed. For names, the message of the parser is used.
fn unreadable(key: &str, value: &Value, origin: &SettingOrigin, fault: &str) -> SettingsError {
    let origin = origin.clone();
    if let Some(fault) = range_of(key, value) {
        return SettingsError::Range { origin, fault };
    }
    let expected = fault.split_once("expected ").map(|(_, expected)| expected);
    SettingsError::Type {
        key: key.to_owned(),
        origin,
        given: shortened(&value.to_string()),
        wanted: expected.unwrap_or(fault).trim().to_owned(),
    }
}

/// Returns an out-of-range error for a value, if its setting has a declared range.
fn range_of(key: &str, given: &Value) -> Option<OutOfRange> {
    let mut declared = Settings::declared().into_iter();
    let setting = declared.find(|setting| setting.key == key)?;
    Some(OutOfRange {
        key: setting.key,
        value: given.to_string(),
        allowed: setting.range?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(file: Option<&str>, sets: &[&str]) -> String {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let files: Vec<_> = file.map(|text| ("run.toml", text)).into_iter().collect();
        Resolved::new(&Settings::default(), &files, &sets)
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn the_command_line_wins_over_the_file_and_the_file_over_the_default() {
        let file = "[xcs]\nbeta = 0.3\nmu = 0.01\n";
        let sets = ["xcs.mu=0.02".to_owned(), "reward.sharing=even".to_owned()];
        let resolved = Resolved::new(&Settings::default(), &[("run.toml", file)], &sets).unwrap();
        let xcs = &resolved.settings.xcs;
        assert_eq!((xcs.alpha, xcs.beta, xcs.mu), (0.1, 0.3, 0.02));
        let origin = |wanted| {
            let entry = resolved.entries().find(|(key, ..)| *key == wanted).unwrap();
            format!("{} {}", entry.1, entry.2)
        };
        assert_eq!(origin("xcs.alpha"), "0.1 default");
        assert_eq!(origin("xcs.beta"), "0.3 run.toml");
        assert_eq!(origin("xcs.mu"), "0.02 --set");
        assert_eq!(origin("reward.sharing"), "\"even\" --set");
    }

    #[test]
    fn a_wrong_setting_is_answered_with_what_it_must_be() {
        let whole = "but must be from 32 to 1000000";
        for (set, answer) in [
            (
                "xcs.betta=1",
                "there is no setting `xcs.betta`; did you mean `xcs.beta`?",
            ),
            ("xcs.ga=0.5", "`xcs.ga` is 0.5, but must be true or false"),
            (
                "reward.sharing=odd",
                "`reward.sharing` is \"odd\", but must be `even` or `discounted`",
            ),
            ("xcs.nu=-1", "`xcs.nu` is -1, but must be from 1 to 20"),
            (
                "xcs.beta=nan",
                "`xcs.beta` is NaN, but must be from 0.000001 to 1",
            ),
            (
                "xcs.population_size=-1",
                &format!("`xcs.population_size` is -1, {whole}"),
            ),
            (
                "xcs.population_size=4294967296",
                &format!("`xcs.population_size` is 4294967296, {whole}"),
            ),
            (
                "xcs.population_size=-9223372036854775808",
                &format!("`xcs.population_size` is -9223372036854775808, {whole}"),
            ),
        ] {
            assert_eq!(message(None, &[set]), format!("--set: {answer}"));
        }
        assert_eq!(
            message(Some("[foo]\nq = 1"), &[]),
            "run.toml: there is no setting `foo.q`; `xcscr config show` lists all"
        );
    }

    #[test]
    fn a_value_that_is_not_a_whole_number_is_refused_with_the_range() {
        // A value of several lines must not set anything beside its key.
        for value in ["nan", "inf", "2.5", "many", "1\nxcs.mu=2"] {
            let message = message(None, &[&format!("xcs.nu={value}")]);
            let wanted = "must be a whole number from 1 to 20";
            assert!(message.contains(wanted), "{message}");
        }
    }

    #[test]
    fn the_maze_sets_the_step_threshold_unless_it_is_set_by_hand() {
        let corridor = format!(
            r##"{{"rows": ["{0}", "#S{1}G#", "{0}"]}}"##,
            "#".repeat(40),
            ".".repeat(36)
        );
        let maze = Maze::from_json(corridor.as_bytes(), "corridor.json").unwrap();
        let resolved = |sets: &[&str]| {
            let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
            let resolved = Resolved::new(&Settings::default(), &[], &sets)
                .unwrap()
                .in_maze(&maze);
            let entry = resolved.entries().find(|(key, ..)| *key == STEP_THRESHOLD);
            let (_, value, origin) = entry.unwrap();
            assert_eq!(value, resolved.settings.reward.step_threshold.to_string());
            format!("{value} {origin}")
        };
        assert_eq!(resolved(&[]), "148 the maze");
        assert_eq!(resolved(&["reward.step_threshold=50"]), "50 --set");
        let both = [
            "reward.step_threshold=200",
            "reward.step_threshold_from_maze=true",
        ];
        assert_eq!(resolved(&both), "200 --set");
    }

    #[test]
    fn a_set_without_a_value_and_a_broken_file_are_refused() {
        assert!(message(None, &["xcs.beta"]).contains("write `--set section.key=value`"));
        assert!(message(Some("[xcs"), &[]).starts_with("run.toml is not valid TOML"));
    }

    #[test]
    fn a_message_repeats_only_the_beginning_of_a_long_line() {
        let long = "x".repeat(1_000_000);
        for text in [
            format!("[xcs]\nbeta = \"{long}\"\n"),
            format!("{long} = 1\n"),
            format!("{} 1\n", "[".repeat(1_000_000)),
            format!("[reward]\nsharing = \"{long}\"\n"),
        ] {
            let message = message(Some(&text), &[]);
            assert!(message.len() < 1000, "{} bytes", message.len());
        }
    }
}
