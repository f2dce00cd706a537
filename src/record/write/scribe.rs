//! Who writes down what is seen: turns events into messages, in the order of time.

use std::iter::{Enumerate, Peekable};

use foxglove::messages::LaserScan;

use super::outbox::{For, Outbox};
use crate::agent::Agent;
use crate::arena::{Contact, Sample, View};
use crate::episode::{Episode, FaultFinder, Learned, PolicyMap, Step};
use crate::record::error::RecordError;
use crate::record::info::{RobotShape, RunInfo};
use crate::record::topics::caption::Caption;
use crate::record::topics::contact::ContactRecord;
use crate::record::topics::curve::Curve;
use crate::record::topics::episode::{EpisodeRecord, Outlook, Running};
use crate::record::topics::estimate::{self, EstimateRecord};
use crate::record::topics::rule::RuleRecord;
use crate::record::topics::step::StepRecord;
use crate::record::topics::trail::Trail;
use crate::record::topics::transforms::Transforms;
use crate::record::topics::{Topic, log, maze, policy, robot, scan, worth};
use crate::sensor::Sensor;
use crate::world::{Cell, Maze, Paths};

/// Poses are written at most every 50 ms, and where a move ends.
const POSE_PERIOD_NS: u64 = 50_000_000;
/// A message on `/tf` shows where the robot is and so many poses after that.
const POSES_AHEAD: usize = 10;

/// Keeps what messages need beyond the event that they report.
pub(super) struct Scribe {
    robot: RobotShape,
    sensor: Sensor,
    heading: String,
    /// What an episode is called, and how many there are.
    episodes: (&'static str, u32),
    transforms: Transforms,
    trail: Trail,
    curve: Curve,
    paths: Paths,
    faults: FaultFinder,
    start: Option<Cell>,
    /// What was learned up to the last episode.
    policy: Option<PolicyMap>,
    was_optimal: bool,
    /// When the robot could decide last: at the end of the last move.
    decided_ns: u64,
    /// The poses of the last move that are written; at first where the episode began.
    way: Vec<Sample>,
    maze_shown: bool,
    /// Are the beams of the lidar written?
    beams: bool,
}

/// What happened during a move and was not written yet, oldest first.
struct Pending<'a> {
    hits: Peekable<Enumerate<std::slice::Iter<'a, Contact>>>,
    scans: Peekable<std::vec::IntoIter<(u64, LaserScan)>>,
}

impl Scribe {
    pub fn new(maze: &Maze, info: &RunInfo, beams: bool) -> Self {
        Self {
            robot: info.robot,
            sensor: info.sensor,
            heading: info.heading(maze.name()),
            episodes: match info.is_evaluation {
                true => ("Greedy drive", info.episodes),
                false => ("Episode", info.episodes),
            },
            transforms: Transforms::default(),
            trail: Trail::new(maze),
            curve: Curve::default(),
            paths: Paths::with_slip(maze, info.slip()),
            faults: FaultFinder::default(),
            start: None,
            policy: None,
            was_optimal: false,
            decided_ns: 0,
            way: Vec::new(),
            maze_shown: false,
            beams,
        }
    }

    /// The learning curve so far, and whether the policy was globally optimal.
    pub fn memory(&self) -> (Curve, bool) {
        (self.curve.clone(), self.was_optimal)
    }

    /// Goes on after episodes of which this is the memory; `policy` is what they taught.
    pub fn resume(&mut self, (curve, was_optimal): (Curve, bool), policy: PolicyMap) {
        self.curve = curve.restored();
        self.was_optimal = was_optimal;
        self.policy = Some(policy);
        self.maze_shown = true;
    }

    /// Begins with what was learned elsewhere.
    pub fn know(&mut self, method: &dyn Agent, sensor: Sensor, maze: &Maze) {
        self.policy = Some(PolicyMap::of(method, sensor, maze));
        let fault = self.faults.find(method, sensor, maze, &self.paths);
        self.was_optimal = fault.is_none();
    }

