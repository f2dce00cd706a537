//! Agents of one's own in a study.

use std::ops::ControlFlow;
use std::path::Path;

use xcscr::study::{Agents, Protocol, Report, StudyFile, StudyFolder};

use crate::kit::program::{expect, outcome};

#[path = "../../examples/agents/fewest_steps.rs"]
mod fewest_steps;
use fewest_steps::FewestSteps;

const FILE: &str = r#"
name = "own"
worlds = ["maze4", "maze5"]
methods = ["xcs", "q-learning"]
trials = 5
episodes = 40
"#;

fn open(path: &Path, agents: Agents) -> StudyFolder {
    let file = StudyFile::parse(FILE, "own.toml", Path::new(".")).unwrap();
    let protocol = Protocol::new(&file, &agents).unwrap();
    let folder = StudyFolder::open(path, protocol, false).unwrap();
    folder.with_agents(agents)
}

fn own() -> Agents {
    let agents = Agents::default().with("fewest-steps", |plan| Box::new(FewestSteps::new(plan)));
    agents.unwrap()
}

fn run(path: &Path, agents: Agents) -> StudyFolder {
    let mut folder = open(path, agents);
    folder
        .run(1, &mut |_, _| ControlFlow::Continue(()))
        .unwrap();
    folder
}

#[test]
fn an_agent_of_ones_own_runs_in_every_world_with_the_seeds_of_the_others_and_changes_none_of_them()
{
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("own");
    let own = run(&path, own());
    let plain = run(&place.path().join("plain"), Agents::default());
    let arms = own.protocol().arms.iter();
    let arms: Vec<String> = arms
        .map(|arm| format!("{} {}", arm.world, arm.method_name()))
        .collect();
    let names = ["xcs", "q-learning", "fewest-steps"];
    let expected = ["maze4", "maze5"].map(|world| names.map(|name| format!("{world} {name}")));
    assert_eq!(arms, expected.concat());
    let figures = |folder: &StudyFolder, is_own: bool| {
        let is_kind = |trial: usize| folder.protocol().arm(trial).agent.is_some() == is_own;
        let records = folder.records().filter(|one| is_kind(one.trial));
        records
            .map(|one| one.result.clone().unwrap())
            .collect::<Vec<_>>()
    };
    assert_eq!(figures(&own, false), figures(&plain, false));
    let found = figures(&own, true);
    assert_eq!(found.len(), 10);
    assert!(found.iter().any(|one| one.progress.best_steps.is_some()));
    // It stands in report and tables.
    let report = Report::new(&own).terminal();
    assert!(report.contains("fewest-steps − q-learning"), "{report}");
    own.write_episodes(1, &|| false).unwrap();
    let table = std::fs::read_to_string(path.join("learning-curves.csv")).unwrap();
    let points = table.matches("fewest-steps").count();
    assert_eq!(points, 80, "two worlds, 40 episodes");
    // Nobody else works in the folder.
    drop(own);
    let path = path.to_str().unwrap();
    let (stdout, _) = expect(0, &["study", "report", path]);
    assert!(stdout.contains("fewest-steps"), "{stdout}");
    // The program has no such agent, and does not give an incomplete table for a whole one.
    let (code, _, stderr) = outcome(&["study", "episodes", path, "--force"]);
    assert!(
        code != Some(0) && stderr.contains("fewest-steps"),
        "{stderr}"
    );
}

/// An agent of another step limit under the name of the first one.
fn changed() -> Agents {
    let agents = Agents::default().with("fewest-steps", |plan| {
        let mut plan = plan.clone();
        plan.config.settings.reward.step_threshold = 30;
        Box::new(FewestSteps::new(&plan))
    });
    agents.unwrap()
}

#[test]
fn results_of_a_changed_agent_are_not_mixed_with_earlier_ones() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("own");
    drop(run(&path, own()));
    drop(run(&path, own()));
    let words =
        "trial 1 of maze4 fewest-steps grid neighbours has another result when it is repeated";
    let mut folder = open(&path, changed());
    let fault = folder
        .run(1, &mut |_, _| ControlFlow::Continue(()))
        .unwrap_err()
        .to_string();
    assert!(fault.contains(words) && fault.contains("--out"), "{fault}");
    let fault = folder.write_episodes(1, &|| false).unwrap_err();
    assert!(fault.to_string().contains(words), "{fault}");
    assert!(!path.join("episodes.csv.gz").exists());
    let folder = folder.with_agents(own());
    folder.write_episodes(1, &|| false).expect("control");
}

#[test]
fn names_that_are_taken_or_no_names_are_refused() {
    for (name, words) in [
        ("xcs", "the name of another method"),
        ("r-max", "the name of another method"),
        ("fewest-steps", "the name of another method"),
        ("", "lower-case letters"),
        ("<b>", "lower-case letters"),
    ] {
        let refused = own().with(name, |plan| Box::new(FewestSteps::new(plan)));
        let message = refused.unwrap_err().to_string();
        assert!(message.contains(words), "{name}: {message}");
    }
}
