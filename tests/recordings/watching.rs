//! Pictures of policies, and recordings served to a viewer, as their users call them.

use std::fs;

use super::{GRID, OTHER, PHYSICS};
use crate::kit::desk::Desk;
use crate::kit::messages::on;
use crate::kit::program::signal;
use crate::kit::served::Served;
use xcscr::record::reader::Recording;

const SAMPLE: &str = "recordings/sample-maze4.mcap";

/// Draws a picture of a run; returns its bytes.
fn svg(desk: &Desk, more: &str) -> String {
    desk.ok(&format!("map @run -o @map.svg --force {more}"));
    desk.text("map.svg")
}

#[test]
fn a_map_shows_the_policy_of_any_episode_and_is_the_same_every_time() {
    let desk = Desk::new();
    desk.train(
        "run",
        "maze4 --arena grid --record none --set reward.step_threshold=50",
    );
    let last = svg(&desk, "");
    for words in ["episode 180: ", "greedy path now: 10 steps, the fewest"] {
        assert!(last.contains(words), "{last}");
    }
    assert_eq!(last, svg(&desk, "--episode 180"));
    let first = svg(&desk, "--episode 1");
    assert!(first.contains("episode 1: "), "{first}");
    assert_ne!(first, last, "control: the policy changed");
}

#[test]
fn a_training_writes_the_action_values_of_three_stages_and_map_draws_the_same() {
    let desk = Desk::new();
    let how = "maze5 --arena grid --method xcscr --record none --set reward.step_threshold=60";
    desk.train("run", how);
    let written = desk.text("run/worth.svg");
    assert_eq!(written, svg(&desk, "--worth"));
    for words in [
        ">a: before the first success",
        ">b: half of the shortest path positive",
        ">c: last success",
        ">stability: ",
        "smaller share (Eq. 9)",
    ] {
        assert_eq!(written.matches(words).count(), 1, "{words}");
    }
    // Values below 0, above 0, and of the policy.
    for colour in ["#c8352b", "#2f6fd6", "#128a3e"] {
        let arrows = written.matches(colour).count();
        assert!(arrows > 10, "{arrows} arrows of the colour {colour}");
    }
    let one = svg(&desk, "--worth --episode 5");
    assert_eq!(one.matches(">episode ").count(), 1, "{one}");
    assert!(one.contains(">episode 5: "), "{one}");
    assert!(
        !one.contains("stability"),
        "control: one episode has no curve"
    );
}

#[test]
fn what_recordings_hold_is_one_json_document() {
    let desk = Desk::new();
    desk.train("run", GRID);
    let shown = desk.json("recording info @run --json");
    let files = shown.as_array().unwrap();
    assert_eq!(files.len(), 12 + 1);
    assert_eq!(files[1]["run"]["episode"], "2");
    assert!(files[0]["topics"].as_array().unwrap().len() > 5, "{shown}");
    desk.run(2, "replay @run --json");
}

#[test]
fn a_viewer_gets_the_ranges_it_asks_for_and_nothing_else() {
    let desk = Desk::new();
    desk.train("run", PHYSICS);
    let bytes = desk.read("run/ep-0001.mcap");
    let size = bytes.len();
    let server = Served::new(&desk, "@run/ep-0001.mcap");
    let path = "/1/ep-0001.mcap";
    let beyond = format!("Range: bytes={size}-\r\n");
    let length = format!("Content-Length: {size}");
    let range = |range: &str| format!("Content-Range: bytes {range}/{size}");
    let (part, end, none) = (
        range("8-99"),
        range(&format!("{}-{}", size - 8, size - 1)),
        range("*"),
    );
    let magic = b"\x89MCAP0\r\n";
    for (method, headers, status, field, wanted) in [
        ("GET", "", 200, "Cache-Control: no-store", &bytes[..]),
        (
            "GET",
            "Range: bytes=8-99\r\n",
            206,
            &part[..],
            &bytes[8..100],
        ),
        ("GET", "Range: bytes=-8\r\n", 206, &end[..], &magic[..]),
        ("GET", &beyond[..], 416, &none[..], &[]),
        ("HEAD", "", 200, &length[..], &[]),
    ] {
        let (head, body) = server.ask(method, path, headers);
        let is_right = head.starts_with(&format!("HTTP/1.1 {status}")) && head.contains(field);
        assert!(is_right, "{method} {headers}: {head}");
        assert!(body == wanted, "{method} {headers}");
    }
    let (head, _) = server.ask("POST", path, "Content-Length: 0\r\n");
    assert!(head.starts_with("HTTP/1.1 405"), "{head}");
    for path in [
        "",
        "/",
        "/1/",
        "/1/ep-0002.mcap",
        "/1/../config.json",
        "/2/ep-0001.mcap",
        "/etc/passwd",
        "//1/ep-0001.mcap",
        "/1/%2e%2e/config.json",
    ] {
        let (head, body) = server.ask("GET", path, "");
        let is_refused = head.starts_with("HTTP/1.1 404") && body.is_empty();
        assert!(is_refused, "{path}: {head}");
    }
    let (head, layout) = server.ask("GET", "/0/foxglove-layout.json", "");
    assert!(head.starts_with("HTTP/1.1 200"), "{head}");
    assert_eq!(layout, desk.read("run/foxglove-layout.json"));
}

