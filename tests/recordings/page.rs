//! The page that plays a recording: the same numbers as the recording, and nothing that a file could smuggle in.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use serde_json::Value;
use xcscr::record::reader::Recording;
use xcscr::replay::player;

use super::{GRID, PHYSICS};
use crate::kit::desk::Desk;
use crate::kit::flat::Flat;
use crate::kit::messages::{count, messages, said};
use crate::recordings::copies::Parts;

const SAMPLE: &str = "recordings/sample-maze4.mcap";

fn sample() -> Recording {
    Recording::open(Path::new(SAMPLE)).unwrap()
}

/// The data that a page holds.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once(r#"id="data">"#).unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}

/// When the page changes, make it anew: `cargo run -- train maze4 --episodes 5 --out RUN`, and copy
/// `RUN/replay.html` over it.
#[test]
fn the_page_in_the_documentation_is_that_of_a_short_run_and_small() {
    let desk = Desk::new();
    desk.train("run", PHYSICS);
    let kept = fs::read_to_string("docs/sample-maze4.html").unwrap();
    let is_kept = desk.text("run/replay.html") == kept;
    assert!(is_kept, "the page in docs is another one");
    assert!(kept.len() < 300_000, "{} bytes", kept.len());
}

#[test]
fn a_page_has_the_decisions_values_estimates_and_episodes_of_its_recording() {
    let recording = sample();
    let data = data(&player::page(&recording).unwrap());
    let (reasons, steps) = (said(&recording, "/rule"), said(&recording, "/step"));
    let decisions = data["decisions"].as_array().unwrap();
    assert_eq!(decisions.len(), reasons.len());
    let told = reasons.iter().zip(&steps);
    for (decision, ((_, reason), (_, step))) in decisions.iter().zip(told) {
        for field in ["episode", "step", "rule", "action", "seen"] {
            assert_eq!(decision[field], reason[field], "{field}");
        }
        assert_eq!(decision["values"], step["values"], "{decision}");
    }
    for (list, topic) in [
        ("localisations", "/localisation"),
        ("begins", "/begin"),
        ("ends", "/episode"),
        ("poses", "/ground_truth"),
        ("estimated", "/estimate"),
        ("learned", "/values"),
    ] {
        let length = data[list].as_array().unwrap().len();
        assert_eq!(length as u64, count(&recording, topic), "{list}");
    }
    let times = || messages(&recording).map(|message| message.time_ns);
    let length_ns = times().max().unwrap() - times().min().unwrap();
    let end_s = data["end"].as_f64().unwrap();
    assert!((end_s - length_ns as f64 / 1e9).abs() < 0.01, "{end_s}");
    assert_eq!(data["poses"][0].as_array().unwrap().len(), 4);
}

#[test]
fn the_ellipse_of_a_page_has_the_covariance_of_the_estimate() {
    let data = data(&player::page(&sample()).unwrap());
    let mut largest: f64 = 0.0;
    for fact in data["localisations"].as_array().unwrap() {
        let number = |of: &Value, name: &str| of[name].as_f64().unwrap();
        let of_ellipse = |name: &str| number(&fact["ellipse"], name);
        let (long, short) = (of_ellipse("long_m").powi(2), of_ellipse("short_m").powi(2));
        let (sine, cosine) = of_ellipse("direction_rad").sin_cos();
        let xx = long * cosine * cosine + short * sine * sine;
        let yy = long * sine * sine + short * cosine * cosine;
        // The numbers of a page have three decimals.
        let off = |variance: f64, name: &str| (variance.sqrt() - number(fact, name)).abs();
        assert!(
            off(xx, "sd_x_m") < 0.0015 && off(yy, "sd_y_m") < 0.0015,
            "{fact}"
        );
        largest = largest.max(((long - short) * sine * cosine).abs());
    }
    assert!(largest > 1e-6, "control: no ellipse is turned, {largest}");
}

/// Returns the shape of a JSON value: the names of its fields, and the types of its values. A list has the
/// shape of its first entry.
fn shape(value: &Value) -> Value {
    match value {
        Value::Null => "null".into(),
        Value::Bool(_) => "boolean".into(),
        Value::Number(_) => "number".into(),
        Value::String(_) => "string".into(),
        Value::Array(list) => list.iter().take(1).map(shape).collect(),
        Value::Object(fields) => {
            let fields = fields
                .iter()
                .map(|(name, field)| (name.clone(), shape(field)));
            fields.collect::<serde_json::Map<_, _>>().into()
        }
    }
}

