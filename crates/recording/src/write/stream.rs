//! The messages of a file: facts as they are, and scenes drawn from them.

use std::sync::Arc;

use foxglove::messages::SceneEntity;

use super::file::File;
use crate::error::Error;
use crate::event::{Begin, Decision, Event, Learned, Pose, StepOutcome};
use crate::info::{RecordingKind, RobotShape, RunInfo, RunKind};
use crate::topics::caption::Caption;
use crate::topics::trail::Trail;
use crate::topics::{
    Topic, estimate, maze, odometry, percept, policy, robot, rule, transforms, values,
};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::Maze;

/// What is drawn and does not change during a run.
pub(super) struct Scenery {
    maze: Maze,
    robot: RobotShape,
    sensor: Sensor,
    heading: String,
    /// The word for an episode, and the number of episodes if it is known.
    episodes: (&'static str, Option<u32>),
}

/// A file of a recording. Each file has its own drawings.
pub(super) struct MessageStream {
    file: File,
    is_episode: bool,
    scenery: Arc<Scenery>,
    trail: Trail,
    learned: Learned,
    /// The learned policy last written.
    shown: Option<Learned>,
    has_maze: bool,
    /// The percept at the last decision.
    perceived_cells: SceneEntity,
    /// The last pose.
    pose: Option<Pose>,
}

impl Scenery {
    /// Returns what is drawn in the recordings of a run.
    pub fn new(maze: &Maze, info: &RunInfo) -> Self {
        Self {
            maze: maze.clone(),
            robot: info.robot,
            sensor: info.sensor,
            heading: info.heading(maze.name()),
            episodes: match info.kind {
                RunKind::Training => ("Episode", Some(info.episodes)),
                RunKind::Evaluation => ("Greedy drive", Some(info.episodes)),
                RunKind::External => ("Episode", None),
            },
        }
    }

    fn caption(&self, begin: &Begin) -> Caption {
        let (name, all) = self.episodes;
        let all = all.map_or(String::new(), |all| format!(" of {all}"));
        Caption {
            title: format!("{name} {}{all}", begin.episode),
            heading: self.heading.clone(),
        }
    }
}

impl MessageStream {
    /// Writes to a file whose topics are declared.
    pub fn new(file: File, kind: RecordingKind, scenery: Arc<Scenery>) -> Self {
        Self {
            file,
            is_episode: kind != RecordingKind::Run,
            trail: Trail::new(&scenery.maze),
            scenery,
            learned: Learned::default(),
            shown: None,
            has_maze: false,
            perceived_cells: SceneEntity::default(),
            pose: None,
        }
    }

    /// Returns the file.
    pub fn into_file(self) -> File {
        self.file
    }

    /// Writes what the file shows of an event. The file of a run has what happens at most once per
    /// step, and drawings at the end of each episode.
    pub fn write(&mut self, time_ns: u64, event: &Event) -> Result<(), Error> {
        match event {
            Event::Pose(pose) => self.pose(pose),
            Event::Begin(begin) => self.begin(time_ns, begin),
            Event::Outcome(outcome) => self.outcome(time_ns, outcome),
            Event::Log(line) => self.file.message(Topic::Log, time_ns, line),
            Event::End(end) => {
                if !self.is_episode {
                    self.show_learned(time_ns)?;
                }
                self.show_trail(time_ns)?;
                if self.is_episode && self.pose.is_some_and(|pose| pose.estimate.is_some()) {
                    self.show_percept(time_ns)?;
                }
                self.file.fact(Topic::Episode, time_ns, end)
            }
            Event::Learned(learned) => {
                self.learned.clone_from(learned);
                if self.is_episode {
                    self.show_learned(time_ns)
                } else {
                    Ok(())
                }
            }
            Event::Contact(contact) => {
                self.trail.hit(&self.scenery.maze, contact);
                if self.is_episode {
                    self.file.fact(Topic::Contact, time_ns, contact)
                } else {
                    Ok(())
                }
            }
            _ if !self.is_episode => Ok(()),
            Event::Decision(decision) => self.decision(time_ns, decision),
            Event::Scan(scan) => self.file.message(Topic::Scan, time_ns, scan),
            Event::Localisation(fact) => self.file.fact(Topic::Localisation, time_ns, fact),
            Event::Curve(curve) => self.file.fact(Topic::Curve, time_ns, curve),
        }
    }

