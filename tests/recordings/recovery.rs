//! Broken recordings: their faults are found, and what is whole in them is saved.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::kit::desk::Desk;
use crate::kit::folder::names;
use crate::kit::messages::{on, raw};
use crate::kit::program::{output_of, wait_for};
use crate::kit::trial::Trial;
use xcscr::ErrorKind;
use xcscr::episode::{Episode, Learned, Observer};
use xcscr::record::reader::Recording;
use xcscr::record::{Recovery, check, recover};

/// A recording of an episode, and damaged copies of it.
struct Damaged {
    desk: Desk,
    file: PathBuf,
    bytes: Vec<u8>,
}

impl Damaged {
    fn new() -> Self {
        let desk = Desk::new();
        let trial = Trial {
            episodes: 1,
            arena: "physics",
            ..Trial::default()
        };
        let file = trial.record(desk.folder()).unwrap().files.swap_remove(0);
        let bytes = fs::read(&file).unwrap();
        Self { desk, file, bytes }
    }

    fn valid(&self) -> Recording {
        Recording::open(&self.file).unwrap()
    }

    /// Recovers what a file of these bytes holds.
    #[track_caller]
    fn recover(&self, bytes: &[u8]) -> (Recovery, Recording) {
        self.desk.write("bad.mcap.part", bytes);
        let [bad, out] = ["bad.mcap.part", "out.mcap"].map(|name| self.desk.path(name));
        let recovery = recover(&bad, &out, true).unwrap();
        (recovery, Recording::open(&out).unwrap())
    }

    /// The same bytes with another bit.
    fn flipped(&self, at: usize, bit: u8) -> Vec<u8> {
        let mut bytes = self.bytes.clone();
        bytes[at] ^= bit;
        bytes
    }

    /// Where the index begins.
    fn index(&self) -> usize {
        mcap::read::footer(&self.bytes).unwrap().summary_start as usize
    }
}

#[test]
fn a_part_is_refused_with_the_way_out() {
    let desk = Desk::new();
    let recorder = Trial::default().recorder(desk.folder()).unwrap();
    let part = desk.path("run.mcap.part");
    let said = Recording::open(&part).unwrap_err().to_string();
    assert!(said.contains("never finished"), "{said}");
    assert!(said.contains("xcscr recording recover"), "{said}");
    assert_eq!(check(&part).unwrap().len(), 1);
    drop(recorder);
}

#[test]
fn a_flipped_bit_anywhere_is_found() {
    let damaged = Damaged::new();
    for at in (0..damaged.bytes.len()).step_by(97) {
        let found = Recording::from_bytes(&damaged.file, damaged.flipped(at, 0x10));
        let size = damaged.bytes.len();
        assert!(found.is_err(), "nobody saw the bit at {at} of {size}");
    }
}

#[test]
fn a_file_that_ends_early_is_found() {
    let damaged = Damaged::new();
    for length in (0..damaged.bytes.len()).step_by(61) {
        let found = Recording::from_bytes(&damaged.file, damaged.bytes[..length].to_vec());
        // Before the eight bytes that an MCAP file begins with, it is none.
        let words = match length {
            0..8 => "this is not a recording",
            _ => "this recording is damaged",
        };
        let fault = found.map_or_else(|error| error.to_string(), |_| String::new());
        assert!(fault.starts_with(words), "{length}: {fault}");
    }
}

/// Remembers the episode that ended last.
#[derive(Default)]
struct Last(u32);

impl Observer for Last {
    fn ended(&mut self, episode: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        self.0 = episode.episode;
        ControlFlow::Continue(())
    }
}

/// Links are replaced and never followed, so a device cannot stand in for a full disk here;
/// `runs/faults.rs` fills a real one.
#[test]
fn an_episode_that_cannot_be_written_ends_the_trial_with_one_error_and_keeps_the_others() {
    let desk = Desk::new();
    fs::create_dir(desk.path("ep-0002.mcap.part")).unwrap();
    let trial = Trial::default();
    let mut learner = trial.learner();
    let mut observers = (trial.recorder(desk.folder()).unwrap(), Last::default());
    trial.run(learner.as_mut(), &mut observers);
    let (recorder, last) = observers;
    assert_eq!(last.0, 2, "the trial went on without a recorder");
    let error = recorder.finish(learner.as_ref()).unwrap_err();
    assert!(error.kind() == ErrorKind::CannotCreate, "{error}");
    assert!(error.to_string().contains("ep-0002.mcap.part"), "{error}");
    let names = names(desk.folder());
    for kept in ["ep-0001.mcap", "run.mcap.part"] {
        assert!(names.iter().any(|name| name == kept), "{names:?}");
    }
}

#[test]
fn a_sound_recording_is_recovered_without_loss_and_stays_sound() {
    let damaged = Damaged::new();
    let old = damaged.valid();
    let (recovery, new) = damaged.recover(&damaged.bytes);
    assert!(recovery.is_lossless(), "{recovery:?}");
    assert_eq!(raw(&old), raw(&new));
    assert_eq!(old.attachments(), new.attachments());
    assert_eq!(old.metadata("run"), new.metadata("run"));
    assert_eq!(old.topics(), new.topics());
}

