//! The files of a study that are generated from its finished trials.

use std::io::{self, Write};
use std::path::Path;

use super::folder::StudyFolder;
use crate::disk;
use crate::study::error;
use crate::{Error, ErrorKind};

/// The table of episodes.
pub const EPISODES: &str = "episodes.csv.gz";
/// The table of learning curves.
pub const LEARNING_CURVES: &str = "learning-curves.csv";
/// The tables and the reports.
const DOCUMENTS: [&str; 6] = [
    "trials.csv",
    EPISODES,
    LEARNING_CURVES,
    "summary.json",
    "report.md",
    "report.html",
];
/// The figures.
const FIGURES: [&str; 4] = [
    "curves.svg",
    "curves-by-steps.svg",
    "first-optimal.svg",
    "episodes.svg",
];

/// Returns true if a study generates a file of this name.
pub fn is_output(name: &str) -> bool {
    outputs().any(|output| output == name)
}

/// Returns the names of the files that a study may generate.
pub(super) fn outputs() -> impl Iterator<Item = &'static str> {
    DOCUMENTS.into_iter().chain(FIGURES)
}

/// Returns the error of the file behind a table. The conversion of the library hides its kind.
pub fn io_error(fault: csv::Error) -> io::Error {
    match fault.into_kind() {
        csv::ErrorKind::Io(cause) => cause,
        other => io::Error::other(format!("{other:?}")),
    }
}

/// Removes all generated files.
pub(super) fn remove_outputs(path: &Path) -> Result<(), Error> {
    remove(path, outputs())
}

fn remove(path: &Path, mut names: impl Iterator<Item = &'static str>) -> Result<(), Error> {
    names.try_for_each(|name| {
        let file = path.join(name);
        disk::remove(&file).map_err(error::io(&file))
    })
}

impl StudyFolder {
    /// Removes the reports, which are generated from the tables.
    pub(in crate::study) fn remove_reports(&self) -> Result<(), Error> {
        remove(self.path(), ["report.md", "report.html"].into_iter())
    }

    /// Writes a generated file. An existing file with other contents belongs to somebody else or
    /// was changed by hand. It is not overwritten without [`replacing`](Self::replacing).
    pub(in crate::study) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        self.write_with(name, |file| file.write_all(bytes))
    }

    /// Like [`Self::write`], for contents that are written piece by piece.
    pub(in crate::study) fn write_with(
        &self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Error> {
        let path = self.path().join(name);
        let written = if self.force {
            disk::replace_with(&path, write).map(|()| true)
        } else {
            disk::keep_or_create(&path, write)
        };
        if written.map_err(error::io(&path))? {
            Ok(())
        } else {
            Err(ErrorKind::CannotCreate.error(format!(
                "{} exists and differs from what this study would write: replace it with `--force`; \
                 the trials are kept",
                path.display()
            )))
        }
    }
}
