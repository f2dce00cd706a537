//! The arms of custom agents.

use super::{Arm, Protocol};
use crate::Error;
use crate::agent::Method;
use crate::study::error;

/// The arms of a custom agent without its name, one for each combination of world, arena, sensor and
/// variant. They have the settings of the study, but those of no method. They are not part of the
/// frozen study, so protocols that differ in them are equal.
#[derive(Debug, Clone, Default)]
pub struct AgentArms(pub(super) Vec<Arm>);

impl PartialEq for AgentArms {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Protocol {
    /// Adds a custom agent in every combination of world, arena, sensor and variant.
    pub(in crate::study) fn add_agent(&mut self, name: &str) -> Result<(), Error> {
        let origin = self.name.clone();
        let refusal = |fault: String| Err(error::file(&origin, fault));
        if !is_plain_name(name) {
            return refusal(format!(
                "invalid agent name `{name}`: use 1 to 40 lower-case letters, digits and hyphens"
            ));
        }
        let is_taken = self.arms.iter().any(|arm| arm.method_name() == name);
        if is_taken || Method::ALL.iter().any(|method| method.name() == name) {
            return refusal(format!("`{name}` is the name of another method"));
        }
        if self.agent_arms.0.is_empty() {
            return refusal(
                "a study that was read from its folder takes no more agents".to_owned(),
            );
        }
        for arm in &self.agent_arms.0 {
            let last = self
                .arms
                .iter()
                .rposition(|other| other.differs_only_in_method(arm));
            let own = Arm {
                agent: Some(name.to_owned()),
                ..arm.clone()
            };
            self.arms
                .insert(last.map_or(self.arms.len(), |last| last + 1), own);
        }
        self.check_numbers()
            .or_else(|fault| refusal(fault.to_string()))
    }
}

/// Returns true for a valid name of a custom agent or of a variant. It is printed in tables, pages
/// and terminals.
pub fn is_plain_name(name: &str) -> bool {
    let is_plain = |letter: char| matches!(letter, 'a'..='z' | '0'..='9' | '-');
    (1..=40).contains(&name.len()) && name.chars().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::protocol::frozen;
    use crate::trial::Settings;

    #[test]
    fn an_agent_has_the_settings_of_the_study_and_those_of_no_method() {
        for methods in ["'xcs'", "'q-learning', 'xcs'", "'xcs', 'q-learning'"] {
            let text = format!(
                "name = 's'\nworlds = ['maze4', 'maze5']\nmethods = [{methods}]\ntrials = 1\nepisodes = 1\n[world-settings.maze5]\nreward.goal = 5\n[method-settings.xcs]\nreward.goal = 6\n[method-settings.q-learning]\nreward.goal = 7\n"
            );
            let mut protocol = frozen(&text, &[]).unwrap();
            protocol.add_agent("own").unwrap();
            let own = |arm: &&Arm| arm.agent.is_some();
            let arms: Vec<&Arm> = protocol.arms.iter().filter(own).collect();
            let worlds: Vec<&str> = arms.iter().map(|arm| &arm.world[..]).collect();
            assert_eq!(worlds, ["maze4", "maze5"]);
            assert_eq!(arms[0].settings, Settings::default());
            assert_eq!(arms[1].settings.reward.goal, 5.0);
            assert!(protocol.arms.last().is_some_and(|arm| own(&arm)));
        }
    }
}
