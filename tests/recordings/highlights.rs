//! The highlights of a run: what it shows, how long it takes, and that it comes from the run alone.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::kit::program::outcome;
use foxglove::Decode;
use foxglove::messages::SceneUpdate;
use serde_json::Value;
use xcscr::record::reader::Recording;
use xcscr::record::{Topic, check};
use xcscr::world::{Cell, Maze};

/// A run in a folder below `parent`.
fn train(parent: &Path, name: &str, more: &[&str]) -> PathBuf {
    let run = parent.join(name);
    let out = ["--quiet", "--out", run.to_str().unwrap()];
    let (code, _, stderr) = outcome(&[&["train", "worlds/maze4.json"][..], &out, more].concat());
    assert_eq!(code, Some(0), "{stderr}");
    run
}

/// What stands in the caption's largest line, segment after segment.
fn titles(highlights: &Recording) -> Vec<String> {
    let captions = highlights.messages().map(|message| message.unwrap());
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
fn said(highlights: &Recording, topic: &str) -> Vec<(u64, Value)> {
    let messages = highlights.messages().map(|message| message.unwrap());
    let of_topic = messages.filter(|message| message.topic() == topic);
    of_topic
        .map(|message| (message.time_ns, message.json().unwrap()))
        .collect()
}

#[test]
fn the_highlights_of_a_run_go_from_failure_to_a_greedy_drive_in_less_than_two_minutes() {
    let folder = tempfile::tempdir().unwrap();
    // With the default percept the first episode of seed 1 reaches the goal, and nothing fails.
    let slow = ["--sensor", "neighbours", "--method", "xcscr"];
    let run = train(folder.path(), "run", &slow);
    let file = run.join("highlights.mcap");
    assert_eq!(check(&file).unwrap(), []);
    let highlights = Recording::open(&file).unwrap();
    let titles = titles(&highlights);
    assert_eq!(titles[0], "Episode 1: how it begins", "{titles:#?}");
    let place = |what: &str| titles.iter().position(|title| title.contains(what));
    let goal = place("the goal for the first time").unwrap();
    let optimal = place("the first optimal policy").unwrap();
    assert!(0 < goal && goal < optimal, "{titles:#?}");
    let last = titles.last().unwrap();
    assert_eq!(last, "After 180 episodes: greedy, exploration off");

    let end_ns = highlights
        .messages()
        .map(|m| m.unwrap().time_ns)
        .max()
        .unwrap();
    assert!((30..120).contains(&(end_ns / 1_000_000_000)), "{end_ns} ns");
    assert!(fs::metadata(&file).unwrap().len() < 300_000);

    let episodes = said(&highlights, "/episode");
    let outcome = |at: usize| episodes[at].1["outcome"].as_str().unwrap();
    assert_eq!([outcome(0), outcome(1)], ["running", "step-limit"]);
    assert_eq!(outcome(episodes.len() - 1), "goal");
    let (drive_ns, _) = episodes[episodes.len() - 2];
    let steps = said(&highlights, "/step");
    let explored = |after: bool| {
        let of_part = steps.iter().filter(|(at, _)| (*at >= drive_ns) == after);
        of_part.filter(|(_, step)| step["explored"] == true).count()
    };
    assert!(explored(false) > 0 && explored(true) == 0);
    let reasons = said(&highlights, "/rule");
    let driving = reasons.iter().filter(|(at, _)| *at >= drive_ns);
    for (_, reason) in driving {
        let text = reason["rule"].as_str().unwrap();
        assert!(
            text.ends_with(" matching rules agree") && text.contains(", value "),
            "{text}"
        );
        assert!(
            reason["runner_up"].as_str().unwrap().contains(", value "),
            "{reason}"
        );
    }
}

/// The caption and the indicator beside it, which shows `/episode`, never contradict each other.
#[test]
fn a_caption_calls_a_policy_optimal_only_while_the_indicator_does() {
    let folder = tempfile::tempdir().unwrap();
    let few = ["--arena", "grid", "--method", "xcscr", "--seed", "2"];
    let run = train(folder.path(), "run", &few);
    let highlights = Recording::open(&run.join("highlights.mcap")).unwrap();
    let (mut is_optimal, mut claims, mut others) = (false, 0, 0);
    for message in highlights.messages().map(|message| message.unwrap()) {
        match message.topic() {
            "/episode" => is_optimal = message.json().unwrap()["optimal"] == true,
            "/scene/caption" => {
                let scene = SceneUpdate::decode(message.data.as_slice()).unwrap();
                let mut lines = scene.entities[0].texts.iter();
                match lines.any(|line| line.text.contains("optimal policy")) {
                    true => {
                        assert!(is_optimal, "at {} ns", message.time_ns);
                        claims += 1;
                    }
                    // Control: there are captions from before it was optimal.
                    false => others += usize::from(!is_optimal),
                }
            }
            _ => {}
        }
    }
    assert!(claims == 1 && others > 1, "{claims}, {others}");
}

#[test]
fn every_panel_has_something_to_show_from_the_first_step_on() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), "run", &["--episodes", "3"]);
    let highlights = Recording::open(&run.join("highlights.mcap")).unwrap();
    let messages = highlights.messages().map(|message| message.unwrap());
    let before = messages.take_while(|message| message.topic() != "/step");
    let mut shown: BTreeSet<String> = before.map(|m| m.topic().to_owned()).collect();
    shown.insert("/step".to_owned());
    let all: BTreeSet<String> = highlights
        .topics()
        .into_iter()
        .map(|topic| topic.name)
        .collect();
    assert_eq!(shown, all);
    let told = Topic::of_episode(true, false);
    let told = told.iter().map(|topic| topic.name().to_owned());
    assert_eq!(all, told.collect());
}

