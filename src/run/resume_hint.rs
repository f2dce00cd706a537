//! Hints for resuming a stopped run from its checkpoint.

use std::path::Path;

use crate::disk;

/// The recent state of an unfinished run.
pub(super) const CHECKPOINT: &str = "checkpoint";

/// Returns true if there is a checkpoint to resume from.
pub(super) fn has_checkpoint(folder: &Path) -> bool {
    folder.join(CHECKPOINT).is_file()
}

/// Returns how to resume a run.
pub(super) fn resume_hint(folder: &Path) -> String {
    format!(
        "resume it with `xcscr train --resume {}`",
        disk::typed(folder)
    )
}
