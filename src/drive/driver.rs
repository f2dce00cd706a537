//! The state machine that drives a robot with a policy.

use nalgebra::Isometry2;
use xcscr_sensing::Readings as StepOfSensors;

use super::fault::{Fault, Mislocalised};
use super::given::{Given, PoseSource};
use super::localisation::{Localisation, sees_walls};
use super::obstacle::{Braking, Obstacles};
use super::readings::Readings;
use super::setup::DriveSetup;
use super::step::{Belief, Decision, DriverStep, Phase};
use super::timeline::Timeline;
use super::watch::{Watch, Watched};
use super::wheels::WheelWatch;
use crate::agent::{Agent, Explorer, Frozen, Transition};
use crate::arena::{Measured, Now, Pilot, Speeds};
use crate::streams::StreamName;
use crate::world::{Cell, Maze};
use xcs::random::Stream;
use xcs::{Action, Percept};

/// Drives a robot with a policy: sensor readings in, commands out. Independent of ROS.
pub struct Driver {
    setup: DriveSetup,
    watch: Watch,
    given: Given,
    wheels: Option<WheelWatch>,
    timeline: Timeline,
    pilot: Pilot,
    localisation: Localisation,
    obstacles: Obstacles,
    policy: Frozen,
    greedy: Explorer,
    phase: Phase,
    decisions: u32,
    /// The percept, cell and action of the last decision, until its move is over.
    chosen: Option<(Percept, Cell, Action)>,
    has_scan: bool,
    /// The first final fault.
    last_fault: Option<Fault>,
}

impl Driver {
    /// Creates a driver for a robot at the start pose of the setup.
    pub fn new(setup: DriveSetup) -> Self {
        let (physics, maze) = (&setup.physics, &setup.maze);
        Self {
            watch: Watch::new(&setup),
            given: Given::new(&setup),
            wheels: setup
                .wheels
                .clone()
                .map(|wheels| WheelWatch::new(wheels, physics.max_speed_mps)),
            timeline: Timeline::new(physics.wheel_base_m),
            pilot: Pilot::new(physics, maze),
            localisation: Localisation::new(physics.lidar.beams),
            obstacles: Obstacles::default(),
            policy: Frozen::new(
                setup.knowledge.clone(),
                maze.action_count(),
                setup.step_threshold,
            )
            .with_detours(setup.sensor, maze),
            greedy: Explorer::new(0.0, Stream::new(setup.seed, StreamName::Exploration)),
            phase: Phase::Waiting,
            decisions: 0,
            chosen: None,
            has_scan: false,
            last_fault: None,
            setup,
        }
    }

    /// Returns the maze of the drive.
    pub fn maze(&self) -> &Maze {
        &self.setup.maze
    }

    /// Keeps the robot at rest from now on.
    pub fn interrupt(&mut self) {
        self.last_fault.get_or_insert(Fault::Interrupted);
    }

    /// Processes the readings that arrived until `steady_ns` and returns the command. `steady_ns`
    /// is a clock in nanoseconds that never jumps.
    ///
    /// Call this when readings arrive, and at least every 50 ms.
    pub fn step(&mut self, steady_ns: u64, readings: &Readings) -> DriverStep {
        let (pose, setup) = (self.pose(), &self.setup);
        let range_m = setup.physics.lidar.range_m;
        let sees_walls = || pose.is_none_or(|pose| sees_walls(&setup.maze, &pose, range_m));
        let watched = self.watch.step(steady_ns, readings, &sees_walls);
        let mut faults = self.take_outside(steady_ns, readings);
        self.take_in(&watched);
        faults.extend(watched.faults);
        if self.last_fault.is_none() {
            self.last_fault = faults.iter().find(|fault| fault.is_final()).cloned();
        }
        if let Some(fault) = self
            .last_fault
            .as_ref()
            .filter(|fault| !faults.contains(fault))
        {
            faults.push(fault.clone());
        }
        let mut step = DriverStep {
            command: Speeds::default(),
            phase: self.phase,
            belief: None,
            decision: None,
            outcome: None,
            faults,
        };
        if step.faults.is_empty() {
            self.advance(&mut step);
        }
        step.phase = self.phase;
        step.belief = self.belief();
        step
    }

