//! A whole recording of what can still be read of a broken one.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::Path;

use mcap::{MAGIC, McapError, McapResult};

use super::salvage::{Recovery, salvage};
use crate::disk;
use crate::record::error::RecordError;
use crate::record::read::reader::Recording;

/// Copies all whole records of `input` into `output`, which is a whole recording then; it is read
/// back before it gets its name. An `output` that exists is replaced only if `force` is set.
///
/// # Errors
/// [`RecordError::Read`], [`RecordError::Damaged`] when `input` is no MCAP file at all,
/// [`RecordError::Create`] and [`RecordError::Recover`] for `output`.
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
    let aside = disk::aside(output).map_err(|cause| RecordError::Create {
        path: output.to_owned(),
        cause,
    })?;
    let recovery = write(&bytes, aside.as_file()).map_err(|cause| write_error(output, &cause))?;
    verify(aside.path(), &recovery)?;
    disk::persist(aside, output, force).map_err(|cause| write_error(output, &cause.into()))?;
    Ok(recovery)
}

/// Refuses to overwrite.
fn refuse(input: &Path, output: &Path, force: bool) -> io::Result<()> {
    let same =
        fs::canonicalize(output).is_ok_and(|o| fs::canonicalize(input).is_ok_and(|i| i == o));
    match same {
        true => Err(io::Error::new(
            io::ErrorKind::AlreadyExists,
            "it is the file to recover",
        )),
        false => disk::require_free(output, force),
    }
}

fn write(bytes: &[u8], aside: &File) -> McapResult<Recovery> {
    let (sink, recovery) = salvage(bytes, BufWriter::new(aside))?;
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

/// Is the new file what it should be?
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
