//! Reading the facts of a recording for a page.

use foxglove::Decode;
use foxglove::messages::Odometry;
use strum::VariantArray;

use super::data::{Choice, Data, EpisodeEnd, Policy, Timed, Uncertainty};
use super::world::World;
use crate::Error;
use crate::picture::css;
use crate::record::colours::{ABOVE, BELOW, NO_GOAL, SCALE};
use crate::record::event::{Contact, Curve, Decision, End, Learned, StepOutcome};
use crate::record::info::{self, RADIUS, RunKind};
use crate::record::reader::{Message, Recording};
use crate::record::topics::{Ellipse, decimal, percept};
use crate::record::{RobotShape, Topic, fault};
use crate::sensor::Sensor;
use crate::world::{Cell, CellState, Maze};
use xcs::Action;

/// The topics with the facts of a page.
const FACTS: [Topic; 10] = [
    Topic::GroundTruth,
    Topic::Estimate,
    Topic::Values,
    Topic::Rule,
    Topic::Step,
    Topic::Begin,
    Topic::Episode,
    Topic::Localisation,
    Topic::Contact,
    Topic::Curve,
];
/// The maximum size of the facts of a page, in bytes. In memory they take up to thirty times as
/// much.
const MOST_BYTES: usize = 16 << 20;
/// What is collected while a recording is read.
struct Reader {
    data: Data,
    maze: Maze,
    sensor: Option<Sensor>,
    from_ns: Option<u64>,
    steps: Vec<Timed<Choice>>,
    /// For each step the middle of its cell as a pose.
    cells: Vec<[f64; 4]>,
    /// The ellipse of the last estimate.
    ellipse: Ellipse,
    last: Option<End>,
    ends: Curve,
}

impl Data {
    /// Reads a recording of a run or an episode.
    pub fn of(recording: &Recording) -> Result<Self, Error> {
        Self::read(recording, |end| format!("Episode {}", end.episode))
    }

    /// Reads a recording of a drive of the learned policy.
    pub fn of_policy(recording: &Recording) -> Result<Self, Error> {
        Self::read(recording, |_| "The learned policy".to_owned())
    }

    /// Reads a recording. `subject` names the last episode in the sentence about its result.
    fn read(recording: &Recording, subject: impl Fn(&End) -> String) -> Result<Self, Error> {
        let mut reader = Reader::new(recording)?;
        let mut left = MOST_BYTES;
        for message in recording.messages() {
            let message = message?;
            let topic = Topic::named(message.topic());
            let Some(topic) = topic.filter(|topic| FACTS.contains(topic)) else {
                reader.passed(message.time_ns);
                continue;
            };
            left = left.checked_sub(message.data.len()).ok_or_else(|| {
                let cause = "its messages are too many for a page, open it in a viewer";
                fault::unusable(recording.path(), cause)
            })?;
            reader.add(recording, topic, &message)?;
        }
        Ok(reader.finish(subject))
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
            value_colours: [BELOW, ABOVE].map(css),
            percept_colours: CellState::VARIANTS
                .iter()
                .map(|&kind| (kind, css(percept::colour(kind))))
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
            ellipse: Ellipse::default(),
            last: None,
            ends: Curve::default(),
        })
    }

    /// Returns the time of a message since the first one, in seconds.
    fn passed(&mut self, time_ns: u64) -> f64 {
        let from_ns = *self.from_ns.get_or_insert(time_ns);
        let t = decimal(time_ns.saturating_sub(from_ns) as f64 / 1e9);
        self.data.end = self.data.end.max(t);
        t
    }

    fn add(&mut self, recording: &Recording, topic: Topic, message: &Message) -> Result<(), Error> {
        let t = self.passed(message.time_ns);
        let odometry = || {
            let odometry = Odometry::decode(&message.data[..]);
            odometry.map_err(|fault| recording.damaged(fault.to_string()))
        };
        match topic {
            Topic::GroundTruth => self.data.poses.push(pose(t, &odometry()?)),
            Topic::Estimate => {
                let odometry = odometry()?;
                self.data.estimated.push(pose(t, &odometry));
                self.ellipse = Ellipse::of(&odometry);
            }
            Topic::Values => {
                let learned = Learned::of_message(&message.data, &self.maze);
                let learned = learned.map_err(|fault| recording.damaged(fault))?;
                let fact = Policy::of(&learned, &self.maze);
                self.data.learned.push(Timed { t, fact });
            }
            Topic::Rule => {
                let fact = self.choice(&recording.fact(message)?);
                self.data.decisions.push(Timed { t, fact });
            }
            Topic::Step => self.step(t, recording.fact(message)?),
            Topic::Begin => {
                let fact = recording.fact(message)?;
                self.data.begins.push(Timed { t, fact });
            }
            Topic::Episode => self.end(t, recording.fact(message)?),
            Topic::Localisation => {
                let fact = Uncertainty {
                    localisation: recording.fact(message)?,
                    ellipse: self.ellipse,
                };
                self.data.localisations.push(Timed { t, fact });
            }
            Topic::Contact => {
                let fact: Contact = recording.fact(message)?;
                if fact.touching {
                    self.data.contacts.push(Timed { t, fact });
                }
            }
            Topic::Curve => self.data.curve = Some(recording.fact(message)?),
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
            perceived: around.into_iter().flatten().collect(),
        }
    }

    /// Returns the middle of a cell in the grid frame, in metres.
    fn middle(&self, col: u16, row: u16) -> [f64; 2] {
        let at = self.maze.centre_in_grid(Cell { col, row });
        [at.x, at.y]
    }

    /// Adds a step. In recordings of whole runs, which have no poses and decisions, steps replace
    /// both.
    fn step(&mut self, t: f64, step: StepOutcome) {
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
        let fact = EpisodeEnd {
            episode: end.episode,
            optimal: end.optimal,
        };
        self.data.ends.push(Timed { t, fact });
        self.ends.push(&end);
        self.last = Some(end);
    }

    /// Returns the data, with what depends on the whole recording.
    fn finish(self, subject: impl Fn(&End) -> String) -> Data {
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
        let last = self.last.as_ref();
        data.result = last.map_or_else(String::new, |end| result(&subject(end), end));
        data
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

/// Returns the result of an episode, which `subject` names, and the length of the shortest path as text.
fn result(subject: &str, end: &End) -> String {
    let how = match end.outcome.as_str() {
        "goal" => "reached the goal",
        _ => "gave up at the step limit",
    };
    let shortest = end
        .shortest
        .map_or_else(String::new, |n| format!("; the shortest path has {n}"));
    format!("{subject} {how} after {} steps{shortest}.", end.steps)
}
