//! Rejects settings of a study that have no effect, and trials that would run twice.

use std::collections::HashMap;

use toml::Table;

use super::overrides::Overrides;
use super::variants::Variation;
use super::{Arm, NOTHING, StudyFile, Variant};
use crate::arena::ArenaKind;
use crate::error::Error;
use crate::study::error;
use crate::trial::{Scope, SettingOrigin, SettingsError, flatten};

impl Variant {
    /// Returns the keys of the entries that `other` does not have, or has with another value.
    fn differing<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = &'a String> {
        let differs = |(key, value): &(&String, _)| other.0.get(*key) != Some(*value);
        self.0.iter().filter(differs).map(|(key, _)| key)
    }
}

impl Arm {
    /// Returns the choices that determine which settings are read.
    fn scope(&self) -> Scope<'_> {
        Scope {
            method: Some(self.method),
            arena: self.arena,
            sensor: self.sensor,
            settings: &self.settings,
        }
    }

    /// Returns true if the arm leaves out a part that its method does not have.
    pub(super) fn leaves_out_missing_part(&self) -> bool {
        let part = self.variant.0.get("without").and_then(|part| part.as_str());
        let part = part.filter(|part| *part != NOTHING);
        part.is_some_and(|key| !self.scope().reads(key))
    }

    /// Returns everything that the arm's trials depend on, as text.
    fn effective_inputs(&self) -> String {
        let table = Table::try_from(&self.settings).expect("settings are plain data");
        let mut settings = flatten(table);
        settings.retain(|(key, _)| self.scope().reads(key));
        format!("{} {settings:?}", self.place())
    }

    /// Returns everything but the settings, as text.
    fn place(&self) -> String {
        let names = [self.method.name(), self.arena.name(), self.sensor.name()];
        format!("{:?} {} {:?}", self.world, names.join(" "), self.after)
    }
}

/// Rejects settings in the study file or on the command line that none of their arms reads, and a
/// robot that no arm uses.
pub(super) fn refuse_unread(
    file: &StudyFile,
    overrides: &Overrides,
    variations: &[Variation],
    arms: &[Arm],
) -> Result<(), Error> {
    let document = &file.document;
    if document.robot.is_some() && arms.iter().all(|arm| arm.arena == ArenaKind::Grid) {
        return Err(SettingsError::NoRobot.into());
    }
    let part = |name: &str| SettingOrigin::File(format!("{}, {name}", file.origin));
    let all: Vec<&Arm> = arms.iter().collect();
    let sets = overrides
        .sets
        .iter()
        .filter_map(|set| set.split('=').next());
    let sets = sets.map(|key| key.trim().to_owned()).collect();
    refuse(sets, SettingOrigin::Set, &all)?;
    refuse(names(&document.settings), part("settings"), &all)?;
    for (world, table) in &document.world_settings {
        let there: Vec<&Arm> = arms.iter().filter(|arm| arm.world == *world).collect();
        refuse(names(table), part("world-settings"), &there)?;
    }
    for (method, table) in &document.method_settings {
        let own = arms.iter().filter(|arm| arm.method_name() == method);
        refuse(
            names(table),
            part("method-settings"),
            &own.collect::<Vec<_>>(),
        )?;
    }
    for (table, _) in variations {
        refuse(names(table), part("sweep, variants or without"), &all)?;
    }
    Ok(())
}

/// Returns the full names of the settings in a table.
fn names(table: &Table) -> Vec<String> {
    let flat = flatten(table.clone()).into_iter();
    flat.map(|(key, _)| key).collect()
}

/// Rejects the first of these settings that none of these arms reads.
fn refuse(keys: Vec<String>, origin: SettingOrigin, arms: &[&Arm]) -> Result<(), SettingsError> {
    let Some(first) = arms.first() else {
        return Ok(());
    };
    let is_read = |key: &str| arms.iter().any(|arm| arm.scope().reads(key));
    let unread = keys.into_iter().find(|key| !is_read(key));
    unread.map_or(Ok(()), |key| {
        let why = first.scope().why_unread(&key);
        Err(SettingsError::Unread { key, origin, why })
    })
}

