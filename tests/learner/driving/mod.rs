//! The driver and the simulated robot in lockstep.

mod bags;
mod faults;
mod lidars;
mod localisers;
mod maps;
mod messages;
mod scans;

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry2, Isometry3};

use xcscr::agent::Knowledge;
use xcscr::arena::{Outcome, Speeds};
use xcscr::drive::*;
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, RobotProfile, ScanOrder};
use xcscr::world::{Cell, Maze, Paths};
use xcscr::xcs::Action;

const STEP_NS: u64 = 50_000_000;

fn maze4() -> Maze {
    Maze::load("worlds/maze4.json".as_ref()).unwrap()
}

/// Returns a plan, and a table with the shortest paths. The table is inverted in `wrong` cells.
fn policy(maze: Maze, wrong: impl Fn(Cell) -> bool) -> (Plan, Knowledge) {
    let plan = Plan::new(maze).sensor(Sensor::LidarPosition);
    let maze = &plan.maze;
    let paths = Paths::with_slip(maze, 0.0);
    let row = |cell: Cell| {
        let is_best = |action| paths.successor(maze, cell, action).is_some();
        let value = |action| Some(f64::from(u8::from(is_best(action) != wrong(cell))));
        Action::all(4).map(value).collect()
    };
    let cells = maze.free_cells();
    let table = cells.map(|cell| (Sensor::LidarPosition.perceive_at(maze, cell), row(cell)));
    let knowledge = Knowledge::Table(table.collect());
    (plan, knowledge)
}

/// The lidar in the middle of the robot.
fn mount() -> Transform {
    Transform {
        parent: "base_link".to_owned(),
        child: "base_scan".to_owned(),
        pose: Isometry3::identity(),
    }
}

/// A simulated robot and a driver that exchange messages only.
struct Rig {
    robot: SimulatedRobot,
    driver: Driver,
    /// The pose of the lidar.
    mount: Transform,
    /// The pose by the last odometry.
    odom: Isometry2<f64>,
    /// The steady clock, which starts at another time than simulated time.
    now_ns: u64,
}

impl Rig {
    fn new(maze: Maze, seed: u64, options: DriveOptions) -> Self {
        let (plan, knowledge) = policy(maze.clone(), |_| false);
        let physics = plan.config.settings.physics.clone();
        let setup = DriveSetup::new(&plan, &knowledge, options).unwrap();
        Self {
            robot: SimulatedRobot::new(maze, &physics, seed, None).unwrap(),
            driver: Driver::new(setup),
            mount: mount(),
            odom: Isometry2::identity(),
            now_ns: 7_000_000_000,
        }
    }

    fn maze4() -> Self {
        Self::new(maze4(), 1, DriveOptions::default())
    }

    /// Advances both by 50 ms. `tamper` changes the readings.
    fn tick(&mut self, tamper: impl FnOnce(&mut Readings)) -> DriverStep {
        let SimulatedReadings {
            odometry,
            imu,
            scan,
            ..
        } = self.robot.step();
        self.now_ns += STEP_NS;
        let mut readings = Readings {
            scans: scan.into_iter().collect(),
            static_transforms: vec![self.mount.clone()],
            odometry: vec![odometry],
            imu: imu.into_iter().collect(),
            ..Readings::default()
        };
        tamper(&mut readings);
        let step = self.driver.step(self.now_ns, &readings);
        self.robot.command(step.command);
        step
    }

    /// Ticks until the robot has driven for a while, without faults.
    fn until_it_drives(&mut self) {
        let mut moving = 0;
        for _ in 0..200 {
            let step = self.tick(|_| ());
            assert!(
                step.faults.is_empty() || step.phase == Phase::Waiting,
                "{step:?}"
            );
            moving += u32::from(step.command.forward_mps.abs() > 0.1);
            if moving == 5 {
                return;
            }
        }
        panic!("it does not drive");
    }

    /// Injects a fault. Returns the number of steps until the driver commands rest, and the names of the faults.
    fn steps_to_rest(&mut self, tamper: impl Fn(&mut Readings)) -> (u32, Vec<&'static str>) {
        self.until_it_drives();
        for count in 1..=40 {
            let step = self.tick(&tamper);
            if !step.faults.is_empty() {
                assert_eq!(step.command, Speeds::default(), "{step:?}");
                return (count, step.faults.iter().map(Fault::name).collect());
            }
        }
        panic!("no fault");
    }

    /// Returns the names of the faults this many steps after the tampering ended.
    fn after(&mut self, steps: u32) -> Vec<&'static str> {
        let last = (0..steps).map(|_| self.tick(|_| ())).last().unwrap();
        last.faults.iter().map(Fault::name).collect()
    }
}