    /// An episode begins: everything that a viewer needs to draw its first picture.
    pub fn began(
        &mut self,
        out: &mut Outbox,
        episode: u32,
        view: &View<'_>,
    ) -> Result<(), RecordError> {
        let now = view.now();
        let time_ns = now.time_ns;
        self.decided_ns = time_ns;
        self.start = Some(view.cell);
        self.trail.restart(view);
        self.way.clear();
        self.way.push(now);
        self.show_way(out, 0, view)?;
        self.show_estimate(out, episode, 0, view)?;
        for (sent_ns, scan) in self.scans(view, true) {
            out.send(For::Episode, Topic::Scan, sent_ns, &scan)?;
        }
        let maze = maze::scene(view.maze, time_ns);
        let shown = std::mem::replace(&mut self.maze_shown, true);
        let to = if shown { For::Episode } else { For::Both };
        out.send(to, Topic::Maze, time_ns, &maze)?;
        let robot = robot::scene(&self.robot, time_ns);
        out.send(For::Episode, Topic::Robot, time_ns, &robot)?;
        self.show_policy(out, For::Episode, view.maze, time_ns)?;
        self.show_trail(out, For::Episode, time_ns)?;
        out.send_json(For::Episode, Topic::Curve, time_ns, &self.curve)?;
        let clear = ContactRecord::clear(episode, 0);
        out.send_json(For::Episode, Topic::Contact, time_ns, &clear)?;
        let running = Running::new(episode, self.was_optimal);
        out.send_json(For::Both, Topic::Episode, time_ns, &running)?;
        let (name, all) = self.episodes;
        let caption = Caption {
            title: format!("{name} {episode} of {all}"),
            heading: self.heading.clone(),
            ..Caption::default()
        };
        let caption = caption.scene(view.maze, time_ns);
        out.send(For::Both, Topic::Caption, time_ns, &caption)?;
        let begins = log::began(episode, time_ns);
        out.send(For::Both, Topic::Log, time_ns, &begins)
    }

    /// A step was taken.
    pub fn stepped(&mut self, out: &mut Outbox, step: &Step<'_>) -> Result<(), RecordError> {
        let end_ns = step.view.now().time_ns;
        let rule = RuleRecord::new(step, self.sensor);
        out.send_json(For::Episode, Topic::Rule, self.decided_ns, &rule)?;
        let over_robot = rule.scene(step.view.maze, self.decided_ns);
        out.send(For::Episode, Topic::RuleText, self.decided_ns, &over_robot)?;
        self.moved(out, step)?;
        let record = StepRecord::new(step);
        out.send_json(For::Both, Topic::Step, end_ns, &record)?;
        self.show_estimate(out, step.episode, step.step, &step.view)?;
        if step.view.contacts.is_empty() {
            self.warn(out, step, end_ns)?;
        } else {
            let clear = ContactRecord::clear(step.episode, step.step);
            out.send_json(For::Episode, Topic::Contact, end_ns, &clear)?;
        }
        step.view
            .contacts
            .iter()
            .for_each(|hit| self.trail.hit(hit));
        self.trail.step(&step.view);
        if self.trail.is_due() {
            self.show_trail(out, For::Episode, end_ns)?;
        }
        self.decided_ns = end_ns;
        Ok(())
    }

    /// The way of a step: poses, hits and scans, in the order of time.
    fn moved(&mut self, out: &mut Outbox, step: &Step<'_>) -> Result<(), RecordError> {
        self.follow(step.view.trace);
        let mut pending = Pending {
            hits: step.view.contacts.iter().enumerate().peekable(),
            scans: self.scans(&step.view, false).into_iter().peekable(),
        };
        for from in (0..self.way.len().saturating_sub(1)).step_by(POSES_AHEAD) {
            let now_ns = self.way[from].time_ns;
            self.show_before(now_ns, &mut pending, out, step)?;
            self.show_way(out, from, &step.view)?;
        }
        self.show_before(u64::MAX, &mut pending, out, step)
    }

    /// Hits and scans before a moment, in the order of time.
    fn show_before(
        &self,
        until_ns: u64,
        pending: &mut Pending<'_>,
        out: &mut Outbox,
        step: &Step<'_>,
    ) -> Result<(), RecordError> {
        loop {
            let hit_ns = pending.hits.peek().map(|(_, hit)| hit.time_ns);
            let is_due = |(at_ns, _): &(u64, _)| {
                *at_ns < until_ns && hit_ns.is_none_or(|hit_ns| *at_ns <= hit_ns)
            };
            if let Some((sent_ns, scan)) = pending.scans.next_if(is_due) {
                out.send(For::Episode, Topic::Scan, sent_ns, &scan)?;
                continue;
            }
            let is_past = |(_, hit): &(usize, &Contact)| hit.time_ns < until_ns;
            match pending.hits.next_if(is_past) {
                Some((number, hit)) => self.hit(out, step, number, hit)?,
                None => return Ok(()),
            }
        }
    }

    /// The scans of a move, if beams are recorded.
    fn scans(&self, view: &View<'_>, is_begin: bool) -> Vec<(u64, LaserScan)> {
        match self.beams {
            true => scan::scans(view, is_begin),
            false => Vec::new(),
        }
    }

    /// Keeps the poses of a move that are to be written; it begins where the last one ended.
    fn follow(&mut self, trace: &[Sample]) {
        self.way.drain(..self.way.len().saturating_sub(1));
        let end_ns = trace.last().map(|sample| sample.time_ns);
        for sample in trace {
            let ahead_ns = match self.way.last() {
                Some(before) => sample.time_ns.saturating_sub(before.time_ns),
                None => POSE_PERIOD_NS,
            };
            if ahead_ns >= POSE_PERIOD_NS || ahead_ns > 0 && Some(sample.time_ns) == end_ns {
                self.way.push(*sample);
            }
        }
    }

