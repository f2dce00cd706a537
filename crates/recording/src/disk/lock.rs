//! A lock on a folder that allows only one process to work in it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, ErrorKind};

/// The name of the lock file. It contains the process id of the holder.
pub const LOCK: &str = "run.lock";
/// The most bytes that are read of a lock file.
const MOST_BYTES: u64 = 64;

/// Error codes of file systems without locks: ENOSYS, ENOTSUP, ENOLCK.
#[cfg(target_os = "linux")]
const WITHOUT_LOCKS: [i32; 3] = [38, 95, 37];
#[cfg(target_os = "macos")]
const WITHOUT_LOCKS: [i32; 3] = [78, 45, 77];
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
const WITHOUT_LOCKS: [i32; 0] = [];

/// Exclusive use of a folder by this process, until the lock is dropped. The operating system
/// releases the lock when the process ends, so a lock file left by a killed process blocks nobody.
/// A file system without locks protects nothing: the caller is then responsible.
#[derive(Debug)]
pub struct FolderLock {
    /// The locked file; `None` on a file system without locks.
    file: Option<File>,
    path: PathBuf,
}

impl FolderLock {
    /// Locks an existing folder. `fault` converts an error of the lock file.
    ///
    /// # Errors
    /// When another process holds the lock, or the lock file cannot be created.
    pub fn acquire(folder: &Path, fault: impl Fn(io::Error) -> Error) -> Result<Self, Error> {
        let path = folder.join(LOCK);
        if is_foreign_lock(&path) {
            let message = "it was not made by this program; move it away";
            return Err(fault(io::Error::other(message)));
        }
        loop {
            let mut file = open(&path).map_err(&fault)?;
            match file.try_lock() {
                Ok(()) if is_at(&file, &path).map_err(&fault)? => {
                    sign(&mut file).map_err(&fault)?;
                    let file = Some(file);
                    return Ok(Self { file, path });
                }
                // The previous holder has removed this file in the meantime.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(in_use(folder, &path)),
                Err(TryLockError::Error(cause)) if has_no_locks(&cause) => {
                    return Ok(Self { file: None, path });
                }
                Err(TryLockError::Error(cause)) => return Err(fault(cause)),
            }
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if let Some(file) = &self.file {
            // Where `is_at` cannot compare files, the file must stay. A lock file that stays is
            // harmless: the lock ends with the process.
            if cfg!(unix) {
                let _ = fs::remove_file(&self.path);
            }
            let _ = file.unlock();
        }
    }
}

/// Writes the process id into a locked file.
fn sign(file: &mut File) -> io::Result<()> {
    file.set_len(0)?;
    file.write_all(format!("{}\n", std::process::id()).as_bytes())
}

/// Returns true if an open file is the one at a path. Otherwise the file at the path may be the lock of another
/// process.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let ours = file.metadata()?;
    match fs::symlink_metadata(path) {
        Ok(there) => Ok((ours.dev(), ours.ino()) == (there.dev(), there.ino())),
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(cause) => Err(cause),
    }
}

#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> io::Result<bool> {
    Ok(true)
}

/// Returns the error for a folder that another process has locked.
fn in_use(folder: &Path, lock: &Path) -> Error {
    let text = super::read_text(lock, MOST_BYTES).unwrap_or_default();
    let holder = match text.trim().parse::<u32>() {
        Ok(pid) => format!("process {pid}"),
        Err(_) => "another process".to_owned(),
    };
    let folder = folder.display();
    ErrorKind::CannotCreate.error(format!(
        "{folder} is in use by {holder}: wait for it, or use another folder"
    ))
}

/// Returns true for the error of a file system that has no locks, such as Lustre without `flock`.
fn has_no_locks(cause: &io::Error) -> bool {
    let code = cause.raw_os_error();
    cause.kind() == io::ErrorKind::Unsupported
        || code.is_some_and(|code| WITHOUT_LOCKS.contains(&code))
}

/// Opens or creates the lock file. Never follows a link.
fn open(path: &Path) -> io::Result<File> {
    super::require_plain(path)?;
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false).open(path)
}

/// Returns true if a file of this name exists that is not a lock file of this program. A lock file
/// contains only a process id, or is empty.
pub fn is_foreign_lock(path: &Path) -> bool {
    match super::read_text(path, MOST_BYTES) {
        Ok(text) => !text
            .bytes()
            .all(|byte| byte.is_ascii_digit() || byte == b'\n'),
        Err(cause) => cause.kind() != io::ErrorKind::NotFound,
    }
}

/// Returns true if another process works in a folder. A lock file that a killed process left does not count.
pub fn is_in_use(folder: &Path) -> bool {
    let path = folder.join(LOCK);
    let file = if is_foreign_lock(&path) {
        return false;
    } else {
        File::open(path)
    };
    // The shared lock ends at once, with the file.
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn acquire(folder: &Path) -> Result<FolderLock, Error> {
        FolderLock::acquire(folder, crate::disk::cannot_create(folder))
    }

    #[test]
    fn a_lock_on_a_removed_file_leaves_the_lock_of_the_next_holder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(LOCK);
        let first = acquire(folder.path()).unwrap();
        let late = open(&path).unwrap();
        drop(first);
        let holder = acquire(folder.path()).unwrap();
        late.try_lock().unwrap();
        assert!(!is_at(&late, &path).unwrap());
        assert!(path.exists(), "the holder's file is removed");
        acquire(folder.path()).unwrap_err();
        assert!(is_in_use(folder.path()));
        // Control: the lock ends with its holder, and leaves no file.
        drop(holder);
        drop(acquire(folder.path()).unwrap());
        assert!(!path.exists());
        // A copy is not the locked file, although it reads the same.
        let copied = open(&path).unwrap();
        fs::copy(&path, folder.path().join("copy")).unwrap();
        fs::rename(folder.path().join("copy"), &path).unwrap();
        assert!(!is_at(&copied, &path).unwrap() && is_at(&open(&path).unwrap(), &path).unwrap());
        fs::write(&path, "123\n").unwrap();
        assert!(!is_in_use(folder.path()), "left by a killed process");
    }

    #[cfg(any(target_os = "linux", target_os = "macos"))]
    #[test]
    fn only_the_errors_of_a_file_system_without_locks_count_as_such() {
        for code in WITHOUT_LOCKS {
            assert!(has_no_locks(&io::Error::from_raw_os_error(code)), "{code}");
        }
        // EIO, EACCES and ENOSPC.
        for code in [5, 13, 28] {
            assert!(!has_no_locks(&io::Error::from_raw_os_error(code)), "{code}");
        }
    }
}
