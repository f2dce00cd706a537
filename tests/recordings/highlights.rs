//! The highlights of a run: what it shows, how long it takes, and that it comes from the run alone.

use std::collections::BTreeSet;
use std::fs;

use foxglove::messages::SceneUpdate;
use xcscr::record::reader::{Message, Recording};
use xcscr::record::{Topic, check};
use xcscr::world::{Cell, Maze};

use crate::kit::desk::Desk;
use crate::kit::messages::{count, messages, on, said, scene};
use crate::{BEAMS, GRID, OTHER, PHYSICS};

/// The highlights of a run, which is put into a desk.
fn highlights(desk: &Desk, arguments: &str) -> Recording {
    desk.train("run", arguments);
    desk.recording("run/highlights.mcap")
}

/// What stands in the caption's largest line, segment after segment.
fn titles(highlights: &Recording) -> Vec<String> {
    let captions = on(highlights, "/scene/caption");
    let title = |message: Message| scene(&message).entities[0].texts[1].text.clone();
    let mut titles: Vec<String> = captions.map(title).collect();
    titles.dedup();
    titles
}

#[test]
fn the_highlights_of_a_run_go_from_failure_to_a_greedy_drive_in_less_than_two_minutes() {
    let desk = Desk::new();
    // With the default percept the first episode of seed 1 reaches the goal, and nothing fails.
    let highlights = highlights(&desk, "maze4 --sensor neighbours --method xcscr");
    let file = desk.path("run/highlights.mcap");
    assert_eq!(check(&file).unwrap(), [""; 0]);
    assert!(fs::metadata(&file).unwrap().len() < 300_000);
    let titles = titles(&highlights);
    assert_eq!(titles[0], "Episode 1: how it begins", "{titles:#?}");
    let place = |what: &str| titles.iter().position(|title| title.contains(what));
    let goal = place("the goal for the first time").unwrap();
    let optimal = place("the first optimal policy").unwrap();
    assert!(0 < goal && goal < optimal, "{titles:#?}");
    let last = titles.last().unwrap();
    assert_eq!(last, "After 180 episodes: greedy, exploration off");
    let end_ns = messages(&highlights).map(|m| m.time_ns).max().unwrap();
    assert!((30..120).contains(&(end_ns / 1_000_000_000)), "{end_ns} ns");

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
    for (at, reason) in said(&highlights, "/rule") {
        if at >= drive_ns {
            let [text, second] = ["rule", "runner_up"].map(|key| reason[key].as_str().unwrap());
            assert!(text.ends_with(" matching rules agree"), "{text}");
            assert!(text.contains(", value "), "{text}");
            assert!(second.contains(", value "), "{reason}");
        }
    }
}