    /// Hit `number` of a step, from 0; only the first is worth a warning.
    fn hit(
        &self,
        out: &mut Outbox,
        step: &Step<'_>,
        number: usize,
        hit: &Contact,
    ) -> Result<(), RecordError> {
        let record = ContactRecord::hit(step.episode, step.step, hit);
        out.send_json(For::Episode, Topic::Contact, hit.time_ns, &record)?;
        match number {
            0 => self.warn(out, step, hit.time_ns),
            _ => Ok(()),
        }
    }

    fn warn(&self, out: &mut Outbox, step: &Step<'_>, time_ns: u64) -> Result<(), RecordError> {
        match log::collision(step, time_ns) {
            Some(warning) => out.send(For::Both, Topic::Log, time_ns, &warning),
            None => Ok(()),
        }
    }

    /// An episode is over and learned.
    pub fn ended(
        &mut self,
        out: &mut Outbox,
        episode: &Episode,
        learned: &Learned<'_>,
    ) -> Result<(), RecordError> {
        let maze = learned.view.maze;
        let time_ns = learned.view.now().time_ns;
        let policy = PolicyMap::of(learned.method, learned.sensor, maze);
        let outlook = self.outlook(&policy, learned);
        self.policy = Some(policy);
        self.curve.push(episode);
        self.show_policy(out, For::Both, maze, time_ns)?;
        self.show_trail(out, For::Both, time_ns)?;
        out.send_json(For::Episode, Topic::Curve, time_ns, &self.curve)?;
        // Nothing new, but viewers draw a state only up to its last message.
        let clear = ContactRecord::clear(episode.episode, episode.steps);
        out.send_json(For::Episode, Topic::Contact, time_ns, &clear)?;
        let record = EpisodeRecord::new(episode, outlook);
        out.send_json(For::Both, Topic::Episode, time_ns, &record)?;
        let said = log::ended(episode, time_ns);
        out.send(For::Both, Topic::Log, time_ns, &said)?;
        if std::mem::replace(&mut self.was_optimal, outlook.optimal) != outlook.optimal {
            let said = log::optimal(outlook.optimal, time_ns);
            out.send(For::Both, Topic::Log, time_ns, &said)?;
        }
        Ok(())
    }

    /// What the policy is good for.
    fn outlook(&mut self, policy: &PolicyMap, learned: &Learned<'_>) -> Outlook {
        let Learned {
            method,
            sensor,
            view,
        } = *learned;
        let maze = view.maze;
        let fault = self.faults.find(method, sensor, maze, &self.paths);
        Outlook {
            optimal: fault.is_none(),
            greedy_steps: self.start.and_then(|cell| policy.greedy_steps(maze, cell)),
            shortest: self.start.and_then(|cell| self.paths.distance(maze, cell)),
        }
    }

    /// Where the robot is at pose `from` of its way, and what comes next.
    fn show_way(
        &mut self,
        out: &mut Outbox,
        from: usize,
        view: &View<'_>,
    ) -> Result<(), RecordError> {
        let end = self.way.len().min(from + POSES_AHEAD + 1);
        let time_ns = self.way[from].time_ns;
        let belief = view.sensed.and_then(|sensed| {
            let at = view.trace.iter().position(|s| s.time_ns == time_ns)?;
            sensed.estimates.get(at)
        });
        let frames = self.transforms.along(&self.way[from..end], belief);
        out.send(For::Episode, Topic::Transforms, time_ns, frames)
    }

    /// What a robot that senses believes at the end of an action.
    fn show_estimate(
        &self,
        out: &mut Outbox,
        episode: u32,
        step: u32,
        view: &View<'_>,
    ) -> Result<(), RecordError> {
        let (now, sensed) = (view.now(), view.sensed.as_ref());
        let Some(sensed) = sensed else {
            return Ok(());
        };
        if let Some(record) = EstimateRecord::new(episode, step, sensed, &now) {
            out.send_json(For::Episode, Topic::Estimate, now.time_ns, &record)?;
        }
        let scene = estimate::scene(sensed, self.robot.radius_m, now.time_ns);
        out.send(For::Episode, Topic::Ghost, now.time_ns, &scene)
    }

    fn show_trail(&self, out: &mut Outbox, to: For, time_ns: u64) -> Result<(), RecordError> {
        out.send(to, Topic::Trail, time_ns, &self.trail.scene(time_ns))
    }

    fn show_policy(
        &self,
        out: &mut Outbox,
        to: For,
        maze: &Maze,
        time_ns: u64,
    ) -> Result<(), RecordError> {
        let (arrows, heat) = match &self.policy {
            Some(known) => (
                policy::scene(known, maze, time_ns),
                worth::grid(known, maze, time_ns),
            ),
            None => (policy::empty(time_ns), worth::empty(maze, time_ns)),
        };
        out.send(to, Topic::Policy, time_ns, &arrows)?;
        out.send(to, Topic::Worth, time_ns, &heat)
    }
}
