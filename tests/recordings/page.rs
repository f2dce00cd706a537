//! The page that plays a recording: the same numbers as the recording, and nothing that a file could smuggle in.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use serde_json::Value;
use xcscr::record::player;
use xcscr::record::reader::Recording;

use crate::kit::program::outcome;

const SAMPLE: &str = "recordings/sample-maze4.mcap";

fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn sample() -> Recording {
    Recording::open(&in_repository(SAMPLE)).unwrap()
}

/// The data that a page holds.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once(r#"id="data">"#).unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}

/// Trains for five episodes on the grid into this folder.
fn train(run: &str) {
    let command = [
        "train",
        "maze4",
        "--arena",
        "grid",
        "--episodes",
        "5",
        "--quiet",
        "--out",
    ];
    assert_eq!(outcome(&[&command[..], &[run]].concat()).0, Some(0));
}

/// The messages of a topic.
fn said(recording: &Recording, topic: &str) -> Vec<Value> {
    let messages = recording.messages().map(|message| message.unwrap());
    let of_topic = messages.filter(|message| message.topic() == topic);
    of_topic.map(|message| message.json().unwrap()).collect()
}

/// When the sample changes, make the page anew: `cargo run -- replay recordings/sample-maze4.mcap --html
/// docs/sample-maze4.html --force`.
#[test]
fn the_page_in_the_documentation_is_that_of_the_sample_and_small() {
    let page = player::page(&sample()).unwrap();
    let kept = fs::read_to_string(in_repository("docs/sample-maze4.html")).unwrap();
    assert!(page == kept, "the page in docs is another one");
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
}

#[test]
fn a_page_has_the_decisions_values_estimates_and_episodes_of_its_recording() {
    let recording = sample();
    let data = data(&player::page(&recording).unwrap());
    let (reasons, steps) = (said(&recording, "/rule"), said(&recording, "/step"));
    let decisions = data["decisions"].as_array().unwrap();
    assert_eq!(decisions.len(), reasons.len());
    for ((decision, reason), step) in decisions.iter().zip(&reasons).zip(&steps) {
        for field in ["episode", "step", "rule", "action", "seen"] {
            assert_eq!(decision[field], reason[field], "{field}");
        }
        assert_eq!(decision["values"], step["values"], "{decision}");
    }
    for (list, topic) in [
        ("estimates", "/estimate"),
        ("episodes", "/episode"),
        ("contacts", "/contact"),
    ] {
        assert_eq!(
            data[list].as_array().unwrap().len(),
            said(&recording, topic).len(),
            "{list}"
        );
    }
    let times = recording.messages().map(|message| message.unwrap().time_ns);
    let last_s = times.max().unwrap() as f64 / 1e9;
    assert!(
        (data["end"].as_f64().unwrap() - last_s).abs() < 0.01,
        "{}",
        data["end"]
    );
    assert_eq!(
        data["poses"].as_array().unwrap()[0]
            .as_array()
            .unwrap()
            .len(),
        4
    );
}

#[test]
fn the_page_of_a_whole_run_has_its_steps_and_its_learning_curve() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let out = run.to_str().unwrap();
    train(out);
    let recording = Recording::open(&run.join("run.mcap")).unwrap();
    let data = data(&player::page(&recording).unwrap());
    let steps = said(&recording, "/step").len();
    assert_eq!(data["decisions"].as_array().unwrap().len(), steps);
    assert_eq!(data["poses"].as_array().unwrap().len(), steps);
    let left = data["decisions"][0]["left"].as_f64().unwrap();
    assert!((90.0..100.0).contains(&left), "{left} %");
    assert_eq!(data["curve"]["episode"], serde_json::json!([1, 2, 3, 4, 5]));
}

