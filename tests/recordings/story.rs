//! The story of a run: what it shows, how long it takes, and that it comes from the run alone.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::kit::program::outcome;
use foxglove::Decode;
use foxglove::messages::SceneUpdate;
use serde_json::Value;
use xcscr::record::reader::Recording;
use xcscr::record::{Topic, check};

/// A run in a folder below `parent`.
fn train(parent: &Path, name: &str, more: &[&str]) -> PathBuf {
    let run = parent.join(name);
    let out = ["--quiet", "--out", run.to_str().unwrap()];
    let (code, _, stderr) = outcome(&[&["train", "worlds/maze4.json"][..], &out, more].concat());
    assert_eq!(code, Some(0), "{stderr}");
    run
}

/// What stands in the caption's largest line, chapter after chapter.
fn titles(story: &Recording) -> Vec<String> {
    let captions = story.messages().map(|message| message.unwrap());
    let captions = captions.filter(|message| message.topic() == "/scene/caption");
    let mut titles: Vec<String> = captions
        .map(|message| {
            let scene = SceneUpdate::decode(message.data.as_slice()).unwrap();
            scene.entities[0].texts[1].text.clone()
        })
        .collect();
    titles.dedup();
    titles
}

/// All messages of a topic, as JSON.
fn said(story: &Recording, topic: &str) -> Vec<(u64, Value)> {
    let messages = story.messages().map(|message| message.unwrap());
    let of_topic = messages.filter(|message| message.topic() == topic);
    of_topic
        .map(|message| (message.time_ns, message.json().unwrap()))
        .collect()
}

#[test]
fn the_story_of_a_run_goes_from_failure_to_a_greedy_drive_in_less_than_two_minutes() {
    let folder = tempfile::tempdir().unwrap();
    // With the default percept the first episode of seed 1 reaches the goal, and nothing fails.
    let slow = ["--sensor", "neighbours", "--method", "xcscr"];
    let run = train(folder.path(), "run", &slow);
    let file = run.join("story.mcap");
    assert_eq!(check(&file).unwrap(), []);
    let story = Recording::open(&file).unwrap();
    let titles = titles(&story);
    assert_eq!(titles[0], "Episode 1: how it begins", "{titles:#?}");
    let place = |what: &str| titles.iter().position(|title| title.contains(what));
    let goal = place("the goal for the first time").unwrap();
    let optimal = place("the first optimal policy").unwrap();
    assert!(0 < goal && goal < optimal, "{titles:#?}");
    let last = titles.last().unwrap();
    assert_eq!(last, "After 180 episodes: greedy, exploration off");

    let end_ns = story.messages().map(|m| m.unwrap().time_ns).max().unwrap();
    assert!((30..120).contains(&(end_ns / 1_000_000_000)), "{end_ns} ns");
    assert!(fs::metadata(&file).unwrap().len() < 300_000);

    let episodes = said(&story, "/episode");
    let outcome = |at: usize| episodes[at].1["outcome"].as_str().unwrap();
    assert_eq!([outcome(0), outcome(1)], ["running", "step-limit"]);
    assert_eq!(outcome(episodes.len() - 1), "goal");
    let (drive_ns, _) = episodes[episodes.len() - 2];
    let steps = said(&story, "/step");
    let explored = |after: bool| {
        let of_part = steps.iter().filter(|(at, _)| (*at >= drive_ns) == after);
        of_part.filter(|(_, step)| step["explored"] == true).count()
    };
    assert!(explored(false) > 0 && explored(true) == 0);
    let reasons = said(&story, "/rule");
    let driving = reasons.iter().filter(|(at, _)| *at >= drive_ns);
    for (_, reason) in driving {
        let text = reason["rule"].as_str().unwrap();
        assert!(
            text.ends_with(" match") && text.contains(", worth "),
            "{text}"
        );
        assert!(
            reason["runner_up"].as_str().unwrap().contains(", worth "),
            "{reason}"
        );
    }
}

#[test]
fn every_panel_has_something_to_show_from_the_first_step_on() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), "run", &["--episodes", "3"]);
    let story = Recording::open(&run.join("story.mcap")).unwrap();
    let messages = story.messages().map(|message| message.unwrap());
    let before = messages.take_while(|message| message.topic() != "/step");
    let mut shown: BTreeSet<String> = before.map(|m| m.topic().to_owned()).collect();
    shown.insert("/step".to_owned());
    let all: BTreeSet<String> = story.topics().into_iter().map(|topic| topic.name).collect();
    assert_eq!(shown, all);
    let told = Topic::of_episode(true, false);
    let told = told.iter().map(|topic| topic.name().to_owned());
    assert_eq!(all, told.collect());
}

