//! The highlights of episodes with many thousands of steps.

use std::path::Path;

use crate::kit::program::expect;
use xcscr::record::reader::Recording;

/// The most messages of a topic that are shown of an episode; see `record/highlights/builder.rs`.
const MOST_SHOWN: u64 = 2_000;

fn messages(file: &Path, topic: &str) -> u64 {
    let topics = Recording::open(file).unwrap().topics();
    topics
        .iter()
        .find(|one| one.name == topic)
        .unwrap()
        .messages
}

#[test]
fn highlights_show_no_more_messages_of_an_episode_however_many_steps_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (json, _) = expect(0, &["world", "generate", "--kind", "dfs", "--size", "31"]);
    let world = path("world.json");
    std::fs::write(&world, json).unwrap();
    let shown_of = |limit: &str| {
        let (run, limit) = (path(limit), format!("reward.step_threshold={limit}"));
        let choices = [
            "--arena",
            "grid",
            "--method",
            "q-learning",
            "--quiet",
            "--episodes",
            "1",
        ];
        let limits = [
            "--set",
            "reward.step_threshold_from_maze=false",
            "--set",
            &limit,
        ];
        let train = [&["train", &world, "--out", &run][..], &choices, &limits];
        expect(0, &train.concat());
        let file = |name: &str| Path::new(&run).join(name);
        let recorded = messages(&file("ep-0001.mcap"), "/step");
        assert!(recorded > MOST_SHOWN, "control: {recorded}");
        expect(
            0,
            &[
                "recording",
                "check",
                file("highlights.mcap").to_str().unwrap(),
            ],
        );
        ["/step", "/tf", "/scene/trail"].map(|topic| messages(&file("highlights.mcap"), topic))
    };
    for limit in ["2500", "5000"] {
        for shown in shown_of(limit) {
            // The episode and the drive, each with its first and last message and with what stands
            // still after it.
            assert!(
                (500..2 * (MOST_SHOWN + 10)).contains(&shown),
                "{limit}: {shown}"
            );
        }
    }
}
