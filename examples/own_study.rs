//! Runs a custom study: a custom agent and two built-in methods, ten paired seeds, one table.

use std::ops::ControlFlow;
use std::path::Path;

use xcscr::study::{Agents, Protocol, Report, StudyFile, StudyFolder};

#[path = "agents/fewest_steps.rs"]
mod fewest_steps;
use fewest_steps::FewestSteps;

const STUDY: &str = r#"
    name = "own-agent"
    worlds = ["maze4"]
    methods = ["xcscr", "q-learning"]
    trials = 10
    episodes = 60
"#;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = StudyFile::parse(STUDY, "own_study.rs", Path::new("."))?;
    let agents = Agents::default().with("fewest-steps", |plan| Box::new(FewestSteps::new(plan)))?;
    let protocol = Protocol::new(&file, &agents)?;
    let parent = tempfile::tempdir()?;
    let path = parent.path().join("study");
    let mut folder = StudyFolder::open(&path, protocol, false)?.with_agents(agents);
    folder.run(1, &mut |_, _| ControlFlow::Continue(()))?;
    let report = Report::new(&folder).terminal();
    println!("{report}");
    assert_eq!(folder.records().count(), 30);
    assert!(report.contains("fewest-steps"));
    Ok(())
}
