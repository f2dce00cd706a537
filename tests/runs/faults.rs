//! Full disks, folders that cannot be used, several processes in one folder, signals, and names
//! that lead elsewhere: a message with file and way out, and nothing whole is harmed.
//!
//! `XCSCR_LONG=1 cargo test --test runs faults` tears ten times as many checkpoints.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::kit::chance::{dice, rounds};
use crate::kit::folder::{assert_same, contents};
use crate::kit::program::{ended, expect, output_of, signal, spawn, wait_until, xcscr};
use xcscr::record;
use xcscr::run::RunFolder;
use xcscr::trial::seal;
use xcscr::xcs::random::Stream;

const WORLD: &str = "worlds/maze4.json";

/// A run that takes many seconds unless it is stopped.
fn long_run(out: &str) -> [&str; 8] {
    [
        "train",
        WORLD,
        "--episodes",
        "1000000",
        "--arena",
        "grid",
        "--out",
        out,
    ]
}

/// Waits until a file is there.
#[track_caller]
fn wait_for(path: &Path) {
    wait_until(&format!("{}", path.display()), || path.exists());
}

/// Waits for the end; gives stdout and stderr.
#[track_caller]
fn end_of(child: Child, code: i32, what: &str) -> (String, String) {
    ended(&output_of(child), code, what)
}

/// A world that is one long winding corridor: to walk it by chance takes a million steps.
fn winding_world(folder: &Path) -> String {
    let (wall, floor) = ("#".repeat(103), format!("#{}#", ".".repeat(101)));
    let door = |left: bool| {
        let closed = "#".repeat(101);
        if left {
            format!("#.{closed}")
        } else {
            format!("{closed}.#")
        }
    };
    let mut rows = vec![wall.clone()];
    for level in 0..40 {
        rows.push(floor.clone());
        rows.push(door(level % 2 == 1));
    }
    rows.push(floor);
    rows.push(wall);
    rows[1].replace_range(1..2, "S");
    rows[81].replace_range(1..2, "G");
    let path = folder.join("winding.json");
    let text = serde_json::json!({ "name": "winding", "rows": rows });
    fs::write(&path, text.to_string()).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn the_first_signal_ends_the_run_with_a_checkpoint() {
    for name in ["INT", "TERM", "USR1"] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("run");
        let dir = out.to_str().unwrap();
        let child = spawn(&long_run(dir));
        wait_for(&out.join("ep-0005.mcap"));
        signal(&child, name);
        let (stdout, stderr) = end_of(child, 75, name);
        assert_eq!(stdout, "", "{name}");
        assert!(
            stderr.contains(&format!("`xcscr train --resume {dir}`")),
            "{name}: {stderr}"
        );
        assert!(!out.join("run.lock").exists(), "{name}");
        let again = spawn(&["train", "--resume", dir]);
        sleep(Duration::from_millis(300));
        signal(&again, name);
        end_of(again, 75, "the resumed run");
    }
}

#[test]
fn an_episode_without_end_is_left_after_a_signal_and_a_second_one_ends_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let world = winding_world(folder.path());
    let out = folder.path().join("run");
    let dir = out.to_str().unwrap();
    let endless = [
        "train",
        &world,
        "--out",
        dir,
        "--record",
        "none",
        "--method",
        "adapted-even",
        "--set",
        "reward.step_threshold=1000000",
        "--set",
        "episode.explore=1",
    ];
    let child = spawn(&endless);
    wait_for(&out.join("config.json"));
    sleep(Duration::from_millis(200));
    signal(&child, "TERM");
    let (_, stderr) = end_of(child, 75, "one signal");
    assert!(stderr.contains("--resume"), "{stderr}");
    let child = spawn(&["train", "--resume", dir]);
    sleep(Duration::from_millis(300));
    signal(&child, "TERM");
    sleep(Duration::from_millis(100));
    signal(&child, "INT");
    end_of(child, 130, "two signals");
}

