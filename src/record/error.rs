//! What can go wrong while recordings are written and read.

use std::io;
use std::path::PathBuf;

use crate::disk;

/// A recording that could not be written or read.
///
/// Every message names the file and the way out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file could not be made at all.
    #[error("cannot create the recording: {cause}{}: {}", disk::way_out_or(.cause, "; choose another folder, or free this one"), path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// Writing stopped half-way, as on a full disk. What was written so far is kept.
    #[error("cannot write the recording: {cause}: {}", path.display())]
    Write {
        /// The file, still with `.part` at the end of its name.
        path: PathBuf,
        /// What the system said.
        cause: String,
    },
    /// A recovered recording could not be written. Nothing of it is left, and the file that was to
    /// be recovered is as it was.
    #[error("cannot write the recovered recording: {cause}: {}", path.display())]
    Recover {
        /// The file that was to be.
        path: PathBuf,
        /// What the system said.
        cause: String,
    },
    /// The file could not be read from the disk.
    #[error("cannot read the recording: {cause}: {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// The file is one that was being written when the program ended.
    #[error("this recording was never finished, and no viewer can open it; make a complete file of it with `xcscr recording recover {0} -o OUT.mcap`", path.display())]
    Unfinished {
        /// The file.
        path: PathBuf,
    },
    /// The file is no MCAP file at all.
    #[error("this is not a recording: it does not begin like an MCAP file: {}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The file is no sound MCAP file.
    #[error("this recording is damaged: {cause}; `xcscr recording check` says more, `xcscr recording recover` saves what can be read: {}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What was found, and where.
        cause: String,
    },
}
