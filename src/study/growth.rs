//! A larger study takes the place of a smaller one in its folder.
//!
//! The plan changes first, in one step, and names the files of the smaller study with their checksums. They are removed
//! next, and their names last. An interrupted replacement is completed by the next command that locks the folder.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::Path;

use flate2::CrcReader;

use super::error;
use super::report::Report;
use super::store::StudyFolder;
use super::store::outputs::outputs;
use crate::disk;
use crate::{Error, ErrorKind};

impl StudyFolder {
    /// Notes the generated files of a smaller study in the folder, which the replacement removes.
    ///
    /// # Errors
    /// When one was changed by hand or was not written with the report, unless it may be replaced.
    pub(super) fn note_smaller(&mut self) -> Result<(), Error> {
        if !self.contains_smaller()? {
            return Ok(());
        }
        let found = checksums(self.path())?;
        if !self.force {
            Self::read(self.path())?.require_own_outputs()?;
        }
        self.planned.replaced = found;
        Ok(())
    }

    /// Checks that all generated files are as the tables and the report are written anew. An unfinished study has none,
    /// and the tables of episodes cannot be checked without repeating the trials.
    fn require_own_outputs(mut self) -> Result<(), Error> {
        let path = self.path().to_owned();
        let mut present = outputs().filter(|name| path.join(name).symlink_metadata().is_ok());
        let Some(first) = present.next() else {
            return Ok(());
        };
        let fresh = tempfile::tempdir().map_err(error::io(&std::env::temp_dir()))?;
        if self.missing().is_empty() {
            self.planned = self.planned.moved_to(fresh.path());
            self.write_tables()?;
            Report::new(&self).write(&self)?;
        }
        let mut changed = Vec::new();
        for name in std::iter::once(first).chain(present) {
            let wanted = disk::read(&fresh.path().join(name), disk::MOST_BYTES).ok();
            let file = path.join(name);
            let equals = |wanted: Vec<u8>| disk::differs(&file, &wanted).map(|differs| !differs);
            if !wanted.map_or(Ok(false), equals).map_err(error::io(&file))? {
                changed.push(name);
            }
        }
        match changed[..] {
            [] => Ok(()),
            _ => Err(ErrorKind::CannotCreate.error(format!(
                "{} has files that were changed by hand, or are from `study episodes` or elsewhere ({}): move them to \
                 another folder, or replace them with `--force`; the trials are kept",
                path.display(),
                changed.join(", ")
            ))),
        }
    }

    /// Replaces a smaller study in the folder by this one, which must be complete, and removes the files
    /// that were noted. The journals stay as they are.
    pub(super) fn replace_smaller(&mut self) -> Result<(), Error> {
        if self.contains_smaller()? {
            self.planned.write(true)?;
            self.remove_replaced()?;
        }
        Ok(())
    }

    /// Removes the files of the smaller study that this one replaced. A file that was changed in the meantime stays.
    pub(super) fn remove_replaced(&mut self) -> Result<(), Error> {
        if self.planned.replaced.is_empty() {
            return Ok(());
        }
        for (name, checksum) in checksums(self.path())? {
            if self.planned.replaced.get(&name) == Some(&checksum) {
                let file = self.path().join(&name);
                disk::remove(&file).map_err(error::io(&file))?;
            }
        }
        self.planned.replaced.clear();
        self.planned.write(true)
    }
}

/// Returns the checksums of the generated files in a folder. Links are left out.
fn checksums(folder: &Path) -> Result<BTreeMap<String, u32>, Error> {
    let files = outputs().map(|name| (name, folder.join(name)));
    let files =
        files.filter(|(_, file)| file.symlink_metadata().is_ok_and(|found| found.is_file()));
    files
        .map(|(name, file)| {
            let sum = checksum(&file).map_err(error::io(&file))?;
            Ok((name.to_owned(), sum))
        })
        .collect()
}

fn checksum(file: &Path) -> io::Result<u32> {
    let mut reader = CrcReader::new(File::open(file)?);
    io::copy(&mut reader, &mut io::sink())?;
    Ok(reader.crc().sum())
}
