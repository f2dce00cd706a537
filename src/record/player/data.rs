//! The data of a page: the messages of a recording by topic, each with its time in seconds.

use std::path::PathBuf;

use foxglove::messages::{Odometry, SceneUpdate};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::chapters::Chapter;
use super::episodes::{self, PackedEpisode};
use super::shapes::Scene;
use crate::error::Error;
use crate::picture::{NO_GOAL, SCALE, css};
use crate::record::error;
use crate::record::info::{self, RunKind};
use crate::record::reader::{Message, Recording};
use crate::record::topics::percept::KINDS;
use crate::record::topics::{decimal, decoded};
use crate::record::{RobotShape, Topic};
use crate::world::{Cell, Maze};
use xcs::Action;

/// The maximum size of the messages of a page, in bytes. In memory they take up to thirty times as
/// much.
const MOST_BYTES: usize = 16 << 20;

/// A JSON message with its time as the field `t`.
pub type Timed = Map<String, Value>;

/// All data that the page shows. Lists are in order of time.
#[derive(Debug, Default, Serialize)]
pub struct Data {
    heading: String,
    /// The result of the last episode.
    result: String,
    /// The duration, in seconds.
    pub end: f64,
    world: World,
    /// The names of the actions.
    pub actions: Vec<String>,
    robot_radius_m: f64,
    /// CSS colours of best actions: far from the goal, near it, and leading to no goal.
    arrow_colours: [String; 3],
    /// CSS colours of cells perceived as free and as a wall.
    percept_colours: [String; 2],
    /// Time, x, y and heading in the map frame, in seconds, metres and radians.
    pub poses: Vec<[f64; 4]>,
    /// The same of the estimated pose.
    estimated: Vec<[f64; 4]>,
    pub estimates: Vec<Timed>,
    pub decisions: Vec<Timed>,
    pub episodes: Vec<Timed>,
    /// The entries of `episodes` at the start of an episode.
    pub begins: Vec<Timed>,
    contacts: Vec<Timed>,
    curve: Value,
    /// The word for an episode.
    noun: &'static str,
    scenes: Scenes,
    /// The most instructive of the episodes inside the page of a run.
    chapters: Vec<Chapter>,
    /// The episodes inside the page of a run.
    pub packed_episodes: Vec<PackedEpisode>,
    /// The steps, and for each step the middle of its cell as a pose.
    #[serde(skip)]
    cells: Vec<[f64; 4]>,
    #[serde(skip)]
    steps: Vec<Timed>,
    #[serde(skip)]
    from_ns: Option<u64>,
}

/// The maze as seen from above.
#[derive(Debug, Default, Serialize)]
struct World {
    width: u16,
    height: u16,
    cell_size_m: f64,
    /// The pose of the grid frame in the map frame: metres and radians.
    origin: [f64; 3],
    /// `#` wall, `S` start, `G` goal, `.` free; the northern row first.
    rows: Vec<String>,
}

#[derive(Debug, Default, Serialize)]
struct Scenes {
    values: Vec<Scene>,
    policy: Vec<Scene>,
    percept: Vec<Scene>,
}

impl World {
    fn of(maze: &Maze) -> Self {
        let origin = maze.origin();
        let sign = |at| match maze.start() == Some(at) {
            true => 'S',
            false if maze.is_goal(at) => 'G',
            false if maze.is_wall(at) => '#',
            false => '.',
        };
        let cells: Vec<char> = maze.cells().map(sign).collect();
        let rows = cells.chunks(usize::from(maze.width()));
        Self {
            width: maze.width(),
            height: maze.height(),
            cell_size_m: maze.cell_size_m(),
            origin: [origin.x_m, origin.y_m, origin.yaw_rad],
            rows: rows.map(|row| row.iter().collect()).collect(),
        }
    }
}

impl Data {
    /// Reads a recording of a run or an episode.
    pub fn of(recording: &Recording) -> Result<Self, Error> {
        let maze = world(recording)?;
        let mut data = Self::empty(&maze, heading(recording));
        data.noun = match recording.run_kind() {
            Ok(RunKind::Evaluation) => "Greedy drive",
            _ => "Episode",
        };
        let mut left = MOST_BYTES;
        for message in recording.messages() {
            let message = message?;
            left = left.checked_sub(message.data.len()).ok_or_else(|| {
                let cause = "its messages are too many for a page, open it in a viewer";
                error::unsuitable(recording.path(), cause)
            })?;
            let added = data.add(&message, &maze);
            added.map_err(|cause| recording.damaged(cause))?;
        }
        data.complete();
        Ok(data)
    }