/// Nothing is known before the first goal, so what is plotted must not be worth alone: the steps
/// that are left tell how the episode goes.
#[test]
fn the_plot_of_worth_has_a_line_from_the_first_decision_on_and_agrees_with_the_words() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), "run", &["--episodes", "4"]);
    let highlights = Recording::open(&run.join("highlights.mcap")).unwrap();
    let layout =
        xcscr::record::layout::paths(highlights.attachment("foxglove-layout.json").unwrap());
    for plotted in ["left", "values"] {
        let is_plotted = |path: &str| path == format!("/rule.{plotted}");
        assert!(
            layout.iter().any(|path| is_plotted(&path.to_string())),
            "{plotted}"
        );
    }
    let reasons = said(&highlights, "/rule");
    let (first_ns, first) = &reasons[0];
    assert_eq!(
        (*first_ns, first["left"].as_u64()),
        (0, Some(100)),
        "{first}"
    );
    let mut worded = 0;
    for (at, reason) in &reasons {
        assert!(reason["left"].is_u64(), "at {at} ns: {reason}");
        let text = reason["rule"].as_str().unwrap();
        let action = reason["action"].as_str().unwrap();
        let number = ["north", "east", "south", "west"]
            .iter()
            .position(|&it| it == action);
        let percent = reason["values"][number.unwrap()].as_f64();
        let words = text.split_once(", value ").map(|(_, rest)| rest);
        let words = words.and_then(|rest| rest.split([',', ' ']).next()?.parse::<f64>().ok());
        // Control: what has no value in words has none in the plot.
        assert_eq!(words.is_some(), percent.is_some(), "{reason}");
        if let Some((words, percent)) = words.zip(percent) {
            assert!((words - 10.0 * percent).abs() <= 1.0, "{reason}");
            worded += 1;
        }
    }
    assert!(0 < worded && worded < reasons.len(), "{worded}");
}

/// The rays of a message of `/scene/percept`, as their ends in the world.
fn ray_ends(data: &[u8]) -> Vec<[f64; 2]> {
    let scene = SceneUpdate::decode(data).unwrap();
    let beams = scene.entities.iter().filter(|entity| entity.id == "beams");
    let lines: Vec<_> = beams.flat_map(|entity| &entity.lines).collect();
    let ends = lines.iter().flat_map(|line| {
        let at = line.pose.as_ref().unwrap().position.as_ref().unwrap();
        let ends = line
            .indices
            .chunks(2)
            .map(|ray| &line.points[ray[1] as usize]);
        ends.map(|end| [at.x + end.x, at.y + end.y])
    });
    ends.collect()
}

#[test]
fn the_drive_of_highlights_shows_each_beam_as_a_ray_that_ends_at_a_wall() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), "run", &["--episodes", "4"]);
    let highlights = Recording::open(&run.join("highlights.mcap")).unwrap();
    let drive_ns = said(&highlights, "/episode").iter().rev().nth(1).unwrap().0;
    let maze = Maze::load(&run.join("world.json")).unwrap();
    // A range is off by some centimetres: what is hit has a wall at most that far away.
    let is_at_a_wall = |[x, y]: [f64; 2]| {
        let near = [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1]];
        let rows = f64::from(maze.height());
        near.iter().any(|[east, north]| {
            let (col, row) = (x + east, rows - (y + north));
            let inside = col >= 0.0 && row >= 0.0 && col < f64::from(maze.width()) && row < rows;
            !inside
                || maze.is_wall(Cell {
                    col: col as u16,
                    row: row as u16,
                })
        })
    };
    assert_eq!(maze.cell_size_m(), 1.0);
    let percepts = highlights.messages().map(|message| message.unwrap());
    let percepts = percepts.filter(|message| message.topic() == "/scene/percept");
    let (mut rays, mut at_walls) = (0, 0);
    for message in percepts {
        let ends = ray_ends(&message.data);
        // Control: episodes of the training were recorded without beams.
        assert_eq!(
            ends.is_empty(),
            message.time_ns < drive_ns,
            "{} ns",
            message.time_ns
        );
        assert!(ends.is_empty() || ends.len() > 24, "{}", ends.len());
        rays += ends.len();
        at_walls += ends.into_iter().filter(|&end| is_at_a_wall(end)).count();
    }
    assert!(
        rays > 300 && at_walls as f64 > 0.95 * rays as f64,
        "{at_walls} of {rays}"
    );
}

