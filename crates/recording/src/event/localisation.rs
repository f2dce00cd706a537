//! `/localisation`: the uncertainty and the error of the pose that the robot estimates.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use xcscr_robot::arena::{Sample, Sensed};

/// The uncertainty and the error of the estimated pose at the end of a reset or an action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Localisation {
    /// Number of the episode, from 1.
    pub episode: u32,
    /// Number of the step, from 1; 0 before the first step.
    pub step: u32,
    /// Standard deviation of x, metres.
    pub sd_x_m: f64,
    /// Standard deviation of y, metres.
    pub sd_y_m: f64,
    /// Standard deviation of the heading, degrees.
    pub sd_heading_deg: f64,
    /// Distance from the true position, metres.
    pub error_m: f64,
    /// Difference from the true heading, degrees.
    pub heading_error_deg: f64,
    /// Normalised estimation error squared; its mean is 3 if the standard deviations are right.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nees: Option<f64>,
    /// True if the estimate is in another cell than the robot.
    pub mislocalised: bool,
}

impl Localisation {
    /// Compares the last estimate with the true pose. Returns `None` if the robot is given its true
    /// pose.
    pub fn of(episode: u32, step: u32, sensed: &Sensed<'_>, truth: &Sample) -> Option<Self> {
        let estimate = sensed.estimates.last()?;
        let (error_m, error_rad) = estimate.error(&truth.robot_in_map);
        let deviation = |at: usize| estimate.covariance[(at, at)].max(0.0).sqrt();
        Some(Self {
            episode,
            step,
            sd_x_m: deviation(0),
            sd_y_m: deviation(1),
            sd_heading_deg: deviation(2).to_degrees(),
            error_m,
            heading_error_deg: error_rad.to_degrees(),
            nees: estimate.nees(&truth.robot_in_map),
            mislocalised: sensed.mislocalised,
        })
    }
}
