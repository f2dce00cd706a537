//! Recordings for ROS 2, made by repeating the recorded run.

use super::folder::RunFolder;
use super::rerun::Rerun;
use super::source::Source;
use crate::arena::ArenaKind;
use crate::error::Error;
use crate::record::RosBag;

impl RunFolder {
    /// Returns the run as an MCAP file for ROS 2, with the topics of `docs/src/reference/recordings.md`. The
    /// same run produces the same bytes.
    ///
    /// # Errors
    /// If the run cannot be read or repeated.
    pub fn ros_bag(&self) -> Result<Vec<u8>, Error> {
        bag(&Rerun::training(self.plan()?), None)
    }
}

impl Source {
    /// Returns the recorded episodes as an MCAP file for ROS 2.
    ///
    /// # Errors
    /// If they cannot be repeated.
    pub fn ros_bag(&self) -> Result<Vec<u8>, Error> {
        self.require_method()?;
        bag(&self.run, self.extent.episode())
    }
}

/// Repeats the run, and writes one episode or all.
fn bag(run: &Rerun, only: Option<u32>) -> Result<Vec<u8>, Error> {
    let config = &run.plan.config;
    let physics = &config.settings.physics;
    let wheel_base_m = (config.arena == ArenaKind::Physics).then_some(physics.wheel_base_m);
    let mut bag = RosBag::new(only, wheel_base_m, physics.lidar.clone())?;
    // The bag breaks on errors, which `finish` returns.
    run.watch(&mut bag)?;
    bag.finish()
}
