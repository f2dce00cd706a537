//! The data of a page: the facts of a recording, each with its time in seconds.

use std::path::PathBuf;

use foxglove::messages::Odometry;
use serde::Serialize;
use strum::VariantArray;

use super::chapters::Chapter;
use super::episodes::{self, PackedEpisode};
use super::world::World;
use crate::error::Error;
use crate::picture::{NO_GOAL, SCALE, css};
use crate::record::event::{
    Begin, Contact, Curve, Decision, End, Learned, Localisation, Outcome, Perceived,
};
use crate::record::info::{self, RADIUS, RunKind};
use crate::record::reader::{Message, Recording};
use crate::record::topics::{decimal, decoded, percept};
use crate::record::{RobotShape, Topic, error};
use crate::sensor::Sensor;
use crate::world::{Cell, Maze};
use xcs::Action;

/// The maximum size of the messages of a page, in bytes. In memory they take up to thirty times as
/// much.
const MOST_BYTES: usize = 16 << 20;
/// The greatest level of rank and nearness on the page.
const LEVELS: f32 = 20.0;

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
    actions: Vec<String>,
    robot_radius_m: f64,
    /// CSS colours of best actions: from far from the goal to near it.
    arrow_colours: [String; 3],
    /// The CSS colour of best actions that lead to no goal.
    no_goal_colour: String,
    /// CSS colours of cells perceived as free, as a wall and as a goal.
    percept_colours: Vec<String>,
    /// Time, x, y and heading in the map frame, in seconds, metres and radians.
    poses: Vec<[f64; 4]>,
    /// The same of the estimated pose.
    estimated: Vec<[f64; 4]>,
    localisations: Vec<Timed<Localisation>>,
    decisions: Vec<Timed<Choice>>,
    /// The beginnings of episodes.
    begins: Vec<Timed<Begin>>,
    /// The ends of episodes, with the policy after each.
    ends: Vec<Timed<Begin>>,
    contacts: Vec<Timed<Contact>>,
    learned: Vec<Timed<Policy>>,
    /// The learning curve; `None` where the page of a run has it.
    curve: Option<Curve>,
    /// The word for an episode.
    noun: &'static str,
    /// The most instructive of the episodes inside the page of a run.
    chapters: Vec<Chapter>,
    /// The episodes inside the page of a run.
    pub packed_episodes: Vec<PackedEpisode>,
}

/// A fact and its time.
#[derive(Debug, Serialize)]
struct Timed<F> {
    /// Seconds since the first message.
    t: f64,
    #[serde(flatten)]
    fact: F,
}

/// A decision, with the values of the actions as readers compare them: in units of reward.
#[derive(Debug, Serialize)]
struct Choice {
    episode: u32,
    step: u32,
    /// The middle of the robot's cell in the grid frame, in metres.
    cell_m: [f64; 2],
    action: String,
    chosen_by: String,
    /// The rule in words; empty in recordings of whole runs.
    rule: String,
    /// The percept in words; empty in recordings of whole runs.
    seen: String,
    runner_up: String,
    /// The percentage of steps that is left.
    left: u32,
    values: Vec<Option<f64>>,
    /// The perceived cells, clockwise from north, as numbers of their colours.
    perceived: Vec<u8>,
}

/// The learned policy: for each cell of the maze, the northern row first, the best actions as bits, and
/// the levels of rank and nearness; 0 if unknown.
#[derive(Debug, Serialize)]
struct Policy {
    best: Vec<u8>,
    rank: Vec<u8>,
    nearness: Vec<u8>,
}

/// What is collected while a recording is read.
struct Reader {
    data: Data,
    maze: Maze,
    sensor: Option<Sensor>,
    from_ns: Option<u64>,
    steps: Vec<Timed<Choice>>,
    /// For each step the middle of its cell as a pose.
    cells: Vec<[f64; 4]>,
    last: Option<End>,
    ends: Curve,
}

impl Data {
    /// Reads a recording of a run or an episode.
    pub fn of(recording: &Recording) -> Result<Self, Error> {
        let mut reader = Reader::new(recording)?;
        let mut left = MOST_BYTES;
        for message in recording.messages() {
            let message = message?;
            left = left.checked_sub(message.data.len()).ok_or_else(|| {
                let cause = "its messages are too many for a page, open it in a viewer";
                error::unusable(recording.path(), cause)
            })?;
            reader.add(recording, &message)?;
        }
        Ok(reader.finish())
    }

    /// Returns world, method, arena, sensor and seed.
    pub fn heading(&self) -> &str {
        &self.heading
    }

