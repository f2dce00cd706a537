//! What a recording must be.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use crate::kit::folder::names;
use crate::kit::messages::{messages, on, said, scene};
use crate::kit::scripted::Scripted;
use crate::kit::trial::{Trial, contents};
use foxglove::Decode;
use foxglove::messages::log::Level;
use foxglove::messages::{FrameTransform, FrameTransforms, Log};
use serde_json::Value;
use xcscr::record::reader::Recording;
use xcscr::record::{EPOCH_NS, compare};
use xcscr::record::{Recorder, RunInfo};
use xcscr::world::Maze;

/// The episodes that a mode keeps, of ways with 12, 10, 3 (to nowhere), 10 and 14 steps.
fn kept(mode: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let trial = Trial {
        episodes: 5,
        explore: 0.0,
        mode: mode.parse().unwrap(),
        ..Trial::default()
    };
    let mut walker = Scripted::new(&[
        "EWESSSEEEESS",
        "ESSSEEEESS",
        "EWE",
        "ESSSEEEESS",
        "NNEWESSSEEEESS",
    ]);
    let summary = trial.record_with(folder.path(), &mut walker).unwrap();
    let names = names(folder.path());
    assert!(
        !names.iter().any(|name| name.ends_with(".part")),
        "{names:?}"
    );
    let files = names.iter().filter(|name| name.ends_with(".mcap")).count();
    assert_eq!(files, summary.files.len());
    let episodes = names.iter().filter_map(|name| name.strip_prefix("ep-"));
    episodes.map(|name| name.replace(".mcap", "")).collect()
}

#[test]
fn each_mode_keeps_its_episodes() {
    assert_eq!(kept("all"), ["0001", "0002", "0003", "0004", "0005"]);
    assert_eq!(kept("every:2"), ["0001", "0003", "0005"]);
    assert_eq!(kept("none"), Vec::<String>::new());
}

/// The recordings of a trial of four episodes in physics. The last one is that of the run.
fn fresh() -> &'static [Recording] {
    static FRESH: LazyLock<Vec<Recording>> = LazyLock::new(|| {
        let trial = Trial {
            arena: "physics",
            ..Trial::default()
        };
        let folder = tempfile::tempdir().unwrap();
        let files = trial.record(folder.path()).unwrap().files;
        let recordings = files.iter().map(|file| Recording::open(file).unwrap());
        recordings.collect()
    });
    &FRESH
}

#[test]
fn a_fresh_recording_is_sound_and_its_layout_points_at_what_exists() {
    for recording in fresh() {
        assert_eq!(recording.check(), [""; 0], "{}", recording.path().display());
    }
}

#[test]
fn every_topic_has_a_schema() {
    for recording in fresh() {
        for topic in recording.topics() {
            assert!(
                !topic.schema.is_empty() && !topic.schema_data.is_empty(),
                "{topic:?}"
            );
            let schema: Option<Value> = serde_json::from_slice(&topic.schema_data).ok();
            assert_eq!(schema.is_some(), topic.encoding == "json", "{}", topic.name);
        }
    }
}

/// The fields of the JSON topics of a recording, and whether all are explained.
fn fields(recording: &Recording) -> BTreeMap<(String, String), bool> {
    let mut fields = BTreeMap::new();
    for topic in recording.topics() {
        let schema: Value = serde_json::from_slice(&topic.schema_data).unwrap_or_default();
        for (field, known) in schema["properties"].as_object().into_iter().flatten() {
            let name = (topic.name.clone(), field.clone());
            fields.insert(name, known["description"].is_string());
        }
    }
    fields
}

#[test]
fn every_field_is_explained_in_every_recording() {
    let mut met = 0;
    for recording in fresh() {
        for (name, is_explained) in fields(recording) {
            assert!(is_explained, "{name:?}");
            met += 1;
        }
    }
    assert!(met > 40, "{met} fields");
}

#[test]
fn a_seek_shows_the_whole_scene() {
    for recording in fresh() {
        let mut ids: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for message in messages(recording) {
            let topic = message.topic();
            if !topic.starts_with("/scene/") {
                continue;
            }
            let entities = scene(&message).entities;
            assert!(entities.iter().all(|entity| entity.lifetime.is_none()));
            let named: Vec<_> = entities.into_iter().map(|entity| entity.id).collect();
            let before = ids.entry(topic.to_owned()).or_insert(named.clone());
            assert_eq!(*before, named, "a message on {topic} leaves others");
        }
        assert!(ids.len() >= 3, "{ids:?}");
    }
}

/// After a seek a viewer is given the last message of each topic up to then, and no more.
#[test]
fn a_seek_to_any_step_finds_something_on_every_topic() {
    for recording in &fresh()[..4] {
        let before = messages(recording).take_while(|message| message.topic() != "/step");
        let said: BTreeSet<String> = before.map(|m| m.topic().to_owned()).collect();
        let topics = recording.topics().into_iter().map(|topic| topic.name);
        let silent: Vec<String> = topics.filter(|name| !said.contains(name)).collect();
        assert_eq!(silent, ["/episode", "/step"]);
    }
}