/// Then each of its segments shows them, and a new run tells the same highlights.
#[test]
fn the_highlights_of_a_run_that_records_beams_show_them_throughout() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(
        folder.path(),
        "run",
        &["--episodes", "2", "--record", "beams"],
    );
    let file = run.join("highlights.mcap");
    let highlights = Recording::open(&file).unwrap();
    let percepts = highlights.messages().map(|message| message.unwrap());
    let mut percepts = percepts.filter(|message| message.topic() == "/scene/percept");
    assert!(percepts.all(|message| !ray_ends(&message.data).is_empty()));
    let (code, stdout, stderr) = outcome(&["recording", "verify", file.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{stdout}{stderr}");
}

/// The colours that are drawn are explained in these colours.
#[test]
fn a_recording_has_a_legend_of_what_it_draws_and_of_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let legend = |name: &str, more: &[&str]| {
        let run = train(folder.path(), name, &[&["--episodes", "1"], more].concat());
        let episode = Recording::open(&run.join("ep-0001.mcap")).unwrap();
        let scenes = episode.messages().map(|message| message.unwrap());
        let scenes = scenes.filter(|m| ["/scene/maze", "/scene/robot"].contains(&m.topic()));
        let entities =
            scenes.flat_map(|m| SceneUpdate::decode(m.data.as_slice()).unwrap().entities);
        let rows = entities.filter(|entity| entity.id.ends_with("legend"));
        let words = rows.flat_map(|row| row.texts).map(|text| text.text);
        words.collect::<Vec<_>>().join(", ")
    };
    let policy = "arrow: best action, goal, far, near, never, path, hit";
    let seen = "frame: seen free, seen wall";
    assert_eq!(
        legend("grid", &["--arena", "grid"]),
        format!("{policy}, {seen}")
    );
    let senses = format!("{policy}, {seen}, estimate");
    assert_eq!(legend("physics", &[]), senses);
    assert_eq!(
        legend("beams", &["--record", "beams"]),
        format!("{senses}, lidar")
    );
}

#[test]
fn the_highlights_come_from_the_run_alone_and_have_the_same_bytes_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let few = ["--episodes", "4"];
    let whole = train(folder.path(), "whole", &few);
    let told = fs::read(whole.join("highlights.mcap")).unwrap();
    let bare = train(
        folder.path(),
        "bare",
        &[&few[..], &["--record", "none"]].concat(),
    );
    assert!(!bare.join("highlights.mcap").exists());
    for (number, from) in [&whole, &bare, &whole.join("ep-0002.mcap")]
        .into_iter()
        .enumerate()
    {
        let file = folder.path().join(format!("{number}.mcap"));
        let args = ["recording", "highlights", from.to_str().unwrap(), "-o"];
        let args = [&args[..], &[file.to_str().unwrap()]].concat();
        let (code, stdout, stderr) = outcome(&args);
        assert_eq!((code, stdout.as_str()), (Some(0), ""), "{stderr}");
        assert!(fs::read(&file).unwrap() == told, "{}", from.display());
        let (code, _, stderr) = outcome(&args);
        assert_eq!(code, Some(73), "a file was replaced: {stderr}");
    }
    let file = whole.join("highlights.mcap");
    let (code, stdout, _) = outcome(&["recording", "verify", file.to_str().unwrap()]);
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
    let highlights = Recording::open(&run.join("highlights.mcap")).unwrap();
    let titles = titles(&highlights);
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
    let (code, stdout, stderr) = outcome(&["recording", "verify", beside.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    assert!(
        stdout.starts_with("4 of 4 recordings are bit-identical"),
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
    let (code, stdout, stderr) = outcome(&["recording", "info", run.to_str().unwrap()]);
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
    let (_, whole, _) = outcome(&["recording", "info", run.join("run.mcap").to_str().unwrap()]);
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
    let advice = "  try                  --method xcscr-plus --episodes 30";
    assert!(failed.contains(advice), "{failed}");
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
    let (code, said, stderr) = outcome(&["recording", "verify", to]);
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
        code == Some(65) && stderr.contains("comparison of two runs"),
        "{stderr}"
    );
}

/// The drive of what was learned is that of an agent which only uses it, whoever learned it.
#[test]
fn a_table_is_said_to_have_chosen_what_it_chose_and_rules_what_they_did() {
    let folder = tempfile::tempdir().unwrap();
    for (method, chooser) in [("q-learning", "table"), ("xcs", "rules")] {
        let few = ["--method", method, "--episodes", "3", "--arena", "grid"];
        let highlights = train(folder.path(), method, &few).join("highlights.mcap");
        let told = said(&Recording::open(&highlights).unwrap(), "/rule");
        let (_, last) = told.last().unwrap();
        assert_eq!(last["chosen_by"], chooser, "{last}");
    }
}
