//! `/contact`: a hit, and its end.

use serde::Serialize;

use super::decimal;
use super::schema::{Kind, Object};
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
    /// The robot hit a wall.
    pub fn hit(episode: u32, step: u32, contact: &Contact) -> Self {
        let (at, normal) = (contact.point_in_world, contact.normal_in_world);
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

    /// The robot is clear of the walls again.
    pub fn clear(episode: u32, step: u32) -> Self {
        Self {
            episode,
            step,
            touching: false,
            hit: None,
        }
    }
}

pub(super) fn schema() -> Object {
    let fields = [
        ("episode", Kind::Count, "from 1"),
        ("step", Kind::Count, "from 1; 0 before the first"),
        (
            "touching",
            Kind::Bool,
            "true at a hit, false when that move or the episode is over",
        ),
        ("x_m", Kind::Number, "point of the hit, metres, world frame"),
        ("y_m", Kind::Number, "point of the hit, metres, world frame"),
        ("normal_x", Kind::Number, "unit vector into the wall"),
        ("normal_y", Kind::Number, "unit vector into the wall"),
        ("impulse_ns", Kind::Number, "impulse of the hit, N s"),
    ];
    Object::new("xcscr.Contact", &fields)
}
