//! Snapshots of the whole state of a physics arena.

use serde::{Deserialize, Serialize};

use super::PhysicsArena;
use super::robot::Wheels;
use super::sensing::SensingState;
use super::simulation::State;
use crate::world::Cell;
use xcs::random::Stream;

/// Everything that changes while a [`PhysicsArena`] runs, down to the forces in a contact.
///
/// After restoring a snapshot, an arena of the same maze and settings continues bit-identically to
/// the original arena.
#[derive(Clone, Serialize, Deserialize)]
pub struct Snapshot {
    state: State,
    wheels: Wheels,
    noise: Stream,
    steps: u64,
    cell: Cell,
    /// `None` for a robot that gets the true pose.
    sensing: Option<SensingState>,
}

impl PhysicsArena {
    /// Returns the state between two actions.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            state: self.simulation.state(),
            wheels: self.wheels,
            noise: self.noise.stream.clone(),
            steps: self.steps,
            cell: self.cell,
            sensing: self.sensing.as_ref().map(|sensing| sensing.state()),
        }
    }

    /// Restores a snapshot of an arena of the same maze and the same settings. The view then shows
    /// a robot that has not acted yet.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.simulation.set_state(&snapshot.state);
        self.wheels = snapshot.wheels;
        self.noise.stream = snapshot.noise.clone();
        self.steps = snapshot.steps;
        self.cell = snapshot.cell;
        if let Some((sensing, state)) = self.sensing.as_mut().zip(snapshot.sensing.as_ref()) {
            sensing.set_state(state);
        }
        self.begin_trace();
    }
}
