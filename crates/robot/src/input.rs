//! Reads input files: regular files of a limited size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

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

/// Reads a file of at most so many bytes. A larger one is refused before any of it is read.
///
/// # Errors
/// Those of the file system and of [`open`], and [`io::ErrorKind::FileTooLarge`].
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let mut bytes = Vec::new();
    let size = file.metadata()?.len();
    if size <= most {
        // It may grow while it is read, and some files of the system do not know their size.
        file.take(most + 1).read_to_end(&mut bytes)?;
    }
    match size.max(bytes.len() as u64) > most {
        false => Ok(bytes),
        true => {
            let message = format!("it is larger than {}", amount(most));
            Err(io::Error::new(io::ErrorKind::FileTooLarge, message))
        }
    }
}

fn amount(bytes: u64) -> String {
    match bytes >> 20 {
        0 => format!("{bytes} bytes"),
        mib => format!("{mib} MiB"),
    }
}

/// The same for a file of text.
///
/// # Errors
/// The same, and [`io::ErrorKind::InvalidData`] when it is no UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let text = String::from_utf8(read(path, most)?);
    text.map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::NamedTempFile;

    #[test]
    fn a_file_beyond_its_limit_is_refused_before_it_is_read() {
        let file = NamedTempFile::new().unwrap();
        file.as_file().set_len(1 << 40).unwrap();
        let fault = read(file.path(), 1 << 30).unwrap_err();
        assert_eq!(fault.kind(), io::ErrorKind::FileTooLarge);
        assert_eq!(fault.to_string(), "it is larger than 1024 MiB");
        file.as_file().set_len(1000).unwrap();
        assert_eq!(read(file.path(), 1000).unwrap().len(), 1000);
        assert!(read(file.path(), 999).is_err());
    }
}