#[test]
fn the_page_loads_nothing_and_its_policy_forbids_it() {
    let page = player::page(&sample()).unwrap();
    for outside in ["http://", "https://", "src=", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains(r#"content="default-src 'none'; "#));
}

const EVIL: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>";

/// A recording of nobody's, in which every text is hostile.
fn forged() -> Recording {
    let mut file = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    let world = br######"{ "rows": ["#####", "#S.G#", "#####"] }"######;
    let attachment = mcap::Attachment {
        log_time: 0,
        create_time: 0,
        name: "world.json".to_owned(),
        media_type: "application/json".to_owned(),
        data: world.into(),
    };
    file.attach(&attachment).unwrap();
    let facts =
        ["world", "method", "arena", "sensor", "seed"].map(|key| (key.to_owned(), EVIL.to_owned()));
    let facts = mcap::records::Metadata {
        name: "run".to_owned(),
        metadata: facts.into(),
    };
    file.write_metadata(&facts).unwrap();
    for topic in ["/rule", "/episode"] {
        let channel = file
            .add_channel(0, topic, "json", &BTreeMap::new())
            .unwrap();
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: 1,
            publish_time: 1,
        };
        let message =
            serde_json::json!({ "episode": 1, "rule": EVIL, "action": EVIL, "outcome": EVIL });
        file.write_to_known_channel(&header, message.to_string().as_bytes())
            .unwrap();
    }
    file.finish().unwrap();
    Recording::from_bytes(Path::new("forged.mcap"), file.into_inner().into_inner()).unwrap()
}

#[test]
fn a_text_from_a_recording_cannot_become_script() {
    let page = player::page(&forged()).unwrap();
    assert_eq!(
        page.matches("</script>").count(),
        2,
        "those of the page itself"
    );
    assert!(!page.contains("<img"), "an element came from a text");
    // Control: the texts are there.
    let data = data(&page);
    assert!(data["heading"].as_str().unwrap().starts_with(EVIL));
    assert_eq!(data["decisions"][0]["rule"], EVIL);
}

#[test]
fn the_page_of_a_comparison_holds_the_pages_of_both_runs() {
    let folder = tempfile::tempdir().unwrap();
    let [run, both, direct, page] =
        ["run", "both.mcap", "a.html", "b.html"].map(|name| folder.path().join(name));
    let [run, both, direct, page] =
        [&run, &both, &direct, &page].map(|path| path.to_str().unwrap());
    train(run);
    assert_eq!(
        outcome(&["replay", run, run, "--compare", "-o", both]).0,
        Some(0)
    );
    assert_eq!(outcome(&["replay", both, "--html", page]).0, Some(0));
    assert_eq!(
        outcome(&["replay", run, run, "--compare", "--html", direct]).0,
        Some(0)
    );
    let text = fs::read_to_string(page).unwrap();
    assert!(
        text == fs::read_to_string(direct).unwrap(),
        "the page depends on how it was asked for"
    );
    let (code, _, stderr) = outcome(&["replay", both, "--terminal"]);
    assert_eq!(code, Some(65), "{stderr}");
    assert!(
        stderr.contains("give a recording of one of them"),
        "{stderr}"
    );
    let sides: Vec<Value> = text.split(r#"srcdoc=""#).skip(1).map(side).collect();
    let recording = Recording::open(Path::new(both)).unwrap();
    assert_eq!(sides.len(), 2);
    for (side, name) in sides.iter().zip(["/a", "/b"]) {
        let rules = said(&recording, &format!("{name}/rule"));
        assert_eq!(side["decisions"].as_array().unwrap().len(), rules.len());
        assert!(side["poses"].as_array().unwrap().len() > 10);
        assert!(!side["scenes"]["policy"].as_array().unwrap().is_empty());
    }
    // Two times the same run.
    assert_eq!(sides[0], sides[1]);
}

#[test]
fn as_text_a_recording_has_a_frame_for_each_decision() {
    let (code, stdout, stderr) = outcome(&["replay", SAMPLE, "--terminal"]);
    assert_eq!(code, Some(0), "{stderr}");
    let rules = said(&sample(), "/rule");
    let frames: Vec<&str> = stdout
        .split("\n\n")
        .filter(|frame| frame.contains("step"))
        .collect();
    assert_eq!(frames.len(), rules.len());
    for (frame, rule) in frames.iter().zip(&rules) {
        let [episode, step, action] = ["episode", "step", "action"].map(|key| &rule[key]);
        let action = action.as_str().unwrap();
        let decision = format!("episode {episode}, step {step}: {action}, chosen by");
        assert!(frame.contains(&decision), "{decision} is not in\n{frame}");
    }
    // The run begins at the start, in the second column and row, and the goal is two to the left of the eastern wall.
    let lines: Vec<&str> = frames[0].lines().collect();
    assert!(lines[2].starts_with("██▶ "), "{}", frames[0]);
    assert!(lines[7].ends_with("██G ██"), "{}", frames[0]);
}

#[test]
fn a_frame_fits_and_shows_the_robot_in_any_terminal() {
    let player = player::TextPlayer::of(&sample()).unwrap();
    let robot = |letter: &char| "▶◥▲◤◀◣▼◢".contains(*letter);
    for (columns, rows) in [(80, 24), (20, 24), (12, 11), (6, 9)] {
        for t_s in player.decisions_s() {
            let frame = player.frame(t_s, (columns, rows));
            let widest = frame.lines().map(|line| line.chars().count()).max();
            assert!(
                widest <= Some(columns),
                "{widest:?} of {columns} columns\n{frame}"
            );
            assert!(frame.lines().count() <= rows, "{rows} rows\n{frame}");
            assert_eq!(
                frame.chars().filter(robot).count(),
                1,
                "{columns} x {rows}\n{frame}"
            );
        }
    }
}

/// The data of a page that is the value of an attribute.
fn side(attribute: &str) -> Value {
    let page = attribute.split('"').next().unwrap();
    let page = page.replace("&lt;", "<").replace("&gt;", ">");
    data(
        &page
            .replace("&quot;", "\"")
            .replace("&#39;", "'")
            .replace("&amp;", "&"),
    )
}

#[test]
fn the_page_of_a_study_is_that_of_its_best_trial() {
    let folder = tempfile::tempdir().unwrap();
    let [study, run, page, expected] =
        ["study", "run", "study.html", "run.html"].map(|name| folder.path().join(name));
    let [study, run, page, expected] =
        [&study, &run, &page, &expected].map(|path| path.to_str().unwrap());
    let file = folder.path().join("two.toml");
    let text = r#"
        name = "two"
        worlds = ["maze4"]
        methods = ["q-learning", "xcscr-plus"]
        arenas = ["grid"]
        trials = 2
        episodes = 5
        "#;
    fs::write(&file, text).unwrap();
    let command = [
        "study",
        "run",
        file.to_str().unwrap(),
        "--quiet",
        "--out",
        study,
    ];
    let (code, _, stderr) = outcome(&command);
    assert_eq!(code, Some(0), "{stderr}");
    let (code, stdout, stderr) = outcome(&["replay", study, "--html", page]);
    assert_eq!(code, Some(0), "{stderr}");
    let (trial, rest) = stdout.split_once(": ").unwrap();
    assert!(rest.starts_with("maze4, xcscr-plus, seed "), "{stdout}");
    // The trials of the table say the same.
    let trials = fs::read_to_string(Path::new(study).join("trials.csv")).unwrap();
    let mut rows = csv::Reader::from_reader(trials.as_bytes());
    let rows: Vec<BTreeMap<String, String>> = rows.deserialize().map(Result::unwrap).collect();
    let steps =
        |row: &BTreeMap<String, String>| row["first_optimal_env_steps"].parse().unwrap_or(u64::MAX);
    let best = rows
        .iter()
        .enumerate()
        .min_by_key(|(_, row)| steps(row))
        .unwrap();
    assert_eq!(trial, format!("trial {}", best.0));
    let seed = best.1["seed"].as_str();
    let options = [
        "--arena",
        "grid",
        "--episodes",
        "5",
        "--quiet",
        "--seed",
        seed,
        "--out",
        run,
    ];
    let train = [&["train", "maze4"], &options[..]].concat();
    assert_eq!(outcome(&train).0, Some(0));
    assert_eq!(outcome(&["replay", run, "--html", expected]).0, Some(0));
    let decisions = |page: &str| data(&fs::read_to_string(page).unwrap())["decisions"].clone();
    assert_eq!(decisions(page), decisions(expected));
}