#[test]
fn a_study_leaves_a_trial_without_end_after_a_signal_and_ends_at_once_after_a_second_one() {
    let folder = tempfile::tempdir().unwrap();
    winding_world(folder.path());
    let study = folder.path().join("endless.toml");
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
    fs::write(&study, text).unwrap();
    let out = folder.path().join("out");
    let (file, dir) = (study.to_str().unwrap(), out.to_str().unwrap());
    let endless = ["study", "run", file, "--out", dir];
    let child = spawn(&endless);
    wait_for(&out.join("journals"));
    sleep(Duration::from_millis(200));
    signal(&child, "USR1");
    let (_, stderr) = end_of(child, 75, "one signal");
    assert!(stderr.contains("run the same command again"), "{stderr}");
    let child = spawn(&endless);
    sleep(Duration::from_millis(300));
    signal(&child, "TERM");
    sleep(Duration::from_millis(100));
    signal(&child, "TERM");
    end_of(child, 130, "two signals");
}

#[test]
fn a_reader_of_stdout_that_goes_away_is_a_clean_end() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let args = [
        "train",
        WORLD,
        "--episodes",
        "5",
        "--out",
        out.to_str().unwrap(),
    ];
    for args in [
        &args[..],
        &["config", "show"],
        &["completions", "bash"],
        &["--help"],
    ] {
        let mut child = spawn(args);
        drop(child.stdout.take());
        let (_, stderr) = end_of(child, 0, &format!("{args:?}"));
        assert_eq!(stderr, "", "{args:?}");
    }
    assert!(out.join("rules.json").is_file());
}

#[test]
fn a_reader_of_stderr_that_goes_away_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let dir = out.to_str().unwrap();
    for (args, code) in [
        (&["train", WORLD, "--episodes", "5", "--out", dir][..], 0),
        (&["train", WORLD, "--out", dir], 73),
        (&["train", "no/such/world"], 66),
        (&["train", "--no-such-flag"], 2),
    ] {
        let mut child = spawn(args);
        drop(child.stderr.take());
        end_of(child, code, &format!("{args:?}"));
    }
}

#[test]
fn messages_hold_no_colours_where_nobody_sees_them() {
    for args in [
        &["train", "no/such/world"][..],
        &["world", "check", "Cargo.toml"],
        &["tarin"],
    ] {
        for (name, value) in [
            ("TERM", "dumb"),
            ("TERM", "xterm-256color"),
            ("NO_COLOR", "1"),
        ] {
            let output = xcscr(args).env(name, value).output().unwrap();
            let stderr = String::from_utf8(output.stderr).unwrap();
            assert!(
                !stderr.contains('\x1b'),
                "{name}={value} {args:?}: {stderr:?}"
            );
        }
    }
}

#[test]
fn a_full_device_for_the_result_is_an_error_with_its_code() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full");
    let Ok(full) = full else {
        return println!("skipped: this system has no /dev/full");
    };
    let output = xcscr(&["config", "show"])
        .stdout(full)
        .stderr(Stdio::piped())
        .output();
    let (_, stderr) = ended(&output.unwrap(), 74, "stdout on /dev/full");
    assert!(stderr.contains("cannot write the result"), "{stderr}");
}

/// Every file that has its final name is whole: recordings are sound, the checkpoint resumes.
#[track_caller]
fn assert_whole(folder: &Path) {
    for (name, bytes) in contents(folder) {
        if name.ends_with(".mcap") {
            let findings = record::check(&folder.join(&name)).unwrap();
            assert!(findings.is_empty(), "{name}: {findings:?}");
        } else if name.ends_with(".json") {
            serde_json::from_slice::<serde_json::Value>(&bytes).expect(&name);
        }
    }
}

#[test]
fn a_file_size_limit_ends_in_code_74_and_the_run_goes_on_when_it_is_lifted() {
    let folder = tempfile::tempdir().unwrap();
    let (out, wanted) = (folder.path().join("run"), folder.path().join("wanted"));
    let args = |out: &Path| {
        let dir = out.to_str().unwrap().to_owned();
        ["train", WORLD, "--episodes", "60", "--quiet", "--out"]
            .map(str::to_owned)
            .into_iter()
            .chain([dir])
            .collect::<Vec<_>>()
    };
    let limited = Command::new("sh")
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["-c", "ulimit -f 150; exec \"$0\" \"$@\""])
        .arg(env!("CARGO_BIN_EXE_xcscr"))
        .args(args(&out))
        .output()
        .unwrap();
    let (_, stderr) = ended(&limited, 74, "ulimit -f");
    assert!(
        stderr.contains(".mcap.part") && stderr.contains("--resume"),
        "{stderr}"
    );
    assert_whole(&out);
    expect(0, &["train", "--resume", out.to_str().unwrap()]);
    expect(
        0,
        &args(&wanted).iter().map(String::as_str).collect::<Vec<_>>(),
    );
    assert_same(&out, &wanted, "after the limit was lifted");
}

