//! A recorded, resumable run in a folder.
//!
//! [`Session`] trains, records into a [`RunFolder`], and resumes stopped runs. A [`RecordedRun`] is what
//! a recording tells about its run. A [`RunInputs`] is what determines a run, and repeats it for an
//! observer. A [`Repetition`] is the same run, recorded again into a temporary folder, to compare the
//! bytes. [`RunFolder::replay_page`] returns a page that plays it.
//!
//! # Example
//! ```
//! use std::path::Path;
//! use xcscr::{record::RecordMode, run::{RunFolder, Session}, trial::{Plan, Trial}, world::Maze};
//!
//! let maze = Maze::load(Path::new("worlds/maze4.json"))?;
//! let parent = tempfile::tempdir()?;
//! let folder = RunFolder::create(&parent.path().join("run"), false)?;
//! let trial = Trial::new(Plan::new(maze).episodes(3))?;
//! let run = Session::begin(folder, trial, RecordMode::All)?.run(&mut (), &|| false)?;
//! assert_eq!(run.recording.files.len(), 4); // three episodes and run.mcap
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod contents;
mod error;
mod evaluation;
mod external;
mod facts;
mod folder;
mod session;
mod recorded_run;
mod page;
mod run_inputs;
mod unfinished;
mod untouched;
mod repetition;

pub use evaluation::evaluate;
pub(crate) use evaluation::observe;
pub use external::{ExternalActions, ExternalEpisode, ExternalRecorder, WheelSpeeds};
pub use folder::RunFolder;
pub use page::page;
pub use recorded_run::RecordedRun;
pub use repetition::Repetition;
pub use run_inputs::RunInputs;
pub use session::{Finished, Resumed, Session};
