//! Nothing is overwritten that somebody else wrote: every command that writes, against files and
//! folders that it finds.

use std::fs;

use crate::kit::desk::Desk;
use crate::kit::folder::contents;
use crate::kit::program::{ended, output_of, signal, wait_for};
use crate::kit::script;

#[test]
fn whatever_writes_leaves_the_files_of_others_and_replaces_its_own_only_by_force() {
    script::run(include_str!("overwriting.txt"));
}

#[cfg(unix)]
#[test]
fn a_link_is_never_written_through_or_replaced() {
    use std::os::unix::fs::symlink;
    let desk = Desk::new();
    desk.train("run", "maze4 --arena grid --episodes 2 --method q-learning");
    desk.write("kept.svg", "mine");
    symlink(desk.path("kept.svg"), desk.path("link.svg")).unwrap();
    symlink(desk.path("nothere.svg"), desk.path("dangling.svg")).unwrap();
    for line in [
        "map @run -o @link.svg",
        "map @run -o @dangling.svg",
        "export @run --target python -o @link.svg",
    ] {
        desk.fails(73, line, "it is a link");
        desk.fails(73, &format!("{line} --force"), "it is a link");
    }
    assert_eq!(desk.text("kept.svg"), "mine");
    assert!(!desk.path("nothere.svg").exists());
    assert!(desk.path("link.svg").is_symlink() && desk.path("dangling.svg").is_symlink());
    desk.ok("map @run -o @kept.svg --force");
}

#[cfg(unix)]
#[test]
fn a_study_writes_and_removes_nothing_through_a_link_in_its_folder() {
    let desk = Desk::new();
    let study = "study run paper --trials 1 --arena grid --jobs 1 --quiet --out @s --episodes";
    desk.ok(&format!("{study} 2"));
    std::fs::rename(desk.path("s/journals"), desk.path("outside")).unwrap();
    std::os::unix::fs::symlink(desk.path("outside"), desk.path("s/journals")).unwrap();
    let before = contents(&desk.path("outside"));
    for line in [format!("{study} 2"), format!("{study} 3 --force")] {
        desk.fails(73, &line, "is a link");
    }
    assert!(
        contents(&desk.path("outside")) == before,
        "a journal changed"
    );
}

#[cfg(unix)]
#[test]
fn the_recordings_of_a_run_that_lasts_can_be_read() {
    let desk = Desk::new();
    let child = desk.spawn("train maze4 --episodes 1000000 --quiet --out @run");
    wait_for(&desk.path("run/ep-0009.mcap"));
    for line in ["recording check @run", "recording info @run"] {
        let (stdout, stderr) = desk.run(0, line);
        assert!(
            stdout.contains("ep-0009.mcap") && !stdout.contains(".part"),
            "{stdout}"
        );
        assert!(stderr.contains("is in use by another process"), "{stderr}");
    }
    desk.fails(66, "rules @run", "has no rules.json yet");
    signal(&child, "KILL");
    output_of(child);
    // Control: a stopped run has an unfinished recording.
    desk.fails(65, "recording check @run", "recordings failed the check");
}

#[cfg(unix)]
#[test]
fn too_many_open_files_are_not_another_process() {
    let desk = Desk::new();
    let mut told = 0;
    for limit in 3..12 {
        let line = "train maze4 --episodes 1 --quiet --force --out @run";
        let output = desk.limited(&format!("-n {limit}"), line).output();
        let stderr = String::from_utf8_lossy(&output.unwrap().stderr).into_owned();
        assert!(!stderr.contains("in use"), "limit {limit}: {stderr}");
        assert!(!stderr.contains("panicked"), "limit {limit}: {stderr}");
        told += usize::from(stderr.contains("ulimit -n"));
    }
    assert!(told > 0, "no limit was named");
}

#[cfg(unix)]
#[test]
fn a_folder_that_vanishes_during_a_run_gets_no_advice_that_cannot_work() {
    let desk = Desk::new();
    let child = desk.spawn("train maze4 --episodes 1000000 --quiet --out @run");
    wait_for(&desk.path("run/ep-0003.mcap"));
    // The run may be about to write into it: once more, then.
    while desk.path("run").exists() {
        let _ = fs::remove_dir_all(desk.path("run"));
    }
    let (_, stderr) = ended(&output_of(child), 74, "the folder is gone");
    assert!(stderr.contains("its folder is gone"), "{stderr}");
    assert!(!stderr.contains("--resume"), "{stderr}");
    assert!(!stderr.contains("free some space"), "{stderr}");
}

#[test]
fn a_missing_file_is_not_said_to_have_lost_its_folder() {
    let desk = Desk::new();
    desk.write("folder/file", "");
    for line in [
        "recording check nothere.mcap",
        "recording verify @folder/nothere.mcap",
        "replay --html @p.html @nothere",
    ] {
        let (_, stderr) = desk.run(66, line);
        assert!(stderr.contains("No such file"), "{line}: {stderr}");
        assert!(!stderr.contains("gone"), "{line}: {stderr}");
    }
}
