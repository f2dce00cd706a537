//! The simulated robot without its controller and onboard computer: speeds in, sensor readings out.

use nalgebra::{Isometry2, Vector2};
use rapier2d::prelude::Rotation;

use super::motion::Speeds;
use super::params::{Localisation, PhysicsParams};
use super::sensing::streams;
use super::{Arena, PhysicsArena, PhysicsError};
use crate::arena::View;
use crate::world::Maze;
use xcscr_sensing::{Readings, Return, Sensors};

/// A simulated robot that is controlled by speeds and reads its sensors, in steps of 50 ms.
///
/// Body, wheels, floor, walls, sensors and noise are the same as in [`PhysicsArena`].
pub struct SensedDrive {
    arena: PhysicsArena,
    /// The share by which each wheel turns too fast, drawn whenever the robot starts from rest.
    bias: [f64; 2],
    was_at_rest: bool,
    sensors: Sensors,
    /// The beams of one step.
    returns: Vec<Return>,
}

impl SensedDrive {
    /// Creates a robot at rest in the first start cell. All noise derives from `seed`.
    ///
    /// # Errors
    /// Returns an error if a setting is out of range, or the world is not valid in physics.
    pub fn new(maze: Maze, params: &PhysicsParams, seed: u64) -> Result<Self, PhysicsError> {
        let robot = params.robot(maze.cell_size_m());
        // The onboard computer of the arena is not needed here.
        let params = PhysicsParams {
            localisation: Localisation::GroundTruth,
            ..params.clone()
        };
        Ok(Self {
            arena: PhysicsArena::new(maze, params, seed)?,
            bias: [0.0; 2],
            was_at_rest: true,
            sensors: Sensors::new(&robot, streams(seed)),
            returns: Vec::new(),
        })
    }

    /// Places the robot at rest at a pose of the grid frame, in metres. Time continues.
    pub fn put_down(&mut self, pose: Isometry2<f64>) {
        let start = self.arena.maze.starts().next();
        let start = start.unwrap_or(self.arena.cell);
        self.arena.reset(start);
        let body = self.arena.simulation.body_mut();
        let mut placed = *body.position();
        placed.translation.x = pose.translation.x as f32;
        placed.translation.y = pose.translation.y as f32;
        placed.rotation = Rotation::from_angle(pose.rotation.angle() as f32);
        body.set_position(placed, true);
        self.arena.begin_trace();
        self.sensors.reset();
        self.was_at_rest = true;
    }

    /// Drives for 50 ms at the commanded speeds, limited by the robot's settings, and reads the
    /// sensors.
    pub fn step(&mut self, speeds: Speeds) -> Readings<'_> {
        let arena = &mut self.arena;
        arena.begin_trace();
        let command = speeds.limited(&arena.params);
        let is_at_rest = command == Speeds::REST;
        if self.was_at_rest && !is_at_rest {
            self.bias = arena.noise.wheel_bias();
        }
        self.was_at_rest = is_at_rest;
        let motion = arena.motion();
        arena.drive(command, &motion, self.bias, false);
        arena.read_step(&mut self.sensors, &mut self.returns, Vector2::x())
    }

    /// Returns the view of the arena: the true pose, and the collisions of the last step.
    pub fn view(&self) -> View<'_> {
        self.arena.view()
    }

    /// Returns the true pose in the grid frame, in metres.
    pub fn pose(&self) -> Isometry2<f64> {
        self.arena.motion().pose
    }

    /// Returns the settings of the robot.
    pub fn params(&self) -> &PhysicsParams {
        &self.arena.params
    }

    /// Returns the simulated time since the start, in nanoseconds.
    pub fn time_ns(&self) -> u64 {
        self.arena.time_ns()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive() -> SensedDrive {
        let world = br######"{ "rows": ["#####", "#S.G#", "#####"] }"######;
        let maze = Maze::from_json(world, "corridor.json").unwrap();
        let params = PhysicsParams {
            noise: 0.0,
            ..PhysicsParams::default()
        };
        SensedDrive::new(maze, &params, 1).unwrap()
    }

    #[test]
    fn sensor_readings_match_the_motion_of_the_robot() {
        let mut drive = drive();
        drive.put_down(Isometry2::new(Vector2::new(1.5, 1.5), 0.0));
        let (mut rolled_m, mut turned_rad) = (0.0, 0.0);
        let mut go = |forward_mps, turn_radps, steps| {
            for _ in 0..steps {
                let readings = drive.step(Speeds {
                    forward_mps,
                    turn_radps,
                });
                rolled_m += readings.rolled_m.iter().sum::<f64>() / 2.0;
                turned_rad += readings.turned_rad.unwrap();
                assert_eq!(readings.beams.len(), 8);
            }
            (drive.pose(), rolled_m, turned_rad)
        };
        let (pose, rolled_m, _) = go(0.5, 0.0, 20);
        assert!((pose.translation.x - 1.5 - rolled_m).abs() < 0.01, "{pose}");
        go(0.0, 0.0, 10);
        let (pose, _, turned_rad) = go(0.0, 1.0, 20);
        assert!((pose.rotation.angle() - turned_rad).abs() < 0.01, "{pose}");
        assert!(turned_rad > 0.8, "{turned_rad}");
    }

    #[test]
    fn it_drives_no_faster_than_its_settings() {
        let mut drive = drive();
        drive.put_down(Isometry2::new(Vector2::new(1.5, 1.5), 0.0));
        let mut fastest_mps: f64 = 0.0;
        for _ in 0..20 {
            let readings = drive.step(Speeds {
                forward_mps: 50.0,
                turn_radps: f64::NAN,
            });
            fastest_mps = fastest_mps.max(readings.rolled_m[0] / xcscr_sensing::STEP_S);
        }
        let most = drive.params().max_speed_mps;
        assert!(fastest_mps > 0.9 * most, "control: {fastest_mps}");
        assert!(fastest_mps < 1.03 * most, "{fastest_mps}");
    }
}
