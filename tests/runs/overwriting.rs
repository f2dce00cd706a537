//! Nothing is overwritten that somebody else wrote: every command that writes, against files and
//! folders that it finds.

use std::fs;
use std::path::{Path, PathBuf};

use crate::kit::folder::contents;
use crate::kit::program::{ended, expect, outcome, spawn, xcscr};

const WORLD: &str = "worlds/maze4.json";

/// A folder for everything, and paths in it as arguments.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn name(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    /// A folder with these files in it, each of which says who wrote it.
    fn folder(&self, name: &str, files: &[&str]) -> String {
        fs::create_dir_all(self.path(name)).unwrap();
        for file in files {
            fs::write(self.path(name).join(file), "mine").unwrap();
        }
        self.name(name)
    }
}

const STUDY: &str = r#"
name = "small"
worlds = ["maze4"]
methods = ["xcs"]
trials = 2
episodes = 2
"#;

fn study(out: &str, more: &[&str]) -> Vec<String> {
    let file = Path::new(out).with_file_name("small.toml");
    fs::write(&file, STUDY).unwrap();
    let words = ["study", "run", file.to_str().unwrap()];
    let folder = ["--quiet", "--out", out];
    let all = words.iter().chain(&folder).chain(more);
    all.map(|&word| word.to_owned()).collect()
}

#[track_caller]
fn refused(args: &[&str], folder: &Path, words: &str) {
    let before = contents(folder);
    let (_, stderr) = expect(73, args);
    assert!(stderr.contains(words), "{args:?}: {stderr}");
    assert!(contents(folder) == before, "{args:?} changed a file");
}

fn words(args: &[String]) -> Vec<&str> {
    args.iter().map(String::as_str).collect()
}

#[test]
fn a_study_takes_no_folder_of_somebody_else() {
    let desk = Desk::new();
    for file in [
        "report.md",
        "trials.csv",
        "summary.json",
        "curves.svg",
        "journal",
        "run.lock",
        "notes.txt",
    ] {
        let out = desk.folder(file, &[file]);
        for more in [&[][..], &["--force"]] {
            let args = study(&out, more);
            refused(&words(&args), &desk.path(file), "did not create");
        }
    }
    // A finished run is somebody's work, too.
    let run = desk.name("run");
    let trained = ["train", WORLD, "--episodes", "1", "--quiet", "--out", &run];
    expect(0, &trained);
    for more in [&[][..], &["--force"]] {
        let args = study(&run, more);
        refused(&words(&args), &desk.path("run"), "did not create");
    }
}

#[test]
fn a_study_goes_on_in_its_own_folder_and_is_replaced_only_by_force() {
    let desk = Desk::new();
    let out = desk.name("s");
    let part = study(&out, &["--shard", "1/2"]);
    expect(0, &words(&part));
    let whole = study(&out, &[]);
    expect(0, &words(&whole));
    let first = contents(&desk.path("s"));
    expect(0, &words(&whole));
    assert!(contents(&desk.path("s")) == first, "run again");
    let other = study(&out, &["--seed", "2"]);
    refused(&words(&other), &desk.path("s"), "--force");
    fs::write(desk.path("s").join("notes.txt"), "mine").unwrap();
    let forced = study(&out, &["--seed", "2", "--force"]);
    expect(0, &words(&forced));
    assert_eq!(fs::read(desk.path("s").join("notes.txt")).unwrap(), b"mine");
    assert!(contents(&desk.path("s")) != first, "another seed");
}

#[test]
fn a_report_that_was_changed_by_hand_stays_until_it_is_forced() {
    let desk = Desk::new();
    let out = desk.name("s");
    expect(0, &words(&study(&out, &[])));
    let before = contents(&desk.path("s"));
    for file in ["report.md", "trials.csv", "summary.json", "curves.svg"] {
        fs::write(desk.path("s").join(file), "mine").unwrap();
        let again = study(&out, &[]);
        for args in [
            &["study", "report", &out][..],
            &["study", "merge", &out, "--out", &out],
            &words(&again),
        ] {
            refused(args, &desk.path("s"), "--force");
        }
        expect(0, &["study", "report", &out, "--force"]);
        assert!(contents(&desk.path("s")) == before, "{file}");
    }
}

#[test]
fn a_report_leaves_nothing_in_a_folder_without_a_study() {
    let desk = Desk::new();
    let folder = desk.folder("other", &["run.lock"]);
    let before = contents(&desk.path("other"));
    expect(66, &["study", "report", &folder]);
    assert!(contents(&desk.path("other")) == before);
}