#[test]
fn a_recording_cut_anywhere_gives_its_whole_records_and_says_what_is_lost() {
    let damaged = Damaged::new();
    let whole = raw(&damaged.valid());
    let mut before = 0;
    for part in 1..50 {
        let length = damaged.bytes.len() * part / 50;
        let (recovery, recording) = damaged.recover(&damaged.bytes[..length]);
        let saved = raw(&recording);
        let what = format!("{part}/50: {recovery:?}, {before} messages before");
        assert!(saved.len() >= before, "{what}");
        assert_eq!(saved, whole[..saved.len()], "{what}");
        assert_eq!(recovery.messages, saved.len() as u64);
        let all = saved.len() == whole.len();
        assert!(all || !recovery.is_lossless(), "{what}");
        before = saved.len();
    }
    assert_eq!(before, whole.len(), "only the index was missing at 49/50");
}

#[test]
fn a_flipped_bit_costs_at_most_its_chunk_and_is_never_called_lossless() {
    let damaged = Damaged::new();
    let data_end = damaged.index() - 13;
    for at in (8..data_end).step_by(211) {
        let (recovery, _) = damaged.recover(&damaged.flipped(at, 0x10));
        assert!(!recovery.is_lossless(), "bit at {at}: {recovery:?}");
    }
}

#[test]
fn a_damaged_index_is_not_believed() {
    let damaged = Damaged::new();
    let whole = raw(&damaged.valid());
    for at in (damaged.index()..damaged.bytes.len() - 8).step_by(101) {
        let (recovery, recording) = damaged.recover(&damaged.flipped(at, 1));
        assert!(recovery.is_lossless(), "bit at {at}: {recovery:?}");
        assert_eq!(raw(&recording), whole, "bit at {at}");
        assert_eq!(recording.check(), [""; 0], "bit at {at}");
    }
}

#[test]
fn a_recording_that_ends_between_two_records_is_not_called_whole() {
    let damaged = Damaged::new();
    let (recovery, _) = damaged.recover(&damaged.bytes[..8]);
    assert_eq!((recovery.messages, recovery.lost_bytes), (0, 0));
    let fault = recovery.fault.unwrap();
    assert!(fault.contains("the end of the file is missing"), "{fault}");
}

#[test]
fn recover_overwrites_only_by_force_and_says_what_is_lost() {
    let Damaged { desk, file, bytes } = Damaged::new();
    fs::rename(file, desk.path("in.mcap")).unwrap();
    desk.write("out.mcap", "mine");
    let line = "recording recover @in.mcap -o @out.mcap";
    desk.fails(73, line, "--force");
    assert_eq!(desk.text("out.mcap"), "mine");
    let forced = format!("{line} --force");
    let (stdout, stderr) = desk.run(0, &forced);
    assert_eq!(stdout, "");
    assert!(stderr.contains("nothing was lost"), "{stderr}");
    desk.write("in.mcap", &bytes[..bytes.len() / 2]);
    let stderr = desk.fails(3, &forced, "lost ");
    assert!(stderr.contains("from byte"), "{stderr}");
    let left = names(desk.folder());
    let is_aside = |name: &String| name.ends_with(".recovering");
    assert!(!left.iter().any(is_aside), "{left:?}");
}

#[cfg(unix)]
#[test]
fn recover_neither_follows_a_link_nor_takes_the_place_of_a_device() {
    use std::os::unix::fs::symlink;
    let Damaged { desk, file, .. } = Damaged::new();
    desk.write("precious", "precious");
    symlink(desk.path("precious"), desk.path("out.mcap.recovering")).unwrap();
    recover(&file, &desk.path("out.mcap"), false).unwrap();
    assert_eq!(desk.text("precious"), "precious");
    let device = desk.path("device");
    symlink("/dev/null", &device).unwrap();
    let error = recover(&file, &device, true).unwrap_err();
    assert!(error.kind() == ErrorKind::CannotCreate, "{error}");
    assert_eq!(fs::read_link(&device).unwrap(), Path::new("/dev/null"));
}

#[cfg(unix)]
#[test]
fn a_killed_run_leaves_whole_episodes_and_parts_that_are_recovered() {
    let desk = Desk::new();
    let run = desk.path("run");
    let mut child = desk.spawn("train maze4 --quiet --episodes 100000 --out @run");
    wait_for(&run.join("ep-0010.mcap"));
    child.kill().unwrap();
    output_of(child);
    let names = names(&run);
    let is_episode = |name: &&String| name.starts_with("ep-") && name.ends_with(".mcap");
    let episodes: Vec<_> = names.iter().filter(is_episode).collect();
    assert!(episodes.len() >= 10, "{names:?}");
    for name in &episodes {
        let found = check(&run.join(name)).unwrap();
        assert_eq!(found, [""; 0], "{name}");
    }
    let out = run.join("recovered.mcap");
    recover(&run.join("run.mcap.part"), &out, false).unwrap();
    let told = on(&Recording::open(&out).unwrap(), "/ended").count();
    // The file of an episode gets its name after the run's file was flushed, or right before.
    let kept = episodes.len();
    assert!(told.abs_diff(kept) <= 1, "{told} told, {kept} kept");
}
