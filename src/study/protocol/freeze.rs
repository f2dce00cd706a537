//! From a study file to a frozen protocol.

use toml::{Table, Value};

use super::{Arm, Protocol, StudyFile, Variant};
use crate::bounds::within;
use crate::reward::Method;
use crate::study::error::StudyError;
use crate::study::plan::{ArenaKind, PlanError};
use crate::study::resolve::Resolved;
use crate::study::settings::Settings;
use crate::world::Maze;

/// More combinations than these fill the memory with settings before the first trial begins.
const MOST_ARMS: usize = 10_000;

/// What the command line says otherwise than the study file.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Trials per arm.
    pub trials: Option<usize>,
    /// Episodes per trial.
    pub episodes: Option<u32>,
    /// The root of the trials' seeds.
    pub seed: Option<u64>,
    /// The only arena.
    pub arena: Option<ArenaKind>,
    /// Settings, as `section.key=value`, which win over all others.
    pub sets: Vec<String>,
}

pub fn freeze(file: &StudyFile, overrides: &Overrides) -> Result<Protocol, StudyError> {
    let document = &file.document;
    let worlds = file.worlds()?;
    check_names(file, &worlds)?;
    let protocol = Protocol {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        name: document.name.clone(),
        seed: overrides.seed.unwrap_or(document.seed),
        trials: overrides.trials.unwrap_or(document.trials),
        episodes: overrides.episodes.unwrap_or(document.episodes),
        arms: arms(file, &worlds, overrides)?,
        worlds,
    };
    within("trials", protocol.trials, 1..=1_000_000).map_err(PlanError::from)?;
    within("episodes", protocol.episodes, 1..=1_000_000).map_err(PlanError::from)?;
    match protocol.check() {
        Ok(()) => Ok(protocol),
        Err(fault) => Err(StudyError::file(&file.origin, &fault)),
    }
}

/// Names tell worlds apart, in tables and in protocols, and are printed to terminals.
fn check_names(file: &StudyFile, worlds: &[Maze]) -> Result<(), StudyError> {
    if file.document.name.contains(char::is_control) {
        let fault = "`name` holds a control character: leave it out";
        return Err(StudyError::file(&file.origin, fault));
    }
    for (i, maze) in worlds.iter().enumerate() {
        if worlds[..i].iter().any(|other| other.name() == maze.name()) {
            let fault = format!("two worlds are called `{}`", maze.name());
            return Err(StudyError::file(&file.origin, &fault));
        }
    }
    Ok(())
}

/// Refuses a study of too many combinations; the sweep alone can make billions of them.
fn check_number(file: &StudyFile, places: usize) -> Result<(), StudyError> {
    let document = &file.document;
    let fixed = [document.methods.len(), document.sensors.len()];
    let swept = file.sweep()?.into_iter().map(|(_, values)| values.len());
    let number = fixed
        .into_iter()
        .chain(swept)
        .fold(places, usize::saturating_mul);
    if number <= MOST_ARMS {
        return Ok(());
    }
    let fault = format!("it makes {number} combinations, but at most {MOST_ARMS} are possible");
    Err(StudyError::file(&file.origin, &fault))
}

/// Every combination, in the order of the file, worlds first.
fn arms(file: &StudyFile, worlds: &[Maze], overrides: &Overrides) -> Result<Vec<Arm>, StudyError> {
    let document = &file.document;
    let arenas = overrides
        .arena
        .map_or(document.arenas.clone(), |arena| vec![arena]);
    check_number(file, worlds.len() * arenas.len())?;
    let variants = variants(file, overrides)?;
    let mut arms = Vec::new();
    for &method in &document.methods {
        let base = settings(file, method, overrides)?;
        for variant in &variants {
            let settings = lay_over(&base, &format!("{}, sweep", file.origin), variant)?;
            for &arena in &arenas {
                for &sensor in &document.sensors {
                    arms.push((method, arena, sensor, variant, settings.clone()));
                }
            }
        }
    }
    let in_world = |maze: &Maze| {
        let name = maze.name().to_owned();
        let arms = arms.iter().cloned();
        arms.map(move |(method, arena, sensor, variant, settings)| Arm {
            world: name.clone(),
            method,
            arena,
            sensor,
            variant: to_variant(variant),
            settings,
        })
        .collect::<Vec<_>>()
    };
    Ok(worlds.iter().flat_map(in_world).collect())
}

/// The settings of a method: default < study < method < command line.
fn settings(
    file: &StudyFile,
    method: Method,
    overrides: &Overrides,
) -> Result<Settings, StudyError> {
    let common = lay_over(&Settings::default(), &file.origin, &file.document.settings)?;
    let own = lay_over(&common, &file.origin, &file.method_settings(method)?)?;
    Ok(Resolved::new(&own, None, &overrides.sets)?.settings)
}

fn lay_over(base: &Settings, origin: &str, table: &Table) -> Result<Settings, StudyError> {
    let text = table.to_string();
    Ok(Resolved::new(base, Some((origin, &text)), &[])?.settings)
}

