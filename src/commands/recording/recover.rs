//! `xcscr recording recover`: a whole recording of what can be read of a broken one.

use std::path::PathBuf;

use xcscr::record::{self, Recovery};

use crate::commands::failure::{Exit, Failure};
use crate::commands::terminal::say;

/// Arguments of `recover`.
#[derive(Debug, clap::Args)]
pub struct RecoverArgs {
    /// The recording, such as run.mcap.part; it is left as it is.
    file: PathBuf,
    /// The new recording.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Replace OUT if it exists.
    #[arg(long)]
    force: bool,
}

/// Recovers, and says on stderr how much.
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
            Err(Failure::new(Exit::Lossy, message))
        }
    }
}
