//! Percepts from scans: exported code and the robot see the same.

use nalgebra::{Complex, Isometry2, Point2, Rotation2, Translation2, UnitComplex, Vector2};
use xcscr::arena::{ArenaKind, LocalMap, PhysicsParams};
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::world::{Cell, Direction, Maze};
use xcscr::xcs::random::Stream;
use xcscr_sensing::{Moment, Onboard, Return, RobotParams, Sensors, Streams, cast};

use super::frame::{exported, in_map};
use super::program::{LANGUAGES, Program, Questions};
use crate::kit::trial::maze;

/// Sensors of which a scan shows the percept.
const SCANNING: [Sensor; 2] = [Sensor::Lidar, Sensor::LidarPosition];

/// A pose as exported code takes it, shifted in the grid frame, and brought to the map frame.
fn pose(isometry: &Isometry2<f64>, origin: [f64; 3], shift_m: f64) -> [f64; 4] {
    let at = Point2::from(isometry.translation.vector) + Vector2::new(shift_m, 0.0);
    let heading = Vector2::new(isometry.rotation.re, isometry.rotation.im);
    let turned = Rotation2::new(origin[2]) * heading;
    let [x, y] = in_map(origin, at);
    [x, y, turned.x, turned.y]
}

/// The answers of an exported policy, as long as the percept of the sensor is.
fn seen(questions: &Questions, target: Target, maze: &Maze, sensor: Sensor) -> Vec<String> {
    let policy = exported(target, maze, sensor, ArenaKind::Physics);
    let mut answers = Program::new(target, &policy).answers(questions);
    for answer in &mut answers {
        answer.truncate(sensor.width(maze));
    }
    answers
}

#[test]
fn in_python_a_whole_scan_at_rest_shows_what_a_perfect_lidar_shows() {
    for (maze, heading_rad) in [(maze("maze4"), 0.0), (maze("maze6"), 2.0)] {
        let (mut random, mut questions) = (Stream::new(9, 0_u64), Questions::about(&maze));
        for cell in maze.free_cells() {
            let mut off = || 0.2 * random.unit() - 0.1;
            let at_m = maze.centre_m(cell).coords + Vector2::new(off(), off());
            let range_m = |degrees: u32| {
                let angle_rad = heading_rad + f64::from(degrees).to_radians();
                let direction = Vector2::new(angle_rad.cos(), angle_rad.sin());
                cast(&maze, at_m, direction, 8.0).unwrap_or(f64::INFINITY)
            };
            let ranges_m: Vec<f64> = (0..360).map(range_m).collect();
            let pose = [at_m.x, at_m.y, heading_rad];
            questions.say('w', &[&pose[..], &ranges_m].concat());
        }
        for sensor in SCANNING {
            let found = seen(&questions, Target::Python, &maze, sensor);
            let wanted = maze
                .free_cells()
                .map(|cell| sensor.perceive_at(&maze, cell));
            let wanted: Vec<String> = wanted.map(|percept| percept.to_string()).collect();
            assert_eq!(found, wanted, "{} {}", maze.name(), sensor.name());
        }
    }
}