#[test]
fn the_story_comes_from_the_run_alone_and_has_the_same_bytes_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let few = ["--episodes", "4"];
    let whole = train(folder.path(), "whole", &few);
    let told = fs::read(whole.join("story.mcap")).unwrap();
    let bare = train(
        folder.path(),
        "bare",
        &[&few[..], &["--record", "none"]].concat(),
    );
    assert!(!bare.join("story.mcap").exists());
    for (number, from) in [&whole, &bare, &whole.join("ep-0002.mcap")]
        .into_iter()
        .enumerate()
    {
        let file = folder.path().join(format!("{number}.mcap"));
        let args = ["replay", from.to_str().unwrap(), "--story", "-o"];
        let args = [&args[..], &[file.to_str().unwrap()]].concat();
        let (code, stdout, stderr) = outcome(&args);
        assert_eq!((code, stdout.as_str()), (Some(0), ""), "{stderr}");
        assert!(fs::read(&file).unwrap() == told, "{}", from.display());
        let (code, _, stderr) = outcome(&args);
        assert_eq!(code, Some(73), "a file was replaced: {stderr}");
    }
    let file = whole.join("story.mcap");
    let (code, stdout, _) = outcome(&["replay", file.to_str().unwrap(), "--verify"]);
    assert_eq!(code, Some(0), "{stdout}");
}

#[test]
fn a_run_that_never_succeeds_claims_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(
        folder.path(),
        "run",
        &["--episodes", "2", "--arena", "grid", "--method", "xcscr"],
    );
    let story = Recording::open(&run.join("story.mcap")).unwrap();
    let titles = titles(&story);
    assert!(
        !titles
            .iter()
            .any(|title| title.contains("goal") || title.contains("optimal")),
        "{titles:#?}"
    );
    assert_eq!(
        titles.last().unwrap(),
        "After 2 episodes: greedy, exploration off"
    );
}

#[test]
fn an_evaluation_is_recorded_watched_and_verified_as_a_run_is() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(
        folder.path(),
        "run",
        &["--method", "xcscr-plus", "--episodes", "20"],
    );
    let evaluate = |more: &[&str]| {
        let args = [
            "evaluate",
            run.to_str().unwrap(),
            "--episodes",
            "3",
            "--seed",
            "5",
        ];
        outcome(&[&args[..], more].concat())
    };
    let (_, plain, _) = evaluate(&["--json"]);
    let (code, recorded, stderr) = evaluate(&["--json", "--record"]);
    assert_eq!((code, recorded), (Some(0), plain), "{stderr}");
    let beside = folder.path().join("run-evaluation");
    let episode = beside.join("ep-0003.mcap");
    assert_eq!(check(&episode).unwrap(), []);
    let shown = Recording::open(&episode).unwrap();
    let steps = said(&shown, "/step");
    assert!(steps.len() >= 10 && steps.iter().all(|(_, step)| step["explored"] == false));
    // The policy is there from the first moment on, as it was learned.
    let messages = shown.messages().map(|message| message.unwrap());
    let policy = messages.into_iter().find(|m| m.topic() == "/scene/policy");
    let arrows = SceneUpdate::decode(policy.unwrap().data.as_slice()).unwrap();
    assert!(!arrows.entities[0].triangles.is_empty());
    let (code, stdout, stderr) = outcome(&["replay", beside.to_str().unwrap(), "--verify"]);
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    assert!(
        stdout.starts_with("4 of 4 recordings are the same"),
        "{stdout}"
    );

    let (code, _, stderr) = evaluate(&["--record"]);
    assert_eq!(code, Some(73), "{stderr}");
    assert_eq!(evaluate(&["--record", "--force"]).0, Some(0));
    fs::write(beside.join("notes.txt"), "mine").unwrap();
    let (code, _, stderr) = evaluate(&["--record", "--force"]);
    assert_eq!(code, Some(73), "{stderr}");
    assert!(episode.exists() && beside.join("notes.txt").exists());
}

#[test]
fn a_run_is_summed_up_on_one_screen() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(
        folder.path(),
        "run",
        &["--arena", "grid", "--episodes", "30"],
    );
    let (code, stdout, stderr) = outcome(&["replay", run.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{stderr}");
    assert!(
        stdout.starts_with("maze4: xcscr-plus on grid, neighbours, seed 1, 30 episodes\n"),
        "{stdout}"
    );
    assert!(stdout.contains("32 recordings, "), "{stdout}");
    assert!(stdout.contains("  steps per episode    "), "{stdout}");
    assert!(stdout.lines().count() <= 20, "{stdout}");
    let wide = |line: &&str| line.chars().count() > 80 && !line.contains(run.to_str().unwrap());
    assert_eq!(stdout.lines().find(wide), None);
    let (_, whole, _) = outcome(&["replay", run.join("run.mcap").to_str().unwrap()]);
    assert!(
        whole.contains("/episode"),
        "a single recording is still listed: {whole}"
    );
}

#[test]
fn a_training_ends_with_a_legend_a_curve_and_on_failure_with_what_to_try() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let report = |more: &[&str]| {
        let args = [
            "train",
            "worlds/maze4.json",
            "--arena",
            "grid",
            "--record",
            "none",
        ];
        let to = ["--force", "--out", out.to_str().unwrap()];
        let (code, stdout, stderr) = outcome(&[&args[..], &to, more].concat());
        assert_eq!(code, Some(0), "{stderr}");
        let wide = |line: &&str| line.chars().count() > 80 && !line.contains("Saved in");
        assert_eq!(stdout.lines().find(wide), None);
        stdout
    };
    let failed = report(&["--method", "xcscr", "--episodes", "2"]);
    assert!(failed.contains("  it takes             "), "{failed}");
    assert!(
        failed.contains("  try                  --episodes 4, "),
        "{failed}"
    );
    let solved = report(&["--episodes", "20"]);
    assert!(!solved.contains("  try  "), "{solved}");
    for text in [failed, solved] {
        assert!(text.contains("→ best action"), "{text}");
        let curve = text
            .lines()
            .find(|line| line.starts_with("  steps per episode"));
        assert!(curve.unwrap().contains('█'), "{text}");
    }
}

