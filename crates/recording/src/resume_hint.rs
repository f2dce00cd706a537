//! Hints for resuming a stopped run.

use std::path::Path;

use crate::disk;

/// The plan of an unfinished run.
pub const UNFINISHED: &str = "unfinished.json";

/// Returns true if the folder contains an unfinished run.
pub fn is_resumable(folder: &Path) -> bool {
    folder.join(UNFINISHED).is_file()
}

/// Returns how to resume a run.
pub fn resume_hint(folder: &Path) -> String {
    format!(
        "resume it with `xcscr train --resume {}`",
        disk::typed(folder)
    )
}

/// Returns how to resume the run in a folder, if it was stopped.
pub fn way_to_resume(folder: &Path) -> Option<String> {
    is_resumable(folder).then(|| resume_hint(folder))
}
