//! The folder of a study: `study.json`, and a journal of finished trials for each process.
//!
//! Only two properties of the file system are required. The writes of a process become visible
//! eventually, and in order. Only one process can create a file of a given name. No journal is
//! renamed or has two writers: every process that runs trials writes its own. A process repeats
//! trials whose results are not visible yet, and gets the same results. A lock only protects the
//! tables and reports that are generated from all trials.
//!
//! A journal names each trial by the contents of its arm and by its number in the arm. A study that grows therefore reads
//! the journals of the smaller one, and the smaller one passes over the trials of the larger one.

mod folder;
mod growth;
mod journal;
pub(super) mod outputs;
mod plan;
pub(super) mod record;

pub use folder::StudyFolder;
pub(super) use journal::Journal;
pub use record::{Driven, Figures, TrialRecord};