    /// Takes in poses from outside, and the angles of the wheels. Returns their faults.
    fn take_outside(&mut self, steady_ns: u64, readings: &Readings) -> Vec<Fault> {
        let taken = self.given.step(steady_ns, readings, &self.setup);
        let mut faults = taken.faults;
        if taken.begins_again {
            self.phase = Phase::Waiting;
            self.chosen = None;
        }
        if let Some(start) = taken.start_in_grid {
            self.setup.start_in_grid = start;
        }
        if let Some(wheels) = &mut self.wheels {
            let odometry_ns = self.timeline.latest().map(|(time_ns, ..)| time_ns);
            let (rolled, found) = wheels.step(steady_ns, readings, odometry_ns);
            rolled
                .into_iter()
                .for_each(|one| self.timeline.add_wheels(one));
            faults.extend(found);
        }
        faults
    }

    /// Passes readings to the onboard computer, and checks its estimates.
    fn take_in(&mut self, watched: &Watched<'_>) {
        for odometry in &watched.odometry {
            self.timeline.add_odometry(odometry);
        }
        for imu in &watched.imu {
            self.timeline.add_imu(imu);
        }
        for scan in &watched.scans {
            let beams = self.timeline.add_scan(scan, self.setup.physics.lidar.beams);
            self.localisation.set_beams(beams);
            self.obstacles.see(scan, &self.timeline);
            self.has_scan = true;
        }
        if self.phase == Phase::Waiting {
            self.begin();
        }
        while self.phase != Phase::Waiting
            && let Some(readings) = self.timeline.next_step()
        {
            let before = self.pilot.estimate().0;
            let told = self.told_at(self.timeline.time_ns());
            self.pilot.sense(&Measured::Sensors(StepOfSensors {
                rolled_m: readings.rolled_m,
                turned_rad: readings.turned_rad,
                told,
                bumped: [false; 2],
                over_marker: false,
                beams: &readings.beams,
            }));
            let (pose, covariance) = self.pilot.estimate();
            let moved = before.inverse() * pose;
            let (maze, range_m) = (&self.setup.maze, self.setup.physics.lidar.range_m);
            let turn = self
                .localisation
                .step(maze, &pose, &moved, &readings.beams, range_m);
            let now = self.localisation.check(maze, &pose, &covariance);
            self.note(turn.or(now));
        }
    }

    fn note(&mut self, found: Option<Mislocalised>) {
        if let Some(cause) = found {
            self.last_fault.get_or_insert(Fault::Mislocalised(cause));
        }
    }

    /// Starts the drive once a scan and odometry have arrived.
    fn begin(&mut self) {
        let Some((time_ns, ..)) = self.timeline.latest().filter(|_| self.has_scan) else {
            return;
        };
        let Some(start) = self.start() else {
            return;
        };
        self.timeline.begin(time_ns);
        let tolerance = self.setup.start_tolerance;
        self.pilot.put_down(start, tolerance, time_ns);
        self.phase = Phase::LookingRound;
    }

    /// Returns the pose in the grid frame where the drive starts; `None` if the other localiser has not
    /// sent one.
    fn start(&self) -> Option<Isometry2<f64>> {
        match self.setup.source {
            PoseSource::Own => Some(self.setup.start_in_grid),
            PoseSource::Tf => self.told_at(self.timeline.latest()?.0),
        }
    }

    /// Returns the pose in the grid frame, as far as it is known.
    fn pose(&self) -> Option<Isometry2<f64>> {
        match self.phase {
            Phase::Waiting => self.start(),
            _ => self.now().map(|now| now.pose),
        }
    }

    /// Returns the pose in the grid frame at a time, by the other localiser; `None` without one.
    fn told_at(&self, time_ns: u64) -> Option<Isometry2<f64>> {
        let in_map = self.given.odom_in_map()? * self.timeline.pose_at(time_ns)?;
        let grid = self.setup.maze.grid_in_map();
        Some(grid.unwrap_or_else(Isometry2::identity).inverse() * in_map)
    }

    /// Returns the current pose and speeds, at the time of the newest odometry.
    fn now(&self) -> Option<Now> {
        let (time_ns, _, speeds) = self.timeline.latest()?;
        let pose = self.pilot.estimate().0 * self.timeline.since()?;
        Some(Now {
            pose,
            speeds,
            time_ns,
        })
    }

