//! Atomic file writes: after a write, a file is either complete or unchanged. Each writer uses its
//! own temporary file, so that concurrent writers of one file cannot mix their bytes.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use super::{differs_from, remove};

/// Number of random characters in the name of a temporary file.
const RANDOM: usize = 6;
/// Suffix of the name of a temporary file.
const SUFFIX: &str = ".tmp";
/// Longest file name that is included in the temporary name, so that both fit into 255 bytes.
const MOST_NAME: usize = 200;

/// Writes a file. `force` allows it to replace an existing file. After a crash or a power failure,
/// the path holds either the old file or the new one.
///
/// # Errors
/// Errors of the file system. The old file is then unchanged.
pub fn write(path: &Path, bytes: &[u8], force: bool) -> io::Result<()> {
    let temporary = written_temporary(path, |file| file.write_all(bytes))?;
    persist(temporary, path, force)
}

/// Writes a file and replaces an existing one; see [`write()`].
///
/// # Errors
/// The same as [`write()`].
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write(path, bytes, true)
}

/// Like [`replace`], for content that is written piece by piece.
///
/// # Errors
/// The same as [`write()`], and the errors of the `write` argument.
pub fn replace_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    persist(written_temporary(path, write)?, path, true)
}

/// Like [`replace_with`], but keeps an existing file with different content. Returns true if the
/// file holds the written content.
///
/// # Errors
/// The same as [`replace_with`].
pub fn keep_or_create(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<bool> {
    let temporary = written_temporary(path, write)?;
    let written = temporary.reopen()?;
    if differs_from(path, written.metadata()?.len(), written)? {
        Ok(false)
    } else {
        persist(temporary, path, true).map(|()| true)
    }
}

/// Writes a temporary file. If writing fails, the file is removed at once: the disk may be full.
fn written_temporary(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<NamedTempFile> {
    let mut file = BufWriter::new(aside(path)?);
    write(&mut file)?;
    Ok(file.into_inner()?)
}

/// Creates a temporary file `.NAME.RANDOM.tmp` next to `path`. It is removed when dropped, unless
/// it is [persisted](persist).
///
/// # Errors
/// Errors of the file system.
pub fn aside(path: &Path) -> io::Result<NamedTempFile> {
    let name = path.file_name().filter(|name| name.len() <= MOST_NAME);
    let mut prefix = OsStr::new(".").to_owned();
    if let Some(name) = name {
        prefix.push(name);
        prefix.push(".");
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM);
    // By default, a temporary file is readable only by its owner.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(path))
}

/// Syncs a temporary file to disk and renames it to `path`. `force` allows it to replace an
/// existing file. A symbolic link at `path` is replaced, not followed.
///
/// # Errors
/// Errors of the file system. The old file is then unchanged.
pub fn persist(temporary: NamedTempFile, path: &Path, force: bool) -> io::Result<()> {
    temporary.as_file().sync_all()?;
    let named = if force {
        temporary.persist(path)
    } else {
        temporary.persist_noclobber(path)
    };
    named.map_err(|fault| fault.error)?;
    // The file has its name. Some folders cannot be opened or synced.
    let _ = sync_folder(folder_of(path));
    Ok(())
}

/// Returns the name of the target file if `name` is the name of a temporary file.
pub fn leftover_of(name: &str) -> Option<&str> {
    let (whole, random) = name
        .strip_prefix('.')?
        .strip_suffix(SUFFIX)?
        .rsplit_once('.')?;
    let is_random = random.len() == RANDOM && random.bytes().all(|b| b.is_ascii_alphanumeric());
    is_random.then_some(whole)
}

/// Returns true if `name` is a temporary file that was left by an interrupted write of `whole`.
pub fn is_leftover_of(name: &OsStr, whole: &str) -> bool {
    name.to_str().and_then(leftover_of) == Some(whole)
}

/// Removes the temporary files left by killed processes, for the target files accepted by
/// `is_ours`. Call it only in a folder that this process has locked: elsewhere, a temporary file
/// may be in use.
///
/// # Errors
/// Errors of the file system.
pub fn remove_leftovers(folder: &Path, is_ours: impl Fn(&str) -> bool) -> io::Result<()> {
    for entry in folder.read_dir()? {
        let entry = entry?;
        let name = entry.file_name();
        if name.to_str().and_then(leftover_of).is_some_and(&is_ours) {
            remove(&entry.path())?;
        }
    }
    Ok(())
}

/// Returns the parent folder of a path.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn sync_folder(folder: &Path) -> io::Result<()> {
    // Only Unix can sync a folder.
    if cfg!(unix) {
        File::open(folder)?.sync_all()
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::thread;

    #[test]
    fn concurrent_writers_of_one_file_all_succeed_and_leave_one_complete_file() {
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
    fn temporary_files_of_killed_writers_are_removed_and_other_files_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rules.json");
        let (_, left) = aside(&path).unwrap().keep().unwrap();
        assert!(is_leftover_of(left.file_name().unwrap(), "rules.json"));
        let foreign = [
            "rules.json.part",
            ".rules.json.tmp",
            ".notes.abcdef.tmp",
            "notes.tmp",
        ];
        for name in foreign {
            fs::write(folder.path().join(name), "mine").unwrap();
        }
        remove_leftovers(folder.path(), |whole| whole == "rules.json").unwrap();
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
