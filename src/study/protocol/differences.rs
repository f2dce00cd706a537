//! The reference method of a protocol, and its differences from another protocol.

use std::collections::BTreeMap;

use toml::{Table, Value};

use super::{Arm, Protocol, named};
use crate::agent::Method;
use crate::trial::{Settings, flatten, why_unread};
use crate::world::Maze;

/// Maximum number of differences that a message lists.
const MOST_LISTED: usize = 3;

impl Protocol {
    /// Checks that the study has its reference method.
    pub(super) fn check_reference(&self) -> Result<(), String> {
        let Some(name) = &self.reference else {
            return Ok(());
        };
        let methods = distinct(self.arms.iter().map(|arm| arm.method_name().to_owned()));
        match methods.contains(name) {
            true => Ok(()),
            false => Err(format!(
                "`reference` is `{name}`, which is not a method of this study: give one of {}",
                methods.join(", ")
            )),
        }
    }

    /// Returns the method that reports compare with each other one: the chosen reference, or else
    /// `xcscr-plus`, `xcscr`, or the last method.
    pub fn reference_method(&self) -> &str {
        let has = |name: &&str| self.arms.iter().any(|arm| arm.method_name() == *name);
        let ours = [Method::XcscrPlus, Method::Xcscr].map(Method::name);
        let last = self.arms.last().map_or("", Arm::method_name);
        let usual = || ours.into_iter().find(has).unwrap_or(last);
        self.reference.as_deref().unwrap_or_else(usual)
    }

    /// Returns the settings that the study changes in some arm and that nothing reads, each with the reason. A setting
    /// is read if an arm reads it that has the same value or changes it, too.
    pub fn unread(&self) -> BTreeMap<String, String> {
        let by_name = |all: &Settings| settings(all).into_iter().collect::<BTreeMap<_, _>>();
        let arms = self.arms.iter().filter(|arm| arm.agent.is_none());
        let arms = arms.map(|arm| {
            let usual = by_name(&Settings::of(arm.method));
            (arm, by_name(&arm.settings), usual)
        });
        let arms: Vec<_> = arms.collect();
        let mut unread = BTreeMap::new();
        for (arm, here, usual) in &arms {
            let changed = here
                .iter()
                .filter(|&(key, value)| usual.get(key) != Some(value));
            for (key, value) in changed {
                let why = |arm: &Arm| why_unread(key, arm.method, arm.arena);
                let is_read = || {
                    arms.iter().any(|(other, there, usual)| {
                        let has_it =
                            there.get(key) == Some(value) || there.get(key) != usual.get(key);
                        has_it && why(other).is_none()
                    })
                };
                if let Some(why) = why(arm).filter(|_| !is_read()) {
                    unread.insert(key.clone(), why);
                }
            }
        }
        of_robot_as_one(unread)
    }

