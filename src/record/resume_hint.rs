//! Hints for resuming a stopped run from its checkpoint.

use std::path::Path;

use crate::disk;

/// The recent state of an unfinished run.
pub(crate) const CHECKPOINT: &str = "checkpoint";

/// Returns true if there is a checkpoint to resume from.
pub(crate) fn has_checkpoint(folder: &Path) -> bool {
    folder.join(CHECKPOINT).is_file()
}

/// Returns how to resume a run.
pub(crate) fn resume_hint(folder: &Path) -> String {
    format!(
        "resume it with `xcscr train --resume {}`",
        disk::typed(folder)
    )
}

/// Returns how to resume the run in a folder, if it was stopped.
pub(crate) fn way_to_resume(folder: &Path) -> Option<String> {
    has_checkpoint(folder).then(|| resume_hint(folder))
}
