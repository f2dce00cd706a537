//! Sensors with more bits than the contexts of rules with a map keep of a percept.

use crate::kit::program::expect;

#[test]
fn a_map_is_learned_shown_exported_and_transferred_with_sensors_wider_than_a_context_keeps() {
    let folder = tempfile::tempdir().unwrap();
    for sensor in ["neighbours-position", "lidar-position"] {
        let path = |name: &str| {
            let path = folder.path().join(format!("{sensor}-{name}"));
            path.to_str().unwrap().to_owned()
        };
        let run = path("run");
        let train = |rest: &[&str]| {
            let method = ["train", "worlds/maze4.json", "--method", "xcscr-plus"];
            let map = ["--set", "plus.estimator=map", "--arena", "grid"];
            let rest = [&map[..], &["--sensor", sensor, "--quiet"], rest].concat();
            expect(0, &[&method[..], &rest].concat())
        };
        train(&["--episodes", "40", "--out", &run]);
        let (rules, _) = expect(0, &["rules", &run]);
        assert!(
            rules.contains(" wall"),
            "{sensor}: no rule was described: {rules}"
        );
        for target in ["c99", "csv", "dot"] {
            expect(
                0,
                &["export", &run, "--target", target, "-o", &path(target)],
            );
        }
        let rules = format!("{run}/rules.json");
        train(&[
            "--episodes",
            "3",
            "--init-rules",
            &rules,
            "--out",
            &path("later"),
        ]);
    }
}
