//! `xcscr replay --live`: streams finished recordings to a viewer.

use std::path::{Path, PathBuf};
use std::time::Duration;

use xcscr::record::reader::Recording;
use xcscr::record::{RecordingKind, Topic};

use crate::commands::failure::Failure;
use crate::commands::live::Broadcast;

/// Streams all files in order, then waits until the last viewer has disconnected. Ctrl-C ends the
/// stream. If there are episodes, the recording of the whole run and the highlights are left out,
/// because time would jump back.
pub fn run(files: &[PathBuf], mut broadcast: Broadcast) -> Result<(), Failure> {
    let apart = [RecordingKind::Run, RecordingKind::Highlights].map(RecordingKind::file_name);
    let is_apart = |file: &&PathBuf| apart.iter().any(|name| file.ends_with(name));
    let episodes = files.iter().filter(|file| !is_apart(file));
    let streamed: Vec<_> = match episodes.clone().next() {
        Some(_) => episodes.collect(),
        None => files.iter().collect(),
    };
    for file in streamed {
        stream(file, &mut broadcast)?;
        if broadcast.is_interrupted() {
            return Ok(());
        }
    }
    broadcast.stay();
    Ok(())
}

fn stream(file: &Path, broadcast: &mut Broadcast) -> Result<(), Failure> {
    let recording = Recording::open(file)?;
    for message in recording.messages() {
        let message = message?;
        broadcast.wait_for_viewer(Duration::MAX);
        if broadcast.is_interrupted() {
            break;
        }
        if let Some(topic) = Topic::named(message.topic()) {
            broadcast.send(topic, message.time_ns, &message.data);
        }
    }
    Ok(())
}
