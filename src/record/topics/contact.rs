//! `/contact`: the start and the end of a wall contact.

use serde::Serialize;

use super::decimal;
use crate::arena::Contact;

/// A change of contact with the walls.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(in crate::record) struct ContactRecord {
    episode: u32,
    step: u32,
    touching: bool,
    #[serde(flatten)]
    hit: Option<Hit>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Hit {
    x_m: f64,
    y_m: f64,
    normal_x: f64,
    normal_y: f64,
    impulse_ns: f64,
}

impl ContactRecord {
    /// Creates the record of a wall hit.
    pub fn hit(episode: u32, step: u32, contact: &Contact) -> Self {
        let (at, normal) = (contact.point_in_map, contact.normal_in_map);
        let hit = Hit {
            x_m: decimal(at.x),
            y_m: decimal(at.y),
            normal_x: decimal(normal.x),
            normal_y: decimal(normal.y),
            impulse_ns: decimal(contact.impulse_ns),
        };
        Self {
            episode,
            step,
            touching: true,
            hit: Some(hit),
        }
    }

    /// Creates the record of the end of a wall contact.
    pub fn clear(episode: u32, step: u32) -> Self {
        Self {
            episode,
            step,
            touching: false,
            hit: None,
        }
    }
}
