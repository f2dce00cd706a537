//! The variants of a study: the combinations of settings in its sweep.

use toml::{Table, Value};

use super::file::NOTHING;
use super::{StudyFile, Variant, is_plain_name};
use crate::Error;
use crate::trial::{flatten, value_of};

/// The key in a table of a sweep that names its combinations.
const NAME: &str = "name";

/// A table of a sweep: settings with one or more values each.
#[derive(Debug, Default)]
struct Grid {
    /// The name, which variants show instead of the settings with a single value.
    name: Option<String>,
    settings: Vec<(String, Vec<Value>)>,
}

/// A variant, with its settings as a table.
pub(super) type Variation = (Table, Variant);

/// Returns the combinations of the sweep, and each of them without the parts to leave out, with their
/// settings. Returns a single empty variant when nothing is varied.
pub(super) fn variants(file: &StudyFile) -> Result<Vec<Variation>, Error> {
    let mut variants = Vec::new();
    for grid in grids(file)? {
        let keys = grid.settings.iter().map(|(key, _)| key);
        keys.into_iter().try_for_each(|key| refuse_set(file, key))?;
        variants.extend(grid.combinations());
    }
    refuse_twins(file, &variants)?;
    let switches = &file.without;
    if switches.is_empty() {
        return Ok(variants);
    }
    let mut with_switches = Vec::new();
    for variant in variants {
        with_switches.push((
            variant.0.clone(),
            with_entry(&variant.1, "without", NOTHING),
        ));
        for (switch, off) in switches.iter().map(|part| switched_off(part)) {
            refuse_set(file, switch)?;
            refuse_swept(file, &variant.0, switch)?;
            let (table, _) = varied(&variant, switch, &off);
            with_switches.push((table, with_entry(&variant.1, "without", switch)));
        }
    }
    Ok(with_switches)
}

/// Returns the number of combinations of the sweep.
pub(super) fn number_of_combinations(file: &StudyFile) -> Result<usize, Error> {
    let number = |grid: &Grid| {
        let lengths = grid.settings.iter().map(|(_, values)| values.len());
        lengths.fold(1, usize::saturating_mul)
    };
    let numbers = grids(file)?.iter().map(number).collect::<Vec<_>>();
    Ok(numbers.into_iter().fold(0, usize::saturating_add))
}

/// Returns the tables of the sweep. A study without a sweep has an empty one.
fn grids(file: &StudyFile) -> Result<Vec<Grid>, Error> {
    match file.sweep.clone() {
        None => Ok(vec![Grid::default()]),
        Some(Value::Table(table)) => Ok(vec![Grid::new(file, table)?]),
        Some(Value::Array(tables)) if !tables.is_empty() => {
            let grid = |table: Value| match table {
                Value::Table(table) => Grid::new(file, table),
                _ => Err(file.fault(NOT_A_SWEEP)),
            };
            tables.into_iter().map(grid).collect()
        }
        Some(_) => Err(file.fault(NOT_A_SWEEP)),
    }
}

/// The fault of a sweep of another type.
const NOT_A_SWEEP: &str = "`sweep` must be a table of settings, or a list of such tables";

impl Grid {
    /// Reads a table, and sorts its settings by their full names.
    fn new(file: &StudyFile, mut table: Table) -> Result<Self, Error> {
        let name = match table.remove(NAME) {
            None => None,
            Some(Value::String(name)) if is_plain_name(&name) => Some(name),
            Some(_) => {
                let fault = "`sweep.name` must be a text of lower-case letters, digits and hyphens";
                return Err(file.fault(fault));
            }
        };
        let values = |(key, value)| match value {
            Value::Array(values) if values.is_empty() => {
                let fault = format!("`sweep.{key}` has no values: list some, such as [0.1, 0.2]");
                Err(file.fault(fault))
            }
            Value::Array(values) => Ok((key, values)),
            value => Ok((key, vec![value])),
        };
        let settings: Result<Vec<_>, Error> = flatten(table).into_iter().map(values).collect();
        let mut settings = settings?;
        settings.sort_by(|a, b| a.0.cmp(&b.0));
        Ok(Self { name, settings })
    }

    /// Returns every combination of the values, the last setting varying fastest.
    fn combinations(&self) -> Vec<Variation> {
        let mut variant = Variant::default();
        if let Some(name) = &self.name {
            variant = with_entry(&variant, NAME, name);
        }
        let first = vec![(Table::new(), variant)];
        self.settings.iter().fold(first, |variants, (key, values)| {
            let is_named = self.name.is_some() && values.len() == 1;
            let combined = product(&variants, values).map(|(variation, value)| {
                let (table, variant) = varied(variation, key, value);
                match is_named {
                    true => (table, variation.1.clone()),
                    false => (table, variant),
                }
            });
            combined.collect()
        })
    }
}

/// Rejects two variants with the same name, whose rows and trials could not be told apart.
fn refuse_twins(file: &StudyFile, variants: &[Variation]) -> Result<(), Error> {
    let mut names: Vec<String> = variants.iter().map(|(_, v)| v.to_string()).collect();
    names.sort();
    let twin = names.windows(2).find(|pair| pair[0] == pair[1]);
    twin.map_or(Ok(()), |pair| {
        let fault = format!(
            "`sweep` has `{}` twice: remove one of them, or give them different names",
            pair[0]
        );
        Err(file.fault(fault))
    })
}

/// Returns the setting of a part to leave out, and the value that turns it off. The value is
/// `false` unless one follows `=`.
fn switched_off(part: &str) -> (&str, Value) {
    match part.split_once('=') {
        None => (part, Value::Boolean(false)),
        Some((key, text)) => (key.trim(), value_of(text.trim())),
    }
}

/// Returns every pair of one element each.
pub(super) fn product<'a, 'b, A, B>(
    first: &'a [A],
    second: &'b [B],
) -> impl Iterator<Item = (&'a A, &'b B)> {
    first
        .iter()
        .flat_map(move |a| second.iter().map(move |b| (a, b)))
}

/// Rejects a varied setting that is also set on the command line.
fn refuse_set(file: &StudyFile, key: &str) -> Result<(), Error> {
    let is_same = |set: &String| set.split('=').next().is_some_and(|k| k.trim() == key);
    if !file.sets.iter().any(is_same) {
        return Ok(());
    }
    let fault = format!("`{key}` is swept by this study: leave it out of --set");
    Err(file.fault(fault))
}

/// Rejects a part to leave out that the sweep sets.
fn refuse_swept(file: &StudyFile, swept: &Table, switch: &str) -> Result<(), Error> {
    if !swept.contains_key(switch) {
        return Ok(());
    }
    let fault =
        format!("`{switch}` is both in `sweep` and in `without`: leave it out of one of them");
    Err(file.fault(fault))
}

/// Returns a variant with one more setting.
fn varied((table, variant): &Variation, key: &str, value: &Value) -> Variation {
    let (mut table, mut variant) = (table.clone(), variant.clone());
    table.insert(key.to_owned(), value.clone());
    let json = serde_json::to_value(value).expect("plain data becomes JSON");
    variant.0.insert(key.to_owned(), json);
    (table, variant)
}

/// Returns a variant with one more entry, which is not a setting.
pub(super) fn with_entry(variant: &Variant, name: &str, value: &str) -> Variant {
    let mut variant = variant.clone();
    variant.0.insert(name.to_owned(), value.into());
    variant
}