    fn empty(maze: &Maze, heading: String) -> Self {
        Self {
            heading,
            world: World::of(maze),
            actions: Action::all(maze.action_count())
                .map(|action| maze.action_name(action))
                .collect(),
            robot_radius_m: RobotShape::for_cell(maze.cell_size_m()).radius_m,
            arrow_colours: [SCALE[0], SCALE[2], NO_GOAL].map(css),
            percept_colours: [KINDS[0], KINDS[1]].map(css),
            curve: json!({ "episode": [], "steps": [] }),
            ..Self::default()
        }
    }

    /// Returns world, method, arena, sensor and seed.
    pub fn heading(&self) -> &str {
        &self.heading
    }

    /// Returns the number of the first episode; `None` without an episode.
    pub fn first_episode(&self) -> Option<u64> {
        self.episodes.first()?.get("episode")?.as_u64()
    }

    /// Adds the episodes of a run, the learning curve of the last one, and those chapters that are
    /// among the episodes.
    pub fn set_run(&mut self, mut chapters: Vec<Chapter>, files: &[PathBuf]) -> Result<(), Error> {
        let wanted: Vec<u32> = chapters.iter().map(|chapter| chapter.episode).collect();
        self.packed_episodes = episodes::packed(files, &wanted)?;
        let packed = &self.packed_episodes;
        chapters.retain(|chapter| {
            let number = u64::from(chapter.episode);
            packed.iter().any(|one| one.episode == number)
        });
        self.chapters = chapters;
        if let Some(last) = files.last() {
            self.curve = Self::of(&Recording::open(last)?)?.curve;
        }
        Ok(())
    }

    /// Removes the learning curve, which grows with each episode of a run.
    pub fn without_curve(self) -> Self {
        let curve = Value::Null;
        Self { curve, ..self }
    }

