//! `/contact`: the start and the end of a wall contact.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use xcscr_robot::arena;

/// The start or the end of a wall contact.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Contact {
    /// Number of the episode, from 1.
    pub episode: u32,
    /// Number of the step, from 1; 0 before the first step.
    pub step: u32,
    /// True at a collision, false at the end of the move or of the episode.
    pub touching: bool,
    /// Point of contact in the map frame, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x_m: Option<f64>,
    /// Point of contact in the map frame, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y_m: Option<f64>,
    /// Unit vector into the wall, x component.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal_x: Option<f64>,
    /// Unit vector into the wall, y component.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal_y: Option<f64>,
    /// Impulse of the collision, newton-seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impulse_n_s: Option<f64>,
}

impl Contact {
    /// Creates the event of a wall hit.
    pub fn hit(episode: u32, step: u32, hit: &arena::Contact) -> Self {
        Self {
            touching: true,
            x_m: Some(hit.point_in_map.x),
            y_m: Some(hit.point_in_map.y),
            normal_x: Some(hit.normal_in_map.x),
            normal_y: Some(hit.normal_in_map.y),
            impulse_n_s: Some(hit.impulse_n_s),
            ..Self::clear(episode, step)
        }
    }

    /// Creates the event of the end of a wall contact.
    pub fn clear(episode: u32, step: u32) -> Self {
        Self {
            episode,
            step,
            ..Self::default()
        }
    }
}
