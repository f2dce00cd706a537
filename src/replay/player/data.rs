//! The data of a page: the facts of a recording, each with its time in seconds.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Serialize;

use super::chapters::Chapter;
use super::episodes::{self, PackedEpisode};
use super::world::World;
use crate::Error;
use crate::record::event::{Begin, Contact, Curve, Learned, Localisation};
use crate::record::reader::Recording;
use crate::record::topics::Ellipse;
use crate::world::{CellState, Maze};

/// The greatest level of rank and nearness on the page.
const LEVELS: f32 = 20.0;

/// All data that the page shows. Lists are in order of time.
#[derive(Debug, Default, Serialize)]
pub struct Data {
    pub heading: String,
    /// The result of the last episode, or of the drive of the learned policy.
    pub result: String,
    /// The duration, in seconds.
    pub end: f64,
    pub world: World,
    /// The names of the actions.
    pub actions: Vec<String>,
    pub robot_radius_m: f64,
    /// CSS colours of best actions: from far from the goal to near it.
    pub arrow_colours: [String; 3],
    /// The CSS colour of best actions that lead to no goal.
    pub no_goal_colour: String,
    /// CSS colours of action values below and above 0.
    pub value_colours: [String; 2],
    /// The CSS colours of perceived cells.
    pub percept_colours: BTreeMap<CellState, String>,
    /// Time, x, y and heading in the map frame, in seconds, metres and radians.
    pub poses: Vec<[f64; 4]>,
    /// The same of the estimated pose.
    pub estimated: Vec<[f64; 4]>,
    pub localisations: Vec<Timed<Uncertainty>>,
    pub decisions: Vec<Timed<Choice>>,
    /// The beginnings of episodes.
    pub begins: Vec<Timed<Begin>>,
    /// The ends of episodes, with the policy after each.
    pub ends: Vec<Timed<EpisodeEnd>>,
    pub contacts: Vec<Timed<Contact>>,
    pub learned: Vec<Timed<Policy>>,
    /// The learning curve; `None` where the page of a run has it.
    pub curve: Option<Curve>,
    /// The word for an episode.
    pub noun: &'static str,
    /// The most instructive of the episodes inside the page of a run.
    pub chapters: Vec<Chapter>,
    /// The episodes inside the page of a run.
    pub packed_episodes: Vec<PackedEpisode>,
}

/// A fact and its time.
#[derive(Debug, Serialize)]
pub struct Timed<F> {
    /// Seconds since the first message.
    pub t: f64,
    #[serde(flatten)]
    pub fact: F,
}

/// The uncertainty and the error of an estimate.
#[derive(Debug, Serialize)]
pub struct Uncertainty {
    #[serde(flatten)]
    pub localisation: Localisation,
    pub ellipse: Ellipse,
}

/// The end of an episode.
#[derive(Debug, Serialize)]
pub struct EpisodeEnd {
    pub episode: u32,
    /// True if the policy after the episode is globally optimal.
    pub optimal: bool,
}

/// A decision, with the values of the actions as readers compare them: in units of reward.
#[derive(Debug, Serialize)]
pub struct Choice {
    pub episode: u32,
    pub step: u32,
    /// The middle of the robot's cell in the grid frame, in metres.
    pub cell_m: [f64; 2],
    pub action: String,
    pub chosen_by: String,
    /// The rule in words; empty in recordings of whole runs.
    pub rule: String,
    /// The percept in words; empty in recordings of whole runs.
    pub seen: String,
    pub runner_up: String,
    /// The percentage of steps that is left.
    pub left: u32,
    pub values: Vec<Option<f64>>,
    /// The perceived cells, clockwise from north.
    pub perceived: Vec<CellState>,
}

/// The learned policy: for each cell of the maze, the northern row first, the best actions as bits, and
/// the levels of rank and nearness; 0 if unknown.
#[derive(Debug, Serialize)]
pub struct Policy {
    pub best: Vec<u8>,
    pub rank: Vec<u8>,
    pub nearness: Vec<u8>,
    /// For each action of each cell the value in percent of the greatest magnitude; 0 if unknown.
    pub shares: Vec<i8>,
}

impl Data {
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

impl Policy {
    /// Returns the levels of what was learned.
    pub fn of(learned: &Learned, maze: &Maze) -> Self {
        let none = vec![0; usize::from(maze.width()) * usize::from(maze.height())];
        let actions = maze.action_count();
        let mut policy = Self {
            best: none.clone(),
            rank: none.clone(),
            shares: vec![0; actions * none.len()],
            nearness: none,
        };
        let level = |share: f32| (share * LEVELS).round() as u8;
        for at in &learned.cells {
            let index = maze.index(at.cell);
            policy.best[index] = at.best;
            policy.rank[index] = level(at.rank);
            policy.nearness[index] = level(at.nearness);
            let shares = policy.shares[actions * index..].iter_mut().zip(at.shares);
            shares
                .take(actions)
                .for_each(|(to, share)| *to = share.unwrap_or(0));
        }
        policy
    }
}
