//! Converts episode events into log messages, in order of time.

mod step;

use foxglove::messages::SceneEntity;

use super::odometry::Odometry;
use super::outbox::{For, Outbox};
use super::trajectory::Trajectory;
use crate::agent::Agent;
use crate::arena::View;
use crate::episode::{self, Episode, PolicyMap};
use crate::error::Error;
use crate::record::event::{Begin, Contact, Curve, End, Learned, Outlook};
use crate::record::info::{RobotShape, RunInfo, RunKind};
use crate::record::topics::caption::Caption;
use crate::record::topics::trail::Trail;
use crate::record::topics::{Topic, log, maze, policy, robot, transforms, values};
use crate::sensor::Sensor;
use crate::trial::{Judge, steps_to_goal};
use crate::world::{Cell, Maze};
use step::send_pose;
use xcs::PredictionArray;

/// The average number of cells per step whose action values are queried.
const CELLS_A_STEP: u32 = 64;

/// The state that messages need beyond the event they report.
pub(super) struct EventLogger {
    robot: RobotShape,
    sensor: Sensor,
    /// The reward for reaching a goal.
    goal: f64,
    heading: String,
    /// The word for an episode, and the number of episodes if it is known.
    episodes: (&'static str, Option<u32>),
    odometry: Odometry,
    trail: Trail,
    curve: Curve,
    judge: Judge,
    start: Option<Cell>,
    /// The learned policy so far.
    learned: Learned,
    shown: ShownIn,
    was_optimal: bool,
    /// The time of the last decision, which is the end of the last move.
    decided_ns: u64,
    trajectory: Trajectory,
    /// The percept at the last decision, and the estimated pose if the robot estimates its pose.
    perceived_cells: SceneEntity,
    belief: Vec<SceneEntity>,
    maze_shown: bool,
    /// The number of steps between two queries of all cells; `None` in a very large maze.
    query_interval: Option<u32>,
    /// True if lidar beams are written.
    beams: bool,
}

/// The learned state last shown in a file. Unchanged parts are not repeated.
#[derive(Default)]
struct Shown {
    learned: Option<Learned>,
}

/// The last shown state in the episode's file and in the run's file.
#[derive(Default)]
struct ShownIn {
    episode: Shown,
    run: Shown,
}

impl ShownIn {
    fn of(&mut self, to: For) -> &mut Shown {
        match to {
            For::Run => &mut self.run,
            For::Episode | For::Both => &mut self.episode,
        }
    }
}

impl EventLogger {
    pub fn new(maze: &Maze, info: &RunInfo, beams: bool) -> Self {
        Self {
            robot: info.robot,
            sensor: info.sensor,
            goal: info.goal,
            heading: info.heading(maze.name()),
            episodes: match info.kind {
                RunKind::Training => ("Episode", Some(info.episodes)),
                RunKind::Evaluation => ("Greedy drive", Some(info.episodes)),
                RunKind::External => ("Episode", None),
            },
            odometry: Odometry::new(info.wheel_base_m()),
            trail: Trail::new(maze),
            curve: Curve::default(),
            judge: Judge::new(maze, info.sensor, info.slip),
            start: None,
            learned: Learned::default(),
            shown: ShownIn::default(),
            was_optimal: false,
            decided_ns: 0,
            trajectory: Trajectory::new(maze.cell_size_m()),
            perceived_cells: SceneEntity::default(),
            belief: Vec::new(),
            maze_shown: false,
            query_interval: (!maze.is_too_large()).then(|| {
                (maze.free_cells().count() as u32)
                    .div_ceil(CELLS_A_STEP)
                    .max(1)
            }),
            beams,
        }
    }

    /// Starts with a policy that was learned elsewhere.
    pub fn warm_start(&mut self, method: &dyn Agent, sensor: Sensor, maze: &Maze) {
        self.learned = Learned::of(&PolicyMap::of(method, sensor, maze), maze);
        self.was_optimal = self.judge.is_optimal(method, maze);
    }

