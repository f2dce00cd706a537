//! Signals: the first one ends a run after its episode, the second one at once.

use std::os::unix::process::ExitStatusExt;
use std::process::Child;

use crate::kit::desk::Desk;
use crate::kit::program::{ended, output_of, signal, wait_for, wait_for_handlers};

/// A run that takes many seconds unless it is stopped.
pub const LONG_RUN: &str = "train maze4 --episodes 1000000 --arena grid --out @run";

/// Waits for the end; gives stdout and stderr.
#[track_caller]
pub fn end_of(child: Child, code: i32, what: &str) -> (String, String) {
    ended(&output_of(child), code, what)
}

/// Starts a command line, and sends it these signals when it listens to them.
#[track_caller]
pub fn signalled(desk: &Desk, line: &str, names: &[&str]) -> Child {
    let child = desk.spawn(line);
    wait_for_handlers(&child);
    for name in names {
        signal(&child, name);
    }
    child
}

/// Writes a world that is one long winding corridor: to walk it by chance takes a million steps.
fn write_winding_world(desk: &Desk) {
    let (wall, floor) = ("#".repeat(103), format!("#{}#", ".".repeat(101)));
    let closed = "#".repeat(101);
    let doors = [format!("{closed}.#"), format!("#.{closed}")];
    let mut rows = vec![wall.clone()];
    for level in 0..40 {
        rows.push(floor.clone());
        rows.push(doors[level % 2].clone());
    }
    rows.push(floor);
    rows.push(wall);
    rows[1].replace_range(1..2, "S");
    rows[81].replace_range(1..2, "G");
    let world = serde_json::json!({ "name": "winding", "rows": rows });
    desk.write("winding.json", world.to_string());
}

#[test]
fn the_first_signal_ends_the_run_after_its_episode() {
    for name in ["INT", "TERM", "USR1"] {
        let desk = Desk::new();
        let child = desk.spawn(LONG_RUN);
        wait_for(&desk.path("run/ep-0005.mcap"));
        signal(&child, name);
        let (stdout, stderr) = end_of(child, 75, name);
        assert_eq!(stdout, "", "{name}");
        let hint = format!("`xcscr train --resume {}`", desk.name("run"));
        assert!(stderr.contains(&hint), "{name}: {stderr}");
        assert!(!desk.path("run/run.lock").exists(), "{name}");
        let again = signalled(&desk, "train --resume @run", &[name]);
        end_of(again, 75, "the resumed run");
    }
}

/// The standard library aborts when memory runs out: whoever started the program must see that it was killed.
#[test]
fn an_abort_kills_the_program_and_has_no_exit_code() {
    let desk = Desk::new();
    let status = output_of(signalled(&desk, LONG_RUN, &["ABRT"])).status;
    assert_eq!((status.code(), status.signal()), (None, Some(6)));
}

#[cfg(feature = "long")]
#[test]
fn an_episode_without_end_is_left_after_a_signal_and_a_second_one_ends_at_once() {
    let desk = Desk::new();
    write_winding_world(&desk);
    let endless = "train @winding.json --out @run --record none --method adapted-even \
                   --set reward.step_threshold=1000000 --set episode.explore=1";
    let child = desk.spawn(endless);
    wait_for(&desk.path("run/config.json"));
    signal(&child, "TERM");
    let (_, stderr) = end_of(child, 75, "one signal");
    assert!(stderr.contains("--resume"), "{stderr}");
    let child = signalled(&desk, "train --resume @run", &["TERM", "INT"]);
    end_of(child, 130, "two signals");
}

#[cfg(feature = "long")]
#[test]
fn an_evaluation_ends_after_a_signal() {
    let desk = Desk::new();
    desk.train("run", "maze4 --arena grid --episodes 20 --record none");
    for more in ["", "--robustness"] {
        let line = format!("evaluate @run --arena physics --episodes 100000 {more}");
        let child = signalled(&desk, &line, &["TERM"]);
        let (stdout, stderr) = end_of(child, 75, &line);
        assert_eq!(stdout, "", "{line}");
        assert!(stderr.contains("run the same command again"), "{stderr}");
    }
}

#[cfg(feature = "long")]
#[test]
fn a_study_leaves_a_trial_without_end_after_a_signal_and_ends_at_once_after_a_second_one() {
    let desk = Desk::new();
    write_winding_world(&desk);
    let text = r#"
        name = "endless"
        worlds = ["winding.json"]
        methods = ["adapted-even"]
        trials = 1
        episodes = 1000
        [settings]
        reward.step_threshold = 1000000
        episode.explore = 1
    "#;
    desk.write("endless.toml", text);
    let endless = "study run @endless.toml --out @out";
    let child = desk.spawn(endless);
    wait_for(&desk.path("out/journals"));
    wait_for_handlers(&child);
    signal(&child, "USR1");
    let (_, stderr) = end_of(child, 75, "one signal");
    assert!(stderr.contains("run the same command again"), "{stderr}");
    end_of(
        signalled(&desk, endless, &["TERM", "INT"]),
        130,
        "two signals",
    );
}
