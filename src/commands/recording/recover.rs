//! `xcscr recording recover`: recovers the readable part of a damaged recording.

use std::path::PathBuf;

use xcscr::ErrorKind;
use xcscr::record::{self, Recovery};

use crate::commands::failure::Failure;
use crate::commands::terminal::say;

/// Arguments of `recording recover`.
#[derive(Debug, clap::Args)]
pub struct RecoverArgs {
    /// The recording, such as run.mcap.part. It is not changed.
    file: PathBuf,
    /// The new recording.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Replace OUT if it exists.
    #[arg(long)]
    force: bool,
}

/// Recovers a recording, and reports the result on stderr.
pub fn run(args: &RecoverArgs) -> Result<(), Failure> {
    let Recovery {
        messages,
        attachments,
        metadata,
        lost_bytes,
        fault,
    } = record::recover(&args.file, &args.output, args.force)?;
    let saved = format!(
        "saved {messages} messages, {attachments} attachments and {metadata} metadata records"
    );
    match fault {
        None => {
            say(&format!("{saved}; nothing was lost"));
            Ok(())
        }
        Some(fault) => {
            let lost = match lost_bytes {
                0 => String::new(),
                _ => format!("lost {lost_bytes} bytes, "),
            };
            let message = format!("{saved}; {lost}{fault}");
            Err(Failure::new(ErrorKind::Lossy, message))
        }
    }
}
