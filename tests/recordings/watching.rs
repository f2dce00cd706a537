//! Pictures of policies, and recordings served to a viewer, as their users call them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::kit::program::outcome;
use crate::kit::served::Served;
use xcscr::record::reader::Recording;

/// A run of so many episodes.
fn train(folder: &Path, more: &[&str]) -> PathBuf {
    let run = folder.join("run");
    let args = [
        "train",
        "worlds/maze4.json",
        "--quiet",
        "--out",
        run.to_str().unwrap(),
    ];
    let (code, _, stderr) = outcome(&[&args[..], more].concat());
    assert_eq!(code, Some(0), "{stderr}");
    run
}

/// Draws a picture of a run into `name`; returns its bytes.
fn map(run: &Path, name: &str, more: &[&str]) -> Vec<u8> {
    let picture = run.join(name);
    let args = [
        "map",
        run.to_str().unwrap(),
        "-o",
        picture.to_str().unwrap(),
    ];
    let (code, _, stderr) = outcome(&[&args[..], more].concat());
    assert_eq!(code, Some(0), "{stderr}");
    fs::read(picture).unwrap()
}

#[test]
fn a_map_shows_the_policy_of_any_episode_and_is_the_same_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), &["--arena", "grid", "--record", "none"]);
    let last = String::from_utf8(map(&run, "a.svg", &[])).unwrap();
    assert!(last.contains("episode 180: "), "{last}");
    assert!(
        last.contains("greedy path now: 10 steps, the fewest"),
        "{last}"
    );
    assert!(!last.contains("<animate"), "a still picture moves");
    assert_eq!(last.as_bytes(), map(&run, "b.svg", &["--episode", "180"]));
    let first = String::from_utf8(map(&run, "c.svg", &["--episode", "1"])).unwrap();
    assert!(first.contains("episode 1: 50 steps and gave up"), "{first}");
    let arrows = |svg: &str| svg.matches("<use ").count();
    assert!(arrows(&first) < arrows(&last), "learning added no arrow");
    let (one, two) = (map(&run, "a.png", &[]), map(&run, "b.png", &[]));
    assert!(one.starts_with(b"\x89PNG") && one == two);
}

#[test]
fn an_animated_map_shows_the_policy_as_it_forms() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(
        folder.path(),
        &[
            "--arena",
            "grid",
            "--method",
            "xcscr",
            "--record",
            "none",
            "--episodes",
            "90",
        ],
    );
    let svg = String::from_utf8(map(&run, "a.svg", &["--animate"])).unwrap();
    let captions = svg.matches("episode ").count();
    assert!((20..=45).contains(&captions), "{captions} moments");
    assert!(svg.contains("episode 90: ") && svg.contains("<animateTransform "));
    let png = map(&run, "a.png", &["--animate"]);
    let mut decoder = png::Decoder::new(std::io::Cursor::new(png))
        .read_info()
        .unwrap();
    let frames = decoder.info().animation_control().unwrap().num_frames;
    assert_eq!(frames as usize, captions);
    let mut pixels = vec![0; decoder.output_buffer_size().unwrap()];
    for frame in 0..frames {
        decoder
            .next_frame(&mut pixels)
            .unwrap_or_else(|e| panic!("frame {frame}: {e}"));
    }
}

#[test]
fn an_interrupted_run_has_a_map_only_of_episodes_that_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), &["--episodes", "3", "--record", "none"]);
    // What a killed run leaves: a checkpoint; what is in it does not matter here.
    fs::write(run.join("checkpoint"), "").unwrap();
    let picture = folder.path().join("map.svg");
    let (run, picture) = (run.to_str().unwrap(), picture.to_str().unwrap());
    let (code, _, stderr) = outcome(&["map", run, "-o", picture]);
    assert_eq!(code, Some(65), "{stderr}");
    assert!(
        stderr.contains("--resume") && stderr.contains("--episode"),
        "{stderr}"
    );
    let (code, _, stderr) = outcome(&["map", run, "-o", picture, "--episode", "2"]);
    assert_eq!(code, Some(0), "{stderr}");
}

#[test]
fn what_recordings_hold_is_one_json_document() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), &["--episodes", "2"]);
    let (code, stdout, stderr) = outcome(&["recording", "info", run.to_str().unwrap(), "--json"]);
    assert_eq!(code, Some(0), "{stderr}");
    let shown: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let files = shown.as_array().unwrap();
    assert_eq!(files.len(), 4);
    assert_eq!(files[1]["run"]["episode"], "2");
    assert!(files[0]["topics"].as_array().unwrap().len() > 5, "{stdout}");
    let (code, ..) = outcome(&["replay", run.to_str().unwrap(), "--json"]);
    assert_eq!(code, Some(2));
}

