//! Files that are there whole or not at all.

mod lock;

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

pub use lock::{FolderLock, LOCK, LockError};

/// The name under which a file is written until it is whole.
pub fn part(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

/// Opens a file to be read. Pipes, devices and folders are refused at once: those may have no end,
/// or wait for ever for a writer.
///
/// # Errors
/// Those of the file system, and [`io::ErrorKind::InvalidInput`].
pub fn open(path: &Path) -> io::Result<File> {
    // Before it is opened: opening a pipe waits.
    match fs::metadata(path)?.is_file() {
        true => File::open(path),
        false => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is not a regular file",
        )),
    }
}

/// Reads a file of at most so many bytes: an endless one, such as a device, fills no memory.
///
/// # Errors
/// Those of the file system, and [`io::ErrorKind::FileTooLarge`].
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let message = format!("it is larger than {} MiB", most >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

/// The same for a file of text.
///
/// # Errors
/// The same, and [`io::ErrorKind::InvalidData`] when it is no UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let text = String::from_utf8(read(path, most)?);
    text.map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text"))
}

/// Reads a file of any size, but no device and no pipe: those may have no end.
///
/// # Errors
/// Those of the file system.
pub fn read_plain(path: &Path) -> io::Result<Vec<u8>> {
    match fs::metadata(path)?.is_file() {
        true => fs::read(path),
        false => Err(io::Error::other("it is not a regular file")),
    }
}

/// Refuses a name that leads elsewhere, before it is written to: a link, or a device.
///
/// # Errors
/// When there is something, and it is not a regular file.
pub fn require_plain(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if !found.is_file() => {
            let message = "it is not a regular file, so it was not made by this program; remove it";
            Err(io::Error::other(message))
        }
        _ => Ok(()),
    }
}

/// Makes a new file in place of an older one. A link of this name is replaced, never followed.
///
/// # Errors
/// Those of the file system.
pub fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// Removes a file that may be there.
///
/// # Errors
/// Those of the file system; that there is no such file is none.
pub fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(cause) if cause.kind() != io::ErrorKind::NotFound => Err(cause),
        _ => Ok(()),
    }
}

/// Writes a file so that after a crash or a power failure either the old one is there or the new
/// one: aside, to the disk, into its place.
///
/// # Errors
/// Those of the file system; then the old file is untouched.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let part = part(path);
    let written = create(&part).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    if let Err(cause) = written {
        // It may lie on a full disk, where its space is needed.
        let _ = fs::remove_file(&part);
        return Err(cause);
    }
    rename(&part, path)
}

/// The same among files of somebody else: the file that lies aside has a name of its own, so that
/// none of them is overwritten.
///
/// # Errors
/// Those of the file system; then the old file is untouched.
pub fn replace_among_others(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut aside = aside(path)?;
    aside.write_all(bytes)?;
    persist(aside, path)
}

/// A file beside `path` with a name that nothing has; it vanishes unless it is
/// [persisted](persist).
///
/// # Errors
/// Those of the file system.
pub fn aside(path: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".").suffix(".tmp");
    // As readable as other files: a temporary file is otherwise for its owner alone.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(path))
}

/// Brings a file that lies aside to the disk, and gives it its name.
///
/// # Errors
/// Those of the file system; then the old file is untouched.
pub fn persist(aside: NamedTempFile, path: &Path) -> io::Result<()> {
    aside.as_file().sync_all()?;
    aside.persist(path).map_err(|fault| fault.error)?;
    sync_folder(folder_of(path))
}

/// Gives a file that is safely on the disk its name, and brings the name to the disk, too.
///
/// # Errors
/// Those of the file system.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
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

/// A path as it can be typed in a shell: in quotes where it needs them, and never an option.
pub fn typed(path: &Path) -> String {
    let text = path.display().to_string();
    let text = match text.starts_with('-') {
        true => format!("./{text}"),
        false => text,
    };
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./+:,@%=".contains(c);
    match !text.is_empty() && text.chars().all(is_plain) {
        true => text,
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_shown_as_it_can_be_typed() {
        for (path, shown) in [
            ("runs/maze4-s1", "runs/maze4-s1"),
            ("my run", "'my run'"),
            ("-x", "./-x"),
            ("it's", r"'it'\''s'"),
            ("$HOME", "'$HOME'"),
        ] {
            assert_eq!(typed(Path::new(path)), shown);
        }
    }
}