    /// Returns the number of the first episode; `None` without an episode.
    pub fn first_episode(&self) -> Option<u32> {
        Some(self.begins.first()?.fact.episode)
    }

    /// Adds the episodes of a run, the learning curve of the last one, and those chapters that are
    /// among the episodes.
    pub fn set_run(&mut self, mut chapters: Vec<Chapter>, files: &[PathBuf]) -> Result<(), Error> {
        let wanted: Vec<u32> = chapters.iter().map(|chapter| chapter.episode).collect();
        self.packed_episodes = episodes::packed(files, &wanted)?;
        let packed = &self.packed_episodes;
        chapters.retain(|chapter| packed.iter().any(|one| one.episode == chapter.episode));
        self.chapters = chapters;
        if let Some(last) = files.last() {
            self.curve = Self::of(&Recording::open(last)?)?.curve;
        }
        Ok(())
    }

    /// Removes the learning curve, which grows with each episode of a run.
    pub fn without_curve(self) -> Self {
        Self {
            curve: None,
            ..self
        }
    }
}

impl Reader {
    fn new(recording: &Recording) -> Result<Self, Error> {
        let maze = maze(recording)?;
        let entry = |key: &str| {
            let found = recording.metadata("run").and_then(|facts| facts.get(key));
            found.map_or("", String::as_str)
        };
        let radius_m = entry(RADIUS)
            .parse()
            .ok()
            .filter(|radius_m: &f64| radius_m.is_finite());
        let data = Data {
            heading: info::heading(["world", "method", "arena", "sensor", "seed"].map(entry)),
            world: World::of(&maze),
            actions: Action::all(maze.action_count())
                .map(|action| maze.action_name(action))
                .collect(),
            robot_radius_m: radius_m
                .unwrap_or_else(|| RobotShape::for_cell(maze.cell_size_m()).radius_m),
            arrow_colours: SCALE.map(css),
            no_goal_colour: css(NO_GOAL),
            percept_colours: Perceived::VARIANTS
                .iter()
                .map(|&kind| css(percept::colour(kind)))
                .collect(),
            noun: match recording.run_kind() {
                Ok(RunKind::Evaluation) => "Greedy drive",
                _ => "Episode",
            },
            ..Data::default()
        };
        let mut sensors = Sensor::ALL.iter().copied();
        Ok(Self {
            data,
            maze,
            sensor: sensors.find(|sensor| sensor.name() == entry("sensor")),
            from_ns: None,
            steps: Vec::new(),
            cells: Vec::new(),
            last: None,
            ends: Curve::default(),
        })
    }

    fn add(&mut self, recording: &Recording, message: &Message) -> Result<(), Error> {
        let from_ns = *self.from_ns.get_or_insert(message.time_ns);
        let t = decimal(message.time_ns.saturating_sub(from_ns) as f64 / 1e9);
        self.data.end = self.data.end.max(t);
        let damaged = |fault: String| recording.damaged(fault);
        match Topic::named(message.topic()) {
            Some(Topic::GroundTruth) => {
                let odometry = decoded(&message.data).map_err(damaged)?;
                self.data.poses.push(pose(t, &odometry));
            }
            Some(Topic::Estimate) => {
                let odometry = decoded(&message.data).map_err(damaged)?;
                self.data.estimated.push(pose(t, &odometry));
            }
            Some(Topic::Values) => {
                let grid = decoded(&message.data).map_err(damaged)?;
                let learned = Learned::of_grid(&grid, &self.maze).map_err(damaged)?;
                let fact = Policy::of(&learned, &self.maze);
                self.data.learned.push(Timed { t, fact });
            }
            Some(Topic::Rule) => {
                let fact = self.choice(&recording.fact(message)?);
                self.data.decisions.push(Timed { t, fact });
            }
            Some(Topic::Step) => self.step(t, recording.fact(message)?),
            Some(Topic::Begin) => {
                let fact = recording.fact(message)?;
                self.data.begins.push(Timed { t, fact });
            }
            Some(Topic::Episode) => self.end(t, recording.fact(message)?),
            Some(Topic::Localisation) => {
                let fact = recording.fact(message)?;
                self.data.localisations.push(Timed { t, fact });
            }
            Some(Topic::Contact) => {
                let fact: Contact = recording.fact(message)?;
                if fact.touching {
                    self.data.contacts.push(Timed { t, fact });
                }
            }
            Some(Topic::Curve) => self.data.curve = Some(recording.fact(message)?),
            _ => {}
        }
        Ok(())
    }

