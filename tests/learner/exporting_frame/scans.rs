//! Percepts from scans: exported code and the simulated robot see the same.

use std::fs;
use std::process::Command;

use nalgebra::{Isometry2, Point2, Rotation2, UnitComplex, Vector2};
use xcscr::arena::{Arena, ArenaKind, Beam, Outcome, PhysicsArena, PhysicsParams};
use xcscr::arena::{Estimate, Localisation, View};
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::world::Maze;
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;
use xcscr_sensing::cast;

use super::programs::{LANGUAGES, Questions};
use super::{exported, in_map};
use crate::exporting::{fed, folder};
use crate::kit::trial::maze;

/// Sensors of which a scan shows the percept.
pub const SCANNING: [Sensor; 4] = [
    Sensor::Lidar,
    Sensor::LidarRanges,
    Sensor::LidarBeams,
    Sensor::LidarPosition,
];
pub const ACTIONS: usize = 520;
const STEP_NS: f64 = 50e6;

/// A pose as exported code takes it, shifted in the grid frame, and brought to the map frame.
pub fn pose(isometry: &Isometry2<f64>, origin: [f64; 3], shift_m: f64) -> [f64; 4] {
    let at = Point2::from(isometry.translation.vector) + Vector2::new(shift_m, 0.0);
    let turned =
        Rotation2::new(origin[2]) * Vector2::new(isometry.rotation.re, isometry.rotation.im);
    let [x, y] = in_map(origin, at);
    [x, y, turned.x, turned.y]
}

/// The answers of an exported policy, as long as the percept of the sensor is.
pub fn seen(questions: &Questions, target: Target, maze: &Maze, sensor: Sensor) -> Vec<String> {
    let policy = exported(target, maze, sensor, ArenaKind::Physics);
    let mut answers = questions.answers(target, &policy, maze);
    answers
        .iter_mut()
        .for_each(|answer| answer.truncate(sensor.width(maze)));
    answers
}

/// Beams of actions in the physics arena, and what every sensor perceived after each.
struct Driven {
    actions: Vec<Seen>,
}

struct Seen {
    estimates: Vec<Estimate>,
    /// Which estimate comes after the beam, and how much of that step was over.
    beams: Vec<(usize, f64, Beam)>,
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
            questions.begin(given(&seen.estimates[0].robot_in_map));
            for (after, share, beam) in &seen.beams {
                let [from, to] = [after - 1, *after].map(|at| seen.estimates[at].robot_in_map);
                let way = to.translation.vector - from.translation.vector;
                let turn = from.rotation.rotation_to(&to.rotation);
                let mut then = to;
                then.translation.vector += (share - 1.0) * way;
                then.rotation *= UnitComplex::new((share - 1.0) * turn.angle());
                questions.moved(given(&then));
                questions.beam([beam.bearing.re, beam.bearing.im], beam.range_m);
            }
            questions.moved(given(&seen.estimates.last().unwrap().robot_in_map));
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