/// The script of the page reads these fields.
#[test]
fn the_data_of_a_page_have_these_fields() {
    let data = data(&player::page(&sample()).unwrap());
    insta::assert_snapshot!(serde_json::to_string_pretty(&shape(&data)).unwrap());
}

/// It reads these in addition in the page of a run in a world from a map.
#[test]
fn the_data_of_a_run_have_chapters_packed_episodes_and_walls_of_a_map() {
    let desk = Desk::new();
    desk.write("flat.json", Flat::new().gridded(0.5).maze.to_json());
    desk.ok("train @flat.json --arena grid --episodes 2 --out @run --quiet");
    let data = data(&desk.text("run/replay.html"));
    let fields = ["chapters", "packed_episodes"].map(|field| shape(&data[field]));
    let fields = serde_json::json!([fields, shape(&data["world"]["walls"])]);
    insta::assert_snapshot!(serde_json::to_string_pretty(&fields).unwrap());
}

#[test]
fn the_page_of_a_whole_run_has_its_steps_and_its_learning_curve() {
    let desk = Desk::new();
    desk.train("run", GRID);
    let recording = desk.recording("run/run.mcap");
    let data = data(&player::page(&recording).unwrap());
    let steps = said(&recording, "/step").len();
    assert_eq!(data["decisions"].as_array().unwrap().len(), steps);
    assert_eq!(data["poses"].as_array().unwrap().len(), steps);
    let left = data["decisions"][0]["left"].as_f64().unwrap();
    assert!((90.0..=100.0).contains(&left), "{left} %");
    let episodes: Vec<u32> = (1..=12).collect();
    assert_eq!(data["curve"]["episode"], serde_json::json!(episodes));
}

/// Returns the data of the episodes inside a page by their numbers.
fn packed_episodes(page: &Value) -> BTreeMap<u64, Value> {
    let episodes = page["packed_episodes"].as_array().unwrap().iter();
    let unpacked = episodes.map(|packed| {
        let bytes = STANDARD.decode(packed["data"].as_str().unwrap()).unwrap();
        let data = serde_json::from_reader(ZlibDecoder::new(&bytes[..])).unwrap();
        (packed["episode"].as_u64().unwrap(), data)
    });
    unpacked.collect()
}

#[test]
fn the_page_of_a_run_holds_its_episodes_as_their_recordings_have_them() {
    let desk = Desk::new();
    desk.train("run", GRID);
    desk.ok("replay @run --html @page.html");
    assert!(desk.text("page.html") == desk.text("run/replay.html"));
    let page = data(&desk.text("page.html"));
    let episodes = packed_episodes(&page);
    assert_eq!(episodes.len(), 12);
    for (number, packed) in episodes {
        let recording = desk.recording(&format!("run/ep-{number:04}.mcap"));
        let mut alone = data(&player::page(&recording).unwrap());
        // The episodes share the curve of the run.
        alone["curve"] = Value::Null;
        assert!(packed == alone, "episode {number} differs");
    }
    // Control: the page of a single recording holds no other.
    assert!(packed_episodes(&data(&player::page(&sample()).unwrap())).is_empty());
}

#[test]
fn the_page_of_a_run_stays_small_and_leaves_out_what_does_not_fit() {
    let desk = Desk::new();
    desk.train("run", GRID);
    let large = desk.path("run/ep-0005.mcap");
    let file = fs::OpenOptions::new().write(true).open(&large).unwrap();
    file.set_len(600 << 10).unwrap();
    desk.ok("replay @run --html @page.html");
    let episodes = packed_episodes(&data(&desk.text("page.html")));
    assert_eq!(episodes.len(), 11);
    assert!(!episodes.contains_key(&5));
    // A run of thousands of episodes: every fourth, and so on, is shown, and the last one.
    let one = desk.path("run/ep-0001.mcap");
    let many = vec![one; 3000];
    let (drive, run) = (
        desk.recording("run/ep-0012.mcap"),
        desk.recording("run/run.mcap"),
    );
    let page = player::page_of_run(&drive, &run, &many).unwrap();
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    let shown = data(&page)["packed_episodes"].as_array().unwrap().len();
    assert!((100..1500).contains(&shown), "{shown}");
}