#[test]
fn the_robot_is_there_from_the_first_moment_on_and_never_jumps() {
    for recording in &fresh()[..4] {
        assert_eq!(messages(recording).next().unwrap().topic(), "/tf");
        let mut before_ns = None;
        for message in on(recording, "/tf") {
            let frames = FrameTransforms::decode(message.data.as_slice()).unwrap();
            let names = frames.transforms.iter().map(|frame| &*frame.child_frame_id);
            let names: Vec<&str> = names.collect();
            assert_eq!(names, ["odom", "base_link", "base_link_true"]);
            let now_ns = message.time_ns;
            // No message looks ahead.
            let mut times_ns = frames.transforms.iter().map(time_ns);
            assert!(times_ns.all(|time_ns| time_ns == now_ns));
            let apart_ns = now_ns - before_ns.replace(now_ns).unwrap_or(now_ns);
            assert!(apart_ns <= 500_000_000, "{apart_ns} ns before {now_ns} ns");
        }
    }
}

/// When a frame was there, in nanoseconds since the beginning of the run.
fn time_ns(frame: &FrameTransform) -> u64 {
    let stamp = frame.timestamp.unwrap();
    u64::from(stamp.sec()) * 1_000_000_000 + u64::from(stamp.nsec()) - EPOCH_NS
}

#[test]
fn an_episode_file_tells_how_to_run_it_again() {
    for recording in fresh() {
        let run = recording.metadata("run").unwrap();
        assert_eq!(
            (run["seed"].as_str(), run["method"].as_str()),
            ("1", "xcscr")
        );
        let world = recording.attachment("world.json").unwrap();
        assert_eq!(
            Maze::from_json(world, "world.json").unwrap(),
            Trial::default().maze()
        );
        let is_run = run["episode"] == "run";
        assert_eq!(recording.attachment("rules.json").is_some(), is_run);
    }
}

#[test]
fn another_seed_differs_first_in_the_facts_and_then_in_a_field() {
    let record = |seed, named| {
        let folder = tempfile::tempdir().unwrap();
        let trial = Trial {
            seed,
            ..Trial::default()
        };
        let info = RunInfo {
            seed: named,
            ..trial.info()
        };
        let mut recorder =
            Recorder::create(folder.path(), &trial.maze(), info, trial.mode).unwrap();
        let mut method = trial.learner();
        trial.run(method.as_mut(), &mut recorder);
        contents(&recorder.finish(method.as_ref()).unwrap().files).swap_remove(0)
    };
    let (one, two, disguised) = (record(1, 1), record(2, 2), record(2, 1));
    assert_eq!(compare(&one, &one).unwrap(), None);
    let found = compare(&one, &two).unwrap().unwrap();
    assert!(found.starts_with("at 0 s, metadata, "), "{found}");
    let found = compare(&one, &disguised).unwrap().unwrap();
    assert!(found.contains(" s, /rule, "), "{found}");
}

#[test]
fn a_hit_is_a_contact_that_ends_and_a_warning_with_its_impulse() {
    let contacts = said(&fresh()[0], "/contact");
    let touching: Vec<bool> = contacts
        .iter()
        .map(|(_, contact)| contact["touching"].as_bool().unwrap())
        .collect();
    assert!(touching.len() > 2 && !touching[0] && !touching[touching.len() - 1]);
    let warnings: Vec<Log> = on(&fresh()[0], "/log")
        .map(|message| Log::decode(message.data.as_slice()).unwrap())
        .filter(|line| line.level == Level::Warning as i32)
        .collect();
    let said = &warnings[0].message;
    assert!(said.starts_with("contact going "), "{said}");
    assert!(
        said.contains(", impulse ") && said.contains(" N s; value of "),
        "{said}"
    );
}

#[test]
fn a_step_gives_its_reason_when_it_is_decided_and_its_outcome_when_it_happened() {
    let (rules, steps) = (said(&fresh()[0], "/rule"), said(&fresh()[0], "/step"));
    assert_eq!(rules.len(), steps.len());
    let contacts = said(&fresh()[0], "/contact");
    let mut collisions = 0;
    for ((decided_ns, rule), (known_ns, step)) in rules.iter().zip(&steps) {
        assert_eq!(
            (&rule["step"], &rule["action"]),
            (&step["step"], &step["action"])
        );
        assert!(decided_ns < known_ns, "{step}");
        if step["outcome"] == "collided" {
            collisions += 1;
            let hits = contacts.iter().filter(|(_, c)| c["step"] == step["step"]);
            let mut hits = hits.filter(|(_, contact)| contact["touching"] == true);
            let (hit_ns, _) = hits.next().unwrap();
            assert!(hit_ns <= known_ns, "announced before it happened: {step}");
        }
    }
    assert!(collisions > 0);
}

#[test]
fn a_reason_names_rule_action_worth_error_and_support_and_says_when_it_is_none() {
    let (mut chosen, mut explored) = (0, 0);
    for recording in &fresh()[..4] {
        let rules = said(recording, "/rule").into_iter();
        for ((_, rule), (_, step)) in rules.zip(said(recording, "/step")) {
            let [text, action, seen] =
                ["rule", "action", "seen"].map(|key| rule[key].as_str().unwrap());
            assert!(text.contains(&format!(" -> {action}, value ")), "{text}");
            let [set, all] = ["action_set", "match_set"].map(|key| &step[key]);
            let support = format!(", {set} of {all} matching rules agree");
            assert!(text.ends_with(&support), "{text}");
            let is_explored = rule["explored"] == true;
            assert_eq!(
                text.starts_with("explores by chance"),
                is_explored,
                "{text}"
            );
            explored += usize::from(is_explored);
            chosen += usize::from(!is_explored);
            assert!(
                seen.contains("north wall") || seen.contains("north free"),
                "{seen}"
            );
        }
    }
    assert!(chosen > 0 && explored > 0);
}
