//! The variants of a study: every combination of the swept settings.

use toml::{Table, Value};

use super::file::NOTHING;
use super::overrides::Overrides;
use super::{StudyFile, Variant};
use crate::Error;
use crate::trial::{flatten, value_of};

/// Swept settings and their values.
type Sweep = [(String, Vec<Value>)];

/// A variant, with its settings as a table.
pub(super) type Variation = (Table, Variant);

/// Returns all combinations of the swept values, the listed tables, and the switches to turn off,
/// with their settings. Returns a single empty variant when nothing is varied.
pub(super) fn variants(file: &StudyFile, overrides: &Overrides) -> Result<Vec<Variation>, Error> {
    let sweep = file.sweep()?;
    for (key, _) in &sweep {
        refuse_set(file, overrides, key)?;
    }
    let variants = with_listed(file, overrides, every_combination(&sweep))?;
    let switches = &file.document.without;
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
            refuse_set(file, overrides, switch)?;
            refuse_swept(file, &variant.1, switch, "without")?;
            let (table, _) = varied(&variant, switch, &off);
            with_switches.push((table, with_entry(&variant.1, "without", switch)));
        }
    }
    Ok(with_switches)
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

fn every_combination(sweep: &Sweep) -> Vec<Variation> {
    let nothing = vec![(Table::new(), Variant::default())];
    sweep.iter().fold(nothing, |variants, (key, values)| {
        product(&variants, values)
            .map(|(variant, value)| varied(variant, key, value))
            .collect()
    })
}

/// Combines each of the variants with each table that the file lists.
fn with_listed(
    file: &StudyFile,
    overrides: &Overrides,
    variants: Vec<Variation>,
) -> Result<Vec<Variation>, Error> {
    if file.document.variants.is_empty() {
        return Ok(variants);
    }
    let mut all = Vec::new();
    for (variant, listed) in product(&variants, &file.document.variants) {
        let mut one = variant.clone();
        for (key, value) in flatten(listed.clone()) {
            refuse_set(file, overrides, &key)?;
            refuse_swept(file, &variant.1, &key, "variants")?;
            one = varied(&one, &key, &value);
        }
        all.push(one);
    }
    Ok(all)
}

/// Rejects a varied setting that is also set on the command line.
fn refuse_set(file: &StudyFile, overrides: &Overrides, key: &str) -> Result<(), Error> {
    let is_same = |set: &String| set.split('=').next().is_some_and(|k| k.trim() == key);
    if !overrides.sets.iter().any(is_same) {
        return Ok(());
    }
    let fault = format!("`{key}` is swept by this study: leave it out of --set");
    Err(file.fault(fault))
}

/// Rejects a swept setting that another key of the file, `besides`, also sets.
fn refuse_swept(
    file: &StudyFile,
    variant: &Variant,
    switch: &str,
    besides: &str,
) -> Result<(), Error> {
    if !variant.0.contains_key(switch) {
        return Ok(());
    }
    let fault =
        format!("`{switch}` is both in `sweep` and in `{besides}`: leave it out of one of them");
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
