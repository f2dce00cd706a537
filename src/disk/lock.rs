//! A folder that one process alone works in.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

/// The file that is locked; it holds the number of the process.
pub const LOCK: &str = "run.lock";
/// Room for the number of a process.
const MOST_BYTES: u64 = 64;
/// How often a lock is tried whose holder is just coming or going ...
const TRIES: usize = 50;
/// ... and the pause between two tries.
const PAUSE: Duration = Duration::from_millis(5);

/// A folder that this process alone works in, until this is dropped. The lock is the system's, and
/// goes with the process however that ends: a file that a killed process leaves locks nobody out.
#[derive(Debug)]
pub struct FolderLock {
    file: File,
    path: PathBuf,
}

/// Why there is no lock.
#[derive(Debug)]
pub enum LockError {
    /// Another process has it: its number, if it could be read.
    Held(Option<u32>),
    /// The file of the lock cannot be used.
    File(PathBuf, io::Error),
}

impl FolderLock {
    /// Locks a folder that exists.
    pub fn acquire(folder: &Path) -> Result<Self, LockError> {
        let path = folder.join(LOCK);
        let fault = |cause| LockError::File(path.clone(), cause);
        if is_foreign_lock(&path) {
            let message = "it was not made by this program; move it away";
            return Err(fault(io::Error::other(message)));
        }
        let mut holder = None;
        for _ in 0..TRIES {
            let file = open(&path).map_err(fault)?;
            match file.try_lock() {
                Ok(()) => {
                    let mut lock = Self {
                        file,
                        path: path.clone(),
                    };
                    if lock.sign().map_err(fault)? {
                        return Ok(lock);
                    }
                }
                Err(TryLockError::WouldBlock) => {
                    holder = pid_in(&path).ok().flatten();
                    if holder.is_some() {
                        break;
                    }
                }
                Err(TryLockError::Error(cause)) => return Err(fault(cause)),
            }
            sleep(PAUSE);
        }
        Err(LockError::Held(holder))
    }

    /// Writes down who holds the lock. False when the file was removed in the meantime by the
    /// holder before: then somebody else may lock a new one.
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
        // A file that cannot be removed does no harm: the lock itself ends with the process.
        let _ = fs::remove_file(&self.path);
        let _ = self.file.unlock();
    }
}

/// Opens the file or makes it; never follows a link to a file elsewhere.
fn open(path: &Path) -> io::Result<File> {
    super::require_plain(path)?;
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false).open(path)
}

/// Is there a file of this name that no process left which worked in the folder? Those hold the
/// number of their process, or nothing yet.
pub fn is_foreign_lock(path: &Path) -> bool {
    match super::read_text(path, MOST_BYTES) {
        Ok(text) => !text
            .bytes()
            .all(|byte| byte.is_ascii_digit() || byte == b'\n'),
        Err(cause) => cause.kind() != io::ErrorKind::NotFound,
    }
}

/// The process that a lock names; `None` when it names none, or is gone.
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