    fn pose(&mut self, pose: &Pose) -> Result<(), Error> {
        self.trail.follow(&self.scenery.maze, pose);
        self.pose = Some(*pose);
        if !self.is_episode {
            return Ok(());
        }
        let (file, time_ns) = (&mut self.file, pose.time_ns);
        file.message(Topic::Transforms, time_ns, &transforms::moving(pose))?;
        file.message(Topic::GroundTruth, time_ns, &odometry::truth(pose))?;
        match &pose.estimate {
            Some(known) => {
                let message = odometry::estimate(time_ns, known);
                file.message(Topic::Estimate, time_ns, &message)
            }
            None => Ok(()),
        }
    }

    fn begin(&mut self, time_ns: u64, begin: &Begin) -> Result<(), Error> {
        self.trail = Trail::new(&self.scenery.maze);
        if let Some(pose) = &self.pose {
            self.trail.follow(&self.scenery.maze, pose);
        }
        self.show_scenery(time_ns)?;
        if self.is_episode {
            self.show_trail(time_ns)?;
        }
        self.file.fact(Topic::Begin, time_ns, begin)?;
        let caption = self
            .scenery
            .caption(begin)
            .scene(&self.scenery.maze, time_ns);
        self.file.message(Topic::Caption, time_ns, &caption)
    }

    /// Writes the static scene and the robot's body once.
    fn show_scenery(&mut self, time_ns: u64) -> Result<(), Error> {
        if std::mem::replace(&mut self.has_maze, true) {
            return Ok(());
        }
        let (file, Scenery { maze, robot, .. }) = (&mut self.file, &*self.scenery);
        file.message(Topic::GridFrame, time_ns, &transforms::fixed(maze, time_ns))?;
        file.message(Topic::Maze, time_ns, &maze::scene(maze, time_ns))?;
        if self.is_episode {
            file.message(Topic::Robot, time_ns, &robot::scene(robot, time_ns))
        } else {
            Ok(())
        }
    }

    fn decision(&mut self, time_ns: u64, decision: &Decision) -> Result<(), Error> {
        let Scenery { maze, sensor, .. } = &*self.scenery;
        self.file.fact(Topic::Rule, time_ns, decision)?;
        let over_robot = rule::scene(decision, maze, time_ns);
        self.file.message(Topic::RuleText, time_ns, &over_robot)?;
        self.perceived_cells = percept::perceived_cells(*sensor, maze, decision, time_ns);
        self.show_percept(time_ns)
    }

    fn outcome(&mut self, time_ns: u64, outcome: &StepOutcome) -> Result<(), Error> {
        self.file.fact(Topic::Step, time_ns, outcome)?;
        if self.trail.is_due(time_ns) && self.is_episode {
            self.show_trail(time_ns)
        } else {
            Ok(())
        }
    }

    fn show_trail(&mut self, time_ns: u64) -> Result<(), Error> {
        let scene = self.trail.scene(time_ns);
        self.file.message(Topic::Trail, time_ns, &scene)
    }

    /// Writes the percept at the last decision and the estimated pose.
    fn show_percept(&mut self, time_ns: u64) -> Result<(), Error> {
        let radius_m = self.scenery.robot.radius_m;
        let known = self.pose.and_then(|pose| pose.estimate);
        let estimate = known.map(|known| estimate::entities(&known, radius_m, time_ns));
        let estimate = estimate.into_iter().flatten().collect();
        let scene = percept::scene(self.perceived_cells.clone(), estimate);
        self.file.message(Topic::Percept, time_ns, &scene)
    }

    /// Writes the learned policy where it differs from the last written one.
    fn show_learned(&mut self, time_ns: u64) -> Result<(), Error> {
        let last = self.shown.replace(self.learned.clone());
        if last.as_ref() == Some(&self.learned) {
            return Ok(());
        }
        let (maze, learned) = (&self.scenery.maze, &self.learned);
        let values = values::grid(learned, maze, time_ns);
        self.file.message(Topic::Values, time_ns, &values)?;
        if last.is_some_and(|last| policy::marks(&last) == policy::marks(learned)) {
            Ok(())
        } else {
            let scene = policy::scene(learned, maze, time_ns);
            self.file.message(Topic::Policy, time_ns, &scene)
        }
    }
}
