//! Reads and writes files.

mod atomic;
mod error;
mod lock;
mod typed;

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use serde::Serialize;

pub use atomic::write;
pub use atomic::{
    is_leftover_of, keep_or_create, leftover_of, remove_leftovers, replace, replace_with,
};
pub use error::{cannot_create, cannot_read, cannot_write};
pub use lock::is_in_use;
pub use lock::{FolderLock, LOCK, is_foreign_lock};
pub use typed::{named, typed};
pub use xcscr_robot::input::read_text;
pub use xcscr_robot::input::{open, read};

/// Returns the name of an unfinished recording.
pub fn part(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

/// Returns plain data as the text of a JSON file.
pub fn json(value: &impl Serialize) -> String {
    let text = serde_json::to_string_pretty(value).expect("plain data becomes JSON");
    text + "\n"
}

/// The most bytes read of any input. This is more than this program writes into any file that it
/// reads as a whole, and small enough for any machine.
pub const MOST_BYTES: u64 = 1 << 30;

/// Returns the memory that an input of `bytes` may take: ten times its size plus 64 MiB.
pub fn room_for(bytes: u64) -> u64 {
    bytes.saturating_mul(10).saturating_add(64 << 20)
}

/// Returns the limit on the total unpacked size of an input of `bytes` packed bytes. A recording of
/// a robot in a hall without landmarks unpacks to 120 times its size. The limit of 200 times allows
/// it, and keeps the time to read a small file short.
pub fn most_unpacked(bytes: u64) -> u64 {
    bytes.saturating_mul(200).saturating_add(16 << 20)
}

/// Rejects a path that exists and is not a regular file, such as a link or a device. Call it before
/// writing to the path.
///
/// # Errors
/// When the path exists and is not a regular file.
pub fn require_plain(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if !found.is_file() => {
            let message = "it is not a regular file, so it was not made by this program; remove it";
            Err(io::Error::other(message))
        }
        _ => Ok(()),
    }
}

/// Returns a hint for a file that cannot be created: a remedy for the cause, or else `place`.
pub fn way_out_or(cause: &io::Error, place: &'static str) -> &'static str {
    match way_out(cause) {
        "" => place,
        way => way,
    }
}

/// Creates a new file and replaces an existing one. A link of this name is replaced, not followed.
///
/// # Errors
/// Errors of the file system.
pub fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// Removes a file if it exists.
///
/// # Errors
/// Errors of the file system. A missing file is not an error.
pub fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(cause) if cause.kind() != io::ErrorKind::NotFound => Err(cause),
        _ => Ok(()),
    }
}

/// Returns true if the path exists and is anything other than a file with exactly these bytes.
///
/// # Errors
/// Errors of the file system. A missing file is not an error.
pub fn differs(path: &Path, bytes: &[u8]) -> io::Result<bool> {
    differs_from(path, bytes.len() as u64, bytes)
}

/// Like [`differs`], for `length` bytes that are read from `bytes`.
fn differs_from(path: &Path, length: u64, bytes: impl Read) -> io::Result<bool> {
    match fs::symlink_metadata(path) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(cause) => Err(cause),
        Ok(found) if found.is_file() && found.len() == length => {
            let (there, wanted) = (BufReader::new(File::open(path)?), BufReader::new(bytes));
            let mut pairs = there.bytes().zip(wanted.bytes());
            pairs.try_fold(false, |differs, (a, b)| Ok(differs || a? != b?))
        }
        Ok(_) => Ok(true),
    }
}

/// Rejects a path that exists, unless `force` allows a regular file to be replaced. A link is never replaced, because
/// its target may be what the user means.
///
/// # Errors
/// [`io::ErrorKind::AlreadyExists`], with the remedy.
pub fn require_free(path: &Path, force: bool) -> io::Result<()> {
    let exists = |what| Err(io::Error::new(io::ErrorKind::AlreadyExists, what));
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => {
            exists("it is a link: name the file that it leads to, or remove it")
        }
        Ok(found) if !found.is_file() => exists("it is not a regular file"),
        Ok(_) if !force => exists("it exists (replace it with `--force`)"),
        _ => Ok(()),
    }
}

/// Like [`way_out`], for a file that is written. Only its folder can be missing then.
pub fn way_out_of_writing(cause: &io::Error) -> &'static str {
    match cause.kind() {
        io::ErrorKind::NotFound => "; its folder is gone",
        _ => way_out(cause),
    }
}

/// Returns a hint for an error of the file system, as the end of a message. Empty if there is no
/// hint.
pub fn way_out(cause: &io::Error) -> &'static str {
    /// The codes for the limit of this process and of the whole system.
    #[cfg(unix)]
    const TOO_MANY_OPEN_FILES: [i32; 2] = [24, 23];
    #[cfg(not(unix))]
    const TOO_MANY_OPEN_FILES: [i32; 1] = [4];
    match (cause.kind(), cause.raw_os_error()) {
        _ if is_full(cause) => "; free some space",
        (_, Some(code)) if TOO_MANY_OPEN_FILES.contains(&code) => {
            "; allow more open files (`ulimit -n`), or close some"
        }
        _ => "",
    }
}

/// Returns true if the disk, the quota or the file-size limit is exhausted.
pub fn is_full(cause: &io::Error) -> bool {
    use io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    matches!(cause.kind(), StorageFull | QuotaExceeded | FileTooLarge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_different_content_differs() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        assert!(!differs(&path, b"ours").unwrap(), "nothing is there");
        fs::write(&path, "ours").unwrap();
        assert!(!differs(&path, b"ours").unwrap());
        assert!(differs(&path, b"hers").unwrap() && differs(&path, b"our").unwrap());
        assert!(differs(folder.path(), b"").unwrap(), "a folder");
    }
}
