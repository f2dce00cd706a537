//! Recovery of a complete recording from a damaged file.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::Path;

use mcap::{MAGIC, McapError, McapResult};

use super::records::{Recovery, copy_records};
use crate::disk;
use crate::error::{Error, ErrorKind};
use crate::record::error;
use crate::record::read::reader::Recording;

/// Copies all complete records of `input` to a complete recording `output`. The recording is read
/// back before it gets its name. An existing `output` is replaced only if `force` is set.
///
/// # Errors
/// If `input` cannot be read or is not an MCAP file, or `output` cannot be written or read back.
pub fn recover(input: &Path, output: &Path, force: bool) -> Result<Recovery, Error> {
    let bytes = disk::read(input, disk::MOST_BYTES).map_err(error::unread(input))?;
    refuse(input, output, force).map_err(disk::cannot_create(output))?;
    if !bytes.starts_with(MAGIC) {
        return Err(error::foreign(input, &bytes));
    }
    let temporary = disk::aside(output).map_err(disk::cannot_create(output))?;
    let unwritable = |cause: McapError| {
        let (cause, path) = (error::explained(&cause), output.display());
        let message = format!("cannot write the recovered recording: {cause}: {path}");
        ErrorKind::Io.error(message)
    };
    let recovery = write(&bytes, temporary.as_file()).map_err(unwritable)?;
    verify(temporary.path(), &recovery)?;
    disk::persist(temporary, output, force).map_err(|cause| unwritable(cause.into()))?;
    Ok(recovery)
}

/// Rejects an output file that must not be overwritten.
fn refuse(input: &Path, output: &Path, force: bool) -> io::Result<()> {
    let same =
        fs::canonicalize(output).is_ok_and(|o| fs::canonicalize(input).is_ok_and(|i| i == o));
    match same {
        true => Err(io::Error::new(
            io::ErrorKind::AlreadyExists,
            "the output is the file to recover",
        )),
        false => disk::require_free(output, force),
    }
}

fn write(bytes: &[u8], temporary: &File) -> McapResult<Recovery> {
    let (sink, recovery) = copy_records(bytes, BufWriter::new(temporary))?;
    sink.into_inner().map_err(|e| e.into_error())?;
    Ok(recovery)
}

/// Checks that the new file can be read and has all recovered messages.
fn verify(path: &Path, recovery: &Recovery) -> Result<(), Error> {
    let recording = Recording::open(path)?;
    let mut messages = 0;
    for message in recording.messages() {
        message?;
        messages += 1;
    }
    if messages == recovery.messages {
        return Ok(());
    }
    let written = recovery.messages;
    let cause = format!("{written} messages were written, {messages} read back");
    Err(recording.damaged(cause))
}
