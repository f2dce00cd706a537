//! The study, and its overrides on the command line.

use std::path::PathBuf;

use xcscr::Error;
use xcscr::arena::ArenaKind;
use xcscr::study::{Agents, Protocol, StudyFile};

use crate::commands::choices;

/// A study and its overrides.
#[derive(Debug, clap::Args)]
pub(super) struct ChoiceArgs {
    /// Study file (TOML), or the name of a bundled study, such as paper or ablation (an unknown
    /// name lists them all).
    study: PathBuf,
    /// Trials of each method in each world.
    #[arg(long, value_name = "N", value_parser = choices::count::<usize>)]
    trials: Option<usize>,
    /// Episodes of each trial.
    #[arg(long, value_name = "N", value_parser = choices::count::<u32>)]
    episodes: Option<u32>,
    /// Root seed of all trials.
    #[arg(long, value_name = "S", value_parser = choices::seed)]
    seed: Option<u64>,
    /// Method that the report compares with each of the others.
    #[arg(long, value_name = "METHOD")]
    reference: Option<String>,
    /// Arena to use instead of the study's.
    #[arg(long, value_parser = choices::arena())]
    arena: Option<ArenaKind>,
    /// Override one setting of all trials, such as `xcs.dont_care=0.5`.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl ChoiceArgs {
    /// Returns the study's protocol.
    pub fn protocol(&self) -> Result<Protocol, Error> {
        let mut file = StudyFile::load(&self.study)?;
        file.trials = self.trials.unwrap_or(file.trials);
        file.episodes = self.episodes.unwrap_or(file.episodes);
        file.seed = self.seed.unwrap_or(file.seed);
        file.reference = self.reference.clone().or(file.reference);
        file.arenas = self.arena.map_or(file.arenas, |arena| vec![arena]);
        file.sets.clone_from(&self.set);
        Protocol::new(&file, &Agents::default())
    }
}