#[test]
fn a_lock_file_that_no_process_left_is_kept_and_named() {
    let desk = Desk::new();
    let out = desk.name("run");
    let args = ["train", WORLD, "--episodes", "1", "--quiet", "--out", &out];
    expect(0, &args);
    fs::write(desk.path("run").join("run.lock"), "mine").unwrap();
    for more in [&[][..], &["--force"]] {
        let (_, stderr) = expect(73, &[&args, more].concat());
        assert!(
            stderr.contains("run.lock") && stderr.contains("move it away"),
            "{stderr}"
        );
        let kept = fs::read_to_string(desk.path("run").join("run.lock")).unwrap();
        assert_eq!(kept, "mine");
    }
    // Control: the number of a process that is gone is no hindrance.
    fs::write(desk.path("run").join("run.lock"), "4294967295\n").unwrap();
    expect(0, &[&args, &["--force"][..]].concat());
}

#[test]
fn a_run_is_forced_only_into_the_place_of_a_run() {
    let desk = Desk::new();
    for (i, files) in [
        &["config.json"][..],
        &["config.json", "rules.json", "world.json"],
        &["checkpoint"],
        &["checkpoint", "run.mcap"],
        &["run.lock", "thesis.txt"],
    ]
    .into_iter()
    .enumerate()
    {
        let name = format!("{i}");
        let out = desk.folder(&name, files);
        for more in [&[][..], &["--force"]] {
            let args = ["train", WORLD, "--episodes", "1", "--quiet", "--out", &out];
            refused(
                &[&args, more].concat(),
                &desk.path(&name),
                "xcscr did not create",
            );
        }
    }
    // Control: what a run wrote is replaced, and what else is there stays.
    let out = desk.name("run");
    let args = ["train", WORLD, "--episodes", "1", "--quiet", "--out", &out];
    expect(0, &args);
    fs::write(desk.path("run").join("notes.txt"), "mine").unwrap();
    refused(&args, &desk.path("run"), "--force");
    expect(0, &[&args[..], &["--force"]].concat());
    assert_eq!(
        fs::read(desk.path("run").join("notes.txt")).unwrap(),
        b"mine"
    );
}

#[test]
fn pictures_and_recovered_recordings_want_force_for_a_file_that_exists() {
    let desk = Desk::new();
    let run = desk.name("run");
    expect(
        0,
        &["train", WORLD, "--episodes", "1", "--quiet", "--out", &run],
    );
    let recording = format!("{run}/run.mcap");
    let out = desk.folder("out", &["p.svg", "p.png", "r.mcap"]);
    let commands = [
        (&["map", &run][..], "p.svg"),
        (&["map", &run], "p.png"),
        (&["recording", "recover", &recording], "r.mcap"),
    ];
    for (command, file) in commands {
        let target = format!("{out}/{file}");
        let args = [command, &["-o", &target]].concat();
        refused(&args, &desk.path("out"), "--force");
        expect(0, &[&args[..], &["--force"]].concat());
        assert_ne!(fs::read(&target).unwrap(), b"mine");
    }
}

#[test]
fn exports_stories_maps_and_manual_pages_want_force_for_a_file_that_exists() {
    let desk = Desk::new();
    let run = desk.name("run");
    let trained = ["train", WORLD, "--episodes", "6", "--quiet", "--out", &run];
    expect(
        0,
        &[&trained[..], &["--arena", "grid", "--method", "q-learning"]].concat(),
    );
    let out = desk.folder("out", &["p.py", "s.mcap", "m.yaml", "m.pgm", "xcscr.1"]);
    let [export, highlights, map] =
        ["p.py", "s.mcap", "m.yaml"].map(|name| format!("{out}/{name}"));
    for (args, replaced) in [
        (
            &["export", &run, "--target", "python", "-o", &export][..],
            "p.py",
        ),
        (
            &["recording", "highlights", &run, "-o", &highlights],
            "s.mcap",
        ),
        (&["world", "convert", WORLD, "-o", &map], "m.pgm"),
        (&["man", "--out", &out], "xcscr.1"),
    ] {
        refused(args, &desk.path("out"), "--force");
        expect(0, &[args, &["--force"]].concat());
        let now = fs::read(desk.path("out").join(replaced)).unwrap();
        assert_ne!(now, b"mine", "{args:?}");
    }
    // The same pages again are no others.
    expect(0, &["man", "--out", &out]);
}