/// A file system of its own with a few megabytes, while this lives.
struct SmallDisk(tempfile::TempDir);

impl SmallDisk {
    fn mount(size: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let options = format!("size={size}");
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &options, "xcscr-test"])
            .arg(folder.path())
            .output();
        mounted
            .is_ok_and(|output| output.status.success())
            .then_some(Self(folder))
    }

    /// Changes its options, such as `ro` or `size=60m`.
    fn remount(&self, options: &str) {
        let options = format!("remount,{options}");
        let done = Command::new("mount")
            .args(["-o", &options])
            .arg(self.0.path())
            .status();
        assert!(done.unwrap().success(), "{options}");
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).output();
    }
}

#[test]
fn a_full_disk_ends_in_code_74_and_the_run_goes_on_when_there_is_room() {
    let Some(disk) = SmallDisk::mount("2m") else {
        return println!("skipped: only root may mount a small disk, and not everywhere");
    };
    let (out, ballast) = (disk.0.path().join("run"), disk.0.path().join("ballast"));
    let dir = out.to_str().unwrap();
    for room in [4, 40, 400, 1200] {
        fs::write(&ballast, vec![0; (2048 - room) * 1024]).unwrap();
        let output = output_of(spawn(&["train", WORLD, "--out", dir]));
        let code = output.status.code();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            matches!(code, Some(73 | 74)),
            "{room} kB: {code:?} {stderr}"
        );
        assert!(
            stderr.contains("No space left") && stderr.contains(dir),
            "{room} kB: {stderr}"
        );
        if out.exists() {
            assert_whole(&out);
        }
        if room < 1200 {
            let _ = fs::remove_dir_all(&out);
        }
    }
    fs::remove_file(&ballast).unwrap();
    disk.remount("size=60m");
    expect(0, &["train", "--resume", dir]);
    let wanted = disk.0.path().join("wanted");
    expect(0, &["train", WORLD, "--out", wanted.to_str().unwrap()]);
    assert_same(&out, &wanted, "after the disk was full");
}

#[test]
fn pictures_recovered_recordings_and_studies_on_a_full_disk_end_in_code_74_and_leave_nothing_torn()
{
    let Some(disk) = SmallDisk::mount("64k") else {
        return println!("skipped: only root may mount a small disk, and not everywhere");
    };
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let (dir, below) = (run.to_str().unwrap(), |name: &str| disk.0.path().join(name));
    expect(0, &["train", WORLD, "--episodes", "9", "--out", dir]);
    fs::write(below("ballast"), vec![0; 48 * 1024]).unwrap();
    let recording = run.join("run.mcap");
    let (png, mcap, study) = (below("p.png"), below("m.mcap"), below("s"));
    for args in [
        &["map", dir, "-o", png.to_str().unwrap()][..],
        &[
            "recording",
            "recover",
            recording.to_str().unwrap(),
            "-o",
            mcap.to_str().unwrap(),
        ],
        &[
            "study",
            "run",
            "paper",
            "--episodes",
            "1",
            "--out",
            study.to_str().unwrap(),
        ],
    ] {
        let (_, stderr) = expect(74, args);
        assert!(stderr.contains("No space left"), "{args:?}: {stderr}");
    }
    assert_eq!(names_of_files(disk.0.path()), ["ballast"]);
}

/// The names of the files in a folder, without those of folders.
fn names_of_files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    let files = entries.filter(|entry| entry.path().is_file());
    files
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect()
}

