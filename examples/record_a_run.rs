//! Records a run in its own folder. The run can be replayed, verified and resumed like a run of the
//! command line.

use std::path::Path;

use xcscr::record::RecordMode;
use xcscr::run::{RunFolder, Session};
use xcscr::trial::{Plan, Trial};
use xcscr::world::Maze;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let maze = Maze::load(Path::new("worlds/maze4.json"))?;
    let parent = tempfile::tempdir()?;
    let folder = RunFolder::create(&parent.path().join("run"), false)?;
    let trial = Trial::new(Plan::new(maze).episodes(10).seed(7))?;
    let session = Session::begin(folder, trial, RecordMode::All)?;
    // The observer sees every step. The function returns true to stop the run.
    let run = session.run(&mut (), &|| false)?;
    for file in &run.recording.files {
        println!("{}", file.display());
    }
    assert_eq!(run.recording.files.len(), 11, "episodes and the run");
    Ok(())
}
