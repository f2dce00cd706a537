//! Turns what an observer sees into events, in order of time.

use super::odometry::Odometry;
use super::trajectory::Trajectory;
use crate::event::{
    Begin, Contact, Curve, Decision, End, Event, Learned, Localisation, Outlook, StepOutcome,
};
use crate::info::RunInfo;
use crate::topics::{log, policy, scan};
use xcs::PredictionArray;
use xcscr_learner::agent::Agent;
use xcscr_learner::episode::{self, Episode, PolicyMap, Step};
use xcscr_learner::trial::{Judge, steps_to_goal};
use xcscr_robot::arena::View;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze};

/// The average number of cells per step whose action values are queried.
const CELLS_A_STEP: u32 = 64;

/// An event with its time in nanoseconds.
pub(super) type Timed = (u64, Event);

/// What is known of the run so far.
pub(super) struct EventSource {
    sensor: Sensor,
    /// The reward for reaching a goal.
    goal: f64,
    odometry: Odometry,
    trajectory: Trajectory,
    curve: Curve,
    judge: Judge,
    start: Option<Cell>,
    learned: Learned,
    was_optimal: bool,
    /// The time of the last decision, which is the end of the last move.
    decided_ns: u64,
    /// The number of steps between two queries of all cells; `None` in a very large maze.
    query_interval: Option<u32>,
    /// True if lidar beams are recorded.
    beams: bool,
}

impl EventSource {
    /// Knows nothing yet. `beams` adds the measurements of the lidar.
    pub fn new(maze: &Maze, info: &RunInfo, beams: bool) -> Self {
        let cells = maze.free_cells().count() as u32;
        Self {
            sensor: info.sensor,
            goal: info.goal,
            odometry: Odometry::new(info.wheel_base_m()),
            trajectory: Trajectory::new(maze.cell_size_m()),
            curve: Curve::default(),
            judge: Judge::new(maze, info.sensor, info.slip),
            start: None,
            learned: Learned::default(),
            was_optimal: false,
            decided_ns: 0,
            query_interval: (!maze.is_too_large()).then(|| cells.div_ceil(CELLS_A_STEP).max(1)),
            beams,
        }
    }

    /// Starts with a policy that was learned elsewhere.
    pub fn warm_start(&mut self, method: &dyn Agent, maze: &Maze) {
        self.learned = Learned::of(&PolicyMap::of(method, self.sensor, maze), maze);
        self.was_optimal = self.judge.is_optimal(method, maze);
    }

    /// Returns the start of an episode, with everything that a viewer needs for its first picture.
    pub fn began(&mut self, episode: u32, view: &View<'_>) -> Vec<Timed> {
        let time_ns = view.now().time_ns;
        self.decided_ns = time_ns;
        self.start = Some(view.cell);
        self.odometry.restart();
        let mut events = Vec::new();
        if let Some(pose) = self.odometry.follow(view).pop() {
            self.trajectory.restart(pose);
            events.push(Event::Pose(pose));
        }
        let begin = Begin {
            episode,
            optimal: self.was_optimal,
        };
        events.extend(localisation(episode, 0, view));
        events.extend([
            Event::Begin(begin),
            Event::Learned(self.learned.clone()),
            Event::Curve(self.curve.clone()),
            Event::Contact(Contact::clear(episode, 0)),
            Event::Log(log::began(episode, time_ns)),
        ]);
        let scans = self.scans(view, true);
        at(time_ns, events).chain(scans).collect()
    }

    /// Returns the events of a step. `queries` tells whether a change of the policy is wanted.
    pub fn stepped(&mut self, step: &Step<'_>, queries: bool) -> Vec<Timed> {
        let end_ns = step.view.now().time_ns;
        let decision = Decision::of(step, self.sensor, self.goal);
        let mut events = vec![(self.decided_ns, Event::Decision(decision))];
        events.extend(self.moved(step));
        let mut ends = vec![Event::Outcome(StepOutcome::of(step))];
        ends.extend(localisation(step.episode, step.step, &step.view));
        if step.view.contacts.is_empty() {
            ends.extend(log::collision(step, end_ns).map(Event::Log));
        } else {
            ends.push(Event::Contact(Contact::clear(step.episode, step.step)));
        }
        if queries {
            ends.extend(self.learned_a_step(step));
        }
        events.extend(at(end_ns, ends));
        self.decided_ns = end_ns;
        events
    }

