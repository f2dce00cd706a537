//! A trial between two episodes, as bytes.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::Progress;
use super::plan::{Config, Plan, PlanError};
use crate::agent::RestoreError;
use xcs::random::Stream;
use xcscr_robot::arena::Lasting;
use xcscr_robot::world::{Maze, WorldError};

/// What the file begins with.
const MAGIC: &[u8; 8] = b"xcscr\x1a\r\n";
/// The number of this format.
const FORMAT: u32 = 11;
/// Magic, format and length before the content; a checksum after it.
const HEAD: usize = MAGIC.len() + 4 + 8;
const TAIL: usize = 4;

/// A trial as it is between two episodes: a trial that resumes from it gives the same bytes as
/// one that never stopped. Made by [`Trial::checkpoint`](super::Trial::checkpoint).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    pub(super) config: Config,
    pub(super) world: String,
    pub(super) progress: Progress,
    pub(super) method: Vec<u8>,
    pub(super) arena: Lasting,
    pub(super) exploration: Stream,
    pub(super) starts: Stream,
}

impl Checkpoint {
    /// The plan of the trial.
    ///
    /// # Errors
    /// When world and settings do not make one.
    pub fn plan(&self) -> Result<Plan, CheckpointError> {
        let plan = Plan {
            maze: Maze::from_json(self.world.as_bytes(), "world.json")?,
            config: self.config.clone(),
        };
        plan.check()?;
        Ok(plan)
    }

    /// How far the trial had come.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }
}

/// Why a checkpoint is of no use.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The bytes are no checkpoint at all.
    #[error("it is not a checkpoint")]
    Foreign,
    /// It has another format.
    #[error(
        "it has format {found}, and this version reads format {FORMAT}; resume with the version that wrote it, or begin anew with `--force`"
    )]
    Format {
        /// The format that it names.
        found: u32,
    },
    /// It was written by another version, which may give other bytes.
    #[error("it was written by version {found}, and this is version {}; resume with that version, or begin anew with `--force`", env!("CARGO_PKG_VERSION"))]
    Version {
        /// The version that it names.
        found: String,
    },
    /// It is shorter or longer than it says.
    #[error("it has {found} bytes, but should have {wanted}")]
    Length {
        /// The bytes that there are.
        found: usize,
        /// The bytes that there should be.
        wanted: u64,
    },
    /// Its checksum is wrong.
    #[error("its checksum is wrong")]
    Crc,
    /// Its content makes no sense.
    #[error("its content contradicts itself: {0}")]
    Content(String),
    /// Its plan cannot be run.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Its world is no good.
    #[error(transparent)]
    World(#[from] WorldError),
    /// Its learner is no good.
    #[error(transparent)]
    Memory(#[from] RestoreError),
}

/// Do these bytes begin as a checkpoint does?
pub fn is_sealed(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Wraps a value for the disk: magic, format, length, version and value, checksum.
pub fn seal(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = [MAGIC, &FORMAT.to_le_bytes()[..], &[0; 8]].concat();
    bytes = postcard::to_extend(&(env!("CARGO_PKG_VERSION"), value), bytes)
        .expect("a checkpoint is plain data and a vector has room");
    let length = (bytes.len() + TAIL) as u64;
    bytes[HEAD - 8..HEAD].copy_from_slice(&length.to_le_bytes());
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// Unwraps what [`seal`] made.
///
/// # Errors
/// The first thing that is wrong; every missing or changed byte is noticed.
pub fn unseal<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, CheckpointError> {
    let content = content(bytes)?;
    let unread = |fault: postcard::Error| CheckpointError::Content(fault.to_string());
    let (version, content): (String, _) = postcard::take_from_bytes(content).map_err(unread)?;
    if version != env!("CARGO_PKG_VERSION") {
        return Err(CheckpointError::Version { found: version });
    }
    match postcard::take_from_bytes(content).map_err(unread)? {
        (value, []) => Ok(value),
        _ => Err(CheckpointError::Content(
            "bytes are left over at its end".to_owned(),
        )),
    }
}

/// What lies between head and tail, when both are right.
fn content(bytes: &[u8]) -> Result<&[u8], CheckpointError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::Foreign)?;
    let (format, rest) = rest.split_first_chunk().ok_or(CheckpointError::Foreign)?;
    let format = u32::from_le_bytes(*format);
    if format != FORMAT {
        return Err(CheckpointError::Format { found: format });
    }
    let (length, rest) = rest.split_first_chunk().ok_or(CheckpointError::Foreign)?;
    let (found, wanted) = (bytes.len(), u64::from_le_bytes(*length));
    let (content, crc) = rest
        .split_last_chunk()
        .filter(|_| found as u64 == wanted)
        .ok_or(CheckpointError::Length { found, wanted })?;
    if crc32fast::hash(&bytes[..found - TAIL]) != u32::from_le_bytes(*crc) {
        return Err(CheckpointError::Crc);
    }
    Ok(content)
}