#[test]
fn an_evaluation_is_forced_only_into_the_place_of_an_evaluation() {
    let desk = Desk::new();
    let run = desk.name("run");
    let trained = ["train", WORLD, "--episodes", "1", "--quiet", "--out", &run];
    expect(0, &[&trained[..], &["--arena", "grid"]].concat());
    let notes = desk.folder("notes", &["notes.txt"]);
    let evaluate = ["evaluate", &run, "--episodes", "1", "--record", "--out"];
    for taken in [&notes, &run] {
        for more in [&[][..], &["--force"]] {
            let args = [&evaluate[..], &[taken], more].concat();
            refused(&args, Path::new(taken), "xcscr did not create");
        }
    }
    // Control: its own earlier recordings.
    let own = desk.name("own");
    let again = [&evaluate[..], &[&own]].concat();
    expect(0, &again);
    refused(&again, &desk.path("own"), "--force");
    expect(0, &[&again[..], &["--force"]].concat());
    // One that was killed has no whole `run.mcap`.
    fs::rename(desk.path("own/run.mcap"), desk.path("own/run.mcap.part")).unwrap();
    refused(&again, &desk.path("own"), "--force");
    expect(0, &[&again[..], &["--force"]].concat());
    assert!(!desk.path("own/run.mcap.part").exists());
}

#[test]
fn an_evaluation_is_not_taken_for_a_training() {
    let desk = Desk::new();
    let [run, own] = ["run", "own"].map(|name| desk.name(name));
    let trained = [
        "train",
        WORLD,
        "--episodes",
        "1",
        "--quiet",
        "--arena",
        "grid",
        "--out",
        &run,
    ];
    expect(0, &trained);
    expect(
        0,
        &[
            "evaluate",
            &run,
            "--episodes",
            "1",
            "--record",
            "--out",
            &own,
        ],
    );
    let (episode, file) = (format!("{own}/ep-0001.mcap"), desk.name("out"));
    for args in [
        &["map", &episode, "-o", "map.svg"][..],
        &["recording", "highlights", &episode, "-o", &file],
        &["replay", &run, &episode, "--compare", "-o", &file],
    ] {
        let (code, _, stderr) = outcome(args);
        assert_eq!(code, Some(65), "{args:?}: {stderr}");
        assert!(stderr.contains("it shows an evaluation"), "{stderr}");
    }
}

#[cfg(unix)]
#[test]
fn too_many_open_files_are_not_another_process() {
    let desk = Desk::new();
    let out = desk.name("run");
    let mut told = 0;
    for limit in 3..12 {
        let mut shell = std::process::Command::new("sh");
        shell
            .args(["-c", &format!("ulimit -n {limit}; exec \"$0\" \"$@\"")])
            .arg(env!("CARGO_BIN_EXE_xcscr"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args([
                "train",
                WORLD,
                "--episodes",
                "1",
                "--quiet",
                "--force",
                "--out",
                &out,
            ]);
        let output = shell.output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
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
    let out = desk.name("run");
    let args = [
        "train",
        WORLD,
        "--episodes",
        "1000000",
        "--quiet",
        "--out",
        &out,
    ];
    let child = spawn(&args);
    while !desk.path("run").join("ep-0003.mcap").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    // The run may be about to write into it: once more, then.
    while desk.path("run").exists() {
        let _ = fs::remove_dir_all(desk.path("run"));
    }
    let output = child.wait_with_output().unwrap();
    let (_, stderr) = ended(&output, 74, "the folder is gone");
    assert!(stderr.contains("its folder is gone"), "{stderr}");
    assert!(!stderr.contains("--resume"), "{stderr}");
    assert!(!stderr.contains("free some space"), "{stderr}");
}

#[cfg(unix)]
#[test]
fn a_folder_whose_name_is_no_text_is_named_so_that_a_shell_finds_it() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let desk = Desk::new();
    let out = desk.0.path().join(OsStr::from_bytes(b"run \xff"));
    let mut command = xcscr(&["train", WORLD, "--episodes", "1", "--json", "--out"]);
    let (stdout, _) = ended(&command.arg(&out).output().unwrap(), 0, "train");
    let report: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let named = report["run_dir"].as_str().unwrap();
    let bash = std::process::Command::new("bash")
        .args(["-c", &format!("cd {named}")])
        .output();
    // Not every system has this shell.
    if let Ok(found) = bash {
        assert!(found.status.success(), "{named}");
    }
}
