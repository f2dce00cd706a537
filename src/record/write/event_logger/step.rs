//! What a step shows: why it was decided, the way that it took, and what was learned by it.

use std::iter::{Enumerate, Peekable};

use foxglove::messages::LaserScan;

use super::EventLogger;
use crate::arena::{Contact, Estimate, View};
use crate::episode::{PolicyMap, Step};
use crate::record::error::RecordError;
use crate::record::topics::contact::ContactRecord;
use crate::record::topics::estimate::{self, EstimateRecord};
use crate::record::topics::rule::RuleRecord;
use crate::record::topics::step::StepRecord;
use crate::record::topics::{Topic, log, percept, policy, rays, scan};
use crate::record::write::outbox::{For, Outbox};

/// What happened during a move and was not written yet, oldest first.
struct Pending<'a> {
    hits: Peekable<Enumerate<std::slice::Iter<'a, Contact>>>,
    scans: Peekable<std::vec::IntoIter<(u64, LaserScan)>>,
}

impl EventLogger {
    /// A step was taken.
    pub fn stepped(&mut self, out: &mut Outbox, step: &Step<'_>) -> Result<(), RecordError> {
        let end_ns = step.view.now().time_ns;
        let rule = RuleRecord::new(step, self.sensor, self.goal);
        out.send_json(For::Episode, Topic::Rule, self.decided_ns, &rule)?;
        let over_robot = rule.scene(step.view.maze, self.decided_ns);
        out.send(For::Episode, Topic::RuleText, self.decided_ns, &over_robot)?;
        let (maze, at_ns) = (step.view.maze, self.decided_ns);
        self.perceived_cells =
            percept::perceived_cells(self.sensor, maze, step.cell, &step.percept, at_ns);
        self.show_percept(out, at_ns)?;
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
            .for_each(|hit| self.trail.hit(step.view.maze, hit));
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
        let marks = policy::marks(Some(&policy), maze);
        self.policy = Some(policy);
        match self.shown.marks == Some(marks) {
            true => Ok(()),
            false => self.show_learned(out, For::Episode, maze, time_ns),
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
    pub(super) fn scans(&self, view: &View<'_>, is_begin: bool) -> Vec<(u64, LaserScan)> {
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

    /// What a robot that senses believes at the end of an action.
    pub(super) fn show_estimate(
        &mut self,
        out: &mut Outbox,
        episode: u32,
        step: u32,
        view: &View<'_>,
    ) -> Result<(), RecordError> {
        let (now, sensed) = (view.now(), view.sensed.as_ref());
        let Some(sensed) = sensed else {
            return Ok(());
        };
        self.belief = estimate::entities(sensed, self.robot.radius_m, now.time_ns).into();
        self.belief
            .extend(self.beams.then(|| rays::rays(view)).flatten());
        match EstimateRecord::new(episode, step, sensed, &now) {
            Some(record) => out.send_json(For::Episode, Topic::Estimate, now.time_ns, &record),
            None => Ok(()),
        }
    }

    /// What the robot perceived when it decided last, and what it believes.
    pub(super) fn show_percept(&self, out: &mut Outbox, time_ns: u64) -> Result<(), RecordError> {
        let scene = percept::scene(self.perceived_cells.clone(), &self.belief);
        out.send(For::Episode, Topic::Percept, time_ns, &scene)
    }
}

/// What a robot that senses believed at a moment of what is seen.
pub(super) fn belief<'a>(view: &View<'a>, time_ns: u64) -> Option<&'a Estimate> {
    let at = view.trace.iter().position(|s| s.time_ns == time_ns)?;
    view.sensed?.estimates.get(at)
}
