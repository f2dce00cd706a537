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
fn a_comparison_of_two_runs_has_no_page_and_the_message_says_what_to_give() {
    let folder = tempfile::tempdir().unwrap();
    let [run, both, page] = ["run", "both.mcap", "page.html"].map(|name| folder.path().join(name));
    let [run, both, page] = [&run, &both, &page].map(|path| path.to_str().unwrap());
    train(run);
    assert_eq!(
        outcome(&["replay", run, run, "--compare", "-o", both]).0,
        Some(0)
    );
    let (code, _, stderr) = outcome(&["replay", both, "--html", page]);
    assert_eq!(code, Some(65), "{stderr}");
    assert!(
        stderr.contains("give a recording of one of them"),
        "{stderr}"
    );
    // Control: one recording of the run has a page.
    let (code, stdout, _) = outcome(&["replay", &format!("{run}/ep-0001.mcap"), "--html", page]);
    assert_eq!(
        (code, stdout.starts_with("file://")),
        (Some(0), true),
        "{stdout}"
    );
    assert!(Path::new(page).is_file());
}
