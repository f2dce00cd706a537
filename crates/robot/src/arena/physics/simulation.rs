//! The physics engine: one robot among fixed walls, lengths in metres of the grid frame.

use nalgebra::Isometry2;
use rapier2d::prelude::{
    ActiveEvents, BroadPhaseBvh, ColliderBuilder, ColliderHandle, ColliderSet, IslandManager,
    NarrowPhase, PhysicsWorld, Pose, RigidBody, RigidBodyBuilder, RigidBodyHandle, RigidBodySet,
    Rotation, SharedShape, Vector,
};

use super::contact::Listener;
use super::params::PhysicsParams;
use super::shortcut::{Clearance, coast};
use super::{SOLVER_ITERATIONS, STEP_S};
use crate::world::{Block, Solid};
use xcscr_sensing::Push;

/// How far ahead the engine looks for walls, in metres: farther than any robot drives in a step.
/// The engine brakes the robot so that it ends the step at the wall and not inside. Without the
/// lookahead the robot enters walls by up to 6 cm at 1.4 m/s.
const LOOKAHEAD_M: f64 = 0.15;

/// The engine's world, and the state that decides whether a step can skip the engine.
pub(super) struct Simulation {
    world: PhysicsWorld,
    listener: Listener,
    robot: RigidBodyHandle,
    shape: ColliderHandle,
    /// `None` if the engine computes every step.
    clearance: Option<Clearance>,
    /// True if a wall pushed the robot in the engine's last step. The next step begins with that
    /// push.
    pushed: bool,
}

/// Everything in the engine that a step can change.
#[derive(Clone)]
pub(super) struct State {
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    pushed: bool,
}

impl Simulation {
    /// Creates the walls, and a robot clear of them.
    pub(super) fn new(walls: SharedShape, at: Pose, params: &PhysicsParams) -> Self {
        let mut world = empty_world();
        world.insert_collider(ColliderBuilder::new(walls), None);
        let body = RigidBodyBuilder::dynamic()
            .pose(at)
            .can_sleep(false)
            // Otherwise the engine caps the turn rate, and the shortcut does not.
            .allow_fast_rotation(true)
            .soft_ccd_prediction(LOOKAHEAD_M as f32);
        let disc = ColliderBuilder::ball(params.radius_m as f32)
            .mass(params.mass_kg as f32)
            .active_events(ActiveEvents::CONTACT_FORCE_EVENTS)
            .contact_force_event_threshold(0.0);
        let (robot, shape) = world.insert(body, disc);
        let prediction = f64::from(world.integration_parameters.prediction_distance());
        let mut simulation = Self {
            world,
            listener: Listener::new(shape),
            robot,
            shape,
            clearance: params
                .shortcut
                .then(|| Clearance::new(params.radius_m, prediction)),
            pushed: false,
        };
        // The first step builds the search structure of the walls, and takes longer than all
        // others.
        simulation.step();
        simulation
    }

    /// Returns the robot's body.
    pub(super) fn body(&self) -> &RigidBody {
        &self.world.bodies[self.robot]
    }

    /// Returns the robot's body, mutably.
    pub(super) fn body_mut(&mut self) -> &mut RigidBody {
        &mut self.world.bodies[self.robot]
    }

    /// Simulates one step. Returns the pushes of walls during the step, and the body after it.
    pub(super) fn advance(&mut self, solid: &Solid) -> (&[Push], &RigidBody) {
        self.listener.pushes().clear();
        let body = &mut self.world.bodies[self.robot];
        if !self.pushed && self.clearance.is_some_and(|c| c.is_clear(solid, body)) {
            coast(body);
        } else {
            self.step();
        }
        (self.listener.pushes(), &self.world.bodies[self.robot])
    }

    /// Returns the pushes of walls during the last step.
    pub(super) fn pushes(&mut self) -> &[Push] {
        self.listener.pushes()
    }

    /// Computes a step with the engine.
    fn step(&mut self) {
        self.world.step_with_events(&(), &self.listener);
        self.pushed = self
            .world
            .narrow_phase
            .contact_pairs_with(self.shape)
            .any(|pair| pair.total_impulse_magnitude() > 0.0);
    }

    /// Returns a copy of the state.
    pub(super) fn state(&self) -> State {
        State {
            islands: self.world.islands.clone(),
            broad_phase: self.world.broad_phase.clone(),
            narrow_phase: self.world.narrow_phase.clone(),
            bodies: self.world.bodies.clone(),
            colliders: self.world.colliders.clone(),
            pushed: self.pushed,
        }
    }

    /// Restores a state.
    pub(super) fn set_state(&mut self, state: &State) {
        self.world.islands = state.islands.clone();
        self.world.broad_phase = state.broad_phase.clone();
        self.world.narrow_phase = state.narrow_phase.clone();
        self.world.bodies = state.bodies.clone();
        self.world.colliders = state.colliders.clone();
        self.pushed = state.pushed;
    }
}

/// Builds the walls of a world as one shape. The engine would solve separate walls in the order in
/// which the robot approached them. Neither a reset nor the shortcut can reproduce that history.
pub(super) fn walls(blocks: &[Block], solid: &Solid) -> SharedShape {
    SharedShape::compound(blocks.iter().map(|block| wall(block, solid)).collect())
}

/// Returns a pose in the engine's single precision.
pub(super) fn pose_of(pose: &Isometry2<f64>) -> Pose {
    let (at, turn) = (pose.translation, pose.rotation);
    Pose::from_parts(
        Vector::new(at.x as f32, at.y as f32),
        Rotation::from_cos_sin_unchecked(turn.re as f32, turn.im as f32),
    )
}

/// Creates a world without gravity, with the step and the solver settings that the robot is tuned
/// for.
fn empty_world() -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let integration = &mut world.integration_parameters;
    integration.dt = STEP_S as f32;
    integration.num_solver_iterations = SOLVER_ITERATIONS;
    // The contact prediction above replaces continuous collision detection.
    integration.max_ccd_substeps = 0;
    // Contacts with carried-over history would make the shortcut inexact.
    integration.contact_recycling = false;
    integration.contact_clustering = false;
    world
}

/// Converts a block of solid pixels to a shape in the grid frame.
fn wall(block: &Block, solid: &Solid) -> (Pose, SharedShape) {
    let centre = solid.middle_of(block);
    let rotation = solid.corner_in_grid().map_or(Rotation::IDENTITY, |corner| {
        let turn = corner.rotation;
        Rotation::from_cos_sin_unchecked(turn.re as f32, turn.im as f32)
    });
    let half = solid.size_of(block).map(|length| (length / 2.0) as f32);
    (
        Pose::from_parts(Vector::new(centre.x as f32, centre.y as f32), rotation),
        SharedShape::cuboid(half[0], half[1]),
    )
}
