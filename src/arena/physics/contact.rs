//! What the engine tells about contacts, and the hits that are made of it.

use std::sync::{Mutex, PoisonError};

use nalgebra::Vector2;
use rapier2d::prelude::{
    ColliderHandle, ColliderSet, CollisionEvent, ContactPair, EventHandler, Real, RigidBodySet,
    SoftBodySet, SoftBodyTearEvent,
};

use crate::arena::Contact;

/// The cosine of the largest angle between a frontal hit and the direction of travel.
const FRONTAL: f64 = 0.7;

/// A wall pushing on the robot during one physics step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    /// The wall block.
    pub wall: ColliderHandle,
    /// Unit vector from the robot into the wall.
    pub normal: Vector2<f64>,
    /// Force times duration of the step, with lengths in cells.
    pub impulse: f64,
}

/// Collects the pushes of a step.
///
/// Only contact forces count: the engine's `Started` comes up to a prediction distance before
/// the touch, and is not repeated while the contact lasts. A force of zero raises no event. The
/// engine wants handlers that can be shared between threads, hence the lock; it is taken in the
/// few steps with contact only, and never contended.
pub(super) struct Listener {
    robot: ColliderHandle,
    pushes: Mutex<Vec<Push>>,
}

impl Listener {
    /// Listens to contacts of the `robot`.
    pub(super) fn new(robot: ColliderHandle) -> Self {
        Self {
            robot,
            pushes: Mutex::new(Vec::with_capacity(4)),
        }
    }

    /// The pushes since they were last cleared.
    pub(super) fn pushes(&mut self) -> &mut Vec<Push> {
        self.pushes
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

impl EventHandler for Listener {
    fn handle_collision_event(
        &self,
        _: &RigidBodySet,
        _: &ColliderSet,
        _: CollisionEvent,
        _: Option<&ContactPair>,
    ) {
    }

    fn handle_contact_force_event(
        &self,
        dt: Real,
        _: &RigidBodySet,
        _: &ColliderSet,
        pair: &ContactPair,
        force: Real,
    ) {
        let (_, normal) = pair.max_impulse();
        let (wall, sign) = if pair.collider1 == self.robot {
            (pair.collider2, 1.0)
        } else {
            (pair.collider1, -1.0)
        };
        let push = Push {
            wall,
            normal: sign * Vector2::new(f64::from(normal.x), f64::from(normal.y)),
            impulse: f64::from(force * dt),
        };
        self.pushes
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(push);
    }

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}

/// Does a wall in the direction `normal` stop a robot on its way `along`? (Unit vectors.)
pub(super) fn is_frontal(normal: Vector2<f64>, along: Vector2<f64>) -> bool {
    normal.dot(&along) > FRONTAL
}

/// The hits of one action: one for each wall block that was touched.
#[derive(Debug, Default)]
pub(super) struct Hits {
    walls: Vec<ColliderHandle>,
    contacts: Vec<Contact>,
}

impl Hits {
    /// Forgets all hits.
    pub(super) fn clear(&mut self) {
        self.walls.clear();
        self.contacts.clear();
    }

    /// Begins a hit like `contact`, or adds one step to the hit against the same wall.
    ///
    /// The hit's impulse is that of its hardest step, which stops the robot. In the steps after
    /// it the wall only resists the motors until they have turned round.
    pub(super) fn add(&mut self, wall: ColliderHandle, contact: Contact) {
        if let Some(known) = self.walls.iter().position(|&known| known == wall) {
            let hardest = &mut self.contacts[known].impulse_ns;
            *hardest = hardest.max(contact.impulse_ns);
            return;
        }
        self.walls.push(wall);
        self.contacts.push(contact);
    }

    /// The sum of the impulses of all frontal hits for a robot on its way `along`.
    pub(super) fn frontal_impulse_ns(&self, along: Vector2<f64>) -> f64 {
        let hits = self.contacts.iter();
        hits.filter(|hit| is_frontal(hit.normal_in_world, along))
            .map(|hit| hit.impulse_ns)
            .sum()
    }

    /// The hits, oldest first.
    pub(super) fn contacts(&self) -> &[Contact] {
        &self.contacts
    }
}
