//! A search, and its state as stored in its folder.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::candidates::Candidate;
use super::standing::{Standing, Verdict, standings};
use crate::disk;
use crate::error::Error;
use crate::study::error;
use crate::study::protocol::Protocol;
use crate::study::store::plan::{SEARCH, foreign, names};
use crate::study::store::{PlannedStudy, StudyFolder};
use xcs::bounds::within;
use xcs::random::replicate_seed;

/// The first replicate number for the root seeds of the final and the rungs. No study has as many
/// trials.
const FIRST_SEED: u64 = 1 << 32;
/// Number of candidates in the final.
const FINALISTS: usize = 2;

/// A search for settings, in its own folder.
#[derive(Debug, Clone)]
pub struct Tuning {
    path: PathBuf,
    protocol: Protocol,
    budget: usize,
    tasks: usize,
    candidates: Vec<Candidate>,
}

/// The next step of a search.
#[derive(Debug)]
pub enum Stage {
    /// A rung, or the final, that has unfinished trials.
    Open(PlannedStudy),
    /// The search is finished.
    Done(Found),
}

/// The result of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// The name of the study.
    pub study: String,
    /// The id of its plan.
    pub plan: String,
    /// Maximum number of trials of the search.
    pub budget: usize,
    /// Number of trials that the search ran.
    pub spent: usize,
    /// The rungs, from the first.
    pub rungs: Vec<Rung>,
    /// The folder of the final, in which the finalists run on fresh seeds.
    #[serde(skip)]
    pub last: PlannedStudy,
}

/// A rung of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rung {
    /// Seeds of each candidate in each world, in this rung.
    pub seeds: usize,
    /// The candidates in this rung, the best first.
    pub standings: Vec<Standing>,
}

impl Tuning {
    /// Creates a search among everything that a study varies. The rungs together run at most
    /// `budget` trials. Each rung is split into `tasks` tasks.
    ///
    /// # Errors
    /// When there are fewer than two candidates, or the budget is too small for one trial each.
    pub fn new(
        path: &Path,
        protocol: Protocol,
        budget: usize,
        tasks: usize,
    ) -> Result<Self, Error> {
        let candidates = Candidate::all(&protocol)?;
        let this = Self {
            path: path.to_owned(),
            protocol,
            budget,
            tasks,
            candidates,
        };
        let least = this.rungs() * this.protocol.arms.len();
        within("budget", budget, least..=100_000_000)?;
        Ok(this)
    }

    /// Returns the next step of the search. Creates the folder of the next rung.
    ///
    /// # Errors
    /// When the folder contains another search or other files, or on an error of the file system.
    pub fn stage(&self) -> Result<Stage, Error> {
        self.require_own_folder()?;
        fs::create_dir_all(&self.path).map_err(disk::cannot_create(&self.path))?;
        let mut rungs: Vec<Rung> = Vec::new();
        let (mut left, mut studies) = (self.candidates.clone(), Vec::new());
        while rungs.len() < self.rungs() && left.len() > 1 {
            let (number, seeds) = (rungs.len() + 1, self.seeds(&left));
            let planned = self.planned(&format!("rung-{number}"), &left, seeds, number)?;
            let study = StudyFolder::of(planned.clone(), None)?;
            if study.require_complete().is_err() {
                return Ok(Stage::Open(planned));
            }
            studies.push(study);
            let standings = standings(&scores(&left, &studies), left.len().div_ceil(2));
            left = staying(&left, &standings);
            rungs.push(Rung { seeds, standings });
        }
        self.last_stage(
            rungs,
            studies.iter().map(|study| study.protocol().len()).sum(),
        )
    }

    /// A folder without a first rung may contain an unfinished `rung-1`, and nothing else.
    fn require_own_folder(&self) -> Result<(), Error> {
        // List the names first: another process may continue the same search in the meantime.
        let is_empty = names(&self.path)?.iter().all(|name| name == "rung-1");
        match is_empty || PlannedStudy::is_in(&self.path.join("rung-1")) {
            true => Ok(()),
            false => Err(foreign(&self.path)),
        }
    }

    /// Returns the final between the best candidates of the last rung.
    fn last_stage(&self, rungs: Vec<Rung>, spent: usize) -> Result<Stage, Error> {
        let names = rungs.last().into_iter().flat_map(|rung| &rung.standings);
        let best: Vec<&String> = names.map(|one| &one.candidate).take(FINALISTS).collect();
        let is_best = |one: &&Candidate| best.contains(&&one.name);
        let finalists: Vec<Candidate> = self.candidates.iter().filter(is_best).cloned().collect();
        let last = self.planned("final", &finalists, self.protocol.trials, 0)?;
        if StudyFolder::of(last.clone(), None)?
            .require_complete()
            .is_err()
        {
            return Ok(Stage::Open(last));
        }
        let found = Found {
            study: self.protocol.name.clone(),
            plan: self.protocol.id(),
            budget: self.budget,
            spent,
            rungs,
            last,
        };
        let path = self.path.join(SEARCH);
        let kept =
            disk::keep_or_create(&path, |file| file.write_all(disk::json(&found).as_bytes()));
        match kept.map_err(error::io(&path))? {
            true => Ok(Stage::Done(found)),
            false => Err(error::altered(&path)),
        }
    }

    /// The maximum number of rungs. Each rung halves the candidates.
    fn rungs(&self) -> usize {
        self.candidates.len().next_power_of_two().ilog2() as usize
    }

    /// Returns the seeds per candidate. Every rung may use the same share of the budget.
    fn seeds(&self, left: &[Candidate]) -> usize {
        let arms: usize = left.iter().map(|one| one.arms.len()).sum();
        self.budget / self.rungs() / arms
    }

    /// Creates the planned study of some candidates, with its own root seed.
    fn planned(
        &self,
        name: &str,
        candidates: &[Candidate],
        seeds: usize,
        number: usize,
    ) -> Result<PlannedStudy, Error> {
        let arms = candidates.iter().flat_map(|one| &one.arms);
        let mut arms: Vec<usize> = arms.copied().collect();
        arms.sort_unstable();
        let protocol = Protocol {
            name: format!("{} ({name})", self.protocol.name),
            seed: replicate_seed(self.protocol.seed, FIRST_SEED + number as u64),
            trials: seeds,
            arms: arms
                .iter()
                .map(|arm| self.protocol.arms[*arm].clone())
                .collect(),
            ..self.protocol.clone()
        };
        let tasks = Some(self.tasks.min(protocol.len()));
        let planned = PlannedStudy::in_folder(&self.path.join(name), protocol, tasks)?;
        planned.make()?;
        Ok(planned)
    }
}

/// Returns the scores of candidates in all rungs so far.
fn scores(candidates: &[Candidate], studies: &[StudyFolder]) -> Vec<(String, Vec<f64>)> {
    let scores = |one: &Candidate| studies.iter().flat_map(|study| one.scores(study)).collect();
    let all = candidates.iter();
    all.map(|one| (one.name.clone(), scores(one))).collect()
}

/// Returns the candidates that stay, in the order of the study.
fn staying(candidates: &[Candidate], standings: &[Standing]) -> Vec<Candidate> {
    let stays = |candidate: &&Candidate| {
        let mut of = standings.iter().filter(|one| one.verdict == Verdict::Stays);
        of.any(|one| one.candidate == candidate.name)
    };
    candidates.iter().filter(stays).cloned().collect()
}