/// Removes each arm that would repeat the trials of an earlier one because the study varies a switch together with a
/// setting that only some values of the switch need. Each of the settings in which the two differ counts in another arm
/// with the same method, arena and percept.
pub(super) fn run_repeated_trials_once(arms: &mut Vec<Arm>) {
    let all = arms.clone();
    let mut places: HashMap<String, Vec<&Arm>> = HashMap::new();
    for arm in &all {
        places.entry(arm.place()).or_default().push(arm);
    }
    let mut met: HashMap<String, Variant> = HashMap::new();
    arms.retain(|arm| {
        let there = &places[&arm.place()];
        if there.len() == 1 {
            return true;
        }
        let inputs = arm.effective_inputs();
        let Some(twin) = met.get(&inputs) else {
            met.insert(inputs, arm.variant.clone());
            return true;
        };
        let counts = |key: &String| there.iter().any(|other| other.scope().reads(key));
        let mut differing = arm.variant.differing(twin).peekable();
        differing.peek().is_none() || !differing.all(counts)
    });
}

/// Rejects arms whose trials, and so whose rows, would be identical.
pub(in crate::study) fn refuse_duplicates(origin: &str, arms: &[Arm]) -> Result<(), Error> {
    let mut places: HashMap<String, usize> = HashMap::new();
    for arm in arms {
        *places.entry(arm.place()).or_default() += 1;
    }
    let mut met: HashMap<String, &Arm> = HashMap::new();
    for arm in arms.iter().filter(|arm| places[&arm.place()] > 1) {
        let Some(twin) = met.insert(arm.effective_inputs(), arm) else {
            continue;
        };
        let key = arm.variant.differing(&twin.variant).next();
        let why = key.map_or(String::new(), |key| {
            format!(" (`{key}`: {})", arm.scope().why_unread(key))
        });
        let fault = format!(
            "`{}` and `{}` would run the same trials{why}: remove one, or split the study in two",
            twin.name(),
            arm.name()
        );
        return Err(error::file(origin, fault));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::protocol::{Protocol, frozen};

    fn protocol(methods: &str, more: &str, sets: &[&str]) -> Result<Protocol, Error> {
        let text = format!(
            "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [{methods}]\ntrials = 1\nepisodes = 1\n{more}"
        );
        frozen(&text, sets)
    }

    const TABLE: &str = "\"q-learning\"";
    const BOTH: &str = "\"q-learning\", \"xcs\"";

    #[test]
    fn a_setting_that_no_arm_reads_is_rejected_wherever_it_is_set() {
        let varied = "s.toml, sweep, variants or without";
        for (more, sets, place) in [
            (
                "[settings]\n\"xcs.mu\" = 0.1\n",
                &[][..],
                "s.toml, settings",
            ),
            (
                "[world-settings.maze4]\n\"xcs.mu\" = 0.1\n",
                &[],
                "s.toml, world-settings",
            ),
            (
                "[method-settings.q-learning]\n\"xcs.mu\" = 0.1\n",
                &[],
                "s.toml, method-settings",
            ),
            ("[sweep]\n\"xcs.mu\" = [0.1]\n", &[], varied),
            ("variants = [{ \"xcs.mu\" = 0.1 }]\n", &[], varied),
            ("without = [\"xcs.ga\"]\n", &[], varied),
            ("", &["xcs.mu=0.1"], "--set"),
        ] {
            let message = protocol(TABLE, more, sets).unwrap_err().to_string();
            let why = "has no effect: the method `q-learning` does not read it; `xcs`";
            let is_told = message.starts_with(&format!("{place}: `xcs.")) && message.contains(why);
            assert!(is_told, "{message}");
            // Control: another method reads it.
            let is_read = !more.contains("method-settings");
            assert_eq!(protocol(BOTH, more, sets).is_ok(), is_read, "{more}");
        }
    }

    #[test]
    fn a_sweep_that_an_arm_does_not_read_is_rejected_with_the_arm() {
        let sweep = "[sweep]\n\"xcs.mu\" = [0.1, 0.2]\n";
        let arenas = "arenas = [\"grid\", \"physics\"]\n[sweep]\n\"physics.noise\" = [0.0, 1.0]\n";
        let arms = "`maze4 q-learning grid neighbours xcs.mu=0.1` and `maze4 q-learning grid neighbours xcs.mu=0.2` \
            would run the same trials (`xcs.mu`: the method `q-learning` does not read it";
        for (methods, sweep, words) in [
            (BOTH, sweep, arms),
            (TABLE, arenas, "the arena `grid` does not read it"),
        ] {
            let message = protocol(methods, sweep, &[]).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
        assert_eq!(protocol("\"xcs\"", sweep, &[]).unwrap().arms.len(), 2);
        protocol(TABLE, &arenas.replace("\"grid\", ", ""), &[]).unwrap();
    }

    #[test]
    fn a_switch_and_its_parameter_are_swept_together_without_repeated_trials() {
        let sweep = "[sweep]\n\"reward.imprinting\" = [true, false]\n\"reward.theta_x\" = [0.2, 0.5, 0.8]\n";
        let study = protocol("\"xcscr\"", sweep, &[]).unwrap();
        let names = study.arms.iter().map(|arm| arm.variant.to_string());
        let expected = [
            "reward.imprinting=true reward.theta_x=0.2",
            "reward.imprinting=true reward.theta_x=0.5",
            "reward.imprinting=true reward.theta_x=0.8",
            "reward.imprinting=false reward.theta_x=0.2",
        ];
        assert!(names.eq(expected), "{:?}", study.arms);
        // The parameter alone, without the part that reads it.
        let off = format!("[settings]\n\"reward.imprinting\" = false\n{sweep}");
        let off = off.replace("\"reward.imprinting\" = [true, false]\n", "");
        let message = protocol("\"xcscr\"", &off, &[]).unwrap_err().to_string();
        let why = "the method `xcscr` does not read it here; `xcscr` with `reward.imprinting=true`";
        assert!(message.contains(why), "{message}");
        // A part that is left out.
        let without =
            "without = [\"plus.collision_rules\"]\n[sweep]\n\"plus.certainty\" = [1, 32]\n";
        assert_eq!(protocol("\"r-max\"", without, &[]).unwrap().arms.len(), 3);
    }

    #[test]
    fn a_sample_with_duplicate_arms_is_run_but_not_tuned() {
        let sample = "sample = 2\n[sweep]\n\"xcs.mu\" = [0.1, 0.2]\n";
        let study = protocol(BOTH, sample, &[]).unwrap();
        let fault = refuse_duplicates("s", &study.arms).unwrap_err().to_string();
        assert!(fault.contains("would run the same trials"), "{fault}");
        let study = protocol("\"xcs\"", sample, &[]).unwrap();
        refuse_duplicates("s", &study.arms).unwrap();
    }

    #[test]
    fn a_part_is_left_out_only_of_methods_that_have_it() {
        let study = protocol(BOTH, "without = [\"xcs.ga\"]\n", &[]).unwrap();
        let name = |arm: &Arm| format!("{} {}", arm.method_name(), arm.variant);
        let expected = [
            "q-learning without=nothing",
            "xcs without=nothing",
            "xcs without=xcs.ga",
        ];
        assert!(study.arms.iter().map(name).eq(expected), "{:?}", study.arms);
    }

    #[test]
    fn a_robot_needs_an_arm_in_physics() {
        let robot = "robot = \"turtlebot3-burger\"\n";
        let message = protocol(TABLE, robot, &[]).unwrap_err().to_string();
        assert!(
            message.contains("the arena `grid` has no robot"),
            "{message}"
        );
        let driven = format!("{robot}arenas = [\"physics\"]\n");
        protocol(TABLE, &driven, &[]).expect("control");
    }
}
