//! Atomic file writes: a file is there whole, or not at all. Each writer has a temporary file of its
//! own, so that writers of one file cannot mix their bytes.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use super::{differs_from, remove};

/// Random characters in the name of a temporary file.
const RANDOM: usize = 6;
/// The end of its name.
const SUFFIX: &str = ".tmp";
/// The longest file name that is made part of the temporary one, so that both fit into 255 bytes.
const MOST_NAME: usize = 200;

/// Writes a file; `force` lets it take the place of an older file. After a crash or a power failure
/// either the old file is there or the new one.
///
/// # Errors
/// Those of the file system; then the old file is untouched.
pub fn write(path: &Path, bytes: &[u8], force: bool) -> io::Result<()> {
    let aside = written_aside(path, |file| file.write_all(bytes))?;
    persist(aside, path, force)
}

/// Writes a file, in place of an older one; see [`write`].
///
/// # Errors
/// The same.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write(path, bytes, true)
}

/// The same for what is written piece by piece.
///
/// # Errors
/// The same, and those of `write`.
pub(crate) fn replace_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    persist(written_aside(path, write)?, path, true)
}

/// The same, unless there is a file of this name with other bytes: then that is kept. Returns
/// whether the file holds what was written.
///
/// # Errors
/// The same.
pub(crate) fn keep_or_create(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<bool> {
    let aside = written_aside(path, write)?;
    let written = aside.reopen()?;
    match differs_from(path, written.metadata()?.len(), written)? {
        true => Ok(false),
        false => persist(aside, path, true).map(|()| true),
    }
}

/// Writes a temporary file. When that fails, the file is removed at once: it may lie on a full disk,
/// where its space is needed.
fn written_aside(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<NamedTempFile> {
    let mut file = BufWriter::new(aside(path)?);
    write(&mut file)?;
    Ok(file.into_inner()?)
}

/// Creates a temporary file next to `path`, called `.NAME.RANDOM.tmp`. It is removed unless it is
/// [persisted](persist).
///
/// # Errors
/// Those of the file system.
pub(crate) fn aside(path: &Path) -> io::Result<NamedTempFile> {
    let name = path.file_name().filter(|name| name.len() <= MOST_NAME);
    let mut prefix = OsStr::new(".").to_owned();
    if let Some(name) = name {
        prefix.push(name);
        prefix.push(".");
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM);
    // As readable as other files: a temporary file is otherwise for its owner alone.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(path))
}

/// Brings a temporary file to the disk, and gives it its name; `force` lets it take the place of an
/// older file. A link of this name is replaced, never followed.
///
/// # Errors
/// Those of the file system; then the old file is untouched.
pub(crate) fn persist(aside: NamedTempFile, path: &Path, force: bool) -> io::Result<()> {
    aside.as_file().sync_all()?;
    let named = match force {
        true => aside.persist(path),
        false => aside.persist_noclobber(path),
    };
    named.map_err(|fault| fault.error)?;
    sync_folder(folder_of(path))
}

/// Returns the name of the file that a killed process was writing when it left a temporary file of
/// this name.
pub(crate) fn leftover_of(name: &str) -> Option<&str> {
    let (whole, random) = name
        .strip_prefix('.')?
        .strip_suffix(SUFFIX)?
        .rsplit_once('.')?;
    let is_random = random.len() == RANDOM && random.bytes().all(|b| b.is_ascii_alphanumeric());
    is_random.then_some(whole)
}

/// Is this the temporary file of a killed process that was writing the file `whole`?
pub(crate) fn is_leftover_of(name: &OsStr, whole: &str) -> bool {
    name.to_str().and_then(leftover_of) == Some(whole)
}

/// Removes the temporary files that killed processes left of the files that `is_ours` names. Only for
/// a folder that this process has locked: elsewhere a file may be in use.
///
/// # Errors
/// Those of the file system.
pub(crate) fn remove_leftovers(folder: &Path, is_ours: impl Fn(&str) -> bool) -> io::Result<()> {
    for entry in folder.read_dir()? {
        let entry = entry?;
        let name = entry.file_name();
        if name.to_str().and_then(leftover_of).is_some_and(&is_ours) {
            remove(&entry.path())?;
        }
    }
    Ok(())
}

/// Gives a file that is safely on the disk its name, and brings the name to the disk, too.
///
/// # Errors
/// Those of the file system.
pub(crate) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)?;
    sync_folder(folder_of(to))
}

/// The folder of a file that is to be there.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn sync_folder(folder: &Path) -> io::Result<()> {
    // Only Unix can do so for a folder.
    match cfg!(unix) {
        true => File::open(folder)?.sync_all(),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    #[test]
    fn many_writers_of_one_file_at_once_leave_one_of_their_files_whole_and_all_succeed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tasks.json");
        let content = |writer: u8| vec![writer; 50_000 + usize::from(writer)];
        thread::scope(|scope| {
            let write = |writer: u8| {
                let path = &path;
                scope.spawn(move || {
                    for _ in 0..20 {
                        replace(path, &content(writer)).unwrap();
                        let read = fs::read(path).unwrap();
                        assert_eq!(read, content(read[0]), "mixed");
                    }
                })
            };
            (1..=8).for_each(|writer| drop(write(writer)));
        });
        let left = folder.path().read_dir().unwrap().count();
        assert_eq!(left, 1, "temporary files were left");
    }

    #[test]
    fn what_a_killed_writer_left_is_told_from_files_of_others_and_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint");
        let (_, left) = aside(&path).unwrap().keep().unwrap();
        assert!(is_leftover_of(left.file_name().unwrap(), "checkpoint"));
        let foreign = [
            "checkpoint.part",
            ".checkpoint.tmp",
            ".notes.abcdef.tmp",
            "notes.tmp",
        ];
        for name in foreign {
            fs::write(folder.path().join(name), "mine").unwrap();
        }
        remove_leftovers(folder.path(), |whole| whole == "checkpoint").unwrap();
        assert!(!left.exists());
        assert!(foreign.iter().all(|name| folder.path().join(name).exists()));
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        replace(&path, b"old").unwrap();
        let failing = |file: &mut dyn Write| {
            file.write_all(b"new")?;
            Err(io::Error::other("no more"))
        };
        assert!(replace_with(&path, failing).is_err());
        assert!(keep_or_create(&path, failing).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(folder.path().read_dir().unwrap().count(), 1);
    }
}
