//! What a recording must be.

mod common;

use std::collections::BTreeMap;
use std::fs;

use common::{Trial, contents, names};
use foxglove::Decode;
use foxglove::messages::{FrameTransforms, SceneUpdate};
use serde_json::Value;
use xcscr::record::reader::Recording;
use xcscr::record::{RecordMode, Recorder, RunInfo, check_recording, compare};
use xcscr::world::Maze;

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

/// A fresh recording of a trial, and the folder that holds it.
fn fresh() -> (tempfile::TempDir, Vec<Recording>) {
    let folder = tempfile::tempdir().unwrap();
    let files = Trial::default().record(folder.path()).unwrap().files;
    let recordings = files.iter().map(|file| Recording::open(file).unwrap());
    let recordings = recordings.collect();
    (folder, recordings)
}

#[test]
fn a_fresh_recording_is_sound_and_its_layout_points_at_what_exists() {
    for recording in fresh().1 {
        assert_eq!(
            check_recording(&recording),
            [],
            "{}",
            recording.path().display()
        );
    }
}

#[test]
fn linear_and_indexed_reading_give_the_same_messages() {
    for recording in fresh().1 {
        let summary = mcap::Summary::read(recording.bytes()).unwrap().unwrap();
        let chunks = summary.chunk_indexes.iter();
        let indexed: Vec<(String, u64, Vec<u8>)> = chunks
            .flat_map(|chunk| summary.stream_chunk(recording.bytes(), chunk).unwrap())
            .map(|message| message.unwrap())
            .map(|m| (m.channel.topic.clone(), m.log_time, m.data.to_vec()))
            .collect();
        let linear = recording.messages().map(|message| message.unwrap());
        let linear: Vec<_> = linear
            .map(|m| (m.topic().to_owned(), m.time_ns, m.data))
            .collect();
        assert!(!linear.is_empty());
        assert!(linear == indexed);
    }
}

#[test]
fn every_topic_has_a_schema_and_every_json_message_only_fields_of_its_schema() {
    for recording in fresh().1 {
        let mut fields = BTreeMap::new();
        for topic in recording.topics() {
            assert!(
                !topic.schema.is_empty() && !topic.schema_data.is_empty(),
                "{topic:?}"
            );
            let schema: Option<Value> = serde_json::from_slice(&topic.schema_data).ok();
            assert_eq!(schema.is_some(), topic.encoding == "json", "{}", topic.name);
            fields.insert(topic.name, schema.unwrap_or_default());
        }
        for message in recording.messages().map(|message| message.unwrap()) {
            let json = message.json().unwrap_or_default();
            for (field, _) in json.as_object().into_iter().flatten() {
                let known = &fields[message.topic()]["properties"][field];
                assert!(
                    known["description"].is_string(),
                    "{} {field}",
                    message.topic()
                );
            }
        }
    }
}

#[test]
fn a_seek_shows_the_whole_scene() {
    for recording in fresh().1 {
        let mut ids: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for message in recording.messages().map(|message| message.unwrap()) {
            if !message.topic().starts_with("/scene/") {
                continue;
            }
            let scene = SceneUpdate::decode(message.data.as_slice()).unwrap();
            let named: Vec<_> = scene.entities.iter().map(|e| e.id.clone()).collect();
            assert!(scene.entities.iter().all(|e| e.lifetime.is_none()));
            let before = ids
                .entry(message.topic().to_owned())
                .or_insert(named.clone());
            assert_eq!(
                *before,
                named,
                "a message on {} leaves others",
                message.topic()
            );
        }
        assert!(ids.len() >= 3, "{ids:?}");
    }
}

#[test]
fn all_frames_are_there_from_the_first_moment_on() {
    let (_folder, recordings) = fresh();
    for recording in recordings
        .iter()
        .filter(|r| !r.path().ends_with("run.mcap"))
    {
        let first = recording.messages().next().unwrap().unwrap();
        assert_eq!(first.topic(), "/tf");
        let children = |data: &[u8]| {
            let tree = FrameTransforms::decode(data).unwrap().transforms;
            let names = tree.iter().map(|frame| frame.child_frame_id.clone());
            names.collect::<Vec<_>>()
        };
        for message in recording.messages().map(|message| message.unwrap()) {
            if message.topic() == "/tf" {
                let names = children(&message.data);
                assert_eq!(names, ["robot"]);
            }
        }
    }
}

#[test]
fn an_episode_file_tells_how_to_run_it_again() {
    for recording in fresh().1 {
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
            Recorder::create(folder.path(), &trial.maze(), info, RecordMode::All).unwrap();
        let mut method = trial.learner();
        trial.run(method.as_mut(), &mut recorder);
        contents(&recorder.finish(method.as_ref()).unwrap().files).swap_remove(0)
    };
    let (one, two, disguised) = (record(1, 1), record(2, 2), record(2, 1));
    assert_eq!(compare(&one, &one).unwrap(), None);
    assert_eq!(compare(&one, &two).unwrap().unwrap().topic, "metadata");
    let found = compare(&one, &disguised).unwrap().unwrap();
    assert_eq!(found.topic, "/step", "{found}");
}

#[test]
fn a_part_is_refused_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let trial = Trial::default();
    let recorder =
        Recorder::create(folder.path(), &trial.maze(), trial.info(), trial.mode).unwrap();
    let part = folder.path().join("run.mcap.part");
    let said = Recording::open(&part).unwrap_err().to_string();
    assert!(
        said.contains("never finished") && said.contains("xcscr recover"),
        "{said}"
    );
    drop(recorder);
}

#[test]
fn a_flipped_bit_anywhere_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let file = Trial::default()
        .record(folder.path())
        .unwrap()
        .files
        .swap_remove(0);
    let sound = fs::read(&file).unwrap();
    for at in (0..sound.len()).step_by(97) {
        let mut bytes = sound.clone();
        bytes[at] ^= 0x10;
        let found = Recording::from_bytes(&file, bytes);
        assert!(
            found.is_err(),
            "nobody saw the bit at {at} of {}",
            sound.len()
        );
    }
}