/// All combinations of the swept values; one empty table when nothing is swept.
fn variants(file: &StudyFile, overrides: &Overrides) -> Result<Vec<Table>, StudyError> {
    let mut variants = vec![Table::new()];
    for (key, values) in file.sweep()? {
        let is_same = |set: &String| set.split('=').next().is_some_and(|k| k.trim() == key);
        if overrides.sets.iter().any(is_same) {
            let fault = format!("`{key}` is swept by this study: leave it out of --set");
            return Err(StudyError::file(&file.origin, &fault));
        }
        let with = |variant: &Table, value: &Value| {
            let mut variant = variant.clone();
            variant.insert(key.clone(), value.clone());
            variant
        };
        variants = variants
            .iter()
            .flat_map(|variant| {
                values
                    .iter()
                    .map(|value| with(variant, value))
                    .collect::<Vec<_>>()
            })
            .collect();
    }
    Ok(variants)
}

fn to_variant(table: &Table) -> Variant {
    let json = |value: &Value| serde_json::to_value(value).expect("plain data becomes JSON");
    Variant(
        table
            .iter()
            .map(|(key, value)| (key.clone(), json(value)))
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn protocol(text: &str, sets: &[&str]) -> Result<Protocol, StudyError> {
        let text = format!(
            "name = \"s\"\nworlds = [\"maze4\", \"maze5\"]\nmethods = [\"xcs\", \"xcscr\"]\ntrials = 3\nepisodes = 4\n{text}"
        );
        let file = StudyFile::parse(&text, "s.toml", Path::new(""))?;
        let sets = sets.iter().map(|set| (*set).to_owned()).collect();
        Protocol::new(
            &file,
            &Overrides {
                sets,
                ..Overrides::default()
            },
        )
    }

    #[test]
    fn a_sweep_tries_every_combination_in_every_world() {
        let study = protocol(
            "[sweep]\n\"xcs.beta\" = [0.1, 0.2]\nxcs.ga = [true, false]\n",
            &[],
        )
        .unwrap();
        assert_eq!(study.arms.len(), 2 * 2 * 4);
        assert_eq!(
            study.arms[1].variant.to_string(),
            "xcs.beta=0.1 xcs.ga=false"
        );
        assert!(!study.arms[1].settings.xcs.ga);
        assert_eq!(study.len(), 48);
    }

    #[test]
    fn a_sweep_of_too_many_combinations_is_refused_before_they_are_made() {
        let values = vec!["0.5"; 100].join(", ");
        let keys = ["xcs.beta", "xcs.mu", "xcs.chi", "xcs.delta", "xcs.alpha"];
        let lines = keys.map(|key| format!("\"{key}\" = [{values}]\n"));
        let fault = protocol(&format!("[sweep]\n{}", lines.concat()), &[]).unwrap_err();
        let words = "it makes 40000000000 combinations, but at most 10000 are possible";
        assert!(fault.to_string().contains(words), "{fault}");
    }

    #[test]
    fn settings_of_a_method_win_over_the_study_and_the_command_line_over_both() {
        let text = "[settings]\n\"xcs.beta\" = 0.1\n\"xcs.mu\" = 0.1\n[method-settings.xcscr]\nxcs.beta = 0.3\nxcs.alpha = 0.3\n";
        let study = protocol(text, &["xcs.alpha=0.4"]).unwrap();
        let figures = |arm: usize| {
            let xcs = &study.arms[arm].settings.xcs;
            (xcs.beta, xcs.mu, xcs.alpha)
        };
        assert_eq!(figures(0), (0.1, 0.1, 0.4));
        assert_eq!(figures(1), (0.3, 0.1, 0.4));
    }

    #[test]
    fn a_swept_setting_cannot_be_set_besides() {
        let fault = protocol("[sweep]\n\"xcs.beta\" = [0.1]\n", &["xcs.beta=1"]).unwrap_err();
        assert!(fault.to_string().contains("leave it out of --set"));
    }

    #[test]
    fn the_same_replicate_has_the_same_seed_in_every_arm_and_no_other() {
        let study = protocol("", &[]).unwrap();
        let seeds: Vec<u64> = (0..study.len())
            .map(|trial| study.trial_seed(trial))
            .collect();
        assert_eq!(seeds[..3], seeds[3..6]);
        assert!(seeds[0] != seeds[1] && seeds[1] != seeds[2]);
    }

    #[test]
    fn the_id_tells_any_change_and_survives_a_round_trip() {
        let study = protocol("", &[]).unwrap();
        let text = serde_json::to_string_pretty(&study).unwrap();
        let again: Protocol = serde_json::from_str(&text).unwrap();
        assert_eq!((again.id(), &again), (study.id(), &study));
        assert_ne!(protocol("", &["xcs.beta=0.21"]).unwrap().id(), study.id());
    }
}