    fn belief(&self) -> Option<Belief> {
        if self.phase == Phase::Waiting {
            return None;
        }
        let now = self.now()?;
        let maze = &self.setup.maze;
        let robot_in_map = maze.pose_in_map(now.pose);
        let (_, robot_in_odom, _) = self.timeline.latest()?;
        Some(Belief {
            stamp_ns: now.time_ns,
            robot_in_map,
            covariance: maze.covariance_in_map(self.pilot.estimate().1),
            odom_in_map: robot_in_map * robot_in_odom.inverse(),
            cell: maze.cell_in_grid(now.pose.translation.vector.into()),
            is_own: self.setup.source == PoseSource::Own,
        })
    }

    /// Advances the state machine. Called only without faults.
    fn advance(&mut self, step: &mut DriverStep) {
        let Some(now) = self.now() else {
            return;
        };
        match self.phase {
            Phase::LookingRound if self.pilot.has_seen() => self.decide(now, step),
            Phase::Settling if self.pilot.has_seen() => self.end_action(now, step),
            Phase::Driving => step.command = self.drive(now),
            Phase::Waiting
            | Phase::LookingRound
            | Phase::Settling
            | Phase::AtGoal
            | Phase::OutOfSteps => {}
        }
    }

    /// Perceives, chooses an action, and starts to drive.
    fn decide(&mut self, now: Now, step: &mut DriverStep) {
        let maze = &self.setup.maze;
        let perceived = self.pilot.percept(maze, self.setup.sensor);
        let (Some(percept), Some(cell)) = (perceived, self.pilot.cell(maze)) else {
            return self.note(Some(Mislocalised::InAWall));
        };
        let values = self.policy.observe(&percept);
        let choice = self.policy.choose(&percept, &values, &mut self.greedy);
        let action = choice.action;
        let Some(direction) = maze.direction(action) else {
            return;
        };
        self.decisions += 1;
        step.command = self.pilot.begin(direction, now).unwrap_or(Speeds::REST);
        self.phase = Phase::Driving;
        self.chosen = Some((percept, cell, action));
        step.decision = Some(Decision {
            number: self.decisions,
            stamp_ns: now.time_ns,
            cell,
            percept,
            values,
            action,
            rule: None,
            words: String::new(),
        });
        if let Some(decision) = &mut step.decision {
            super::reason::explain(decision, &self.setup, &self.policy);
        }
    }

    /// Returns the speeds of the current manoeuvre; rest once it is over. In front of an obstacle the
    /// robot drives back, and rests if there is one behind it, too.
    fn drive(&mut self, now: Now) -> Speeds {
        let is_enclosed = self.is_blocked(now) && !self.pilot.back_off();
        let command = self.pilot.command(now);
        if command.is_none() {
            self.phase = Phase::Settling;
        }
        command.filter(|_| !is_enclosed).unwrap_or(Speeds::REST)
    }

    /// Returns true if the robot must brake for an obstacle on its path.
    fn is_blocked(&self, now: Now) -> bool {
        let path = self.pilot.path(&now).zip(self.timeline.latest());
        path.is_some_and(|((direction, left_m), (_, in_odom, _))| {
            let physics = &self.setup.physics;
            let braking = Braking {
                radius_m: physics.radius_m,
                deceleration_mps2: physics.deceleration_mps2,
                margin_m: physics.arrival_m,
            };
            let along = now.pose.rotation.inverse() * direction;
            let forward_mps = now.speeds.forward_mps;
            self.obstacles
                .is_in_the_path(&in_odom, (along, left_m), forward_mps, braking)
        })
    }

    /// Determines the outcome of the action, and decides again unless the drive is over.
    fn end_action(&mut self, now: Now, step: &mut DriverStep) {
        let is_goal = |cell| self.setup.maze.is_goal(cell);
        let at_goal = self.pilot.cell(&self.setup.maze).is_some_and(is_goal);
        let outcome = self.pilot.end(at_goal);
        if let Some((percept, cell, action)) = self.chosen.take() {
            self.policy.update(&Transition {
                percept: &percept,
                place: Some(cell),
                action,
                outcome,
                next: None,
            });
        }
        step.outcome = Some(outcome);
        if at_goal {
            self.phase = Phase::AtGoal;
        } else if self.decisions >= self.setup.step_threshold {
            self.phase = Phase::OutOfSteps;
        } else {
            self.decide(now, step);
        }
    }
}
