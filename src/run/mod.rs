//! A recorded, resumable run in a folder.
//!
//! [`Session`] trains, records into a [`RunFolder`], and resumes stopped runs. [`Source`]
//! identifies the run of a recording. [`Rerun`] repeats the run for an observer, and [`Again`] to
//! compare the bytes.
//! [`RunFolder::highlights`] shows the turning points in less than two minutes.
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
//! assert_eq!(run.recording.files.len(), 5); // three episodes, run.mcap and highlights.mcap
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod contents;
mod error;
mod evaluation;
mod external;
mod facts;
mod folder;
mod ros;
mod session;
mod source;
mod comparison;
mod highlights;
mod rerun;
mod untouched;
mod verify;

pub(crate) use evaluation::observe;
pub use evaluation::{evaluate, record_evaluation};
pub use external::{ExternalActions, ExternalEpisode, ExternalRecorder, WheelSpeeds};
pub use folder::RunFolder;
pub use highlights::page;
pub use rerun::Rerun;
pub use session::{Finished, Resumed, Session};
pub use source::Source;
pub use verify::Again;
