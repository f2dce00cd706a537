//! What becomes of a recording when something goes wrong.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::kit::folder::names;
use crate::kit::scripted::Scripted;
use crate::kit::trial::Trial;
use xcscr::arena::View;
use xcscr::episode::{Episode, Learned, Observer, Step};
use xcscr::record::check;
use xcscr::record::reader::Recording;
use xcscr::record::{RecordError, Recorder};

const WAYS: [&str; 1] = ["ESSSEEEESS"];

fn trial() -> Trial {
    Trial {
        explore: 0.0,
        ..Trial::default()
    }
}

#[test]
fn a_part_is_refused_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let recorder = trial().recorder(folder.path()).unwrap();
    let part = folder.path().join("run.mcap.part");
    let said = Recording::open(&part).unwrap_err().to_string();
    assert!(said.contains("never finished"), "{said}");
    assert!(said.contains("xcscr recording recover"), "{said}");
    assert_eq!(check(&part).unwrap().len(), 1);
    drop(recorder);
}

#[test]
fn a_missing_file_is_an_error_and_no_finding() {
    let missing = Path::new("no/such.mcap");
    assert!(matches!(check(missing), Err(RecordError::Read { .. })));
}

#[test]
fn a_flipped_bit_anywhere_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let file = trial().record(folder.path()).unwrap().files.swap_remove(0);
    let sound = fs::read(&file).unwrap();
    for at in (0..sound.len()).step_by(97) {
        let mut bytes = sound.clone();
        bytes[at] ^= 0x10;
        let found = Recording::from_bytes(&file, bytes);
        let size = sound.len();
        assert!(found.is_err(), "nobody saw the bit at {at} of {size}");
    }
}

#[test]
fn a_file_that_ends_early_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let file = trial().record(folder.path()).unwrap().files.swap_remove(0);
    let sound = fs::read(&file).unwrap();
    for length in (0..sound.len()).step_by(61) {
        let found = Recording::from_bytes(&file, sound[..length].to_vec());
        // Before the eight bytes that an MCAP file begins with, it is none.
        let is_found = match length {
            0..8 => matches!(found, Err(RecordError::Foreign { .. })),
            _ => matches!(found, Err(RecordError::Damaged { .. })),
        };
        assert!(is_found, "{length}");
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_an_error_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("taken");
    fs::write(&taken, "").unwrap();
    let error = trial().recorder(&taken).err().unwrap();
    assert!(matches!(error, RecordError::Create { .. }), "{error}");
    assert!(error.to_string().ends_with("taken"), "{error}");
}

/// Links are replaced and never followed, so a device cannot stand in for a full disk here;
/// `runs/faults.rs` fills a real one.
#[test]
fn an_episode_that_cannot_be_written_ends_the_trial_with_one_error_and_keeps_the_others() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("ep-0002.mcap.part")).unwrap();
    let recorder = trial().recorder(folder.path()).unwrap();
    let mut walker = Scripted::new(&WAYS);
    let mut observers = (recorder, Last::default());
    trial().run(&mut walker, &mut observers);
    let (recorder, last) = observers;
    assert_eq!(last.episode, 2, "the trial went on without a recorder");
    let error = recorder.finish(&walker).unwrap_err();
    assert!(matches!(error, RecordError::Create { .. }), "{error}");
    assert!(error.to_string().contains("ep-0002.mcap.part"), "{error}");
    let names = names(folder.path());
    for kept in ["ep-0001.mcap", "run.mcap.part"] {
        assert!(names.iter().any(|name| name == kept), "{names:?}");
    }
}

/// Remembers the episode that ended last.
#[derive(Default)]
struct Last {
    episode: u32,
}

impl Observer for Last {
    fn ended(&mut self, episode: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        self.episode = episode.episode;
        ControlFlow::Continue(())
    }
}

/// Takes the files away in the middle of episode 3, as a killed program leaves them.
struct Killer {
    recorder: Recorder,
    folder: PathBuf,
    left: Vec<(String, Vec<u8>)>,
}

impl Observer for Killer {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        self.recorder.began(episode, view);
    }

    fn stepped(&mut self, step: &Step<'_>) {
        self.recorder.stepped(step);
        if (step.episode, step.step) == (3, 5) {
            let read = |name: String| {
                let bytes = fs::read(self.folder.join(&name)).unwrap();
                (name, bytes)
            };
            self.left = names(&self.folder).into_iter().map(read).collect();
        }
    }

    fn ended(&mut self, episode: &Episode, learned: &Learned<'_>) -> ControlFlow<()> {
        self.recorder.ended(episode, learned)
    }
}

#[test]
fn a_killed_run_leaves_earlier_episodes_whole_and_whole_chunks_of_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    let mut killer = Killer {
        recorder: trial().recorder(folder.path()).unwrap(),
        folder: folder.path().to_owned(),
        left: Vec::new(),
    };
    trial().run(&mut Scripted::new(&WAYS), &mut killer);
    let left = |name: &str| {
        let found = killer.left.iter().find(|(left, _)| left == name);
        found.map(|(_, bytes)| bytes.clone())
    };
    for name in ["ep-0001.mcap", "ep-0002.mcap"] {
        Recording::from_bytes(Path::new(name), left(name).unwrap()).unwrap();
    }
    assert!(left("ep-0003.mcap.part").is_some() && left("ep-0003.mcap").is_none());
    let run = left("run.mcap.part").unwrap();
    let read = mcap::MessageStream::new(&run).unwrap();
    let whole: Vec<_> = read.map_while(Result::ok).collect();
    let ended = whole.iter().filter(|m| m.channel.topic == "/ended");
    let told = ended.map(|m| serde_json::from_slice::<serde_json::Value>(&m.data).unwrap());
    let ended: Vec<_> = told.map(|one| one["episode"].as_u64().unwrap()).collect();
    assert_eq!(ended, [1, 2]);
}