/// Drives to the end. Returns the last step, the decisions, and the total impulse of all collisions.
fn drive(rig: &mut Rig) -> (DriverStep, Vec<Decision>, f64) {
    let (mut decisions, mut impulse_n_s) = (Vec::new(), 0.0);
    for _ in 0..12_000 {
        let step = rig.tick(|_| ());
        impulse_n_s += rig.robot.impulse_n_s();
        decisions.extend(step.decision.clone());
        let is_over = matches!(step.phase, Phase::AtGoal | Phase::OutOfSteps);
        let has_failed = step.faults.iter().any(Fault::is_final);
        if is_over || has_failed {
            return (step, decisions, impulse_n_s);
        }
    }
    panic!("not over after 10 minutes");
}

#[test]
fn it_drives_to_the_goal_by_messages_alone_on_a_shortest_path() {
    let mut touched = 0;
    for seed in 1..=20 {
        let mut rig = Rig::new(maze4(), seed, DriveOptions::default());
        let (step, decisions, impulse_n_s) = drive(&mut rig);
        assert_eq!(step.phase, Phase::AtGoal, "seed {seed}: {step:?}");
        assert!(rig.robot.is_at_goal(), "seed {seed}");
        assert_eq!(decisions.len(), 10, "seed {seed}");
        touched += u32::from(impulse_n_s > 0.3);
    }
    assert_eq!(touched, 0);
}

#[test]
fn the_same_readings_give_the_same_decisions() {
    let run = || {
        let mut rig = Rig::maze4();
        let (_, decisions, _) = drive(&mut rig);
        decisions
    };
    let decisions = run();
    assert_eq!(decisions, run());
    let words = &decisions[0].words;
    assert!(words.starts_with("cell 1,1: east"), "{words}");
    assert!(words.contains("seen: "), "{words}");
}

#[test]
fn it_drives_in_a_rotated_maze_and_from_a_given_start() {
    let text = std::fs::read_to_string("worlds/maze4.json").unwrap();
    let turned = text.replace("\"rows\"", "\"origin\": [-3.5, 8.25, 0.7], \"rows\"");
    let maze = Maze::from_json(turned.as_bytes(), "turned.json").unwrap();
    let mut rig = Rig::new(maze.clone(), 3, DriveOptions::default());
    let (step, ..) = drive(&mut rig);
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
    let belief = step.belief.unwrap();
    let off = belief.robot_in_map.inverse() * rig.robot.true_pose();
    assert!(off.translation.vector.norm() < 0.1, "{off}");
    // From another cell, heading north.
    let cell = Cell { col: 2, row: 6 };
    let at = maze.centre_m(cell);
    let start = Some([at.x, at.y, 0.7 + FRAC_PI_2]);
    let options = DriveOptions {
        start,
        ..DriveOptions::default()
    };
    let mut rig = Rig::new(maze.clone(), 4, options);
    let physics = Plan::new(maze.clone()).config.settings.physics;
    rig.robot = SimulatedRobot::new(maze, &physics, 4, start).unwrap();
    assert_eq!(drive(&mut rig).0.phase, Phase::AtGoal);
}

/// Drives with every n-th gyro reading lost. Returns how many of eight drives reach the goal. The others must detect
/// that they are mislocalised.
fn reached_without(every: usize) -> usize {
    let reaches = |seed: &u64| {
        let mut rig = Rig::new(maze4(), *seed, DriveOptions::default());
        for tick in 0..4_000 {
            let step = rig.tick(|readings| {
                if tick % every == 0 {
                    readings.imu.clear();
                }
            });
            match step.faults.iter().find(|fault| fault.is_final()) {
                Some(Fault::Mislocalised(_)) => return false,
                Some(fault) => panic!("{fault}"),
                None if step.phase == Phase::AtGoal => return true,
                None => {}
            }
        }
        panic!("one of {every} lost, seed {seed}: not over");
    };
    (1..=8).filter(reaches).count()
}

#[test]
fn lost_gyro_readings_do_no_harm() {
    assert_eq!([3, 4].map(reached_without), [8, 8]);
}

#[test]
fn a_robot_without_a_gyro_reaches_the_goal_or_detects_that_it_is_mislocalised() {
    let reached = reached_without(1);
    assert!((4..8).contains(&reached), "{reached}");
}

