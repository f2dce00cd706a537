//! Where the bytes of a recording go.

use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};

/// A file that is written, or a complete file that is written again only in thought.
pub enum Target {
    /// A new file.
    New(BufWriter<File>),
    /// A complete file. It stays as it is, and every byte must be the next one in it.
    Complete(BufReader<File>),
}

impl Target {
    /// Ends the file and syncs it to disk. Returns its size in bytes.
    ///
    /// # Errors
    /// Errors of the file system. [`io::ErrorKind::InvalidData`] if a complete file is longer.
    pub fn finish(self) -> io::Result<u64> {
        match self {
            Self::New(file) => {
                let file = file.into_inner()?;
                file.sync_all()?;
                Ok(file.metadata()?.len())
            }
            Self::Complete(mut file) => match file.read(&mut [0])? {
                0 => Ok(file.get_ref().metadata()?.len()),
                _ => Err(different()),
            },
        }
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::New(file) => file.write(bytes),
            Self::Complete(file) => {
                let there = file.fill_buf()?;
                let length = bytes.len().min(there.len());
                let is_same = there[..length] == bytes[..length];
                if !is_same || length == 0 && !bytes.is_empty() {
                    return Err(different());
                }
                file.consume(length);
                Ok(length)
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::New(file) => file.flush(),
            Self::Complete(_) => Ok(()),
        }
    }
}

fn different() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "its bytes are different")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Seek;

    /// Writes `again` over a complete file with the bytes `0123456789`.
    fn written_again(again: &[u8]) -> io::Result<u64> {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(b"0123456789").unwrap();
        file.rewind().unwrap();
        let mut target = Target::Complete(BufReader::with_capacity(4, file));
        target.write_all(again)?;
        target.finish()
    }

    #[test]
    fn only_the_same_bytes_are_accepted_for_a_complete_file() {
        assert_eq!(written_again(b"0123456789").unwrap(), 10);
        for other in ["0123456788", "1123456789", "012345678", "01234567890", ""] {
            let fault = written_again(other.as_bytes()).unwrap_err();
            assert_eq!(fault.kind(), io::ErrorKind::InvalidData, "{other}");
        }
    }
}