#[test]
fn the_links_name_the_files_and_the_layout_of_each_kind() {
    let desk = Desk::new();
    desk.train("run", GRID);
    let text = Served::new(&desk, "@run").lines.concat();
    for words in [
        "Episodes in maze4: xcscr, seed 1 (the last 10 of 12)",
        "The whole run in maze4: xcscr, seed 1\n",
    ] {
        assert!(text.contains(words), "{text}");
    }
    assert!(text.starts_with("The whole run"), "{text}");
    // Episodes that no link opens are not read.
    desk.write("run/ep-0001.mcap", "damaged");
    let again = Served::new(&desk, "@run").lines.concat();
    assert!(again.contains("(the last 10 of 12)"), "{again}");
    desk.write("run/ep-0012.mcap", "damaged");
    desk.fails(65, "replay @run", "ep-0012.mcap");
    for (words, count) in [
        ("ds.url=http%3A%2F%2F127.0.0.1%3A", 2 * (10 + 1)),
        ("&layoutUrl=http%3A%2F%2F", 2),
        ("https://app.foxglove.dev/", 2),
    ] {
        assert_eq!(text.matches(words).count(), count, "{words} in {text}");
    }
}

#[test]
fn recordings_of_two_mazes_come_with_a_layout_each() {
    let desk = Desk::new();
    desk.train("small", GRID);
    desk.train("large", "maze6 --arena grid --episodes 1");
    let server = Served::new(&desk, "@small/ep-0001.mcap @large/ep-0001.mcap");
    let text = server.lines.concat();
    for (maze, path, run) in [("maze4", "/0", "small"), ("maze6", "/2", "large")] {
        let heading = format!("Episodes in {maze}: xcscr, seed 1\n");
        assert!(text.contains(&heading), "{text}");
        let (_, layout) = server.ask("GET", &format!("{path}/foxglove-layout.json"), "");
        let expected = desk.read(&format!("{run}/foxglove-layout.json"));
        assert_eq!(layout, expected, "{path}");
    }
}

/// Opened together, the robot would jump from one run to the other.
#[test]
fn recordings_of_two_runs_in_one_maze_never_share_a_link() {
    let desk = Desk::new();
    desk.train("one", GRID);
    desk.train("two", OTHER);
    let server = Served::new(&desk, "@one/ep-0001.mcap @two/ep-0001.mcap");
    let text = server.lines.concat();
    for seed in [1, 2] {
        let heading = format!("Episodes in maze4: xcscr, seed {seed}\n");
        assert!(text.contains(&heading), "{text}");
    }
    let links = text.lines().filter(|line| line.contains("ds.url="));
    let shared = links.filter(|link| link.matches("ds.url=").count() > 1);
    assert_eq!(shared.count(), 0, "{text}");
}

#[cfg(unix)]
#[test]
fn a_server_ends_with_code_0_when_it_is_interrupted() {
    let mut server = Served::new(&Desk::new(), SAMPLE);
    signal(&server.child, "INT");
    assert_eq!(server.child.wait().unwrap().code(), Some(0));
}

/// When the program changes what a run gives, make the sample anew: `cargo run -- train
/// worlds/maze4.json --record beams --out RUN`, then copy `RUN/ep-0001.mcap` over it.
#[test]
fn the_sample_in_the_repository_is_sound_small_and_the_same_as_a_new_run() {
    assert!(fs::metadata(SAMPLE).unwrap().len() < 300_000);
    let shown = Recording::open(SAMPLE.as_ref()).unwrap();
    assert_eq!(shown.check(), [""; 0]);
    Desk::new().ok(&format!("recording verify {SAMPLE}"));
    let end = on(&shown, "/episode").last().unwrap();
    assert_eq!(end.json().unwrap()["outcome"], "goal");
}