    fn choice(&self, decision: &Decision) -> Choice {
        let around = self.sensor.and_then(|sensor| decision.perceived(sensor));
        Choice {
            episode: decision.episode,
            step: decision.step,
            cell_m: self.middle(decision.col, decision.row),
            action: decision.action.clone(),
            chosen_by: decision.chosen_by.clone(),
            rule: decision.rule.clone(),
            seen: decision.seen.clone(),
            runner_up: decision.runner_up.clone(),
            left: decision.left,
            values: Vec::new(),
            perceived: around
                .into_iter()
                .flatten()
                .map(|kind| kind as u8)
                .collect(),
        }
    }

    /// Returns the middle of a cell in the grid frame, in metres.
    fn middle(&self, col: u16, row: u16) -> [f64; 2] {
        let at = self.maze.centre_in_grid(Cell { col, row });
        [at.x, at.y]
    }

    /// Adds a step. In recordings of whole runs, which have no poses and decisions, steps replace
    /// both.
    fn step(&mut self, t: f64, step: Outcome) {
        let (col, row) = (step.col, step.row);
        let at = self.maze.centre_m(Cell { col, row });
        self.cells.push([t, at.x, at.y, 0.0]);
        let same = |last: &&mut Timed<Choice>| {
            (last.fact.episode, last.fact.step) == (step.episode, step.step)
        };
        if let Some(decision) = self.data.decisions.last_mut().filter(same) {
            // The values of a decision are shares of the goal's reward.
            decision.fact.values = step.values;
            return;
        }
        let fact = Choice {
            episode: step.episode,
            step: step.step,
            cell_m: self.middle(col, row),
            action: step.action,
            chosen_by: step.chosen_by,
            rule: String::new(),
            seen: String::new(),
            runner_up: String::new(),
            left: (100.0 * step.left).round() as u32,
            values: step.values,
            perceived: Vec::new(),
        };
        self.steps.push(Timed { t, fact });
    }

    fn end(&mut self, t: f64, end: End) {
        let fact = Begin {
            episode: end.episode,
            optimal: end.optimal,
        };
        self.data.ends.push(Timed { t, fact });
        self.ends.push(&end);
        self.last = Some(end);
    }

    /// Returns the data, with what depends on the whole recording.
    fn finish(self) -> Data {
        let mut data = self.data;
        if data.poses.is_empty() {
            data.poses = self.cells;
        }
        if data.decisions.is_empty() {
            data.decisions = self.steps;
        }
        let is_empty = data
            .curve
            .as_ref()
            .is_none_or(|curve| curve.episode.is_empty());
        if is_empty {
            data.curve = Some(self.ends);
        }
        data.result = self.last.as_ref().map_or_else(String::new, result);
        data
    }
}

impl Policy {
    fn of(learned: &Learned, maze: &Maze) -> Self {
        let none = vec![0; usize::from(maze.width()) * usize::from(maze.height())];
        let mut policy = Self {
            best: none.clone(),
            rank: none.clone(),
            nearness: none,
        };
        let level = |share: f32| (share * LEVELS).round() as u8;
        for at in &learned.cells {
            let index = maze.index(at.cell);
            policy.best[index] = at.best;
            policy.rank[index] = level(at.rank);
            policy.nearness[index] = level(at.nearness);
        }
        policy
    }
}

/// Returns the time, x, y and heading of a pose.
fn pose(t: f64, message: &Odometry) -> [f64; 4] {
    let pose = message.pose.unwrap_or_default();
    let at = pose.position.unwrap_or_default();
    let turned = pose.orientation.unwrap_or_default();
    [t, at.x, at.y, 2.0 * libm::atan2(turned.z, turned.w)]
}

/// Returns the world of a recording.
pub fn maze(recording: &Recording) -> Result<Maze, Error> {
    let Some(world) = recording.attachment("world.json") else {
        return Err(recording.damaged("it has no attachment world.json".to_owned()));
    };
    Maze::from_json(world, "world.json").map_err(|fault| recording.damaged(fault.to_string()))
}

/// Returns the result of an episode and the length of the shortest path as text.
fn result(end: &End) -> String {
    let how = match end.outcome.as_str() {
        "goal" => "reached the goal",
        _ => "ended before the goal",
    };
    let shortest = end
        .shortest
        .map_or_else(String::new, |n| format!("; the shortest path has {n}"));
    format!(
        "The last episode {how} after {} steps{shortest}.",
        end.steps
    )
}
