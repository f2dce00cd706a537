//! The robot's own computer, driven step by step: exported code sees bit for bit what it sees in the same
//! beams from the same poses.

use nalgebra::{Complex, Isometry2, Translation2, UnitComplex, Vector2};
use xcscr::arena::{ArenaKind, PhysicsParams, Sample, Sensed, View};
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::world::{Cell, Direction, Maze};
use xcscr::xcs::random::Stream;
use xcscr_sensing::{Moment, Onboard, Return, Robot, Sensors, Streams};

use super::exported;
use super::programs::{LANGUAGES, Questions};
use super::scans::{ACTIONS, SCANNING, pose, seen};
use crate::kit::trial::maze;

/// The robot of the physics arena, as its sensors need to know it, of which many beams do not come back.
fn robot(maze: &Maze) -> Robot {
    let mut params = PhysicsParams::default();
    params.lidar.dropouts = 0.2;
    params.lidar.outliers = 0.05;
    Robot {
        noise: 1.0,
        cell_size_m: maze.cell_size_m(),
        wheel_base_m: params.wheel_base_m,
        careful_acceleration_mps2: params.cautious.wheel_acceleration_mps2,
        wheel_bias: params.wheel_bias,
        wheel_noise: params.wheel_noise,
        lidar: params.lidar,
        encoders: params.encoders,
        gyro: params.gyro,
        bumper: params.bumper,
        estimator: params.estimator,
        faults: params.faults,
    }
}

fn streams(seed: u64) -> Streams {
    Streams {
        lidar: Stream::new(seed, StreamName::Lidar),
        encoders: Stream::new(seed, StreamName::Encoders),
        gyro: Stream::new(seed, StreamName::Gyro),
    }
}

/// What every sensor perceives in what a robot made out that believes to stand in a cell.
fn perceived(maze: &Maze, sensed: Sensed<'_>) -> [String; 4] {
    let sample = Sample {
        time_ns: 0,
        robot_in_map: Isometry2::identity(),
        wheel_travel_m: [0.0; 2],
    };
    let view = View {
        maze,
        cell: sensed.cell,
        trace: &[sample],
        contacts: &[],
        sensed: Some(sensed),
        executed: None,
        flipped: None,
    };
    SCANNING.map(|sensor| sensor.perceive(&view).to_string())
}

/// A robot that moves by itself, without physics, with the sensors and the computer of the arena's.
struct Drive<'a> {
    maze: &'a Maze,
    onboard: Onboard,
    sensors: Sensors,
    pose: Isometry2<f64>,
    steps: u64,
    travel_m: [f64; 2],
    questions: Questions,
    /// What it perceived after each step.
    perceived: Vec<[String; 4]>,
}

impl<'a> Drive<'a> {
    fn new(maze: &'a Maze, start: Cell) -> Self {
        let robot = robot(maze);
        let middle = maze.centre_m(start);
        let pose = Isometry2::from_parts(Translation2::from(middle), UnitComplex::identity());
        let mut onboard = Onboard::new(&robot);
        onboard.put_down(pose);
        Self {
            maze,
            onboard,
            sensors: Sensors::new(&robot, streams(1)),
            pose,
            steps: 0,
            travel_m: [0.0; 2],
            questions: Questions::default(),
            perceived: Vec::new(),
        }
    }

    fn begin_action(&mut self) {
        self.onboard.begin_action();
        let estimate = self.onboard.estimate().0;
        self.questions.begin(pose(&estimate, [0.0; 3], 0.0));
    }

    /// One step forward and round.
    fn step(&mut self, forward_m: f64, turn_rad: f64) {
        let before = self.pose;
        let way = before.rotation * Vector2::new(forward_m, 0.0);
        self.pose.translation.vector += way;
        self.pose.rotation *= UnitComplex::new(turn_rad);
        let round_m = 0.2 * turn_rad;
        self.travel_m = [
            self.travel_m[0] + forward_m - round_m,
            self.travel_m[1] + forward_m + round_m,
        ];
        let moment = Moment {
            step: self.steps,
            before,
            after: self.pose,
            travel_m: self.travel_m,
            pushes: &[],
        };
        self.steps += 1;
        let mut beams = Vec::new();
        let readings = self.sensors.read(self.maze, &moment, &mut beams);
        self.onboard.step(&readings);
        self.tell(&beams);
        self.questions.scanned();
        self.perceived.push(self.perceived());
    }

    /// Tells the exported code the beams, from where the robot believes that it sent them: as the estimator has
    /// it (`Estimator::ray`).
    fn tell(&mut self, beams: &[Return]) {
        let belief = serde_json::to_value(self.onboard.belief()).unwrap();
        let number = |pointer: &str| belief.pointer(pointer).unwrap().as_f64().unwrap();
        let way = Vector2::new(number("/last/way/0"), number("/last/way/1"));
        let (turned_rad, scale) = (number("/last/turned_rad"), 1.0 + number("/ranges"));
        let estimate = self.onboard.estimate().0;
        for beam in beams {
            let mut then = estimate;
            then.translation.vector += (beam.moment - 1.0) * way;
            then.rotation *= small_rotation((beam.moment - 1.0) * turned_rad);
            self.questions.moved(pose(&then, [0.0; 3], 0.0));
            let bearing = [beam.bearing.re, beam.bearing.im];
            self.questions
                .beam(bearing, beam.range_m.map(|range| range * scale));
        }
        self.questions.moved(pose(&estimate, [0.0; 3], 0.0));
    }

