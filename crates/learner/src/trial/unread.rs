//! Settings that were set by hand, and that nothing reads in a trial.

use std::fmt;

use super::resolve::Resolved;
use super::settings_error::SettingOrigin;
use crate::agent::Method;
use xcscr_robot::arena::ArenaKind;

/// The settings of `reward` that all methods read.
const COMMON_REWARDS: [&str; 6] = [
    "goal",
    "step",
    "collision",
    "gamma",
    "step_threshold",
    "step_threshold_from_maze",
];
/// The settings of `reward` that only standard XCS reads.
const STANDARD_REWARDS: [&str; 2] = ["xcs_payment", "xcs_step_limit"];

/// A setting that has no effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unread {
    key: String,
    origin: SettingOrigin,
    why: &'static str,
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
fn why_unread(key: &str, method: Method, arena: ArenaKind) -> Option<&'static str> {
    let (section, name) = key.split_once('.').unwrap_or((key, ""));
    let is_tabular = match method {
        Method::QLearning | Method::SarsaLambda | Method::DynaQ => true,
        Method::Xcs | Method::Xcsam | Method::AdaptedEven | Method::AdaptedDiscounted => false,
        Method::Xcscr | Method::XcscrCoevolved | Method::XcscrPlus | Method::RMax => false,
    };
    let is_standard = matches!(method, Method::Xcs | Method::Xcsam);
    let has_model = matches!(method, Method::XcscrPlus | Method::RMax);
    match section {
        "physics" if arena == ArenaKind::Grid => Some("the arena `grid` has no robot"),
        "xcs" if !method.learns_rules() => Some("only classifier systems read it"),
        "tabular" if !is_tabular => Some("only `q-learning`, `sarsa-lambda` and `dyna-q` read it"),
        "plus" if ["replay", "guided_covering"].contains(&name) => {
            (method != Method::XcscrPlus).then_some("only `xcscr-plus` reads it")
        }
        "plus" if !has_model => Some("only `xcscr-plus` and `r-max` read it"),
        "reward" if STANDARD_REWARDS.contains(&name) => {
            (!is_standard).then_some("only `xcs` and `xcsam` read it")
        }
        "reward" if COMMON_REWARDS.contains(&name) => None,
        "reward" if !method.learns_rules() => Some("only classifier systems read it"),
        _ => None,
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
            said(Method::QLearning, "plus.replay=false"),
            ["--set: `plus.replay` has no effect: only `xcscr-plus` reads it"]
        );
        assert_eq!(
            said(Method::XcscrPlus, "physics.noise=2"),
            ["--set: `physics.noise` has no effect: the arena `grid` has no robot"]
        );
        assert_eq!(said(Method::XcscrPlus, "plus.replay=false"), [""; 0]);
        assert_eq!(said(Method::Xcscr, "reward.imprinting=false"), [""; 0]);
        let in_physics = unread(Method::RMax, ArenaKind::Physics, "physics.noise=2");
        assert_eq!(in_physics, [""; 0]);
    }

    /// The other value of each setting, so that it can change what is learned.
    const CHANGES: [&str; 17] = [
        "xcs.dont_care=0.9",
        "xcs.ga=false",
        "tabular.alpha=0.5",
        "tabular.replays=3",
        "plus.replay=false",
        "plus.guided_covering=false",
        "plus.planned_exploration=false",
        "plus.collision_rules=false",
        "reward.goal=500",
        "reward.step=-2",
        "reward.collision=-100",
        "reward.gamma=0.5",
        "reward.failure=-10",
        "reward.beta_success=0.1",
        "reward.short_term_filter=false",
        "reward.xcs_payment=final",
        "physics.noise=2",
    ];

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
            for set in CHANGES {
                let is_unread = !unread(method, ArenaKind::Grid, set).is_empty();
                let same = learned(method, &[set.to_owned()]) == usual;
                assert!(same || !is_unread, "{} reads {set}", method.name());
                unread_ones += usize::from(is_unread);
                read_ones += usize::from(!same);
            }
        }
        assert!(
            unread_ones > 50 && read_ones > 50,
            "{unread_ones} {read_ones}"
        );
    }
}
