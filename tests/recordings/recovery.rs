//! What is saved of broken recordings.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::kit::folder::names;
use crate::kit::program::{outcome, wait_until};
use crate::kit::trial::Trial;
use xcscr::record::RecordError;
use xcscr::record::reader::Recording;
use xcscr::record::recover;

/// A recording of an episode, and what is in it.
fn recorded(folder: &Path) -> (PathBuf, Vec<u8>) {
    let trial = Trial {
        episodes: 1,
        arena: "physics",
        ..Trial::default()
    };
    let file = trial.record(folder).unwrap().files.swap_remove(0);
    let bytes = fs::read(&file).unwrap();
    (file, bytes)
}

fn said(recording: &Recording) -> Vec<(String, u64, Vec<u8>)> {
    let messages = recording.messages().map(|message| message.unwrap());
    messages
        .map(|m| (m.topic().to_owned(), m.time_ns, m.data))
        .collect()
}

#[test]
fn a_sound_recording_is_recovered_without_loss_and_stays_sound() {
    let folder = tempfile::tempdir().unwrap();
    let (file, bytes) = recorded(folder.path());
    let out = folder.path().join("out.mcap");
    let recovery = recover(&file, &out, false).unwrap();
    assert!(recovery.is_lossless(), "{recovery:?}");
    let (old, new) = (
        Recording::open(&file).unwrap(),
        Recording::open(&out).unwrap(),
    );
    assert_eq!(said(&old), said(&new));
    assert_eq!(old.attachments(), new.attachments());
    assert_eq!(old.metadata("run"), new.metadata("run"));
    assert_eq!(old.topics(), new.topics());
    assert_eq!(bytes, fs::read(&file).unwrap(), "the input changed");
}

#[test]
fn a_recording_cut_anywhere_gives_its_whole_records_and_says_what_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let (file, bytes) = recorded(folder.path());
    let whole = said(&Recording::open(&file).unwrap());
    let (cut, out) = (
        folder.path().join("cut.mcap.part"),
        folder.path().join("out.mcap"),
    );
    let mut before = 0;
    for part in 1..50 {
        let length = bytes.len() * part / 50;
        fs::write(&cut, &bytes[..length]).unwrap();
        let recovery = recover(&cut, &out, true).unwrap();
        let recording = Recording::open(&out).unwrap();
        let saved = said(&recording);
        assert!(
            saved.len() >= before,
            "{part}/50: {} after {before}",
            saved.len()
        );
        assert_eq!(saved, whole[..saved.len()], "{part}/50");
        assert_eq!(recovery.messages, saved.len() as u64);
        let all = saved.len() == whole.len();
        assert!(all || !recovery.is_lossless(), "{part}/50: {recovery:?}");
        before = saved.len();
    }
    assert_eq!(before, whole.len(), "only the index was missing at 49/50");
}

#[test]
fn a_flipped_bit_costs_at_most_its_chunk_and_is_never_called_lossless() {
    let folder = tempfile::tempdir().unwrap();
    let (file, bytes) = recorded(folder.path());
    let (bad, out) = (
        folder.path().join("bad.mcap"),
        folder.path().join("out.mcap"),
    );
    let data_end = mcap::read::footer(&bytes).unwrap().summary_start as usize - 13;
    for at in (8..data_end).step_by(211) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x10;
        fs::write(&bad, bytes).unwrap();
        match recover(&bad, &out, true) {
            Ok(recovery) => {
                assert!(!recovery.is_lossless(), "bit at {at}: {recovery:?}");
                Recording::open(&out).unwrap();
            }
            Err(error) => panic!("bit at {at} of {}: {error}", file.display()),
        }
    }
}

#[test]
fn a_damaged_index_is_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    let (file, bytes) = recorded(folder.path());
    let whole = said(&Recording::open(&file).unwrap());
    let (bad, out) = (
        folder.path().join("bad.mcap"),
        folder.path().join("out.mcap"),
    );
    let start = mcap::read::footer(&bytes).unwrap().summary_start as usize;
    for at in (start..bytes.len() - 8).step_by(101) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1;
        fs::write(&bad, bytes).unwrap();
        let recovery = recover(&bad, &out, true).unwrap();
        assert!(recovery.is_lossless(), "bit at {at}: {recovery:?}");
        assert_eq!(said(&Recording::open(&out).unwrap()), whole, "bit at {at}");
        let (code, ..) = outcome(&["recording", "check", out.to_str().unwrap()]);
        assert_eq!(code, Some(0), "bit at {at}");
    }
}

#[test]
fn a_recording_that_ends_between_two_records_is_not_called_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (_, bytes) = recorded(folder.path());
    let (cut, out) = (
        folder.path().join("cut.mcap"),
        folder.path().join("out.mcap"),
    );
    fs::write(&cut, &bytes[..8]).unwrap();
    let recovery = recover(&cut, &out, false).unwrap();
    assert_eq!((recovery.messages, recovery.lost_bytes), (0, 0));
    assert!(
        recovery
            .fault
            .unwrap()
            .contains("the end of the file is missing")
    );
}

