//! Settings that were set by hand, and that nothing reads in a trial.

use std::fmt;

use super::resolve::Resolved;
use super::settings_error::SettingOrigin;
use crate::agent::Method;
use xcscr_robot::arena::ArenaKind;

/// A setting that has no effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unread {
    key: String,
    origin: SettingOrigin,
    why: String,
}

impl fmt::Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, origin, why } = self;
        write!(f, "{origin}: `{key}` has no effect: {why}")
    }
}

impl Resolved {
    /// Returns the settings that were set by hand, and that nothing reads with this method and arena. A robot profile
    /// counts as one setting. Switches that turn other settings off are not considered.
    pub fn unread(&self, method: Method, arena: ArenaKind) -> Vec<Unread> {
        let profile = self.entries().find_map(|(_, _, origin)| match origin {
            SettingOrigin::Robot(_) => Some(("physics".to_owned(), origin.clone())),
            _ => None,
        });
        let given = self.given.iter().cloned().chain(profile);
        let unread = |(key, origin): (String, SettingOrigin)| {
            let why = why_unread(&key, method, arena)?;
            Some(Unread { key, origin, why })
        };
        given.filter_map(unread).collect()
    }
}

/// Returns the reason why nothing reads a setting; `None` if something reads it.
pub fn why_unread(key: &str, method: Method, arena: ArenaKind) -> Option<String> {
    if key.starts_with("physics") && arena == ArenaKind::Grid {
        return Some("the arena `grid` has no robot".to_owned());
    }
    if reads(method, key) {
        return None;
    }
    let readers = Method::ALL.iter().filter(|&&method| reads(method, key));
    let names: Vec<String> = readers
        .map(|method| format!("`{}`", method.name()))
        .collect();
    let [first @ .., last] = names.as_slice() else {
        return Some("no method reads it".to_owned());
    };
    Some(match first {
        [] => format!("only {last} reads it"),
        _ => format!("only {} and {last} read it", first.join(", ")),
    })
}

