//! MCAP streams with the settings of all our recordings.

use std::io::{self, Read, Write};
use std::path::Path;

use mcap::write::NoSeek;
use mcap::{Compression, MAGIC, McapResult, WriteOptions, Writer};

use crate::disk;

/// Uncompressed size at which a chunk is closed, in bytes.
const CHUNK_BYTES: u64 = 512 * 1024;
/// The level of compression: as high as is worthwhile.
const LEVEL: u32 = 8;
/// The library name in the header.
const LIBRARY: &str = concat!("xcscr/", env!("CARGO_PKG_VERSION"));

/// Returns true if the file is a recording written by any version of this program.
///
/// # Errors
/// If the file cannot be read.
pub fn is_ours(path: &Path) -> io::Result<bool> {
    let mut begin = Vec::new();
    disk::open(path)?.take(64).read_to_end(&mut begin)?;
    let writer = b"xcscr/";
    let names_us = begin.windows(writer.len()).any(|bytes| bytes == writer);
    Ok(begin.starts_with(MAGIC) && names_us)
}

/// A stream of MCAP records. The same calls produce the same bytes.
pub type Sink<W> = Writer<NoSeek<W>>;

/// Begins a stream.
pub fn begin<W: Write>(out: W) -> McapResult<Sink<W>> {
    let options = WriteOptions::new()
        .library(LIBRARY)
        .chunk_size(Some(CHUNK_BYTES))
        .compression(Some(Compression::Zstd))
        .compression_level(LEVEL)
        // Compression threads would change the bytes.
        .compression_threads(0)
        .emit_summary_offsets(false)
        .disable_seeking(true);
    options.create(NoSeek::new(out))
}

/// Writes the index and returns the output.
pub fn finish<W: Write>(mut stream: Sink<W>) -> McapResult<W> {
    stream.finish()?;
    Ok(stream.into_inner().into_inner())
}