    fn add(&mut self, message: &Message, maze: &Maze) -> Result<(), String> {
        let t = self.seconds(message.time_ns);
        self.end = self.end.max(t);
        let Some(topic) = Topic::named(message.topic()) else {
            return Ok(());
        };
        let scene = || decoded::<SceneUpdate>(&message.data);
        match topic {
            Topic::GroundTruth => self.poses.push(pose(t, &decoded(&message.data)?)),
            Topic::Estimate => self.estimated.push(pose(t, &decoded(&message.data)?)),
            Topic::Robot => self.measure(&scene()?),
            Topic::Policy => self.scenes.policy.push(Scene::of(t, &scene()?)),
            Topic::Values => self.scenes.values.push(Scene::of(t, &scene()?)),
            Topic::Percept => self.scenes.percept.push(Scene::of(t, &scene()?)),
            Topic::Rule => self.decisions.push(timed(t, message)?),
            Topic::Step => self.step(t, message, maze)?,
            Topic::Begin => {
                let begin = timed(t, message)?;
                self.begins.push(begin.clone());
                self.episodes.push(begin);
            }
            Topic::Episode => self.episodes.push(timed(t, message)?),
            Topic::Localisation => self.estimates.push(timed(t, message)?),
            Topic::Contact => self.contacts.push(timed(t, message)?),
            Topic::Curve => {
                self.curve = serde_json::from_slice(&message.data).map_err(|e| e.to_string())?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Returns the time since the first message, in seconds.
    fn seconds(&mut self, time_ns: u64) -> f64 {
        let from_ns = *self.from_ns.get_or_insert(time_ns);
        decimal(time_ns.saturating_sub(from_ns) as f64 / 1e9)
    }

    /// Sets the robot's radius to that of its widest part.
    fn measure(&mut self, robot: &SceneUpdate) {
        let parts = robot.entities.iter().flat_map(|one| &one.cylinders);
        let widths = parts.filter_map(|part| Some(part.size?.x / 2.0));
        let widest = widths.fold(0.0, f64::max);
        if widest > 0.0 {
            self.robot_radius_m = decimal(widest);
        }
    }

    /// Adds a step. In recordings of whole runs, which have no poses and reasons, steps replace
    /// both.
    fn step(&mut self, t: f64, message: &Message, maze: &Maze) -> Result<(), String> {
        let mut step = timed(t, message)?;
        let number = |key: &str| u16::try_from(step.get(key)?.as_u64()?).ok();
        if let Some((col, row)) = number("col").zip(number("row")) {
            let at = maze.centre_m(Cell { col, row });
            self.cells.push([t, at.x, at.y, 0.0].map(decimal));
        }
        // The values of a reason are shares of the goal's reward. Readers compare the values
        // themselves.
        let values = step.remove("values").unwrap_or(Value::Null);
        let number = |step: &Timed| [step.get("episode").cloned(), step.get("step").cloned()];
        let decision = self.decisions.last_mut();
        if let Some(decision) = decision.filter(|decision| number(decision) == number(&step)) {
            decision.insert("values".to_owned(), values);
        } else {
            step.insert("values".to_owned(), values);
        }
        // A step has the bits of the rule, and a reason has its text.
        step.remove("rule");
        // Converts the share of remaining steps to a percentage, as in a reason.
        if let Some(left) = step.get_mut("left") {
            *left = json!((100.0 * left.as_f64().unwrap_or(0.0)).round());
        }
        self.steps.push(step);
        Ok(())
    }

    /// Returns the learning curve from the ends of all episodes, for recordings without one.
    fn curve_of_episodes(&self) -> Value {
        let ends = self.episodes.iter();
        let ends = ends.filter_map(|end| Some((end.get("episode")?, end.get("steps")?)));
        let (episode, steps): (Vec<&Value>, Vec<&Value>) = ends.unzip();
        json!({ "episode": episode, "steps": steps })
    }

    /// Computes the fields that depend on the whole recording.
    fn complete(&mut self) {
        if self.poses.is_empty() {
            self.poses = std::mem::take(&mut self.cells);
        }
        if self.decisions.is_empty() {
            self.decisions = std::mem::take(&mut self.steps);
        }
        if self.curve["episode"] == json!([]) {
            self.curve = self.curve_of_episodes();
        }
        self.poses.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let last = self.poses.last().map_or(0.0, |pose| pose[0]);
        self.end = self.end.max(last);
        self.result = self.episodes.last().map_or_else(String::new, result);
    }
}

/// Returns the time, x, y and heading of a pose.
fn pose(t: f64, message: &Odometry) -> [f64; 4] {
    let pose = message.pose.unwrap_or_default();
    let at = pose.position.unwrap_or_default();
    let turned = pose.orientation.unwrap_or_default();
    [t, at.x, at.y, 2.0 * libm::atan2(turned.z, turned.w)].map(decimal)
}

/// Returns the world of a recording.
fn world(recording: &Recording) -> Result<Maze, Error> {
    let Some(world) = recording.attachment("world.json") else {
        return Err(recording.damaged("it has no attachment world.json".to_owned()));
    };
    Maze::from_json(world, "world.json").map_err(|fault| recording.damaged(fault.to_string()))
}

/// Returns a JSON message with its time, and without the bits of the percept.
fn timed(t: f64, message: &Message) -> Result<Timed, String> {
    let mut fields: Timed = serde_json::from_slice(&message.data).map_err(|e| e.to_string())?;
    fields.insert("t".to_owned(), json!(t));
    fields.remove("percept");
    Ok(fields)
}

/// Returns world, method, arena, sensor and seed.
fn heading(recording: &Recording) -> String {
    let entry = |key: &str| {
        let found = recording.metadata("run").and_then(|facts| facts.get(key));
        found.map_or("", String::as_str)
    };
    info::heading(["world", "method", "arena", "sensor", "seed"].map(entry))
}

/// Returns the result of an episode and the length of the shortest path as text.
fn result(episode: &Timed) -> String {
    let number = |key: &str| episode.get(key).and_then(Value::as_u64);
    let how = match episode.get("outcome").and_then(Value::as_str) {
        Some("goal") => "reached the goal",
        None => return String::new(),
        Some(_) => "ended before the goal",
    };
    let (steps, shortest) = (number("steps").unwrap_or(0), number("shortest"));
    let shortest = shortest.map_or_else(String::new, |n| format!("; the shortest path has {n}"));
    format!("The last episode {how} after {steps} steps{shortest}.")
}
