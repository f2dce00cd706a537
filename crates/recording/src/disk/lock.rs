//! A lock on a folder that allows only one process to work in it.

use std::collections::hash_map::RandomState;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use crate::error::{Error, ErrorKind};

/// The name of the lock file. It contains the process id of the holder, and a number that differs
/// between two locks.
pub const LOCK: &str = "run.lock";
/// The most bytes that are read of a lock file.
const MOST_BYTES: u64 = 64;
/// Number of attempts to acquire a lock whose holder is just starting or exiting.
const TRIES: usize = 50;
/// Pause between two attempts.
const PAUSE: Duration = Duration::from_millis(5);

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
        let mut holder = None;
        for _ in 0..TRIES {
            let file = open(&path).map_err(&fault)?;
            match file.try_lock() {
                Ok(()) => {
                    if let Some(lock) = Self::signed(file, &path).map_err(&fault)? {
                        return Ok(lock);
                    }
                }
                Err(TryLockError::WouldBlock) => {
                    holder = pid_in(&path).ok().flatten();
                    if holder.is_some() {
                        break;
                    }
                }
                Err(TryLockError::Error(cause)) if has_no_locks(&cause) => {
                    return Ok(Self { file: None, path });
                }
                Err(TryLockError::Error(cause)) => return Err(fault(cause)),
            }
            sleep(PAUSE);
        }
        let holder = holder.map_or("another process".to_owned(), |pid| format!("process {pid}"));
        let message = format!(
            "{} is in use by {holder}: wait for it, or use another folder",
            folder.display()
        );
        Err(ErrorKind::CannotCreate.error(message))
    }

    /// Writes the process id into a locked file. Returns `None` if the previous holder has removed
    /// this file in the meantime. The file at `path` may then be the lock of another process, which
    /// must stay.
    fn signed(mut file: File, path: &Path) -> io::Result<Option<Self>> {
        let number = RandomState::new().build_hasher().finish();
        let signature = format!("{}\n{number}\n", std::process::id());
        file.set_len(0)?;
        file.rewind()?;
        file.write_all(signature.as_bytes())?;
        let is_current = contents(path)?.is_some_and(|text| text == signature);
        Ok(is_current.then(|| Self {
            file: Some(file),
            path: path.to_owned(),
        }))
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if let Some(file) = &self.file {
            // A lock file that cannot be removed is harmless: the lock ends with the process.
            let _ = fs::remove_file(&self.path);
            let _ = file.unlock();
        }
    }
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
    let file = match is_foreign_lock(&path) {
        true => return false,
        false => File::open(path),
    };
    // The shared lock ends at once, with the file.
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// Returns the process id in a lock file; `None` if there is no id or no file.
fn pid_in(path: &Path) -> io::Result<Option<u32>> {
    let text = contents(path)?.unwrap_or_default();
    Ok(text.lines().next().and_then(|line| line.parse().ok()))
}

/// Returns the text of a lock file; `None` if there is no such file, or it has other contents.
fn contents(path: &Path) -> io::Result<Option<String>> {
    match super::read_text(path, MOST_BYTES) {
        Ok(text) => Ok(Some(text)),
        Err(cause) => match cause.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::InvalidData | io::ErrorKind::FileTooLarge => {
                Ok(None)
            }
            _ => Err(cause),
        },
    }
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
        assert!(FolderLock::signed(late, &path).unwrap().is_none());
        assert!(path.exists(), "the holder's file is removed");
        acquire(folder.path()).unwrap_err();
        assert!(is_in_use(folder.path()));
        // Control: the lock ends with its holder, and leaves no file.
        drop(holder);
        drop(acquire(folder.path()).unwrap());
        assert!(!path.exists());
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
