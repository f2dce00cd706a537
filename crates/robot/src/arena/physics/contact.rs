//! What the engine tells about contacts, and the hits that are made of it.

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

/// The cosine of the largest angle between normals of one face, as contacts have them.
const SAME_FACE: f64 = 0.99;

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
            let impulse_ns: f32 = manifold.points.iter().map(|point| point.data.impulse).sum();
            let push = Push {
                normal: sign * Vector2::new(f64::from(normal.x), f64::from(normal.y)),
                impulse_ns: f64::from(impulse_ns),
            };
            add(&mut pushes, push);
        }
    }

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}

/// Does a wall in the direction `normal` stop a robot on its way `along`? (Unit vectors.)
pub(super) fn is_frontal(normal: Vector2<f64>, along: Vector2<f64>) -> bool {
    normal.dot(&along) > FRONTAL
}

/// Adds a push to the one in the same direction. Two blocks that form one face push together.
fn add(pushes: &mut Vec<Push>, push: Push) {
    match pushes
        .iter_mut()
        .find(|known| same_face(known.normal, push.normal))
    {
        Some(known) => known.impulse_ns += push.impulse_ns,
        None if push.impulse_ns > 0.0 => pushes.push(push),
        None => {}
    }
}

/// Do two unit normals belong to one face of a wall?
fn same_face(one: Vector2<f64>, other: Vector2<f64>) -> bool {
    one.dot(&other) > SAME_FACE
}

/// The hits of one action: one for each face that was touched.
#[derive(Debug, Default)]
pub(super) struct Hits(Vec<Contact>);

impl Hits {
    /// Forgets all hits.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Begins a hit like `contact`, or adds one step to the hit against the same face.
    ///
    /// The hit's impulse is that of its hardest step, which stops the robot. In the steps after
    /// it the wall only resists the motors until they have turned round.
    pub(super) fn add(&mut self, contact: Contact) {
        let normal = contact.normal_in_map;
        let mut hits = self.0.iter_mut();
        match hits.find(|hit| same_face(hit.normal_in_map, normal)) {
            Some(hit) => hit.impulse_ns = hit.impulse_ns.max(contact.impulse_ns),
            None => self.0.push(contact),
        }
    }

    /// The sum of the impulses of all frontal hits for a robot on its way `along`.
    pub(super) fn frontal_impulse_ns(&self, along: Vector2<f64>) -> f64 {
        let hits = self.0.iter();
        hits.filter(|hit| is_frontal(hit.normal_in_map, along))
            .map(|hit| hit.impulse_ns)
            .sum()
    }

    /// The hits, oldest first.
    pub(super) fn contacts(&self) -> &[Contact] {
        &self.0
    }
}