    /// Logs the start of an episode, with everything that a viewer needs for its first picture.
    pub fn began(&mut self, out: &mut Outbox, episode: u32, view: &View<'_>) -> Result<(), Error> {
        let now = view.now();
        let time_ns = now.time_ns;
        self.decided_ns = time_ns;
        self.start = Some(view.cell);
        self.trail.restart(view);
        self.odometry.restart();
        if let Some(pose) = self.odometry.follow(view).pop() {
            self.trajectory.restart(pose);
            send_pose(out, &pose)?;
        }
        self.show_estimate(out, episode, 0, view)?;
        for (sent_ns, scan) in self.scans(view, true) {
            out.send(For::Episode, Topic::Scan, sent_ns, &scan)?;
        }
        self.show_maze_and_robot(out, view, time_ns)?;
        self.shown.episode = Shown::default();
        self.show_learned(out, For::Episode, view.maze, time_ns)?;
        self.show_trail(out, For::Episode, time_ns)?;
        out.send_json(For::Episode, Topic::Curve, time_ns, &self.curve)?;
        let clear = Contact::clear(episode, 0);
        out.send_json(For::Episode, Topic::Contact, time_ns, &clear)?;
        let begin = Begin {
            episode,
            optimal: self.was_optimal,
        };
        out.send_json(For::Both, Topic::Begin, time_ns, &begin)?;
        let (name, all) = self.episodes;
        let all = all.map_or(String::new(), |all| format!(" of {all}"));
        let caption = Caption {
            title: format!("{name} {episode}{all}"),
            heading: self.heading.clone(),
        };
        let caption = caption.scene(view.maze, time_ns);
        out.send(For::Both, Topic::Caption, time_ns, &caption)?;
        let begins = log::began(episode, time_ns);
        out.send(For::Both, Topic::Log, time_ns, &begins)
    }

    /// Logs the static scene and the robot's body.
    fn show_maze_and_robot(
        &mut self,
        out: &mut Outbox,
        view: &View<'_>,
        time_ns: u64,
    ) -> Result<(), Error> {
        let shown = std::mem::replace(&mut self.maze_shown, true);
        let to = if shown { For::Episode } else { For::Both };
        let grid = transforms::fixed(view.maze, time_ns);
        out.send(to, Topic::Grid, time_ns, &grid)?;
        let maze = maze::scene(view.maze, time_ns);
        out.send(to, Topic::Maze, time_ns, &maze)?;
        let robot = robot::scene(&self.robot, time_ns);
        out.send(For::Episode, Topic::Robot, time_ns, &robot)
    }

    /// Logs the end of an episode, after learning.
    pub fn ended(
        &mut self,
        out: &mut Outbox,
        episode: &Episode,
        learned: &episode::Learned<'_>,
    ) -> Result<(), Error> {
        let maze = learned.view.maze;
        let time_ns = learned.view.now().time_ns;
        let policy = PolicyMap::of(learned.method, learned.sensor, maze);
        let outlook = self.outlook(&policy, learned);
        self.learned = Learned::of(&policy, maze);
        let end = End::of(episode, &learned.method.knowledge(), &outlook);
        self.curve.push(&end);
        self.show_learned(out, For::Episode, maze, time_ns)?;
        self.show_learned(out, For::Run, maze, time_ns)?;
        // The last step has already written the trail to the episode's file if it was due.
        let to = if self.trail.is_due() {
            For::Run
        } else {
            For::Both
        };
        self.show_trail(out, to, time_ns)?;
        if !self.belief.is_empty() {
            self.show_percept(out, time_ns)?;
        }
        out.send_json(For::Episode, Topic::Curve, time_ns, &self.curve)?;
        // The state is unchanged, but viewers draw it only up to its last message.
        let clear = Contact::clear(episode.episode, episode.steps);
        out.send_json(For::Episode, Topic::Contact, time_ns, &clear)?;
        out.send_json(For::Both, Topic::Episode, time_ns, &end)?;
        let said = log::ended(episode, time_ns);
        out.send(For::Both, Topic::Log, time_ns, &said)?;
        if std::mem::replace(&mut self.was_optimal, outlook.optimal) != outlook.optimal {
            let said = log::optimal(outlook.optimal, time_ns);
            out.send(For::Both, Topic::Log, time_ns, &said)?;
        }
        Ok(())
    }

    /// Evaluates the policy.
    fn outlook(&mut self, policy: &PolicyMap, learned: &episode::Learned<'_>) -> Outlook {
        let episode::Learned { method, view, .. } = *learned;
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

    fn show_trail(&self, out: &mut Outbox, to: For, time_ns: u64) -> Result<(), Error> {
        out.send(to, Topic::Trail, time_ns, &self.trail.scene(time_ns))
    }

    /// Logs the learned policy where it differs from the last shown one.
    fn show_learned(
        &mut self,
        out: &mut Outbox,
        to: For,
        maze: &Maze,
        time_ns: u64,
    ) -> Result<(), Error> {
        let (learned, shown) = (&self.learned, self.shown.of(to));
        let last = shown.learned.replace(learned.clone());
        if last.as_ref() == Some(learned) {
            return Ok(());
        }
        let values = values::grid(learned, maze, time_ns);
        out.send(to, Topic::Values, time_ns, &values)?;
        if last.is_none_or(|last| policy::marks(&last) != policy::marks(learned)) {
            let scene = policy::scene(learned, maze, time_ns);
            out.send(to, Topic::Policy, time_ns, &scene)?;
        }
        Ok(())
    }
}