#[test]
fn a_wall_is_detected_without_contact_and_leads_to_another_way() {
    let (plan, knowledge) = policy(maze4(), |cell| (cell.col, cell.row) == (1, 1));
    let mut rig = Rig::maze4();
    let setup = DriveSetup::new(&plan, &knowledge, DriveOptions::default()).unwrap();
    rig.driver = Driver::new(setup);
    let (mut blocked, mut impulse_n_s) = (0, 0.0);
    for _ in 0..4_000 {
        let step = rig.tick(|_| ());
        impulse_n_s += rig.robot.impulse_n_s();
        assert!(!step.faults.iter().any(Fault::is_final), "{step:?}");
        blocked += u32::from(matches!(step.outcome, Some(Outcome::Collided { .. })));
        if step.phase == Phase::AtGoal {
            break;
        }
    }
    assert!((1..=2).contains(&blocked), "{blocked}");
    assert_eq!(impulse_n_s, 0.0);
    assert!(rig.robot.is_at_goal());
}

#[test]
fn no_command_exceeds_the_profile() {
    let mut rig = Rig::maze4();
    let (mut fastest, mut quickest): (f64, f64) = (0.0, 0.0);
    let physics = Plan::new(maze4()).config.settings.physics;
    for _ in 0..600 {
        let Speeds {
            forward_mps,
            turn_radps,
        } = rig.tick(|_| ()).command;
        fastest = fastest.max(forward_mps.abs());
        quickest = quickest.max(turn_radps.abs());
    }
    assert!(fastest > 1.0 && quickest > 3.0, "control");
    assert!(fastest <= physics.max_speed_mps, "{fastest}");
    assert!(quickest <= physics.max_turn_radps, "{quickest}");
}

#[test]
fn a_policy_for_another_robot_or_other_cells_is_refused() {
    let (plan, knowledge) = policy(maze4(), |_| false);
    let refusal = |options| {
        let refused = DriveSetup::new(&plan, &knowledge, options);
        refused.err().map(|refusal| refusal.to_string())
    };
    let robot = |name| DriveOptions {
        robot: Some(RobotProfile::load(name).unwrap()),
        ..DriveOptions::default()
    };
    let message = refusal(robot("turtlebot3-burger")).unwrap();
    assert!(
        message.contains("a different robot, not with turtlebot3-burger"),
        "{message}"
    );
    assert_eq!(refusal(robot("default")), None, "control");
    let text = std::fs::read_to_string("worlds/maze4.json").unwrap();
    let world = |size: &str| {
        let text = text.replace("\"cell_size_m\": 1.0", size);
        DriveOptions {
            world: Some(Maze::from_json(text.as_bytes(), "other.json").unwrap()),
            ..DriveOptions::default()
        }
    };
    let message = refusal(world("\"cell_size_m\": 1.5")).unwrap();
    assert!(message.contains("cells of 1 m"), "{message}");
    assert_eq!(refusal(world("\"cell_size_m\": 1.0")), None, "control");
    let start = |start| DriveOptions {
        start: Some(start),
        ..DriveOptions::default()
    };
    assert!(refusal(start([0.5, 0.5, 0.0])).unwrap().contains("--start"));
    assert_eq!(refusal(start([1.5, 6.5, 0.0])), None, "control");
}

#[test]
fn a_ground_truth_percept_is_refused() {
    let plan = Plan::new(maze4()).sensor(Sensor::Position);
    let knowledge = Knowledge::Table(std::collections::BTreeMap::new());
    let refused = DriveSetup::new(&plan, &knowledge, DriveOptions::default());
    let message = refused.map_or_else(|error| error.to_string(), |_| String::new());
    assert!(message.starts_with("a robot cannot sense the percept `position`"));
}

#[test]
fn the_simulated_robot_stops_half_a_second_after_the_last_command() {
    let physics = Plan::new(maze4()).config.settings.physics;
    let mut robot = SimulatedRobot::new(maze4(), &physics, 1, None).unwrap();
    robot.command(Speeds {
        forward_mps: 0.0,
        turn_radps: 1.0,
    });
    let mut rates: Vec<f64> = Vec::new();
    for _ in 0..16 {
        rates.push(robot.step().odometry.speeds.turn_radps);
    }
    assert!(rates[9] > 0.9, "control: {rates:?}");
    assert!(rates[14].abs() < 0.05, "{rates:?}");
}

#[test]
fn a_fault_of_the_first_episode_breaks_the_simulated_robot_and_one_of_the_second_does_not() {
    let turn_rate = |from_episode| {
        let mut physics = Plan::new(maze4()).config.settings.physics;
        physics.faults.from_episode = from_episode;
        physics.faults.stuck_encoder = true;
        let mut robot = SimulatedRobot::new(maze4(), &physics, 1, None).unwrap();
        robot.command(Speeds {
            forward_mps: 0.3,
            turn_radps: 0.0,
        });
        let rates = (0..9).map(|_| robot.step().odometry.speeds.turn_radps);
        rates.last().unwrap()
    };
    let (broken, sound) = (turn_rate(1), turn_rate(2));
    assert!(broken > 0.5, "the left wheel seems to stand: {broken}");
    assert!(sound.abs() < 0.2, "control: {sound}");
}
