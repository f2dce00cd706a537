//! Readers that go away, folders that cannot be used, several processes in one folder, and names
//! that lead elsewhere: a message with file and way out, and nothing whole is harmed.

use std::fs;
use std::process::{Child, Stdio};

use super::signals::{LONG_RUN, end_of, signalled};
use crate::kit::desk::Desk;
use crate::kit::folder::contents;
use crate::kit::program::{ended, output_of, signal, wait_for, wait_until};

#[test]
fn a_reader_of_stdout_that_goes_away_is_a_clean_end() {
    let desk = Desk::new();
    // Larger than the buffer of a pipe, so that writing must notice the closed end.
    let mut rows = vec!["#".repeat(300); 300];
    rows[1].replace_range(1..3, "SG");
    desk.write("big.json", format!(r#"{{"rows": {rows:?}}}"#));
    for line in [
        "train maze4 --episodes 5 --out @run",
        "world show @big.json",
        "config show",
        "completions bash",
        "--help",
    ] {
        let mut child = desk.spawn(line);
        drop(child.stdout.take());
        let (_, stderr) = end_of(child, 0, line);
        assert_eq!(stderr, "", "{line}");
    }
    assert!(desk.path("run/rules.json").is_file());
}

#[test]
fn a_reader_of_stderr_that_goes_away_changes_nothing() {
    let desk = Desk::new();
    for (code, line) in [
        (0, "train maze4 --episodes 5 --out @run"),
        (73, "train maze4 --out @run"),
        (66, "train no/such/world"),
        (2, "train --no-such-flag"),
    ] {
        let mut child = desk.spawn(line);
        drop(child.stderr.take());
        end_of(child, code, line);
    }
}

#[test]
fn messages_hold_no_colours_where_nobody_sees_them() {
    let desk = Desk::new();
    for line in ["train no/such/world", "world check Cargo.toml", "tarin"] {
        for (name, value) in [
            ("TERM", "dumb"),
            ("TERM", "xterm-256color"),
            ("NO_COLOR", "1"),
        ] {
            let output = desk.command(line).env(name, value).output().unwrap();
            let stderr = String::from_utf8(output.stderr).unwrap();
            assert!(
                !stderr.contains('\x1b'),
                "{name}={value} {line}: {stderr:?}"
            );
        }
    }
}

#[test]
fn a_full_device_for_the_result_is_an_error_with_its_code() {
    let desk = Desk::new();
    for line in ["config show", "world show worlds/maze4.json"] {
        let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") else {
            return println!("skipped: this system has no /dev/full");
        };
        let mut command = desk.command(line);
        let output = command.stdout(full).stderr(Stdio::piped()).output();
        let (_, stderr) = ended(&output.unwrap(), 74, line);
        assert!(
            stderr.starts_with("error: cannot write the result"),
            "{stderr}"
        );
    }
}

#[test]
fn what_a_crash_leaves_before_a_run_begins_is_not_in_the_way() {
    let desk = Desk::new();
    desk.write("run/.unfinished.json.a1B2c3.tmp", r#"{"record": "al"#);
    desk.ok("train maze4 --arena grid --episodes 2 --out @run");
    assert!(!desk.path("run/.unfinished.json.a1B2c3.tmp").exists());
}

#[cfg(feature = "long")]
#[test]
fn of_eight_processes_in_one_folder_one_wins_and_the_others_name_it() {
    let desk = Desk::new();
    let mut children: Vec<Child> = (0..8).map(|_| desk.spawn(LONG_RUN)).collect();
    wait_until("all but one have ended", || {
        let all = children.iter_mut();
        all.filter_map(|child| child.try_wait().unwrap()).count() == 7
    });
    let mut all = children.iter_mut();
    let alive = all.position(|child| child.try_wait().unwrap().is_none());
    let winner = children.swap_remove(alive.expect("one runs"));
    let holder = format!("is in use by process {}", winner.id());
    for loser in children {
        let (_, stderr) = end_of(loser, 73, "a loser");
        assert!(stderr.contains(&holder), "{stderr}");
    }
    desk.fails(73, "train --resume @run", &holder);
    desk.fails(73, "train maze4 --force --out @run", &holder);
    // It can be resumed from its beginning on.
    wait_for(&desk.path("run/unfinished.json"));
    signal(&winner, "KILL");
    output_of(winner);
    // A killed process removes nothing, and its lock keeps the next one not out.
    assert!(desk.path("run/run.lock").is_file());
    let again = signalled(&desk, "train --resume @run", &["TERM"]);
    end_of(again, 75, "after a killed process");
}

#[cfg(unix)]
#[test]
fn links_in_a_run_folder_lead_nobody_out_of_it() {
    use std::os::unix::fs::symlink;
    let desk = Desk::new();
    let run = desk.train("run", "maze4 --episodes 2");
    for name in [
        "ep-0001.mcap",
        "ep-0001.mcap.part",
        "ep-0002.mcap.part",
        "run.mcap.part",
        "rules.json",
        "world.json",
        "unfinished.json",
        "foxglove-layout.json",
    ] {
        desk.write(&format!("outside/{name}"), "precious");
        let _ = fs::remove_file(run.join(name));
        symlink(desk.path("outside").join(name), run.join(name)).unwrap();
    }
    let line = "train maze4 --episodes 2 --force --out @run";
    desk.ok(line);
    for (name, bytes) in contents(&desk.path("outside")) {
        assert_eq!(bytes, b"precious", "{name} was written through a link");
    }
    symlink(desk.path("outside/rules.json"), run.join("run.lock")).unwrap();
    desk.fails(73, line, "run.lock");
    assert_eq!(desk.text("outside/rules.json"), "precious");
}

#[cfg(unix)]
#[test]
fn odd_names_of_files_are_taken_as_they_are() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let desk = Desk::new();
    let names: [&[u8]; 4] = [
        b"with spaces and 'quotes'",
        b"\xff\xfe not UTF-8",
        b"-leading",
        "größe ⌘".as_bytes(),
    ];
    for name in names {
        let out = desk.folder().join(OsStr::from_bytes(name));
        for line in [
            "train maze4 --episodes 2 --json --out",
            "train --resume",
            "evaluate --episodes 2",
            "recording verify",
        ] {
            let output = desk.command(line).arg(&out).output().unwrap();
            ended(&output, 0, &format!("{line} {out:?}"));
        }
    }
}
