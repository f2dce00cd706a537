//! Recordings for ROS 2, made by repeating the recorded run.

use super::error::RunError;
use super::evaluation::evaluation_plan;
use super::folder::RunFolder;
use super::source::Source;
use crate::agent::Knowledge;
use crate::arena::ArenaKind;
use crate::record::{RecordingKind, RosBag};
use crate::trial::{Evaluation, Plan, Trial};

impl RunFolder {
    /// Returns the run as an MCAP file for ROS 2, with the topics of `docs/src/reference/recordings.md`. The
    /// same run produces the same bytes.
    ///
    /// # Errors
    /// If the run cannot be read or repeated.
    pub fn ros_bag(&self) -> Result<Vec<u8>, RunError> {
        bag(&self.plan()?, None, None)
    }
}

impl Source {
    /// Returns the recorded episodes as an MCAP file for ROS 2.
    ///
    /// # Errors
    /// If they cannot be repeated, or the recording shows highlights, which have parts of many
    /// episodes.
    pub fn ros_bag(&self) -> Result<Vec<u8>, RunError> {
        self.require_method()?;
        let only = match self.extent {
            RecordingKind::Episode(episode) => Some(episode),
            RecordingKind::Run => None,
            RecordingKind::Highlights | RecordingKind::Comparison => {
                return Err(RunError::Recording {
                    file: self.file.clone(),
                    fault: "a highlights recording shows parts of many episodes and cannot be written for ROS 2; give an episode, \
                            run.mcap, or the folder of a run"
                        .to_owned(),
                });
            }
        };
        bag(&self.plan, self.evaluated.as_ref(), only)
    }
}

/// Repeats the run, and writes one episode or all.
fn bag(plan: &Plan, evaluated: Option<&Knowledge>, only: Option<u32>) -> Result<Vec<u8>, RunError> {
    let physics = &plan.config.settings.physics;
    let has_wheels = plan.config.arena == ArenaKind::Physics;
    let wheel_base_m = has_wheels.then_some(physics.wheel_base_m);
    let mut bag = RosBag::new(only, wheel_base_m, physics.lidar.clone())?;
    // The bag breaks on errors, which `finish` returns.
    match evaluated {
        Some(knowledge) => {
            let episodes = plan.config.episodes;
            let plan = evaluation_plan(plan, knowledge, episodes)?;
            Evaluation::observed(&plan, knowledge, episodes, &mut bag)?;
        }
        None => {
            let _ = Trial::new(plan.clone())?.run(&mut bag);
        }
    }
    Ok(bag.finish()?)
}