#[test]
fn a_disk_that_may_only_be_read_ends_in_code_73_and_is_left_as_it_is() {
    let Some(disk) = SmallDisk::mount("60m") else {
        return println!("skipped: only root may mount a small disk, and not everywhere");
    };
    let (out, new) = (disk.0.path().join("run"), disk.0.path().join("new"));
    let (dir, new_dir) = (out.to_str().unwrap(), new.to_str().unwrap());
    let child = spawn(&long_run(dir));
    wait_for(&out.join("ep-0005.mcap"));
    signal(&child, "KILL");
    child.wait_with_output().unwrap();
    let before = contents(&out);
    disk.remount("ro");
    for args in [
        &["train", "--resume", dir][..],
        &["train", WORLD, "--force", "--out", dir],
        &["train", WORLD, "--out", new_dir],
    ] {
        let (_, stderr) = expect(73, args);
        assert!(stderr.contains("Read-only"), "{args:?}: {stderr}");
    }
    assert!(contents(&out) == before, "something was written");
    disk.remount("rw");
    let again = spawn(&["train", "--resume", dir]);
    sleep(Duration::from_millis(400));
    signal(&again, "TERM");
    end_of(again, 75, "when it may be written again");
}

/// A crash while a file is written leaves any part of the new file aside, whole or torn, in old
/// or new order on the disk; only the last step, which the system makes whole, is the new file.
#[test]
fn wherever_a_checkpoint_is_torn_the_old_one_or_the_new_one_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::create(folder.path(), false).unwrap();
    let mut dice = dice(6);
    let state =
        |dice: &mut Stream| -> Vec<u64> { (0..dice.below(40)).map(|_| dice.bits()).collect() };
    let mut old = state(&mut dice);
    run.save_checkpoint(&old).unwrap();
    for seed in 0..rounds(1_000, 10_000) {
        let new = state(&mut dice);
        let mut torn = seal(&new);
        torn.truncate(dice.below(torn.len() + 1));
        // Blocks that never reached the disk read as zeros.
        let lost = dice.below(torn.len() + 1);
        torn[lost..].fill(0);
        fs::write(folder.path().join(".checkpoint.a1B2c3.tmp"), &torn).unwrap();
        let read = || run.checkpoint::<Vec<u64>>().unwrap().unwrap();
        assert_eq!(read(), old, "seed {seed}: torn to {} bytes", torn.len());
        run.save_checkpoint(&new).unwrap();
        assert_eq!(read(), new, "seed {seed}: what was torn is in the way");
        old = new;
    }
}

#[test]
fn a_folder_that_cannot_be_made_ends_in_code_73() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "precious").unwrap();
    let long = folder.path().join("x".repeat(300));
    for out in [&file, &file.join("below"), &long, Path::new("/proc/run")] {
        let out = out.to_str().unwrap();
        let (_, stderr) = expect(73, &["train", WORLD, "--episodes", "1", "--out", out]);
        assert!(stderr.contains("--out"), "{out}: {stderr}");
    }
    assert_eq!(fs::read(&file).unwrap(), b"precious");
}

#[test]
fn of_eight_processes_in_one_folder_one_wins_and_the_others_name_it() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let dir = out.to_str().unwrap();
    let mut children: Vec<Child> = (0..8).map(|_| spawn(&long_run(dir))).collect();
    wait_until("all but one have ended", || {
        let all = children.iter_mut();
        all.filter_map(|child| child.try_wait().unwrap()).count() == 7
    });
    let alive = children
        .iter_mut()
        .position(|child| child.try_wait().unwrap().is_none());
    let winner = children.swap_remove(alive.expect("one runs"));
    let holder = format!("is in use by process {}", winner.id());
    for loser in children {
        let (_, stderr) = end_of(loser, 73, "a loser");
        assert!(stderr.contains(&holder), "{stderr}");
    }
    for args in [
        &["train", "--resume", dir][..],
        &["train", WORLD, "--force", "--out", dir],
    ] {
        let (_, stderr) = expect(73, args);
        assert!(stderr.contains(&holder), "{args:?}: {stderr}");
    }
    signal(&winner, "KILL");
    winner.wait_with_output().unwrap();
    assert!(
        out.join("run.lock").is_file(),
        "a killed process removes nothing"
    );
    let again = spawn(&["train", "--resume", dir]);
    sleep(Duration::from_millis(400));
    signal(&again, "TERM");
    end_of(
        again,
        75,
        "the lock that a killed process left kept the next one out",
    );
}