/// The caption and the indicator beside it, which shows `/episode`, never contradict each other.
#[test]
fn a_caption_calls_a_policy_optimal_only_while_the_indicator_does() {
    let desk = Desk::new();
    let highlights = highlights(&desk, "maze4 --arena grid --method xcscr --seed 2");
    let (mut is_optimal, mut claims, mut others) = (false, 0, 0);
    for message in messages(&highlights) {
        match message.topic() {
            "/episode" => is_optimal = message.json().unwrap()["optimal"] == true,
            "/scene/caption" => {
                let scene = scene(&message);
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
    let desk = Desk::new();
    let highlights = highlights(&desk, PHYSICS);
    let before = messages(&highlights).take_while(|message| message.topic() != "/step");
    let mut shown: BTreeSet<String> = before.map(|m| m.topic().to_owned()).collect();
    shown.insert("/step".to_owned());
    let topics = highlights.topics().into_iter();
    let all: BTreeSet<String> = topics.map(|topic| topic.name).collect();
    assert_eq!(shown, all);
    let told = Topic::of_episode(true, false);
    let told = told.iter().map(|topic| topic.name().to_owned());
    assert_eq!(all, told.collect());
}

/// Nothing is known before the first goal, so what is plotted must not be worth alone: the steps
/// that are left tell how the episode goes.
#[test]
fn the_plot_of_worth_has_a_line_from_the_first_decision_on_and_agrees_with_the_words() {
    let desk = Desk::new();
    let highlights = highlights(&desk, PHYSICS);
    let layout = highlights.attachment("foxglove-layout.json").unwrap();
    let layout = String::from_utf8_lossy(layout);
    for plotted in ["\"/rule.left\"", "\"/rule.values["] {
        assert!(layout.contains(plotted), "{plotted}");
    }
    let reasons = said(&highlights, "/rule");
    let (first_ns, first) = &reasons[0];
    let left = first["left"].as_u64();
    assert_eq!((*first_ns, left), (0, Some(100)), "{first}");
    let mut worded = 0;
    for (at, reason) in &reasons {
        assert!(reason["left"].is_u64(), "at {at} ns: {reason}");
        let text = reason["rule"].as_str().unwrap();
        let mut names = ["north", "east", "south", "west"].iter();
        let number = names.position(|&name| reason["action"] == name);
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
fn ray_ends(scene: &SceneUpdate) -> Vec<[f64; 2]> {
    let beams = scene.entities.iter().filter(|entity| entity.id == "beams");
    let lines = beams.flat_map(|entity| &entity.lines);
    let ends = lines.flat_map(|line| {
        let at = line.pose.as_ref().unwrap().position.as_ref().unwrap();
        let rays = line.indices.chunks(2);
        let ends = rays.map(|ray| &line.points[ray[1] as usize]);
        ends.map(|end| [at.x + end.x, at.y + end.y])
    });
    ends.collect()
}

#[test]
fn the_drive_of_highlights_shows_each_beam_as_a_ray_that_ends_at_a_wall() {
    let desk = Desk::new();
    let highlights = highlights(&desk, PHYSICS);
    let drive_ns = said(&highlights, "/episode").iter().rev().nth(1).unwrap().0;
    let maze = Maze::load(&desk.path("run/world.json")).unwrap();
    // A range is off by some centimetres: what is hit has a wall at most that far away.
    let is_at_a_wall = |[x, y]: [f64; 2]| {
        let near = [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1]];
        let rows = f64::from(maze.height());
        near.iter().any(|[east, north]| {
            let (col, row) = (x + east, rows - (y + north));
            let inside = col >= 0.0 && row >= 0.0 && col < f64::from(maze.width()) && row < rows;
            let (col, row) = (col as u16, row as u16);
            !inside || maze.is_wall(Cell { col, row })
        })
    };
    assert_eq!(maze.cell_size_m(), 1.0);
    let (mut rays, mut at_walls) = (0, 0);
    for message in on(&highlights, "/scene/percept") {
        let (ends, at_ns) = (ray_ends(&scene(&message)), message.time_ns);
        // Control: episodes of the training were recorded without beams.
        assert_eq!(ends.is_empty(), at_ns < drive_ns, "{at_ns} ns");
        assert!(ends.is_empty() || ends.len() > 24, "{}", ends.len());
        rays += ends.len();
        at_walls += ends.into_iter().filter(|&end| is_at_a_wall(end)).count();
    }
    assert!(rays > 300, "{rays}");
    let share = at_walls as f64 / rays as f64;
    assert!(share > 0.95, "{at_walls} of {rays}");
}

/// Then each of its segments shows them, and a new run tells the same highlights.
#[test]
fn the_highlights_of_a_run_that_records_beams_show_them_throughout() {
    let desk = Desk::new();
    let highlights = highlights(&desk, BEAMS);
    let mut percepts = on(&highlights, "/scene/percept");
    assert!(percepts.all(|message| !ray_ends(&scene(&message)).is_empty()));
    desk.ok("recording verify @run/highlights.mcap");
}

/// The colours that are drawn are explained in these colours.
#[test]
fn a_recording_has_a_legend_of_what_it_draws_and_of_nothing_else() {
    let desk = Desk::new();
    let policy = "arrow: best action, goal, far, near, never, path, hit";
    let seen = "frame: seen free, seen wall";
    for (name, run, legend) in [
        ("grid", GRID, format!("{policy}, {seen}")),
        ("physics", PHYSICS, format!("{policy}, {seen}, estimate")),
        ("beams", BEAMS, format!("{policy}, {seen}, estimate, lidar")),
    ] {
        desk.train(name, run);
        let episode = desk.recording(&format!("{name}/ep-0001.mcap"));
        let scenes = messages(&episode)
            .filter(|m| ["/scene/maze", "/scene/robot"].contains(&m.topic()))
            .flat_map(|message| scene(&message).entities);
        let rows = scenes.filter(|entity| entity.id.ends_with("legend"));
        let words = rows.flat_map(|row| row.texts).map(|text| text.text);
        assert_eq!(words.collect::<Vec<_>>().join(", "), legend, "{name}");
    }
}

#[test]
fn the_highlights_come_from_the_run_alone_and_have_the_same_bytes_each_time() {
    let desk = Desk::new();
    desk.train("whole", PHYSICS);
    let told = desk.read("whole/highlights.mcap");
    desk.train("bare", &format!("{PHYSICS} --record none"));
    assert!(!desk.path("bare/highlights.mcap").exists());
    for from in ["@whole", "@bare", "@whole/ep-0002.mcap"] {
        let line = format!("recording highlights {from} --force -o @out.mcap");
        let (stdout, _) = desk.run(0, &line);
        assert_eq!(stdout, "", "{from}");
        assert!(desk.read("out.mcap") == told, "{from}");
    }
    desk.ok("recording verify @whole/highlights.mcap");
}

#[test]
fn a_run_that_never_succeeds_claims_nothing() {
    let run = "maze4 --episodes 2 --arena grid --method xcscr";
    let titles = titles(&highlights(&Desk::new(), run));
    let claims = |title: &String| title.contains("goal") || title.contains("optimal");
    assert!(!titles.iter().any(claims), "{titles:#?}");
    let last = titles.last().unwrap();
    assert_eq!(last, "After 2 episodes: greedy, exploration off");
}

#[test]
fn an_evaluation_is_recorded_watched_and_verified_as_a_run_is() {
    let desk = Desk::new();
    desk.train("run", "maze4 --method xcscr-plus --episodes 20");
    let evaluate = "evaluate @run --episodes 3 --seed 5";
    let plain = desk.ok(&format!("{evaluate} --json"));
    let recorded = desk.ok(&format!("{evaluate} --json --record"));
    assert_eq!(recorded, plain);
    let episode = desk.recording("run-evaluation/ep-0003.mcap");
    assert_eq!(episode.check(), [""; 0]);
    let steps = said(&episode, "/step");
    assert!(steps.len() >= 10);
    assert!(steps.iter().all(|(_, step)| step["explored"] == false));
    // The policy is there from the first moment on, as it was learned.
    let policy = on(&episode, "/scene/policy").next().unwrap();
    assert!(!scene(&policy).entities[0].triangles.is_empty());
    let verified = desk.ok("recording verify @run-evaluation");
    let words = "4 of 4 recordings are bit-identical";
    assert!(verified.starts_with(words), "{verified}");

    let again = format!("{evaluate} --record");
    desk.run(73, &again);
    desk.ok(&format!("{again} --force"));
    desk.write("run-evaluation/notes.txt", "mine");
    desk.run(73, &format!("{again} --force"));
    for kept in ["ep-0003.mcap", "notes.txt"] {
        assert!(desk.path("run-evaluation").join(kept).exists(), "{kept}");
    }
}

/// Opened as they are, the robot of one run would jump to where that of the other is.
#[test]
fn two_runs_are_compared_side_by_side_in_one_recording_in_which_nothing_interleaves() {
    let desk = Desk::new();
    desk.train("one", BEAMS);
    desk.train("two", OTHER);
    let compare = "replay @one @two --compare -o @both.mcap";
    desk.ok(compare);
    let both = desk.recording("both.mcap");
    assert!(messages(&both).is_sorted_by_key(|message| message.time_ns));
    for message in messages(&both) {
        let (side, topic) = message.topic()[1..].split_once('/').unwrap();
        assert!(["a", "b"].contains(&side), "{}", message.topic());
        if topic.starts_with("scene/") {
            for entity in scene(&message).entities {
                let frame = entity.frame_id;
                assert!(frame.starts_with(&format!("{side}/")), "{topic}: {frame}");
            }
        }
    }
    // The whole curve, from the first moment on.
    for (side, episodes) in [("a", 5), ("b", 12)] {
        let curves = said(&both, &format!("/{side}/curve"));
        let wanted = serde_json::json!((1..=episodes).collect::<Vec<_>>());
        assert!(!curves.is_empty(), "{side}");
        assert!(curves.iter().all(|(_, curve)| curve["episode"] == wanted));
    }
    // It says which runs it shows: it can be checked, with all that its layout shows, made again, and
    // served.
    assert_eq!(both.check(), [""; 0]);
    desk.ok("recording verify @both.mcap");
}

/// The drive of what was learned is that of an agent which only uses it, whoever learned it.
#[test]
fn a_table_is_said_to_have_chosen_what_it_chose_and_rules_what_they_did() {
    for (method, source) in [("q-learning", "table"), ("xcs", "rules")] {
        let run = format!("maze4 --method {method} --episodes 3 --arena grid");
        let told = said(&highlights(&Desk::new(), &run), "/rule");
        let (_, last) = told.last().unwrap();
        assert_eq!(last["chosen_by"], source, "{last}");
    }
}

/// The most messages of a topic that are shown of an episode; see `record/highlights/builder.rs`.
const MOST_SHOWN: u64 = 2_000;

#[test]
fn highlights_show_no_more_messages_of_an_episode_however_many_steps_it_has() {
    let desk = Desk::new();
    // A random walk along a corridor of ninety cells does not come to its end in so many steps.
    let (wall, free) = ("#".repeat(92), ".".repeat(88));
    let rows = [wall.clone(), format!("#S{free}G#"), wall];
    desk.write("w.json", serde_json::json!({ "rows": rows }).to_string());
    for limit in [2100, 4200] {
        desk.ok(&format!(
            "train @w.json --arena grid --method q-learning --quiet --episodes 1 --force --out @run \
             --set episode.explore=1 --set reward.step_threshold_from_maze=false \
             --set reward.step_threshold={limit}"
        ));
        let recorded = count(&desk.recording("run/ep-0001.mcap"), "/step");
        assert!(recorded > MOST_SHOWN, "control: {recorded}");
        let highlights = desk.recording("run/highlights.mcap");
        assert_eq!(highlights.check(), [""; 0]);
        for topic in ["/step", "/tf", "/scene/trail"] {
            let shown = count(&highlights, topic);
            // The episode and the drive, each with its first and last message and with what stands
            // still after it.
            let range = 500..2 * (MOST_SHOWN + 10);
            assert!(range.contains(&shown), "{limit}, {topic}: {shown}");
        }
    }
}
