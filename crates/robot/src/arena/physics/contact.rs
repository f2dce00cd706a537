//! The engine's contact events, and the collisions derived from them.

use std::sync::{Mutex, PoisonError};

use nalgebra::Vector2;
use rapier2d::prelude::{
    ColliderHandle, ColliderSet, CollisionEvent, ContactPair, EventHandler, Real, RigidBodySet,
    SoftBodySet, SoftBodyTearEvent,
};

use crate::arena::Contact;
use xcscr_sensing::Push;

/// The cosine of the largest angle between a frontal hit and the direction of travel.
const FRONTAL: f64 = 0.7;

/// The cosine of the largest angle between contact normals of one wall face.
const SAME_FACE: f64 = 0.99;

/// Collects the pushes of a step.
///
/// Only contact forces count. The engine's `Started` event comes up to a prediction distance before
/// the touch, and is not repeated while the contact lasts. A force of zero raises no event. The
/// engine requires thread-safe handlers, hence the lock. The lock is only taken in the few steps
/// with contact, and is never contended.
pub(super) struct Listener {
    robot: ColliderHandle,
    pushes: Mutex<Vec<Push>>,
}

impl Listener {
    /// Listens to contacts of `robot`.
    pub(super) fn new(robot: ColliderHandle) -> Self {
        Self {
            robot,
            pushes: Mutex::new(Vec::with_capacity(4)),
        }
    }

    /// Returns the pushes since they were last cleared.
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
        _: Real,
        _: &RigidBodySet,
        _: &ColliderSet,
        pair: &ContactPair,
        _: Real,
    ) {
        let sign = if pair.collider1 == self.robot {
            1.0
        } else {
            -1.0
        };
        let mut pushes = self.pushes.lock().unwrap_or_else(PoisonError::into_inner);
        for manifold in pair.solver_manifolds() {
            let normal = manifold.data.normal;
            let impulse_n_s: f32 = manifold.points.iter().map(|point| point.data.impulse).sum();
            let push = Push {
                normal: sign * Vector2::new(f64::from(normal.x), f64::from(normal.y)),
                impulse_n_s: f64::from(impulse_n_s),
            };
            add(&mut pushes, push);
        }
    }

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}

/// Returns true if a wall in direction `normal` stops a robot driving along `along` (unit vectors).
pub(super) fn is_frontal(normal: Vector2<f64>, along: Vector2<f64>) -> bool {
    normal.dot(&along) > FRONTAL
}

/// Adds a push to the one in the same direction. Two blocks that form one face push together.
fn add(pushes: &mut Vec<Push>, push: Push) {
    match pushes
        .iter_mut()
        .find(|known| same_face(known.normal, push.normal))
    {
        Some(known) => known.impulse_n_s += push.impulse_n_s,
        None if push.impulse_n_s > 0.0 => pushes.push(push),
        None => {}
    }
}

/// Returns true if two unit normals belong to one face of a wall.
fn same_face(one: Vector2<f64>, other: Vector2<f64>) -> bool {
    one.dot(&other) > SAME_FACE
}

/// The collisions of one action: one for each face that was touched.
#[derive(Debug, Default)]
pub(super) struct Hits(Vec<Contact>);

impl Hits {
    /// Removes all collisions.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Starts a collision like `contact`, or adds one step to the collision with the same face.
    ///
    /// The impulse of a collision is that of its hardest step, which stops the robot. In the
    /// following steps the wall only resists the motors until they have reversed.
    pub(super) fn add(&mut self, contact: Contact) {
        let normal = contact.normal_in_map;
        let mut hits = self.0.iter_mut();
        match hits.find(|hit| same_face(hit.normal_in_map, normal)) {
            Some(hit) => hit.impulse_n_s = hit.impulse_n_s.max(contact.impulse_n_s),
            None => self.0.push(contact),
        }
    }

    /// Returns the total impulse of all frontal collisions for a robot driving along `along`.
    pub(super) fn frontal_impulse_n_s(&self, along: Vector2<f64>) -> f64 {
        let hits = self.0.iter();
        hits.filter(|hit| is_frontal(hit.normal_in_map, along))
            .map(|hit| hit.impulse_n_s)
            .sum()
    }

    /// Returns the collisions, oldest first.
    pub(super) fn contacts(&self) -> &[Contact] {
        &self.0
    }
}
