//! Studies that compare custom agents with the built-in methods.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use super::error;
use super::protocol::Protocol;
use super::runner::{StudyWatcher, run_trials};
use super::store::{StudyFolder, TrialRecord};
use crate::Error;
use crate::agent::Agent;
use crate::trial::Plan;

/// Builds the agent of a trial from the trial's plan.
type Build = dyn Fn(&Plan) -> Box<dyn Agent> + Send + Sync;

/// Custom agents of a program, by name.
#[derive(Default)]
pub struct Agents(BTreeMap<String, Box<Build>>);

impl Agents {
    /// Builds the agent of this name for a trial.
    ///
    /// # Errors
    /// When this program has no agent of this name.
    pub fn build(&self, name: &str, plan: &Plan) -> Result<Box<dyn Agent>, String> {
        let build = self.0.get(name).ok_or_else(|| missing(name))?;
        Ok(build(plan))
    }

    /// Checks that this program has all agents of a study.
    ///
    /// # Errors
    /// When an agent is missing.
    pub fn require_for(&self, protocol: &Protocol) -> Result<(), Error> {
        let mut named = protocol.arms.iter().filter_map(|arm| arm.agent.as_ref());
        let lacking = named.find(|name| !self.0.contains_key(*name));
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
        f.debug_set().entries(self.0.keys()).finish()
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
    /// Creates a study of built-in methods.
    pub fn new(protocol: Protocol) -> Self {
        Self {
            protocol,
            agents: Agents::default(),
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

    /// Adds a custom agent in the worlds, arenas, sensors and variants of the built-in methods,
    /// with the same seeds. `build` creates the agent of a trial from its plan, which has the
    /// world, the settings and the seed.
    ///
    /// The agent appears under its name in reports, tests, tables and figures. Any program can
    /// write these, but only a program that has the agent can run its trials.
    ///
    /// # Errors
    /// When the name is taken, or has other characters than lower-case
    /// letters, digits and hyphens.
    pub fn with_agent(
        mut self,
        name: &str,
        build: impl Fn(&Plan) -> Box<dyn Agent> + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        self.protocol.add_agent(name)?;
        self.agents.0.insert(name.to_owned(), Box::new(build));
        Ok(self)
    }

    /// Sets the method, or the custom agent, that the report compares with each other one.
    ///
    /// # Errors
    /// When the study has no method or agent of this name.
    pub fn reference(mut self, name: &str) -> Result<Self, Error> {
        let set = self.protocol.set_reference(name);
        set.map_err(|fault| error::file(&self.protocol.name, fault))?;
        Ok(self)
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
        self.agents.0.keys().try_for_each(|name| {
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
