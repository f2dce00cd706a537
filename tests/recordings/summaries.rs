//! What is printed of a run on one screen.

use super::GRID;
use crate::kit::desk::Desk;

/// No line but those with a path is wider than a terminal.
#[track_caller]
fn assert_fits(text: &str) {
    let wide = |line: &&str| line.chars().count() > 80 && !line.contains('/');
    assert_eq!(text.lines().find(wide), None);
}

#[test]
fn a_run_is_summed_up_on_one_screen() {
    let desk = Desk::new();
    desk.train("run", GRID);
    let summary = desk.ok("recording info @run");
    let head = "maze4: xcscr on grid, neighbours, seed 1, 12 episodes\n";
    assert!(summary.starts_with(head), "{summary}");
    assert!(summary.contains("13 recordings, "), "{summary}");
    assert!(summary.lines().count() <= 20, "{summary}");
    assert_fits(&summary);
    // A single recording is still listed.
    let whole = desk.ok("recording info @run/run.mcap");
    assert!(whole.contains("/episode"), "{whole}");
}

#[test]
fn a_training_ends_with_policy_legend_and_links_and_on_failure_with_the_greedy_path() {
    let desk = Desk::new();
    let report = |more: &str| {
        let line = "train maze4 --arena grid --force --out @run";
        let (text, stderr) = desk.run(0, &format!("{line} {more}"));
        assert_eq!(stderr, "", "no progress where nobody watches");
        assert_fits(&text);
        assert!(text.contains("→ best action"), "{text}");
        text
    };
    let failed = report("--method xcscr --episodes 2");
    for words in ["  it takes             ", "  short-term filter    "] {
        assert!(failed.contains(words), "{failed}");
    }
    let solved = report("--episodes 20");
    for words in [
        "10 steps, 3 such paths",
        "globally optimal",
        "██→ ↓ ██",
        "/replay.html\n",
        "xcscr replay ",
    ] {
        assert!(solved.contains(words), "{words} in\n{solved}");
    }
}