    /// Turns to a direction and drives one cell, or into the cell and back if a wall is in the way.
    fn act(&mut self, cell: Cell, direction: Direction) -> Cell {
        let (east, south) = direction.offset();
        let wanted = UnitComplex::new_unchecked(Complex::new(f64::from(east), f64::from(-south)));
        let turn_rad = (self.pose.rotation.inverse() * wanted).angle();
        (0..6).for_each(|_| self.step(0.0, turn_rad / 6.0));
        let size_m = self.maze.cell_size_m();
        match self.maze.step(cell, direction) {
            Some(next) => {
                (0..20).for_each(|_| self.step(0.05 * size_m, 0.0));
                next
            }
            None => {
                (0..4).for_each(|_| self.step(0.04 * size_m, 0.0));
                (0..4).for_each(|_| self.step(-0.04 * size_m, 0.0));
                cell
            }
        }
    }

    /// What it perceives now.
    fn perceived(&self) -> [String; 4] {
        let [east, north] = self.onboard.cell();
        let (width, height) = (i32::from(self.maze.width()), i32::from(self.maze.height()));
        let cell = Cell {
            col: east.clamp(0, width - 1) as u16,
            row: (height - 1 - north).clamp(0, height - 1) as u16,
        };
        let sensed = Sensed {
            surroundings: self.onboard.surroundings(),
            cell,
            estimates: &[],
            beams: &[],
            lost: false,
        };
        perceived(self.maze, sensed)
    }
}

/// The rotation of a part of a step, as the computer on board computes it.
fn small_rotation(angle_rad: f64) -> UnitComplex<f64> {
    let square = angle_rad * angle_rad;
    assert!(square < 0.4, "{angle_rad}");
    let sine =
        1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)));
    let cosine = 1.0
        - square / 2.0
            * (1.0
                - square / 12.0
                    * (1.0 - square / 30.0 * (1.0 - square / 56.0 * (1.0 - square / 90.0))));
    UnitComplex::new_unchecked(Complex::new(cosine, angle_rad * sine))
}

#[test]
fn the_same_beams_from_the_same_poses_give_the_same_percept_bit_for_bit() {
    let controls = [
        ("FREE 30", "FREE 60"),
        ("HIT 20", "HIT 10"),
        ("LOST 7", "LOST 20"),
        ("GRAZE_M 0.15", "GRAZE_M 0.05"),
        ("GRAZE_SHARE 0.02", "GRAZE_SHARE 0.1"),
        ("STRAY_M 0.2", "STRAY_M 0.05"),
        ("LOST_RANGE_M 3.0", "LOST_RANGE_M 1.0"),
    ];
    compare_with_exports(&maze("maze6"), &controls);
}

#[test]
fn beams_that_hit_something_too_near_give_the_same_percept_in_small_cells() {
    let text = maze("maze6").to_json();
    let small = text.replace("\"cell_size_m\": 1.0", "\"cell_size_m\": 0.25");
    let small = Maze::from_json(small.as_bytes(), "small.json").unwrap();
    assert_eq!(small.cell_size_m(), 0.25);
    compare_with_exports(&small, &[("NEAREST_M 0.12", "NEAREST_M 0.0")]);
}

/// Compares the percepts of a driving robot with those of exported code in all languages. Each control
/// changes a constant, which must change a percept.
fn compare_with_exports(maze: &Maze, controls: &[(&str, &str)]) {
    let mut cell = maze.free_cells().next().unwrap();
    let (mut drive, mut random) = (Drive::new(maze, cell), Stream::new(5, 0_u64));
    for _ in 0..ACTIONS {
        drive.begin_action();
        cell = drive.act(cell, Direction::MAIN[random.below(4)]);
    }
    for target in LANGUAGES {
        for (at, sensor) in SCANNING.into_iter().enumerate() {
            let found = seen(&drive.questions, target, maze, sensor);
            let name = format!("{} {}", target.name(), sensor.name());
            assert_eq!(found.len(), drive.perceived.len(), "{name}");
            for (found, wanted) in found.iter().zip(&drive.perceived) {
                assert_eq!(found, &wanted[at], "{name}");
            }
        }
    }
    let policy = exported(Target::C99, maze, Sensor::LidarBeams, ArenaKind::Physics);
    let right = drive.questions.answers(Target::C99, &policy, maze);
    for (constant, other) in controls {
        let [constant, other] = [constant, other].map(|name| format!("#define XCSCR_SCAN_{name}"));
        assert!(policy.contains(&constant), "{constant}");
        let changed = policy.replace(&constant, &other);
        let found = drive.questions.answers(Target::C99, &changed, maze);
        assert!(found != right, "control: {other}");
    }
}