#[test]
fn a_map_that_cannot_be_drawn_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), &["--arena", "grid", "--episodes", "3"]);
    let run = run.to_str().unwrap();
    let (code, _, stderr) = outcome(&["map", run, "-o", "x.gif"]);
    assert_eq!(code, Some(2), "{stderr}");
    assert!(stderr.contains(".svg or .png"), "{stderr}");
    let (code, _, stderr) = outcome(&["map", run, "-o", "x.svg", "--episode", "4"]);
    assert_eq!(code, Some(2), "{stderr}");
    assert!(stderr.contains("the run has 3"), "{stderr}");
    let (code, ..) = outcome(&["map", "no-such-run", "-o", "x.svg"]);
    assert_eq!(code, Some(66));
}

#[test]
fn a_viewer_gets_the_ranges_it_asks_for_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), &["--episodes", "2"]);
    let file = run.join("ep-0001.mcap");
    let bytes = fs::read(&file).unwrap();
    let size = bytes.len();
    let server = Served::new(&[file.to_str().unwrap()]);
    let path = "/1/ep-0001.mcap";
    let (head, body) = server.ask("GET", path, "");
    assert!(head.starts_with("HTTP/1.1 200") && body == bytes, "{head}");
    assert!(head.contains("Cache-Control: no-store"), "{head}");
    let (head, body) = server.ask("GET", path, "Range: bytes=8-99\r\n");
    assert!(
        head.starts_with("HTTP/1.1 206") && body == bytes[8..100],
        "{head}"
    );
    assert!(
        head.contains(&format!("Content-Range: bytes 8-99/{size}")),
        "{head}"
    );
    let (_, body) = server.ask("GET", path, "Range: bytes=-8\r\n");
    assert_eq!(body, b"\x89MCAP0\r\n");
    let (head, body) = server.ask("GET", path, &format!("Range: bytes={size}-\r\n"));
    assert!(
        head.starts_with("HTTP/1.1 416") && body.is_empty(),
        "{head}"
    );
    assert!(
        head.contains(&format!("Content-Range: bytes */{size}")),
        "{head}"
    );
    let (head, body) = server.ask("HEAD", path, "");
    assert!(
        head.contains(&format!("Content-Length: {size}")) && body.is_empty(),
        "{head}"
    );
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
        assert!(
            head.starts_with("HTTP/1.1 404") && body.is_empty(),
            "{path}: {head}"
        );
    }
    let (head, layout) = server.ask("GET", "/0/foxglove-layout.json", "");
    assert!(head.starts_with("HTTP/1.1 200"), "{head}");
    assert_eq!(layout, fs::read(run.join("foxglove-layout.json")).unwrap());
}

#[test]
fn the_links_name_the_files_and_the_layout_of_each_kind() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), &["--episodes", "12", "--arena", "grid"]);
    let server = Served::new(&[run.to_str().unwrap()]);
    let text = server.lines.concat();
    assert!(
        text.contains("Episodes in maze4: xcscr-plus, seed 1 (the last 10 of 12)"),
        "{text}"
    );
    assert!(
        text.contains("The whole run in maze4: xcscr-plus, seed 1\n"),
        "{text}"
    );
    assert!(
        text.starts_with("Highlights of the run in maze4: xcscr-plus, seed 1\n"),
        "{text}"
    );
    let count = |what: &str| text.matches(what).count();
    assert_eq!(
        count("ds.url=http%3A%2F%2F127.0.0.1%3A"),
        2 * (10 + 1 + 1),
        "{text}"
    );
    assert_eq!(count("&layoutUrl=http%3A%2F%2F"), 3, "{text}");
    assert_eq!(count("https://app.foxglove.dev/"), 3, "{text}");
}

