//! How a run that was stopped is resumed: from its checkpoint.

use std::path::Path;

use crate::disk;

/// The run as it was a moment ago, while it lasts.
pub(super) const CHECKPOINT: &str = "checkpoint";

/// Is there a checkpoint from which to resume?
pub(super) fn has_checkpoint(folder: &Path) -> bool {
    folder.join(CHECKPOINT).is_file()
}

/// How to resume a run.
pub(super) fn way_on(folder: &Path) -> String {
    format!(
        "resume it with `xcscr train --resume {}`",
        disk::typed(folder)
    )
}
