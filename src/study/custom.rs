//! Custom agents in studies.

use std::fmt;
use std::sync::Arc;

use super::error;
use super::protocol::{Protocol, is_plain_name};
use crate::agent::{Agent, Method};
use crate::trial::Plan;
use crate::{Error, ErrorKind};

/// Builds the agent of a trial from the trial's plan.
type Build = dyn Fn(&Plan) -> Box<dyn Agent> + Send + Sync;

/// Custom agents of a program, with their names.
#[derive(Clone, Default)]
pub struct Agents(Vec<(String, Arc<Build>)>);

impl Agents {
    /// Adds an agent, which a study runs in the worlds, arenas, sensors and variants of the built-in methods,
    /// with the same seeds. `build` creates the agent of a trial from its plan, which has the
    /// world, the settings and the seed.
    ///
    /// The agent appears under its name in reports, tests, tables and figures. Any program can
    /// write these, but only a program that has the agent can run its trials.
    ///
    /// # Errors
    /// When the name is taken, or has other characters than lower-case
    /// letters, digits and hyphens.
    pub fn with(
        mut self,
        name: &str,
        build: impl Fn(&Plan) -> Box<dyn Agent> + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        let mut methods = Method::ALL.iter().map(|method| method.name());
        let fault = if !is_plain_name(name) {
            format!(
                "invalid agent name `{name}`: use 1 to 40 lower-case letters, digits and hyphens"
            )
        } else if self.names().any(|known| known == name) || methods.any(|method| method == name) {
            format!("`{name}` is the name of another method")
        } else {
            self.0.push((name.to_owned(), Arc::new(build)));
            return Ok(self);
        };
        Err(ErrorKind::BadData.error(fault))
    }

    /// Returns the names.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.0.iter().map(|(name, _)| name)
    }

    /// Builds the agent of this name for a trial.
    ///
    /// # Errors
    /// When this program has no agent of this name.
    pub fn build(&self, name: &str, plan: &Plan) -> Result<Box<dyn Agent>, String> {
        let found = self.0.iter().find(|(known, _)| known == name);
        let (_, build) = found.ok_or_else(|| missing(name))?;
        Ok(build(plan))
    }

    /// Checks that this program has all agents of a study.
    ///
    /// # Errors
    /// When an agent is missing.
    pub fn require_for(&self, protocol: &Protocol) -> Result<(), Error> {
        let mut named = protocol.arms.iter().filter_map(|arm| arm.agent.as_ref());
        let lacking = named.find(|name| !self.names().any(|known| known == *name));
        lacking.map_or(Ok(()), |name| {
            Err(error::file(&protocol.name, missing(name)))
        })
    }
}

fn missing(name: &str) -> String {
    format!("this program has no agent `{name}`: run the study with the program that has it")
}

impl fmt::Debug for Agents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.names()).finish()
    }
}
