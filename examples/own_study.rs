//! A study of one's own: two methods, ten paired seeds, one table.

use std::path::Path;

use xcscr::study::{Overrides, Protocol, Report, Shard, StudyFile};

const STUDY: &str = r#"
    name = "two-methods"
    worlds = ["maze4"]
    methods = ["xcscr", "q-learning"]
    trials = 10
    episodes = 60
"#;

/// Runs it.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = StudyFile::parse(STUDY, "own_study.rs", Path::new("."))?;
    let protocol = Protocol::new(&file, &Overrides::default())?;
    let parent = tempfile::tempdir()?;
    let out = parent.path().join("study");
    let folder = protocol.run(&out, Shard::WHOLE, 1, &mut ())?;
    println!("{}", Report::new(&folder).terminal());
    assert_eq!(folder.records().count(), 20);
    Ok(())
}