/// Returns true if a method reads a setting. A test compares this with what each method learns.
fn reads(method: Method, key: &str) -> bool {
    let (is_standard, is_adapted, is_tabular) = match method {
        Method::Xcs | Method::Xcsam => (true, false, false),
        Method::AdaptedEven | Method::AdaptedDiscounted => (false, true, false),
        Method::QLearning | Method::SarsaLambda | Method::DynaQ => (false, false, true),
        Method::Xcscr | Method::XcscrCoevolved | Method::XcscrPlus => (false, false, false),
        Method::RMax => (false, false, false),
    };
    let has_rules = method.learns_rules();
    let has_mechanisms = has_rules && !is_standard && !is_adapted;
    match key.split_once('.').unwrap_or((key, "")) {
        ("xcs", "rate_scope") => has_mechanisms,
        ("xcs", "value_over_match_set") => has_rules && method != Method::XcscrPlus,
        ("xcs", _) => has_rules,
        ("tabular", "lambda") => method == Method::SarsaLambda,
        ("tabular", "replays") => method == Method::DynaQ,
        ("tabular", _) => is_tabular,
        ("plus", "repair") => method == Method::XcscrPlus,
        ("plus", _) => matches!(method, Method::XcscrPlus | Method::RMax),
        ("reward", "xcs_payment" | "xcs_step_limit") => is_standard,
        ("reward", "gamma") => method != Method::AdaptedEven,
        ("reward", "even_constant") => has_mechanisms || method == Method::AdaptedEven,
        ("reward", "failure") => has_rules,
        ("reward", "stack_evolution") => has_rules && !is_standard,
        ("reward", "goal" | "step" | "collision") => true,
        ("reward", "step_threshold" | "step_threshold_from_maze") => true,
        ("reward", _) => has_mechanisms,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::Agent;
    use crate::trial::{Plan, Settings};
    use xcscr_robot::sensor::Sensor;
    use xcscr_robot::world::Maze;

    fn unread(method: Method, arena: ArenaKind, set: &str) -> Vec<String> {
        let resolved = Resolved::new(&Settings::of(method), &[], &[set.to_owned()]).unwrap();
        let unread = resolved.unread(method, arena);
        unread.iter().map(Unread::to_string).collect()
    }

    #[test]
    fn a_setting_that_nothing_reads_is_named_with_its_readers() {
        let said = |method, set| unread(method, ArenaKind::Grid, set);
        assert_eq!(
            said(Method::QLearning, "plus.repair=false"),
            ["--set: `plus.repair` has no effect: only `xcscr-plus` reads it"]
        );
        assert_eq!(
            said(Method::AdaptedEven, "reward.theta_x=0.1"),
            [
                "--set: `reward.theta_x` has no effect: only `xcscr`, `xcscr-coevolved` and `xcscr-plus` read it"
            ]
        );
        assert_eq!(
            said(Method::XcscrPlus, "physics.noise=2"),
            ["--set: `physics.noise` has no effect: the arena `grid` has no robot"]
        );
        assert_eq!(said(Method::XcscrPlus, "plus.repair=false"), [""; 0]);
        assert_eq!(said(Method::Xcscr, "reward.imprinting=false"), [""; 0]);
        let in_physics = unread(Method::RMax, ArenaKind::Physics, "physics.noise=2");
        assert_eq!(in_physics, [""; 0]);
    }

    /// Returns another value of each setting of the learners, so that it can change what is learned.
    fn changes() -> Vec<String> {
        let defaults = Resolved::new(&Settings::default(), &[], &[]).unwrap();
        let entries = defaults.entries();
        let of_learners = entries.filter(|(key, ..)| {
            let sections = ["xcs.", "reward.", "plus.", "tabular."];
            sections.iter().any(|section| key.starts_with(section))
        });
        of_learners
            .map(|(key, value, _)| changed(key, &value))
            .collect()
    }

    /// Returns a setting with the first valid value that differs from `value`.
    fn changed(key: &str, value: &str) -> String {
        let read =
            |value: &str| Resolved::new(&Settings::default(), &[], &[format!("{key}={value}")]);
        let values: Vec<String> = match value.parse::<f64>() {
            Ok(number) => [0.5 * number, 2.0 * number, number + 1.0, -60.0]
                .map(|number| number.to_string())
                .into(),
            // The names of all values stand in backticks.
            Err(_) => read("none")
                .unwrap_err()
                .to_string()
                .split('`')
                .map(str::to_owned)
                .collect(),
        };
        let values = values
            .into_iter()
            .chain(["true", "false"].map(str::to_owned));
        let mut others = values.filter(|one| one != value.trim_matches('"') && read(one).is_ok());
        let other = others
            .next()
            .unwrap_or_else(|| panic!("{key} has one value, {value}"));
        format!("{key}={other}")
    }

    #[test]
    fn a_setting_that_is_called_unread_changes_nothing_that_is_learned() {
        let maze = Maze::load("../../worlds/maze4.json".as_ref()).unwrap();
        let learned = |method, sets: &[String]| {
            let settings = Resolved::new(&Settings::of(method), &[], sets).unwrap();
            let plan = Plan::new(maze.clone()).method(method).episodes(4);
            let plan = plan.arena(ArenaKind::Grid).sensor(Sensor::Neighbours);
            let trial = plan.settings(settings.settings).run().unwrap();
            let agent: &dyn Agent = trial.method();
            format!("{:?} {:?}", trial.progress(), agent.knowledge())
        };
        let (mut unread_ones, mut read_ones) = (0, 0);
        for &method in Method::ALL {
            let usual = learned(method, &[]);
            for set in changes() {
                let is_unread = !unread(method, ArenaKind::Grid, &set).is_empty();
                let same = learned(method, std::slice::from_ref(&set)) == usual;
                assert!(same || !is_unread, "{} reads {set}", method.name());
                unread_ones += usize::from(is_unread);
                read_ones += usize::from(!same);
            }
        }
        assert!(
            unread_ones > 200 && read_ones > 100,
            "{unread_ones} {read_ones}"
        );
    }
}
