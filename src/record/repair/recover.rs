//! Recovery of a complete recording from a damaged file.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::Path;

use mcap::{MAGIC, McapError, McapResult};

use super::records::{Recovery, copy_records};
use crate::disk;
use crate::record::error::RecordError;
use crate::record::read::reader::Recording;

/// Copies all complete records of `input` to a complete recording `output`. The recording is read
/// back before it gets its name. An existing `output` is replaced only if `force` is set.
///
/// # Errors
/// [`RecordError::Read`] if `input` cannot be read, [`RecordError::Foreign`] if it is not an MCAP
/// file, and [`RecordError::Create`], [`RecordError::Recover`] or [`RecordError::Damaged`] for
/// `output`.
pub fn recover(input: &Path, output: &Path, force: bool) -> Result<Recovery, RecordError> {
    let bytes = disk::read(input, disk::MOST_BYTES).map_err(|cause| RecordError::Read {
        path: input.to_owned(),
        cause,
    })?;
    refuse(input, output, force).map_err(|cause| RecordError::Create {
        path: output.to_owned(),
        cause,
    })?;
    if !bytes.starts_with(MAGIC) {
        return Err(RecordError::Foreign {
            path: input.to_owned(),
        });
    }
    let temporary = disk::aside(output).map_err(|cause| RecordError::Create {
        path: output.to_owned(),
        cause,
    })?;
    let recovery =
        write(&bytes, temporary.as_file()).map_err(|cause| write_error(output, &cause))?;
    verify(temporary.path(), &recovery)?;
    disk::persist(temporary, output, force).map_err(|cause| write_error(output, &cause.into()))?;
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

fn write_error(path: &Path, cause: &McapError) -> RecordError {
    RecordError::Recover {
        path: path.to_owned(),
        cause: match cause {
            McapError::Io(cause) => format!("{cause}{}", disk::way_out(cause)),
            other => other.to_string(),
        },
    }
}

/// Checks that the new file can be read and has all recovered messages.
fn verify(path: &Path, recovery: &Recovery) -> Result<(), RecordError> {
    let recording = Recording::open(path)?;
    let mut messages = 0;
    for message in recording.messages() {
        message?;
        messages += 1;
    }
    if messages == recovery.messages {
        return Ok(());
    }
    Err(RecordError::Damaged {
        path: path.to_owned(),
        cause: format!(
            "{} messages were written, {messages} read back",
            recovery.messages
        ),
    })
}
