//! A lock on a folder that allows only one process to work in it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use crate::error::{Error, ErrorKind};

/// The name of the lock file. It contains the process id of the holder.
pub const LOCK: &str = "run.lock";
/// The most bytes that are read of a lock file.
const MOST_BYTES: u64 = 64;
/// Number of attempts to acquire a lock whose holder is just starting or exiting.
const TRIES: usize = 50;
/// Pause between two attempts.
const PAUSE: Duration = Duration::from_millis(5);

/// Exclusive use of a folder by this process, until the lock is dropped. The operating system
/// releases the lock when the process ends, so a lock file left by a killed process blocks nobody.
#[derive(Debug)]
pub struct FolderLock {
    file: File,
    path: PathBuf,
}

impl FolderLock {
    /// Locks an existing folder. `fault` converts an error of the lock file.
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
                Err(TryLockError::Error(cause)) if !has_no_locks(&cause) => {
                    return Err(fault(cause));
                }
                // Without locks, the file only shows that a process works here.
                Ok(()) | Err(TryLockError::Error(_)) => {
                    let mut lock = Self {
                        file,
                        path: path.clone(),
                    };
                    if lock.sign().map_err(&fault)? {
                        return Ok(lock);
                    }
                }
                Err(TryLockError::WouldBlock) => {
                    holder = pid_in(&path).ok().flatten();
                    if holder.is_some() {
                        break;
                    }
                }
            }
            sleep(PAUSE);
        }
        let holder = holder.map_or("another process".to_owned(), |pid| format!("process {pid}"));
        let message = format!(
            "{} is in use by {holder}: wait for it, or choose another folder with `--out`",
            folder.display()
        );
        Err(ErrorKind::CannotCreate.error(message))
    }

    /// Writes the process id into the lock file. Returns false if the previous holder has removed
    /// the file in the meantime: another process may then lock a new file.
    fn sign(&mut self) -> io::Result<bool> {
        let pid = std::process::id();
        self.file.set_len(0)?;
        self.file.rewind()?;
        writeln!(self.file, "{pid}")?;
        Ok(pid_in(&self.path)? == Some(pid))
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // A lock file that cannot be removed is harmless: the lock ends with the process.
        let _ = fs::remove_file(&self.path);
        let _ = self.file.unlock();
    }
}

/// Returns true if the error is that of a file system without locks, such as Lustre's default.
fn has_no_locks(cause: &io::Error) -> bool {
    /// The code of "no locks available".
    #[cfg(target_os = "linux")]
    const NO_LOCKS: Option<i32> = Some(37);
    #[cfg(not(target_os = "linux"))]
    const NO_LOCKS: Option<i32> = Some(77);
    cause.kind() == io::ErrorKind::Unsupported || cause.raw_os_error() == NO_LOCKS
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

/// Returns the process id in a lock file; `None` if there is no id or no file.
fn pid_in(path: &Path) -> io::Result<Option<u32>> {
    match super::read_text(path, MOST_BYTES) {
        Ok(text) => Ok(text.trim().parse().ok()),
        Err(cause) => match cause.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::InvalidData | io::ErrorKind::FileTooLarge => {
                Ok(None)
            }
            _ => Err(cause),
        },
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_file_system_without_locks_is_told_from_a_fault() {
        // ENOSYS, EOPNOTSUPP and ENOLCK; then EIO, EACCES and ENOSPC.
        let is_lockless = |code: &i32| has_no_locks(&io::Error::from_raw_os_error(*code));
        assert!([38, 95, 37].iter().all(is_lockless));
        assert!(![5, 13, 28].iter().any(is_lockless));
    }
}
