//! The messages of a step: the reasons of the decision, the trajectory, and the learned changes.

use foxglove::messages::LaserScan;

use super::EventLogger;
use crate::arena::{self, View};
use crate::episode::{PolicyMap, Step};
use crate::error::Error;
use crate::record::event::{Contact, Decision, Learned, Localisation, Outcome, Pose};
use crate::record::topics::{
    Topic, estimate, log, odometry, percept, policy, rule, scan, transforms,
};
use crate::record::write::outbox::{For, Outbox};

/// An event of a move.
enum Event<'a> {
    Pose(&'a Pose),
    Scan(LaserScan),
    /// A hit, with its number in the step.
    Hit(usize, &'a arena::Contact),
}

impl EventLogger {
    /// Logs a step.
    pub fn stepped(&mut self, out: &mut Outbox, step: &Step<'_>) -> Result<(), Error> {
        let end_ns = step.view.now().time_ns;
        let decision = Decision::of(step, self.sensor, self.goal);
        out.send_json(For::Episode, Topic::Rule, self.decided_ns, &decision)?;
        let over_robot = rule::scene(&decision, step.view.maze, self.decided_ns);
        out.send(For::Episode, Topic::RuleText, self.decided_ns, &over_robot)?;
        let (maze, at_ns) = (step.view.maze, self.decided_ns);
        self.perceived_cells = percept::perceived_cells(self.sensor, maze, &decision, at_ns);
        self.show_percept(out, at_ns)?;
        self.moved(out, step)?;
        out.send_json(For::Both, Topic::Step, end_ns, &Outcome::of(step))?;
        self.show_estimate(out, step.episode, step.step, &step.view)?;
        if step.view.contacts.is_empty() {
            self.warn(out, step, end_ns)?;
        } else {
            let clear = Contact::clear(step.episode, step.step);
            out.send_json(For::Episode, Topic::Contact, end_ns, &clear)?;
        }
        step.view
            .contacts
            .iter()
            .for_each(|hit| self.trail.hit(step.view.maze, hit));
        self.trail
            .step(&step.view, self.trajectory.poses(), step.explored);
        if self.trail.is_due() {
            self.show_trail(out, For::Episode, end_ns)?;
        }
        self.decided_ns = end_ns;
        self.learned_a_step(out, step, end_ns)
    }

    /// Logs the learned changes of a step if its episode is recorded. In large mazes this is done at
    /// intervals, because every cell must be queried.
    fn learned_a_step(
        &mut self,
        out: &mut Outbox,
        step: &Step<'_>,
        time_ns: u64,
    ) -> Result<(), Error> {
        let is_recorded = out.episode.is_some();
        let Some(interval) = self.query_interval.filter(|_| is_recorded) else {
            return Ok(());
        };
        if !step.step.is_multiple_of(interval) {
            return Ok(());
        }
        let maze = step.view.maze;
        let policy = PolicyMap::of(step.method, self.sensor, maze);
        self.learned = Learned::of(&policy, maze);
        let shown = self.shown.episode.learned.as_ref().map(policy::marks);
        match shown == Some(policy::marks(&self.learned)) {
            true => Ok(()),
            false => self.show_learned(out, For::Episode, maze, time_ns),
        }
    }

    /// Logs the trajectory of a step: poses, scans and hits, in order of time.
    fn moved(&mut self, out: &mut Outbox, step: &Step<'_>) -> Result<(), Error> {
        self.trajectory.follow(&self.odometry.follow(&step.view));
        // The first pose is the last one of the move before.
        let poses = self.trajectory.poses().iter().skip(1);
        let poses = poses.map(|pose| (pose.time_ns, Event::Pose(pose)));
        let scans = self.scans(&step.view, false).into_iter();
        let scans = scans.map(|(time_ns, scan)| (time_ns, Event::Scan(scan)));
        let hits = step.view.contacts.iter().enumerate();
        let hits = hits.map(|(number, hit)| (hit.time_ns, Event::Hit(number, hit)));
        let mut events: Vec<_> = poses.chain(scans).chain(hits).collect();
        // Stable: at the same time, poses come before scans, and scans before hits.
        events.sort_by_key(|(time_ns, _)| *time_ns);
        for (time_ns, event) in events {
            match event {
                Event::Pose(pose) => send_pose(out, pose)?,
                Event::Scan(scan) => out.send(For::Episode, Topic::Scan, time_ns, &scan)?,
                Event::Hit(number, hit) => self.hit(out, step, number, hit)?,
            }
        }
        Ok(())
    }

    /// Returns the scans of a move, if beams are recorded.
    pub(super) fn scans(&self, view: &View<'_>, is_begin: bool) -> Vec<(u64, LaserScan)> {
        match self.beams {
            true => scan::scans(view, is_begin),
            false => Vec::new(),
        }
    }

    /// Logs hit `number` of a step, from 0; only the first one causes a warning.
    fn hit(
        &self,
        out: &mut Outbox,
        step: &Step<'_>,
        number: usize,
        hit: &arena::Contact,
    ) -> Result<(), Error> {
        let record = Contact::hit(step.episode, step.step, hit);
        out.send_json(For::Episode, Topic::Contact, hit.time_ns, &record)?;
        match number {
            0 => self.warn(out, step, hit.time_ns),
            _ => Ok(()),
        }
    }

    fn warn(&self, out: &mut Outbox, step: &Step<'_>, time_ns: u64) -> Result<(), Error> {
        match log::collision(step, time_ns) {
            Some(warning) => out.send(For::Both, Topic::Log, time_ns, &warning),
            None => Ok(()),
        }
    }

    /// Logs the estimated pose at the end of an action, if the robot estimates its pose.
    pub(super) fn show_estimate(
        &mut self,
        out: &mut Outbox,
        episode: u32,
        step: u32,
        view: &View<'_>,
    ) -> Result<(), Error> {
        let (now, sensed) = (view.now(), view.sensed.as_ref());
        let Some(sensed) = sensed else {
            return Ok(());
        };
        self.belief = estimate::entities(sensed, self.robot.radius_m, now.time_ns).into();
        match Localisation::of(episode, step, sensed, &now) {
            Some(fact) => out.send_json(For::Episode, Topic::Localisation, now.time_ns, &fact),
            None => Ok(()),
        }
    }

    /// Logs the percept at the last decision and the estimated pose.
    pub(super) fn show_percept(&self, out: &mut Outbox, time_ns: u64) -> Result<(), Error> {
        let scene = percept::scene(self.perceived_cells.clone(), &self.belief);
        out.send(For::Episode, Topic::Percept, time_ns, &scene)
    }
}

/// Logs where the robot is, and where it estimates that it is.
pub(super) fn send_pose(out: &mut Outbox, pose: &Pose) -> Result<(), Error> {
    let time_ns = pose.time_ns;
    let frames = transforms::moving(pose);
    out.send(For::Episode, Topic::Transforms, time_ns, &frames)?;
    let truth = odometry::truth(pose);
    out.send(For::Episode, Topic::GroundTruth, time_ns, &truth)?;
    if let Some(estimate) = &pose.estimate {
        let estimate = odometry::estimate(time_ns, estimate);
        out.send(For::Episode, Topic::Estimate, time_ns, &estimate)?;
    }
    Ok(())
}
