//! Studies that compare custom agents with the built-in methods.

use std::fmt;
use std::path::Path;

use super::error;
use super::protocol::{Protocol, is_plain_name};
use super::runner::{StudyWatcher, run_trials};
use super::store::{StudyFolder, TrialRecord};
use crate::agent::{Agent, Method};
use crate::trial::Plan;
use crate::{Error, ErrorKind};

/// Builds the agent of a trial from the trial's plan.
type Build = dyn Fn(&Plan) -> Box<dyn Agent> + Send + Sync;

/// Custom agents of a program, with their names.
#[derive(Default)]
pub struct Agents(Vec<(String, Box<Build>)>);

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
            self.0.push((name.to_owned(), Box::new(build)));
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

/// A study that can be run: a protocol, and custom agents in addition to the built-in methods.
#[derive(Debug)]
pub struct Study {
    protocol: Protocol,
    pub(super) agents: Agents,
    retry_failed: bool,
    force: bool,
}

impl Study {
    /// Creates the study of a protocol, which was frozen with these agents.
    pub fn new(protocol: Protocol, agents: Agents) -> Self {
        Self {
            protocol,
            agents,
            retry_failed: false,
            force: false,
        }
    }

    /// Sets whether to repeat the trials that failed. Their tables, report and figures are removed first.
    pub fn retry_failed(mut self, retry: bool) -> Self {
        self.retry_failed = retry;
        self
    }

    /// Sets whether to replace files of a smaller study in the folder that were changed by hand.
    pub fn replacing(mut self, force: bool) -> Self {
        self.force = force;
        self
    }

    /// Returns the protocol.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// Runs the missing trials of the study in the folder `out`, on `jobs` threads (all cores when
    /// 0). The results do not depend on `jobs`. A smaller study in the folder stays there until the last trial is
    /// finished.
    ///
    /// # Errors
    /// When the folder contains another study, is in use, or cannot be written, a file of a smaller study there was
    /// changed by hand, or a custom agent has another result than the one stored.
    pub fn run(
        &self,
        out: &Path,
        jobs: usize,
        watcher: &mut dyn StudyWatcher,
    ) -> Result<StudyFolder, Error> {
        let mut folder = StudyFolder::open(out, &self.protocol)?.replacing(self.force);
        self.require_same_agents(&folder)?;
        folder.note_smaller()?;
        if self.retry_failed {
            folder.remove_failed()?;
        }
        watcher.begins(folder.missing().len());
        for task in 1..=folder.planned().tasks() {
            run_trials(&mut folder, &self.agents, task, jobs, watcher)?;
            if !folder.missing_of(task).is_empty() {
                break;
            }
        }
        if folder.missing().is_empty() {
            folder.replace_smaller()?;
        }
        Ok(folder)
    }

    /// Repeats the first stored trial of each custom agent. A changed agent would mix its results with earlier ones.
    fn require_same_agents(&self, folder: &StudyFolder) -> Result<(), Error> {
        self.agents.names().try_for_each(|name| {
            let is_custom = |record: &TrialRecord| {
                let agent = &self.protocol.arm(record.trial).agent;
                agent.as_ref() == Some(name) && record.result.is_ok()
            };
            folder.records().find(is_custom).map_or(Ok(()), |stored| {
                let repeated = TrialRecord::of(&self.protocol, &self.agents, stored.trial);
                folder.require_equal(&repeated)
            })
        })
    }
}