/// The robot of the physics arena, as its sensors need to know it, of which so many beams do not come back.
fn robot(maze: &Maze, dropouts: f64) -> RobotParams {
    let mut params = PhysicsParams::default();
    (params.lidar.dropouts, params.lidar.outliers) = (dropouts, dropouts / 4.0);
    RobotParams {
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

/// A robot that moves by itself, without physics, with the sensors and the computer of the arena's.
struct Drive<'a> {
    maze: &'a Maze,
    onboard: Onboard,
    sensors: Sensors,
    pose: Isometry2<f64>,
    steps: u64,
    travel_m: [f64; 2],
    /// By action, the steps.
    actions: Vec<Vec<Step>>,
}

/// A step of a drive: what came back, where the robot believed to be at its beginning and its end, and at each
/// beam, and what every sensor perceived after it.
struct Step {
    estimates: [Isometry2<f64>; 2],
    beams: Vec<Beam>,
    /// By which scale the robot corrects its ranges.
    scale: f64,
    perceived: [String; 2],
}

impl<'a> Drive<'a> {
    /// Random actions from the first free cell.
    fn new(maze: &'a Maze, actions: usize, dropouts: f64) -> Self {
        let robot = robot(maze, dropouts);
        let mut cell = maze.free_cells().next().unwrap();
        let middle = maze.centre_m(cell);
        let pose = Isometry2::from_parts(Translation2::from(middle), UnitComplex::identity());
        let mut onboard = Onboard::new(&robot);
        onboard.put_down(pose);
        let streams = Streams {
            lidar: Stream::new(1, StreamName::Lidar),
            encoders: Stream::new(1, StreamName::Encoders),
            gyro: Stream::new(1, StreamName::Gyro),
        };
        let mut drive = Self {
            maze,
            onboard,
            sensors: Sensors::new(&robot, streams),
            pose,
            steps: 0,
            travel_m: [0.0; 2],
            actions: Vec::new(),
        };
        let mut random = Stream::new(5, 0_u64);
        for _ in 0..actions {
            drive.onboard.begin_action();
            drive.actions.push(Vec::new());
            cell = drive.act(cell, Direction::MAIN[random.below(4)]);
        }
        drive
    }

    /// One step forward and round.
    fn step(&mut self, forward_m: f64, turn_rad: f64) {
        let (before, believed) = (self.pose, self.onboard.estimate().0);
        self.pose.translation.vector += before.rotation * Vector2::new(forward_m, 0.0);
        self.pose.rotation *= UnitComplex::new(turn_rad);
        let round_m = 0.2 * turn_rad;
        let [left_m, right_m] = self.travel_m;
        self.travel_m = [left_m + forward_m - round_m, right_m + forward_m + round_m];
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
        let step = self.seen(believed, beams);
        self.actions.last_mut().unwrap().push(step);
    }

    /// What the robot made of some beams. It takes them as sent from where the estimator has it
    /// (`Estimator::ray`).
    fn seen(&self, believed: Isometry2<f64>, beams: Vec<Return>) -> Step {
        let (way, turned_rad) = self.onboard.last_motion();
        let estimate = self.onboard.estimate().0;
        let sent = |beam: Return| {
            let mut then = estimate;
            then.translation.vector += (beam.moment - 1.0) * way;
            then.rotation *= small_rotation((beam.moment - 1.0) * turned_rad);
            (beam, then)
        };
        Step {
            estimates: [believed, estimate],
            beams: beams.into_iter().map(sent).collect(),
            scale: self.onboard.range_scale(),
            perceived: self.perceived(),
        }
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

    /// What every sensor perceives now.
    fn perceived(&self) -> [String; 2] {
        let [east, north] = self.onboard.cell();
        let (width, height) = (i32::from(self.maze.width()), i32::from(self.maze.height()));
        let cell = Cell {
            col: east.clamp(0, width - 1) as u16,
            row: (height - 1 - north).clamp(0, height - 1) as u16,
        };
        let local_map = LocalMap {
            surroundings: self.onboard.surroundings(),
            obstacles: self.onboard.obstacles(),
            cell,
        };
        SCANNING.map(|sensor| sensor.sense(self.maze, &local_map).to_string())
    }

    /// What a sensor perceived after each step.
    fn wanted(&self, at: usize) -> Vec<&String> {
        let steps = self.actions.iter().flatten();
        steps.map(|step| &step.perceived[at]).collect()
    }

    /// Questions to exported code in a maze that may be turned: the same beams, sent from these poses and with
    /// these ranges, all shifted by so much to the east.
    fn questions(&self, maze: &Maze, shift_m: f64, sent: Sent) -> Questions {
        let (mut questions, origin) = (Questions::about(maze), maze.origin().into());
        let given = |isometry: &Isometry2<f64>| pose(isometry, origin, shift_m);
        for steps in &self.actions {
            questions.say('b', &given(&steps[0].estimates[0]));
            for step in steps {
                for beam in &step.beams {
                    let (from, range_m) = sent(step, beam);
                    questions.say('v', &given(&from));
                    let range_m = range_m.unwrap_or(f64::INFINITY);
                    let (beam, _) = beam;
                    questions.say('a', &[beam.bearing.re, beam.bearing.im, range_m]);
                }
                questions.say('v', &given(&step.estimates[1]));
                questions.ask('q', &[]);
            }
        }
        questions
    }
}

/// A beam, and from where it was sent on board.
type Beam = (Return, Isometry2<f64>);
/// From where a beam of a step was sent, and its range.
type Sent = fn(&Step, &Beam) -> (Isometry2<f64>, Option<f64>);

/// As the robot has it.
fn as_on_board(step: &Step, (beam, from): &Beam) -> (Isometry2<f64>, Option<f64>) {
    (*from, beam.range_m.map(|range| range * step.scale))
}

/// As a program has it that knows only the estimates before and after a step.
fn between_estimates(step: &Step, (beam, _): &Beam) -> (Isometry2<f64>, Option<f64>) {
    let [from, to] = step.estimates;
    let way = to.translation.vector - from.translation.vector;
    let turn = from.rotation.rotation_to(&to.rotation);
    let mut then = to;
    then.translation.vector += (beam.moment - 1.0) * way;
    then.rotation *= UnitComplex::new((beam.moment - 1.0) * turn.angle());
    (then, beam.range_m)
}

#[test]
fn a_scan_between_the_estimated_poses_shows_what_the_driving_robot_perceives() {
    let maze = maze("maze4");
    let turned = r#""origin": [-3.5, 8.25, 0.7], "rows""#;
    let turned = maze.to_json().replacen("\"rows\"", turned, 1);
    let turned = Maze::from_json(turned.as_bytes(), "turned.json").unwrap();
    let drive = Drive::new(&maze, 100, 0.01);
    let [straight, shifted] =
        [0.0, 0.5].map(|shift_m| drive.questions(&turned, shift_m, between_estimates));
    for (at, sensor) in SCANNING.into_iter().enumerate() {
        let wanted = drive.wanted(at);
        let differing = |questions, target: Target| {
            let answers = seen(questions, target, &turned, sensor);
            assert_eq!(answers.len(), wanted.len());
            let pairs = wanted.iter().zip(&answers);
            pairs.filter(|(wanted, answer)| **wanted != *answer).count()
        };
        for target in LANGUAGES {
            // Exported code knows neither by which scale the robot corrects its ranges, nor how it moved
            // between two estimates.
            let found = differing(&straight, target);
            let name = format!("{} {}", target.name(), sensor.name());
            assert!(found * 100 <= wanted.len(), "{name}: {found} differ");
        }
        let found = differing(&shifted, Target::C99);
        let name = format!("control, half a cell off: {}", sensor.name());
        assert!(found * 2 > wanted.len(), "{name}: {found} differ");
    }
}

/// The rotation of a part of a step, as the computer on board computes it.
fn small_rotation(angle_rad: f64) -> UnitComplex<f64> {
    let square = angle_rad * angle_rad;
    assert!(square < 0.4, "{angle_rad}");
    let series = |factors: [f64; 4]| {
        let term = |rest: f64, factor: &f64| 1.0 - square / factor * rest;
        factors.iter().rev().fold(1.0, term)
    };
    let sine = series([6.0, 20.0, 42.0, 72.0]);
    let cosine = 1.0 - square / 2.0 * series([12.0, 30.0, 56.0, 90.0]);
    UnitComplex::new_unchecked(Complex::new(cosine, angle_rad * sine))
}

#[test]
fn the_same_beams_from_the_same_poses_give_the_same_percept_bit_for_bit() {
    let maze = maze("maze6");
    let text = maze.to_json();
    let small = text.replace("\"cell_size_m\": 1.0", "\"cell_size_m\": 0.25");
    let small = Maze::from_json(small.as_bytes(), "small.json").unwrap();
    assert_eq!(small.cell_size_m(), 0.25);
    // In small cells some beams hit what is too near.
    let nearest = [("NEAREST_M 0.12", "NEAREST_M 0.0")];
    compare_with_exports(&small, 520, &[Sensor::Lidar], &nearest);
    let controls = [
        ("FREE 30", "FREE 60"),
        ("HIT 20", "HIT 10"),
        ("LOST 7", "LOST 20"),
        ("GRAZE_M 0.15", "GRAZE_M 0.05"),
        ("GRAZE_SHARE 0.02", "GRAZE_SHARE 0.1"),
        ("STRAY_M 0.2", "STRAY_M 0.05"),
        ("LOST_RANGE_M 3.0", "LOST_RANGE_M 1.0"),
    ];
    compare_with_exports(&maze, 100, &SCANNING, &controls);
}

/// Compares the percepts of a driving robot with those of exported code in all languages. Each control
/// changes a constant, which must change a percept.
fn compare_with_exports(
    maze: &Maze,
    actions: usize,
    sensors: &[Sensor],
    controls: &[(&str, &str)],
) {
    let drive = Drive::new(maze, actions, 0.2);
    let questions = drive.questions(maze, 0.0, as_on_board);
    for &sensor in sensors {
        let at = SCANNING.iter().position(|&other| other == sensor);
        let wanted = drive.wanted(at.unwrap());
        for target in LANGUAGES {
            let found = seen(&questions, target, maze, sensor);
            let name = format!("{} {}", target.name(), sensor.name());
            assert!(found.iter().eq(wanted.iter().copied()), "{name}");
        }
    }
    let policy = exported(Target::C99, maze, Sensor::Lidar, ArenaKind::Physics);
    let answers = |policy: &str| Program::new(Target::C99, policy).answers(&questions);
    let right = answers(&policy);
    for (constant, other) in controls {
        let [constant, other] = [constant, other].map(|name| format!("#define XCSCR_SCAN_{name}"));
        assert!(policy.contains(&constant), "{constant}");
        let found = answers(&policy.replace(&constant, &other));
        assert!(found != right, "control: {other}");
    }
}
