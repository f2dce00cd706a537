//! Reads input files: regular files of limited size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Opens a file for reading. Refuses pipes, devices and folders, which may be endless or block
/// while waiting for a writer.
///
/// # Errors
/// Those of the file system, and [`io::ErrorKind::InvalidInput`].
pub fn open(path: &Path) -> io::Result<File> {
    // Check before opening, because opening a pipe blocks.
    match fs::metadata(path)?.is_file() {
        true => File::open(path),
        false => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is not a regular file",
        )),
    }
}

/// Reads a file of at most `most` bytes. Refuses a larger file before reading any of it.
///
/// # Errors
/// Those of the file system and of [`open`], and [`io::ErrorKind::FileTooLarge`].
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let mut bytes = Vec::new();
    let size = file.metadata()?.len();
    if size <= most {
        // The file may grow while it is read, and some system files report no size.
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

/// Reads a text file of at most `most` bytes.
///
/// # Errors
/// Those of [`read`], and [`io::ErrorKind::InvalidData`] if the file is not UTF-8.
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