#[test]
fn recordings_of_two_mazes_come_with_a_layout_each() {
    let folder = tempfile::tempdir().unwrap();
    let large = folder.path().join("large");
    let large = large.to_str().unwrap();
    let world = [
        "train",
        "worlds/maze6.json",
        "--episodes",
        "1",
        "--quiet",
        "--out",
        large,
    ];
    assert_eq!(outcome(&world).0, Some(0));
    let small = train(folder.path(), &["--episodes", "1"]);
    let episode = |run: &Path| run.join("ep-0001.mcap").to_str().unwrap().to_owned();
    let files = [episode(&small), episode(Path::new(large))];
    let server = Served::new(&files.each_ref().map(String::as_str));
    let text = server.lines.concat();
    for maze in ["maze4", "maze6"] {
        assert!(
            text.contains(&format!("Episodes in {maze}: xcscr-plus, seed 1\n")),
            "{text}"
        );
    }
    for (path, run) in [("/0", small.as_path()), ("/2", Path::new(large))] {
        let (_, layout) = server.ask("GET", &format!("{path}/foxglove-layout.json"), "");
        let expected = fs::read(run.join("foxglove-layout.json")).unwrap();
        assert_eq!(layout, expected, "{path}");
    }
}

/// Opened together, the robot would jump from one run to the other.
#[test]
fn recordings_of_two_runs_in_one_maze_never_share_a_link() {
    let folder = tempfile::tempdir().unwrap();
    let more = ["--episodes", "1", "--arena", "grid"];
    let one = train(folder.path(), &more);
    fs::rename(&one, folder.path().join("one")).unwrap();
    let two = train(folder.path(), &[&more[..], &["--seed", "2"]].concat());
    let files = [folder.path().join("one"), two].map(|run| run.join("ep-0001.mcap"));
    let server = Served::new(&files.each_ref().map(|file| file.to_str().unwrap()));
    let text = server.lines.concat();
    for seed in [1, 2] {
        let heading = format!("Episodes in maze4: xcscr-plus, seed {seed}\n");
        assert!(text.contains(&heading), "{text}");
    }
    let links = text.lines().filter(|line| line.contains("ds.url="));
    let shared = links.filter(|link| link.matches("ds.url=").count() > 1);
    assert_eq!(shared.count(), 0, "{text}");
}

#[cfg(unix)]
#[test]
fn a_server_ends_with_code_0_when_it_is_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), &["--episodes", "1", "--arena", "grid"]);
    let mut server = Served::new(&[run.to_str().unwrap()]);
    let id = server.child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(server.child.wait().unwrap().code(), Some(0));
}

#[cfg(not(feature = "live"))]
#[test]
fn without_the_feature_live_says_how_to_get_it() {
    for args in [
        &["replay", "recordings/sample-maze4.mcap", "--live"][..],
        &["train", "worlds/maze4.json", "--live", "--out", "never"],
    ] {
        let (code, _, stderr) = outcome(args);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains("cargo build --features live"), "{stderr}");
    }
}

/// An asynchronous web server would double what a newcomer builds.
#[test]
fn the_default_build_is_free_of_what_live_needs() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let text = fs::read_to_string(path).unwrap();
    let manifest: toml::Table = toml::from_str(&text).unwrap();
    assert_eq!(manifest["features"].get("default"), None);
    let live = manifest["features"]["live"].as_array().unwrap();
    assert_eq!(live, &[toml::Value::from("foxglove/websocket")]);
    let foxglove = &manifest["dependencies"]["foxglove"];
    assert_eq!(foxglove["default-features"].as_bool(), Some(false));
    assert_eq!(foxglove.get("features"), None);
}

#[test]
fn a_speed_that_makes_no_sense_is_refused() {
    let sample = "recordings/sample-maze4.mcap";
    for speed in ["0", "-1", "nan", "fast"] {
        let (code, _, stderr) = outcome(&["replay", sample, "--live", "--speed", speed]);
        assert_eq!(code, Some(2), "{stderr}");
    }
    assert_eq!(outcome(&["replay", sample, "--speed", "2"]).0, Some(2));
}

/// When the program changes what a run gives, make the sample anew: `cargo run -- train
/// worlds/maze4.json --out RUN`, then copy `RUN/highlights.mcap` over it.
#[test]
fn the_sample_in_the_repository_is_sound_small_and_the_same_as_a_new_run() {
    let sample = "recordings/sample-maze4.mcap";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(sample);
    assert!(fs::metadata(&path).unwrap().len() < 300_000);
    assert_eq!(xcscr::record::check(&path).unwrap(), []);
    let (code, stdout, stderr) = outcome(&["recording", "verify", sample]);
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    let shown = Recording::open(&path).unwrap();
    let told = shown.messages().map(|message| message.unwrap());
    let end = told.filter(|m| m.topic() == "/episode").last().unwrap();
    assert_eq!(end.json().unwrap()["outcome"], "goal");
}
