//! Percepts from scans: exported code and the robot's own computer see the same in the same beams.

use std::fs;
use std::process::Command;

use nalgebra::{Complex, Isometry2, Point2, Rotation2, Translation2, UnitComplex, Vector2};
use xcscr::arena::{Arena, ArenaKind, Outcome, PhysicsArena, PhysicsParams};
use xcscr::arena::{Estimate, Localisation, Sample, Sensed, View};
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::world::{Cell, Direction, Maze};
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;
use xcscr_sensing::{Moment, Onboard, Return, Robot, Sensors, Streams, cast};

use super::programs::{LANGUAGES, Questions};
use super::{exported, in_map};
use crate::exporting::{fed, folder};
use crate::kit::trial::maze;

/// Sensors of which a scan shows the percept.
const SCANNING: [Sensor; 4] = [
    Sensor::Lidar,
    Sensor::LidarRanges,
    Sensor::LidarBeams,
    Sensor::LidarPosition,
];
const ACTIONS: usize = 520;
const STEP_NS: f64 = 50e6;

/// The robot of the physics arena, as its sensors need to know it, of which many beams do not come back.
fn robot(maze: &Maze) -> Robot {
    let mut params = PhysicsParams::default();
    params.lidar.dropouts = 0.2;
    params.lidar.outliers = 0.05;
    Robot {
        noise: 1.0,
        cell_size_m: maze.cell_size_m(),
        wheel_base_m: params.wheel_base_m,
        careful_acceleration_mps2: params.care.wheel_acceleration_mps2,
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

/// A pose as exported code takes it, shifted in the grid frame, and brought to the map frame.
fn pose(isometry: &Isometry2<f64>, origin: [f64; 3], shift_m: f64) -> [f64; 4] {
    let at = Point2::from(isometry.translation.vector) + Vector2::new(shift_m, 0.0);
    let turned =
        Rotation2::new(origin[2]) * Vector2::new(isometry.rotation.re, isometry.rotation.im);
    let [x, y] = in_map(origin, at);
    [x, y, turned.x, turned.y]
}

/// What every sensor perceives in what a robot made out that believes to stand in a cell.
fn perceived(maze: &Maze, sensed: Sensed<'_>) -> [String; 4] {
    let sample = Sample {
        time_ns: 0,
        robot_in_world: Isometry2::identity(),
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

/// The answers of an exported policy, as long as the percept of the sensor is.
fn seen(questions: &Questions, target: Target, maze: &Maze, sensor: Sensor) -> Vec<String> {
    let policy = exported(target, maze, sensor, ArenaKind::Physics);
    let mut answers = questions.answers(target, &policy, maze);
    answers
        .iter_mut()
        .for_each(|answer| answer.truncate(sensor.width(maze)));
    answers
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
        match self.maze.step(cell, direction) {
            Some(next) => {
                (0..20).for_each(|_| self.step(0.05, 0.0));
                next
            }
            None => {
                (0..4).for_each(|_| self.step(0.04, 0.0));
                (0..4).for_each(|_| self.step(-0.04, 0.0));
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
    let maze = maze("maze6");
    let mut cell = maze.free_cells().next().unwrap();
    let (mut drive, mut random) = (Drive::new(&maze, cell), Stream::new(5, 0_u64));
    for _ in 0..ACTIONS {
        drive.begin_action();
        cell = drive.act(cell, Direction::MAIN[random.below(4)]);
    }
    for target in LANGUAGES {
        for (at, sensor) in SCANNING.into_iter().enumerate() {
            let found = seen(&drive.questions, target, &maze, sensor);
            let name = format!("{} {}", target.name(), sensor.name());
            assert_eq!(found.len(), drive.perceived.len(), "{name}");
            for (found, wanted) in found.iter().zip(&drive.perceived) {
                assert_eq!(found, &wanted[at], "{name}");
            }
        }
    }
    let policy = exported(Target::C99, &maze, Sensor::LidarBeams, ArenaKind::Physics);
    let right = drive.questions.answers(Target::C99, &policy, &maze);
    for (constant, other) in [
        ("FREE 30", "FREE 60"),
        ("HIT 20", "HIT 10"),
        ("LOST 7", "LOST 20"),
        ("GRAZE_M 0.15", "GRAZE_M 0.05"),
        ("GRAZE_SHARE 0.02", "GRAZE_SHARE 0.1"),
        ("STRAY_M 0.2", "STRAY_M 0.05"),
        ("LOST_RANGE_M 3.0", "LOST_RANGE_M 1.0"),
    ] {
        let [constant, other] =
            [constant, other].map(|name| format!("#define XCSCR_SCAN_{name}\n"));
        assert!(policy.contains(&constant), "{constant}");
        let changed = policy.replace(&constant, &other);
        let found = drive.questions.answers(Target::C99, &changed, &maze);
        assert!(found != right, "control: {other}");
    }
}

/// Beams of actions in the physics arena, and what every sensor perceived after each.
struct Driven {
    actions: Vec<Seen>,
}

struct Seen {
    estimates: Vec<Estimate>,
    /// Which estimate comes after the beam, and how much of that step was over.
    beams: Vec<(usize, f64, xcscr::arena::Beam)>,
    perceived: [String; 4],
}

impl Driven {
    fn new(maze: &Maze) -> Self {
        let params = PhysicsParams {
            localisation: Localisation::Estimated,
            ..PhysicsParams::default()
        };
        let mut arena = PhysicsArena::new(maze.clone(), params, 3).unwrap();
        let (starts, mut random) = (maze.start_cells(), Stream::new(5, 0_u64));
        let mut over = true;
        let actions = (0..ACTIONS).map(|_| {
            if over {
                arena.reset(starts[random.below(starts.len())]);
            }
            let action = Action::new(random.below(maze.action_count())).unwrap();
            over = arena.act(action) == Outcome::ReachedGoal;
            Seen::new(&arena.view())
        });
        Self {
            actions: actions.collect(),
        }
    }

    /// Questions to exported code: the same beams, from poses between the estimates, shifted by so much to
    /// the east.
    fn questions(&self, origin: [f64; 3], shift_m: f64) -> Questions {
        let mut questions = Questions::default();
        let given = |isometry: &Isometry2<f64>| pose(isometry, origin, shift_m);
        for seen in &self.actions {
            questions.begin(given(&seen.estimates[0].robot_in_world));
            for (after, share, beam) in &seen.beams {
                let [from, to] = [after - 1, *after].map(|at| seen.estimates[at].robot_in_world);
                let way = to.translation.vector - from.translation.vector;
                let turn = from.rotation.rotation_to(&to.rotation);
                let mut then = to;
                then.translation.vector += (share - 1.0) * way;
                then.rotation *= UnitComplex::new((share - 1.0) * turn.angle());
                questions.moved(given(&then));
                questions.beam([beam.bearing.re, beam.bearing.im], beam.range_m);
            }
            questions.moved(given(&seen.estimates.last().unwrap().robot_in_world));
            questions.scanned();
        }
        questions
    }

    /// How many of the answers differ from what the simulator perceived.
    fn differing(&self, at: usize, answers: &[String]) -> usize {
        assert_eq!(answers.len(), self.actions.len());
        let pairs = self.actions.iter().zip(answers);
        pairs
            .filter(|(seen, answer)| seen.perceived[at] != **answer)
            .count()
    }
}

impl Seen {
    fn new(view: &View<'_>) -> Self {
        let sensed = view.sensed.unwrap();
        assert_eq!(sensed.estimates.len(), view.trace.len());
        let begin_ns = view.trace[0].time_ns;
        let beams = sensed.beams.iter().map(|beam| {
            let steps = (beam.time_ns - begin_ns) as f64 / STEP_NS;
            (steps as usize + 1, steps.fract(), *beam)
        });
        Self {
            estimates: sensed.estimates.to_vec(),
            beams: beams.collect(),
            perceived: SCANNING.map(|sensor| sensor.perceive(view).to_string()),
        }
    }
}

#[test]
fn a_scan_between_the_estimated_poses_shows_what_the_driving_robot_perceives() {
    let [maze, turned] = ["", r#""origin": [-3.5, 8.25, 0.7], "#].map(|origin| {
        let text = maze("maze4")
            .to_json()
            .replacen("\"rows\"", &format!("{origin}\"rows\""), 1);
        Maze::from_json(text.as_bytes(), "turned.json").unwrap()
    });
    let origin = turned.origin();
    let (driven, origin) = (Driven::new(&maze), [origin.x_m, origin.y_m, origin.yaw_rad]);
    let [straight, shifted] = [0.0, 0.5].map(|shift_m| driven.questions(origin, shift_m));
    for (at, sensor) in SCANNING.into_iter().enumerate() {
        for target in LANGUAGES {
            let found = seen(&straight, target, &turned, sensor);
            let differing = driven.differing(at, &found);
            let name = format!("{} {}", target.name(), sensor.name());
            // Exported code knows neither by which scale the robot corrects its ranges, nor how it moved
            // between two estimates.
            assert!(
                differing * 100 <= ACTIONS,
                "{name}: {differing} of {ACTIONS} differ"
            );
        }
        let half_a_cell_off = seen(&shifted, Target::C99, &turned, sensor);
        let differing = driven.differing(at, &half_a_cell_off);
        assert!(
            differing * 2 > ACTIONS,
            "control: {}: {differing} differ",
            sensor.name()
        );
    }
}

/// Reads a pose (x, y, heading) and 360 ranges per line.
const PYTHON_WHOLE_SCANS: &str = "
import math
import sys
import policy
for line in sys.stdin:
    x, y, heading, *ranges = map(float, line.split())
    print(policy.percept_from_scan(x, y, heading, ranges, 0.0, 2.0 * math.pi / len(ranges)))
";

/// The ranges of a whole turn at rest without noise, infinite where nothing comes back.
fn whole_turn(maze: &Maze, at_m: Vector2<f64>, heading_rad: f64) -> Vec<f64> {
    let beam = |number: u32| {
        let angle_rad = heading_rad + f64::from(number).to_radians();
        let direction = Vector2::new(angle_rad.cos(), angle_rad.sin());
        cast(maze, at_m, direction, 8.0).unwrap_or(f64::INFINITY)
    };
    (0..360).map(beam).collect()
}

#[test]
fn in_python_a_whole_scan_at_rest_shows_what_a_perfect_lidar_shows() {
    for (maze, heading_rad) in [("maze4", 0.0), ("maze6", 2.0)].map(|(name, rad)| (maze(name), rad))
    {
        let mut random = Stream::new(9, 0_u64);
        let mut line = |cell| {
            let mut off = || 0.2 * random.unit() - 0.1;
            let at_m = maze.centre_m(cell).coords + Vector2::new(off(), off());
            let ranges = whole_turn(&maze, at_m, heading_rad);
            let numbers = [at_m.x, at_m.y, heading_rad].into_iter().chain(ranges);
            let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
            numbers.join(" ") + "\n"
        };
        let lines: String = maze.free_cells().map(&mut line).collect();
        for sensor in [Sensor::Lidar, Sensor::LidarRanges, Sensor::LidarPosition] {
            let folder = folder();
            let policy = exported(Target::Python, &maze, sensor, ArenaKind::Physics);
            fs::write(folder.path().join("policy.py"), policy).unwrap();
            fs::write(folder.path().join("main.py"), PYTHON_WHOLE_SCANS).unwrap();
            let mut python = Command::new("python3");
            python.arg("main.py").current_dir(folder.path());
            let printed = String::from_utf8(fed(&mut python, lines.clone().into_bytes())).unwrap();
            let wanted = maze
                .free_cells()
                .map(|cell| sensor.perceive_at(&maze, cell).to_string());
            let (printed, wanted): (Vec<&str>, Vec<String>) =
                (printed.lines().collect(), wanted.collect());
            assert_eq!(printed, wanted, "{} {}", maze.name(), sensor.name());
        }
    }
}