    /// Returns the end of an episode, after learning.
    pub fn ended(&mut self, episode: &Episode, after: &episode::AfterEpisode<'_>) -> Vec<Timed> {
        let maze = after.view.maze;
        let time_ns = after.view.now().time_ns;
        let policy = PolicyMap::of(after.method, after.sensor, maze);
        let outlook = self.outlook(&policy, after);
        self.learned = Learned::of(&policy, maze);
        let end = End::of(episode, &after.method.knowledge(), &outlook);
        self.curve.push(&end);
        let mut events = vec![
            Event::Learned(self.learned.clone()),
            Event::Curve(self.curve.clone()),
            // The state is unchanged, but viewers draw it only up to its last message.
            Event::Contact(Contact::clear(episode.episode, episode.steps)),
            Event::End(end),
            Event::Log(log::ended(episode, time_ns)),
        ];
        if std::mem::replace(&mut self.was_optimal, outlook.optimal) != outlook.optimal {
            events.push(Event::Log(log::optimal(outlook.optimal, time_ns)));
        }
        at(time_ns, events).collect()
    }

    /// Evaluates the policy.
    fn outlook(&mut self, policy: &PolicyMap, after: &episode::AfterEpisode<'_>) -> Outlook {
        let episode::AfterEpisode { method, view, .. } = *after;
        let (maze, judge) = (view.maze, &mut self.judge);
        let values = self.start.and_then(|cell| policy.values(cell).copied());
        let path = |cell| policy.greedy_path(maze, cell);
        Outlook {
            start_values: values.unwrap_or_else(|| PredictionArray::new(0)),
            greedy_steps: self
                .start
                .map(path)
                .and_then(|path| steps_to_goal(&path, maze)),
            shortest: self
                .start
                .and_then(|cell| judge.paths().distance(maze, cell)),
            optimal: judge.is_optimal(method, maze),
        }
    }

    /// Returns the policy after a step if its best actions changed. In large mazes this is done at
    /// intervals, because every cell must be queried.
    fn learned_a_step(&mut self, step: &Step<'_>) -> Option<Event> {
        let interval = self.query_interval?;
        if !step.step.is_multiple_of(interval) {
            return None;
        }
        let maze = step.view.maze;
        let learned = Learned::of(&PolicyMap::of(step.method, self.sensor, maze), maze);
        let is_new = policy::marks(&learned) != policy::marks(&self.learned);
        self.learned = learned;
        is_new.then(|| Event::Learned(self.learned.clone()))
    }

    /// Returns the events of a move: poses, scans and hits, in order of time.
    fn moved(&mut self, step: &Step<'_>) -> Vec<Timed> {
        self.trajectory.follow(&self.odometry.follow(&step.view));
        // The first pose is the last one of the move before.
        let poses = self.trajectory.poses().iter().skip(1);
        let poses = poses.map(|pose| (pose.time_ns, Event::Pose(*pose)));
        let mut events: Vec<Timed> = poses.collect();
        events.extend(self.scans(&step.view, false));
        for (number, hit) in step.view.contacts.iter().enumerate() {
            let contact = Contact::hit(step.episode, step.step, hit);
            events.push((hit.time_ns, Event::Contact(contact)));
            // Only the first hit causes a warning.
            let warning = log::collision(step, hit.time_ns).filter(|_| number == 0);
            events.extend(warning.map(|warning| (hit.time_ns, Event::Log(warning))));
        }
        // Stable: at the same time, poses come before scans, and scans before hits.
        events.sort_by_key(|(time_ns, _)| *time_ns);
        events
    }

    /// Returns the scans of a move, if beams are recorded.
    fn scans(&self, view: &View<'_>, is_begin: bool) -> Vec<Timed> {
        let scans = if self.beams {
            scan::scans(view, is_begin)
        } else {
            Vec::new()
        };
        let scans = scans.into_iter();
        scans
            .map(|(time_ns, scan)| (time_ns, Event::Scan(scan)))
            .collect()
    }
}

/// Returns events at a time.
fn at(time_ns: u64, events: Vec<Event>) -> impl Iterator<Item = Timed> {
    events.into_iter().map(move |event| (time_ns, event))
}

/// Returns the error of the estimated pose at the end of an action, if the robot estimates its pose.
fn localisation(episode: u32, step: u32, view: &View<'_>) -> Option<Event> {
    let sensed = view.sensed.as_ref()?;
    Localisation::of(episode, step, sensed, &view.now()).map(Event::Localisation)
}