#[test]
fn a_forced_run_removes_the_files_of_the_run_before_it_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let (out, fresh) = (folder.path().join("run"), folder.path().join("fresh"));
    let (dir, fresh_dir) = (out.to_str().unwrap(), fresh.to_str().unwrap());
    expect(0, &["train", WORLD, "--episodes", "9", "--out", dir]);
    for name in [
        "ep-0007.mcap.part",
        "run.mcap.part",
        "run.mcap.again",
        ".rules.json.a1B2c3.tmp",
    ] {
        fs::write(out.join(name), "left behind").unwrap();
    }
    fs::write(out.join("notes.txt"), "mine").unwrap();
    fs::create_dir(out.join("figures")).unwrap();
    fs::write(out.join("figures/ep-0001.mcap"), "mine, too").unwrap();
    let anew = ["train", WORLD, "--episodes", "2", "--seed", "4", "--out"];
    expect(0, &[&anew[..], &[dir, "--force"]].concat());
    assert_eq!(fs::read(out.join("notes.txt")).unwrap(), b"mine");
    assert_eq!(
        fs::read(out.join("figures/ep-0001.mcap")).unwrap(),
        b"mine, too"
    );
    fs::remove_file(out.join("notes.txt")).unwrap();
    fs::remove_dir_all(out.join("figures")).unwrap();
    expect(0, &[&anew[..], &[fresh_dir]].concat());
    assert_same(&out, &fresh, "something of the run before was left");
}

#[cfg(unix)]
#[test]
fn links_in_a_run_folder_lead_nobody_out_of_it() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let dir = out.to_str().unwrap();
    expect(0, &["train", WORLD, "--episodes", "2", "--out", dir]);
    let outside = folder.path().join("outside");
    let links = [
        "ep-0001.mcap",
        "ep-0001.mcap.part",
        "ep-0002.mcap.part",
        "run.mcap.part",
        "rules.json",
        "world.json",
        "checkpoint",
        "foxglove-layout.json",
    ];
    for name in links {
        let target = outside.join(name);
        fs::create_dir_all(&outside).unwrap();
        fs::write(&target, "precious").unwrap();
        let _ = fs::remove_file(out.join(name));
        symlink(&target, out.join(name)).unwrap();
    }
    expect(
        0,
        &["train", WORLD, "--episodes", "2", "--force", "--out", dir],
    );
    for (name, bytes) in contents(&outside) {
        assert_eq!(bytes, b"precious", "{name} was written through a link");
    }
    symlink(outside.join("rules.json"), out.join("run.lock")).unwrap();
    let (_, stderr) = expect(73, &["train", WORLD, "--force", "--out", dir]);
    assert!(stderr.contains("run.lock"), "{stderr}");
    assert_eq!(fs::read(outside.join("rules.json")).unwrap(), b"precious");
}

#[cfg(unix)]
#[test]
fn odd_names_of_files_are_taken_as_they_are() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let names: [&[u8]; 4] = [
        b"with spaces and 'quotes'",
        b"\xff\xfe not UTF-8",
        b"-leading",
        "größe ⌘".as_bytes(),
    ];
    for name in names {
        let out = folder.path().join(OsStr::from_bytes(name));
        let run = |args: &[&str]| {
            let mut command = xcscr(args);
            ended(
                &command.arg(&out).output().unwrap(),
                0,
                &format!("{args:?} {out:?}"),
            )
        };
        run(&["train", WORLD, "--episodes", "2", "--json", "--out"]);
        run(&["train", "--resume"]);
        run(&["evaluate", "--episodes", "2"]);
        run(&["recording", "verify"]);
    }
}

#[test]
fn the_name_of_a_world_never_becomes_a_path_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "../up",
        "/etc/x",
        "a/b",
        "..",
        "con",
        &"x".repeat(300),
        "nul\\u0000",
        "a b",
    ] {
        let path = folder.path().join("world.json");
        fs::write(
            &path,
            format!(r#"{{"name": "{name}", "wrap": true, "rows": ["S.G"]}}"#),
        )
        .unwrap();
        let output = xcscr(&["train", path.to_str().unwrap(), "--episodes", "1"])
            .current_dir(folder.path())
            .output()
            .unwrap();
        ended(&output, 65, name);
        assert_eq!(contents(folder.path()).len(), 1, "{name} made something");
    }
}
