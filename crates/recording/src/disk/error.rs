//! Conversions of system errors. Every message names the file and says what to do.

use std::io;
use std::path::Path;

use super::{way_out, way_out_of_writing, way_out_or};
use crate::error::{Error, ErrorKind};

/// Returns the conversion of an error when creating a file or folder.
pub fn cannot_create(path: &Path) -> impl Fn(io::Error) -> Error {
    move |cause| {
        let place = "; choose another folder with `--out`, or free this one";
        let hint = way_out_or(&cause, place);
        let message = format!("cannot create {}: {cause}{hint}", path.display());
        ErrorKind::CannotCreate.error(message)
    }
}

/// Returns the conversion of an error when reading a file or folder.
pub fn cannot_read(path: &Path) -> impl Fn(io::Error) -> Error {
    move |cause| {
        let (name, hint) = (path.display(), way_out(&cause));
        ErrorKind::of_reading(&cause).error(format!("cannot read {name}: {cause}{hint}"))
    }
}

/// Returns the conversion of an error when writing a file, for example because the disk is full.
/// Earlier files are complete.
pub fn cannot_write(path: &Path) -> impl Fn(io::Error) -> Error {
    move |cause| {
        let (name, hint) = (path.display(), way_out_of_writing(&cause));
        ErrorKind::Io.error(format!("cannot write {name}: {cause}{hint}"))
    }
}