    /// Describes the first differences from the protocol that was found in a folder.
    pub(in crate::study) fn differences(&self, found: &Self) -> String {
        let mut differences = self.different_values(found);
        differences.extend(self.different_world(found));
        differences.extend(self.different_setting(found));
        let more = differences.len().saturating_sub(MOST_LISTED);
        differences.truncate(MOST_LISTED);
        let more = match more {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        format!("{}{more}", differences.join(", "))
    }

    /// Describes the numbers and lists that differ.
    fn different_values(&self, found: &Self) -> Vec<String> {
        let list = |one: &Self, name: fn(&Arm) -> String| {
            distinct(one.arms.iter().map(name).filter(|name| !name.is_empty())).join(" ")
        };
        let values = |one: &Self| {
            [
                ("version", one.version.clone()),
                ("name", one.name.clone()),
                ("seed", one.seed.to_string()),
                ("trials", one.trials.to_string()),
                ("episodes", one.episodes.to_string()),
                ("drives", one.drives.to_string()),
                ("reference", one.reference_method().to_owned()),
                ("worlds", list(one, |arm| arm.world.clone())),
                ("methods", list(one, |arm| arm.method_name().to_owned())),
                ("arenas", list(one, |arm| arm.arena.name().to_owned())),
                ("sensors", list(one, |arm| arm.sensor.name().to_owned())),
                ("sweep", list(one, |arm| arm.variant.to_string())),
            ]
        };
        let pairs = values(self).into_iter().zip(values(found));
        pairs
            .filter(|((_, here), (_, there))| here != there)
            .map(|((key, here), (_, there))| format!("`{key}` is `{here}`, but `{there}` there"))
            .collect()
    }

    /// Describes a world of the same name with other contents.
    fn different_world(&self, found: &Self) -> Option<String> {
        let is_changed =
            |maze: &&Maze| named(&found.worlds, maze.name()).is_some_and(|other| other != *maze);
        let maze = self.worlds.iter().find(is_changed)?;
        Some(format!("the world `{}` was changed", maze.name()))
    }

    /// Describes the first setting that differs in arms of the same name.
    fn different_setting(&self, found: &Self) -> Option<String> {
        let of_arm = |arm: &Arm| {
            let other = found.arms.iter().find(|other| other.name() == arm.name())?;
            let mut pairs = settings(&arm.settings)
                .into_iter()
                .zip(settings(&other.settings));
            let ((key, here), (_, there)) = pairs.find(|(here, there)| here != there)?;
            let name = arm.name();
            Some(format!("`{key}` is {here} in {name}, but {there} there"))
        };
        self.arms.iter().find_map(of_arm)
    }
}

/// Names many settings of the robot as one: a robot profile changes many at once.
fn of_robot_as_one(mut unread: BTreeMap<String, String>) -> BTreeMap<String, String> {
    let section = "physics";
    let is_of_robot = |key: &str| key.split('.').next() == Some(section);
    if unread.keys().filter(|key| is_of_robot(key)).count() > MOST_LISTED {
        let why = unread.iter().find(|(key, _)| is_of_robot(key));
        let why = why.map(|(_, why)| (section.to_owned(), why.clone()));
        unread.retain(|key, _| !is_of_robot(key));
        unread.extend(why);
    }
    unread
}

/// Returns all settings by their full names.
fn settings(settings: &Settings) -> Vec<(String, Value)> {
    flatten(Table::try_from(settings).expect("settings are plain data"))
}

/// Returns each item once, in the order of first occurrence.
pub fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut list = Vec::new();
    for item in items {
        if !list.contains(&item) {
            list.push(item);
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use crate::study::protocol::frozen;

    const SMALL: &str =
        "name = 's'\nworlds = ['maze4']\nmethods = ['xcs', 'xcscr']\ntrials = 2\nepisodes = 3\n";

    #[test]
    fn the_reference_is_the_chosen_method_and_must_be_in_the_study() {
        assert_eq!(frozen(SMALL, &[]).unwrap().reference_method(), "xcscr");
        let chosen = |name: &str| frozen(&format!("{SMALL}reference = '{name}'\n"), &[]);
        assert_eq!(chosen("xcs").unwrap().reference_method(), "xcs");
        let fault = chosen("r-max").unwrap_err().to_string();
        assert!(fault.contains("give one of xcs, xcscr"), "{fault}");
    }

    #[test]
    fn a_setting_that_no_method_of_a_study_reads_is_named() {
        let unread = |set: &str| frozen(SMALL, &[set]).unwrap().unread();
        assert!(unread("xcs.beta=0.3").is_empty());
        assert!(unread("reward.theta_x=0.3").is_empty(), "xcscr reads it");
        assert_eq!(
            unread("physics.noise=2")["physics.noise"],
            "the arena `grid` has no robot"
        );
        assert_eq!(
            unread("tabular.lambda=0.3")["tabular.lambda"],
            "only `sarsa-lambda` reads it"
        );
        let robot = SMALL.replace("name", "robot = 'turtlebot3-burger'\nname");
        let unread = frozen(&robot, &[]).unwrap().unread();
        assert!(unread.keys().eq(["physics"]), "{unread:?}");
    }

    #[test]
    fn settings_of_one_method_that_only_other_methods_read_are_named() {
        let text = SMALL.replace("xcscr", "q-learning");
        let unread = |own: &str| frozen(&format!("{text}{own}\n"), &[]).unwrap().unread();
        let wrong = unread("[method-settings.xcs]\ntabular.alpha = 0.1");
        assert!(wrong.keys().eq(["tabular.alpha"]), "{wrong:?}");
        for right in [
            "[method-settings.q-learning]\ntabular.alpha = 0.1",
            "[settings]\ntabular.alpha = 0.1",
            "[settings]\nxcs.beta = 0.3\n[method-settings.xcs]\nxcs.beta = 0.1",
            "[sweep]\nxcs.beta = [0.2, 0.3]",
        ] {
            assert!(unread(right).is_empty(), "{right}: {:?}", unread(right));
        }
    }

    #[test]
    fn differences_are_named() {
        let found = frozen(SMALL, &[]).unwrap();
        let said = |text: &str, sets: &[&str]| frozen(text, sets).unwrap().differences(&found);
        let episodes = said(&SMALL.replace("episodes = 3", "episodes = 4"), &[]);
        assert_eq!(episodes, "`episodes` is `4`, but `3` there");
        let beta = said(SMALL, &["xcs.beta=0.3"]);
        let words = "`xcs.beta` is 0.3 in maze4 xcs grid neighbours, but 0.2 there";
        assert_eq!(beta, words);
        let mut world = found.clone();
        let text = include_str!("../../../worlds/maze5.json").replace("\"maze5\"", "\"maze4\"");
        world.worlds = vec![crate::world::Maze::from_json(text.as_bytes(), "maze4").unwrap()];
        assert_eq!(world.differences(&found), "the world `maze4` was changed");
    }
}