#[test]
fn files_beside_a_picture_or_a_recovered_recording_are_nobodys_scratch_space() {
    let folder = tempfile::tempdir().unwrap();
    let (file, bytes) = recorded(folder.path());
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for other in ["out.mcap.recovering", "out.mcap.part"] {
        fs::write(path(other), "precious").unwrap();
    }
    let (code, _, stderr) = outcome(&[
        "recording",
        "recover",
        file.to_str().unwrap(),
        "-o",
        &path("out.mcap"),
    ]);
    assert_eq!(code, Some(0), "{stderr}");
    for other in ["out.mcap.recovering", "out.mcap.part"] {
        assert_eq!(fs::read(path(other)).unwrap(), b"precious", "{other}");
    }
    fs::rename(&file, path("in.mcap.recovering")).unwrap();
    let (code, ..) = outcome(&[
        "recording",
        "recover",
        &path("in.mcap.recovering"),
        "-o",
        &path("in.mcap"),
    ]);
    assert_eq!(code, Some(0));
    assert_eq!(fs::read(path("in.mcap.recovering")).unwrap(), bytes);
    let left = names(folder.path());
    assert!(!left.iter().any(|name| name.starts_with('.')), "{left:?}");
    let nowhere = path("no/such/folder.mcap");
    let (code, ..) = outcome(&["recording", "recover", &path("in.mcap"), "-o", &nowhere]);
    assert_eq!(code, Some(73));
}

#[test]
fn recover_never_touches_its_input_and_overwrites_only_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let (file, bytes) = recorded(folder.path());
    let name = file.to_str().unwrap();
    for more in [&[][..], &["--force"]] {
        let (code, _, stderr) =
            outcome(&[&["recording", "recover", name, "-o", name], more].concat());
        assert_eq!(code, Some(73), "{stderr}");
    }
    assert_eq!(bytes, fs::read(&file).unwrap());
    let out = folder.path().join("out.mcap");
    fs::write(&out, "mine").unwrap();
    let out = out.to_str().unwrap();
    let (code, _, stderr) = outcome(&["recording", "recover", name, "-o", out]);
    assert_eq!(code, Some(73), "{stderr}");
    assert!(stderr.contains("--force"), "{stderr}");
    assert_eq!(fs::read(out).unwrap(), b"mine");
    let (code, stdout, stderr) = outcome(&["recording", "recover", name, "-o", out, "--force"]);
    assert_eq!((code, stdout.as_str()), (Some(0), ""), "{stderr}");
    assert!(stderr.contains("nothing was lost"), "{stderr}");
    fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    let (code, _, stderr) = outcome(&["recording", "recover", name, "-o", out, "--force"]);
    assert_eq!(code, Some(3), "{stderr}");
    assert!(
        stderr.contains("lost ") && stderr.contains("from byte"),
        "{stderr}"
    );
    fs::write(&file, "no recording").unwrap();
    assert_eq!(
        outcome(&["recording", "recover", name, "-o", out, "--force"]).0,
        Some(65)
    );
    assert_eq!(
        outcome(&["recording", "recover", "no-such.mcap", "-o", out]).0,
        Some(66)
    );
    assert!(
        !names(folder.path())
            .iter()
            .any(|name| name.ends_with(".recovering"))
    );
}

#[cfg(unix)]
#[test]
fn recover_neither_follows_a_link_nor_takes_the_place_of_a_device() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = recorded(folder.path());
    let precious = folder.path().join("precious");
    fs::write(&precious, "precious").unwrap();
    let out = folder.path().join("out.mcap");
    symlink(&precious, folder.path().join("out.mcap.recovering")).unwrap();
    recover(&file, &out, false).unwrap();
    assert_eq!(fs::read(&precious).unwrap(), b"precious");
    let device = folder.path().join("device");
    symlink("/dev/null", &device).unwrap();
    let error = recover(&file, &device, true).unwrap_err();
    assert!(matches!(error, RecordError::Create { .. }), "{error}");
    assert_eq!(fs::read_link(&device).unwrap(), Path::new("/dev/null"));
}

#[cfg(unix)]
#[test]
fn a_killed_run_leaves_whole_episodes_and_parts_that_are_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let mut command = Command::new(env!("CARGO_BIN_EXE_xcscr"));
    let args = [
        "train",
        "worlds/maze4.json",
        "--quiet",
        "--episodes",
        "100000",
        "--out",
    ];
    command
        .args(args)
        .arg(&run)
        .current_dir(env!("CARGO_MANIFEST_DIR"));
    let mut child = command.stdout(Stdio::null()).spawn().unwrap();
    let tenth = run.join("ep-0010.mcap");
    wait_until("the tenth episode", || tenth.exists());
    child.kill().unwrap();
    child.wait().unwrap();
    let names = names(&run);
    let episodes: Vec<_> = names
        .iter()
        .filter(|n| n.starts_with("ep-") && n.ends_with(".mcap"))
        .collect();
    assert!(episodes.len() >= 10, "{names:?}");
    for name in &episodes {
        let found = xcscr::record::check(&run.join(name)).unwrap();
        assert_eq!(found, [], "{name}");
    }
    let out = run.join("recovered.mcap");
    recover(&run.join("run.mcap.part"), &out, false).unwrap();
    let recording = Recording::open(&out).unwrap();
    let messages = recording.messages().map(|message| message.unwrap());
    let told = messages
        .filter(|message| message.topic() == "/ended")
        .count();
    // The file of an episode gets its name after the run's file was flushed, or right before.
    assert!(
        told.abs_diff(episodes.len()) <= 1,
        "{told} episodes told, {} kept",
        episodes.len()
    );
}