/// Opened as they are, the robot of one run would jump to where that of the other is.
#[test]
fn two_runs_are_compared_side_by_side_in_one_recording_in_which_nothing_interleaves() {
    let folder = tempfile::tempdir().unwrap();
    let few = ["--episodes", "4"];
    let one = train(
        folder.path(),
        "one",
        &[&few[..], &["--record", "beams"]].concat(),
    );
    let two = train(
        folder.path(),
        "two",
        &[&few[..], &["--seed", "2", "--arena", "grid"]].concat(),
    );
    let file = folder.path().join("both.mcap");
    let [one, two, to] = [&one, &two, &file].map(|path| path.to_str().unwrap());
    let (code, _, stderr) = outcome(&["replay", one, two, "--compare", "-o", to]);
    assert_eq!(code, Some(0), "{stderr}");
    let both = Recording::open(&file).unwrap();
    let mut before_ns = 0;
    let mut ends = BTreeSet::new();
    for message in both.messages().map(|message| message.unwrap()) {
        assert!(message.time_ns >= before_ns, "{}", message.topic());
        before_ns = message.time_ns;
        let (side, topic) = message.topic()[1..].split_once('/').unwrap();
        assert!(["a", "b"].contains(&side), "{}", message.topic());
        if topic.starts_with("scene/") {
            let scene = SceneUpdate::decode(message.data.as_slice()).unwrap();
            let frames = scene.entities.iter().map(|entity| &entity.frame_id);
            for frame in frames {
                assert!(frame.starts_with(&format!("{side}/")), "{topic}: {frame}");
            }
        } else if topic == "curve" {
            // The whole curve, from the first moment on.
            let curve = message.json().unwrap();
            assert_eq!(curve["episode"], serde_json::json!([1, 2, 3, 4]));
            ends.insert(side.to_owned());
        }
    }
    assert_eq!(ends.len(), 2);
    // It says which runs it shows: it can be checked, made again, and served.
    assert_eq!(check(Path::new(to)).unwrap(), []);
    let (code, said, stderr) = outcome(&["replay", to, "--verify"]);
    assert_eq!(code, Some(0), "{said}{stderr}");
    let layout = both.attachment("foxglove-layout.json").unwrap();
    let known: BTreeSet<String> = both.topics().into_iter().map(|topic| topic.name).collect();
    for path in xcscr::record::layout::paths(layout) {
        // Only what a robot that senses believes may be missing.
        let is_known = known.contains(&path.topic);
        assert!(is_known, "{path}");
    }
    let (code, _, stderr) = outcome(&["replay", one, "--compare", "-o", to]);
    assert_eq!(code, Some(2), "{stderr}");
    let (code, _, stderr) = outcome(&["replay", one, two, "--compare", "-o", to]);
    assert_eq!(code, Some(73), "a file was replaced: {stderr}");
    let (code, _, stderr) = outcome(&["replay", one, two, "--compare", "-o", "nowhere/it.mcap"]);
    assert!(
        code == Some(73) && stderr.contains("no such folder"),
        "{stderr}"
    );
    let (code, _, stderr) = outcome(&["replay", one, to, "--compare"]);
    assert!(
        code == Some(65) && stderr.contains("compares two runs"),
        "{stderr}"
    );
}

/// The drive of what was learned is that of an agent which only uses it, whoever learned it.
#[test]
fn a_table_is_said_to_have_chosen_what_it_chose_and_rules_what_they_did() {
    let folder = tempfile::tempdir().unwrap();
    for (method, chooser) in [("q-learning", "table"), ("xcs", "rules")] {
        let few = ["--method", method, "--episodes", "3", "--arena", "grid"];
        let story = train(folder.path(), method, &few).join("story.mcap");
        let told = said(&Recording::open(&story).unwrap(), "/rule");
        let (_, last) = told.last().unwrap();
        assert_eq!(last["chosen_by"], chooser, "{last}");
    }
}