#[test]
fn the_page_loads_nothing_and_its_policy_forbids_it() {
    let page = player::page(&sample()).unwrap();
    for outside in ["http://", "https://", "src=", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains(r#"content="default-src 'none'; "#));
}

#[test]
fn messages_that_take_far_more_memory_than_bytes_are_no_part_of_a_page() {
    let mut parts = Parts::of(&sample());
    let policy = parts.messages_on("/values").next().unwrap();
    // Empty fields of the grid.
    policy.data = [0x42, 0].repeat(4 << 20);
    let name = Path::new("forged.mcap");
    let options = || mcap::WriteOptions::new().compression(None);
    let forged = Recording::from_bytes(name, parts.write(options())).unwrap();
    let fault = player::page(&forged).unwrap_err().to_string();
    assert!(
        fault.contains("larger than the policy of its maze"),
        "{fault}"
    );
    // JSON of 20 MB, which takes some 500 MB as trees.
    parts.messages_on("/values").next().unwrap().data = Vec::new();
    let rule = parts.messages_on("/rule").next().unwrap();
    rule.data = format!("{{\"values\":[{}0]}}", "0,".repeat(10 << 20)).into_bytes();
    let forged = Recording::from_bytes(name, parts.write(options())).unwrap();
    let fault = player::page(&forged).unwrap_err().to_string();
    assert!(fault.contains("too many for a page"), "{fault}");
}

#[test]
fn drawings_are_not_read_and_do_not_count() {
    let mut parts = Parts::of(&sample());
    let trail = parts.messages_on("/scene/trail").next().unwrap();
    trail.data = vec![0xff; 20 << 20];
    let bytes = parts.write(mcap::WriteOptions::new().compression(None));
    let changed = Recording::from_bytes(Path::new("sample.mcap"), bytes).unwrap();
    assert!(player::page(&changed).unwrap() == player::page(&sample()).unwrap());
}

const EVIL: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>";

/// The sample with hostile facts, reasons and outcomes.
fn forged() -> Recording {
    let mut parts = Parts::of(&sample());
    for key in ["world", "method", "arena", "sensor", "seed"] {
        parts.run.insert(key.to_owned(), EVIL.to_owned());
    }
    for topic in ["/rule", "/step", "/episode"] {
        for message in parts.messages_on(topic) {
            let mut fields = message.json().unwrap();
            for field in fields.as_object_mut().unwrap().values_mut() {
                if field.is_string() {
                    *field = EVIL.into();
                }
            }
            message.data = fields.to_string().into_bytes();
        }
    }
    let bytes = parts.write(mcap::WriteOptions::new());
    Recording::from_bytes(Path::new("forged.mcap"), bytes).unwrap()
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
fn the_page_of_a_study_is_that_of_its_best_trial() {
    let desk = Desk::new();
    let text = "name = \"two\"\nworlds = [\"maze4\"]\nmethods = [\"q-learning\", \"xcscr-plus\"]\n\
                arenas = [\"grid\"]\ntrials = 2\nepisodes = 5\n";
    desk.write("two.toml", text);
    desk.ok("study run @two.toml --quiet --out @study");
    let stdout = desk.ok("replay @study --html @study.html");
    let (trial, rest) = stdout.split_once(": ").unwrap();
    assert!(rest.starts_with("maze4, xcscr-plus, seed "), "{stdout}");
    // The trials of the table say the same.
    let trials = desk.read("study/trials.csv");
    let mut rows = csv::Reader::from_reader(&trials[..]);
    let rows: Vec<BTreeMap<String, String>> = rows.deserialize().map(Result::unwrap).collect();
    let steps = |at: &usize| {
        rows[*at]["first_optimal_env_steps"]
            .parse()
            .unwrap_or(u64::MAX)
    };
    let best = (0..rows.len()).min_by_key(steps).unwrap();
    assert_eq!(trial, format!("trial {best}"));
    let seed = &rows[best]["seed"];
    desk.train(
        "run",
        &format!("maze4 --method xcscr-plus --arena grid --episodes 5 --seed {seed}"),
    );
    desk.ok("replay @run --html @run.html");
    let decisions = |page: &str| data(&desk.text(page))["decisions"].clone();
    assert_eq!(decisions("study.html"), decisions("run.html"));
    let inside = packed_episodes(&data(&desk.text("study.html")));
    assert_eq!(inside.len(), 5);
}
