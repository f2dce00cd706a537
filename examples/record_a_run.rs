//! A recorded run in a folder of its own, which can be replayed, verified and resumed as one of
//! the command line can.

use std::path::Path;

use xcscr::record::RecordMode;
use xcscr::run::{RunFolder, Session};
use xcscr::trial::{Plan, Trial};
use xcscr::world::Maze;

/// Runs it.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let maze = Maze::load(Path::new("worlds/maze4.json"))?;
    let parent = tempfile::tempdir()?;
    let folder = RunFolder::create(&parent.path().join("run"), false)?;
    let trial = Trial::new(Plan::new(maze).episodes(10).seed(7))?;
    let session = Session::begin(folder, trial, RecordMode::All)?;
    // The observer sees every step; the function says when to stop and leave a checkpoint.
    let run = session.run(&mut (), &|| false)?;
    for file in &run.recording.files {
        println!("{}", file.display());
    }
    assert_eq!(
        run.recording.files.len(),
        12,
        "episodes, run and highlights"
    );
    Ok(())
}
