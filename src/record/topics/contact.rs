//! `/contact`: the start and the end of a wall contact.

use super::fields::{Fields, fields};
use crate::arena::Contact;

/// Returns the message of a wall hit.
pub(in crate::record) fn hit(episode: u32, step: u32, contact: &Contact) -> Fields {
    let (at, normal) = (contact.point_in_map, contact.normal_in_map);
    fields! { "contact.json":
        episode: episode,
        step: step,
        touching: true,
        x_m: at.x,
        y_m: at.y,
        normal_x: normal.x,
        normal_y: normal.y,
        impulse_ns: contact.impulse_ns,
    }
}

/// Returns the message of the end of a wall contact.
pub(in crate::record) fn clear(episode: u32, step: u32) -> Fields {
    fields! { "contact.json": episode: episode, step: step, touching: false }
}
