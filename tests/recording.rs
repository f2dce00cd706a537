//! What a recording must be.

mod common;

use common::{Trial, contents, names};
use xcscr::record::RecordMode;

#[test]
fn the_same_run_gives_the_same_bytes() {
    let [one, two] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let [a, b] = [&one, &two].map(|folder| Trial::default().record(folder.path()).unwrap());
    assert_eq!(a.files.len(), 5);
    assert_eq!(a.bytes, b.bytes);
    assert!(contents(&a.files) == contents(&b.files));
}

#[test]
fn each_mode_keeps_its_episodes() {
    let kept = |mode: &str| {
        let folder = tempfile::tempdir().unwrap();
        let trial = Trial {
            mode: mode.parse::<RecordMode>().unwrap(),
            ..Trial::default()
        };
        let summary = trial.record(folder.path()).unwrap();
        let names = names(folder.path());
        assert_eq!(
            names.iter().filter(|n| n.ends_with("mcap")).count(),
            summary.files.len()
        );
        assert!(
            !names.iter().any(|name| name.ends_with(".part")),
            "{names:?}"
        );
        names
            .into_iter()
            .filter(|n| n.starts_with("ep-"))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        kept("all"),
        [
            "ep-0001.mcap",
            "ep-0002.mcap",
            "ep-0003.mcap",
            "ep-0004.mcap"
        ]
    );
    assert_eq!(kept("every:2"), ["ep-0001.mcap", "ep-0003.mcap"]);
    assert_eq!(kept("last"), ["ep-0004.mcap"]);
    assert!(kept("best").len() <= 1);
    assert!(kept("none").is_empty());
}
