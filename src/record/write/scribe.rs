//! Who writes down what is seen: turns events into messages, in the order of time.

use std::iter::{Enumerate, Peekable};

use foxglove::messages::{LaserScan, TriangleListPrimitive};

use super::outbox::{For, Outbox};
use super::way::Way;
use crate::agent::Agent;
use crate::arena::{Contact, Estimate, View};
use crate::episode::{Episode, FaultFinder, Learned, PolicyMap, Step};
use crate::record::error::RecordError;
use crate::record::info::{RobotShape, RunInfo};
use crate::record::topics::caption::Caption;
use crate::record::topics::contact::ContactRecord;
use crate::record::topics::curve::Curve;
use crate::record::topics::episode::{Ended, EpisodeRecord, Outlook, Population, Running};
use crate::record::topics::estimate::{self, EstimateRecord};
use crate::record::topics::rule::RuleRecord;
use crate::record::topics::step::StepRecord;
use crate::record::topics::trail::Trail;
use crate::record::topics::transforms::Transforms;
use crate::record::topics::{Topic, log, maze, percept, policy, robot, scan, worth};
use crate::sensor::Sensor;
use crate::world::{Cell, Maze, Paths};
use xcs::PredictionArray;

/// What was learned is asked of so many cells in a step, on average.
const CELLS_A_STEP: u32 = 64;

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
    /// The arrows that were shown last.
    painted: Vec<TriangleListPrimitive>,
    was_optimal: bool,
    /// When the robot could decide last: at the end of the last move.
    decided_ns: u64,
    way: Way,
    maze_shown: bool,
    /// After every how many steps all cells are asked what was learned; never in a vast maze.
    asks_every: Option<u32>,
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
            painted: Vec::new(),
            was_optimal: false,
            decided_ns: 0,
            way: Way::new(maze.cell_size_m()),
            maze_shown: false,
            asks_every: (!maze.is_vast()).then(|| {
                (maze.free_cells().count() as u32)
                    .div_ceil(CELLS_A_STEP)
                    .max(1)
            }),
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
        self.way.restart(now);
        let frames = self.transforms.along(&[now], belief(view, time_ns));
        out.send(For::Episode, Topic::Transforms, time_ns, frames)?;
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
        self.show_landscape(out, For::Episode, view.maze, time_ns)?;
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
        let (maze, at_ns) = (step.view.maze, self.decided_ns);
        let halo = percept::scene(self.sensor, maze, step.cell, &step.percept, at_ns);
        out.send(For::Episode, Topic::Percept, at_ns, &halo)?;
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
        self.trail.step(&step.view, self.way.poses(), step.explored);
        if self.trail.is_due() {
            self.show_trail(out, For::Episode, end_ns)?;
        }
        self.decided_ns = end_ns;
        self.learned_a_step(out, step, end_ns)
    }

    /// What was learned by a step, if it can be seen; in large mazes only now and then, because
    /// every cell has to be asked.
    fn learned_a_step(
        &mut self,
        out: &mut Outbox,
        step: &Step<'_>,
        time_ns: u64,
    ) -> Result<(), RecordError> {
        let is_heard = out.episode.is_some() || out.tap.is_some();
        let Some(rarely) = self.asks_every.filter(|_| is_heard) else {
            return Ok(());
        };
        if !step.step.is_multiple_of(rarely) {
            return Ok(());
        }
        let maze = step.view.maze;
        let policy = PolicyMap::of(step.method, self.sensor, maze);
        let painted = policy::painted(&policy, maze);
        self.policy = Some(policy);
        match painted == self.painted {
            true => Ok(()),
            false => self.show_policy(out, For::Episode, maze, time_ns),
        }
    }

    /// The way of a step: poses, hits and scans, in the order of time.
    fn moved(&mut self, out: &mut Outbox, step: &Step<'_>) -> Result<(), RecordError> {
        self.way.follow(step.view.trace);
        let mut pending = Pending {
            hits: step.view.contacts.iter().enumerate().peekable(),
            scans: self.scans(&step.view, false).into_iter().peekable(),
        };
        for stretch in self.way.stretches() {
            self.show_before(stretch[0].time_ns, &mut pending, out, step)?;
            let frames = self
                .transforms
                .along(stretch, belief(&step.view, stretch[0].time_ns));
            out.send(For::Episode, Topic::Transforms, stretch[0].time_ns, frames)?;
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
        self.show_landscape(out, For::Run, maze, time_ns)?;
        self.show_trail(out, For::Both, time_ns)?;
        out.send_json(For::Episode, Topic::Curve, time_ns, &self.curve)?;
        // Nothing new, but viewers draw a state only up to its last message.
        let clear = ContactRecord::clear(episode.episode, episode.steps);
        out.send_json(For::Episode, Topic::Contact, time_ns, &clear)?;
        let population = Population::of(&learned.method.knowledge());
        let record = EpisodeRecord::new(episode, population, outlook);
        out.send_json(For::Both, Topic::Episode, time_ns, &record)?;
        let ended = Ended::new(episode);
        out.send_json(For::Run, Topic::Ended, time_ns, &ended)?;
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
        let worth = self.start.and_then(|cell| policy.worth(cell).copied());
        Outlook {
            start_worth: worth.unwrap_or_else(|| PredictionArray::new(0)),
            optimal: fault.is_none(),
            greedy_steps: self.start.and_then(|cell| policy.greedy_steps(maze, cell)),
            shortest: self.start.and_then(|cell| self.paths.distance(maze, cell)),
        }
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

    fn show_landscape(
        &self,
        out: &mut Outbox,
        to: For,
        maze: &Maze,
        time_ns: u64,
    ) -> Result<(), RecordError> {
        let columns = policy::landscape(self.policy.as_ref(), maze, time_ns);
        out.send(to, Topic::Landscape, time_ns, &columns)
    }

    fn show_policy(
        &mut self,
        out: &mut Outbox,
        to: For,
        maze: &Maze,
        time_ns: u64,
    ) -> Result<(), RecordError> {
        let (painted, heat) = match &self.policy {
            Some(known) => (
                policy::painted(known, maze),
                worth::grid(known, maze, time_ns),
            ),
            None => (Vec::new(), worth::empty(maze, time_ns)),
        };
        let arrows = policy::scene(&painted, time_ns);
        self.painted = painted;
        out.send(to, Topic::Policy, time_ns, &arrows)?;
        out.send(to, Topic::Worth, time_ns, &heat)
    }
}

/// What a robot that senses believed at a moment of what is seen.
fn belief<'a>(view: &View<'a>, time_ns: u64) -> Option<&'a Estimate> {
    let at = view.trace.iter().position(|s| s.time_ns == time_ns)?;
    view.sensed?.estimates.get(at)
}
