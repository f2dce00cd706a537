//! Tasks on a file system that lies: each machine sees the journals of the others late, cut short or
//! not at all, tasks are run twice at a time, and who is killed leaves half a line.

use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::kit::folder;
use tempfile::TempDir;
use xcscr::streams::StreamName;
use xcscr::study::{Agents, Protocol, StudyFile, StudyFolder, TrialRecord};
use xcscr::xcs::random::Stream;
use xcscr::{Error, ErrorKind};

const TRIALS: usize = 12;
const TASKS: usize = 3;

fn protocol() -> Protocol {
    let text = format!(
        "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\", \"xcscr\"]\ntrials = {}\nepisodes = 2\n",
        TRIALS / 2
    );
    let file = StudyFile::parse(&text, "s.toml", Path::new("")).unwrap();
    Protocol::new(&file, &Agents::default()).unwrap()
}

/// What was truly written, and the machines' views of it.
struct Cluster {
    folder: TempDir,
    written: BTreeMap<String, Vec<u8>>,
    views: usize,
}

impl Cluster {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
            written: BTreeMap::new(),
            views: 0,
        }
    }

    /// A folder as a machine sees it: of each journal so much as `seen` says.
    fn view(&mut self, mut seen: impl FnMut(usize) -> Option<usize>) -> PathBuf {
        self.views += 1;
        let path = self.folder.path().join(self.views.to_string());
        StudyFolder::plan_tasks(&path, protocol(), TASKS).unwrap();
        for (name, bytes) in &self.written {
            if let Some(length) = seen(bytes.len()) {
                fs::write(path.join("journals").join(name), &bytes[..length]).unwrap();
            }
        }
        path
    }

    /// What a machine has written in its view becomes true, whatever it saw of the others.
    fn take_up(&mut self, view: &Path, torn: usize) {
        for (name, mut bytes) in folder::contents(&view.join("journals")) {
            self.written.entry(name).or_insert_with(|| {
                bytes.truncate(bytes.len() - torn.min(bytes.len()));
                bytes
            });
        }
    }
}

/// The trials of a study, which must be complete.
fn finished(path: &Path) -> Result<Vec<TrialRecord>, Error> {
    let folder = StudyFolder::read(path)?;
    folder.require_complete()?;
    Ok(folder.records().cloned().collect())
}

/// Ends an attempt after so many trials.
fn until(most: usize) -> impl FnMut(usize, usize) -> ControlFlow<()> {
    move |finished, _| match finished == most {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}

#[test]
fn whatever_the_machines_see_of_each_other_the_trials_are_those_of_one_process_or_missing() {
    let whole = tempfile::tempdir().unwrap();
    let out = whole.path().join("a");
    let mut done = StudyFolder::open(&out, protocol(), false).unwrap();
    done.run(1, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let wanted: Vec<_> = done.records().cloned().collect();
    let mut chance = Stream::new(1, StreamName::World);
    let (mut twice, mut refused, mut torn) = (0, 0, 0);
    for round in 0..3 {
        let mut cluster = Cluster::new();
        loop {
            let path = cluster.view(|length| match chance.below(4) {
                0 => None,
                1 => Some(chance.below(length + 1)),
                _ => Some(length),
            });
            let task = 1 + chance.below(TASKS);
            let mut grace_period = until(1 + chance.below(4));
            let mut machine = StudyFolder::read(&path).unwrap();
            machine.run_task(task, 1, &mut grace_period).unwrap();
            let half = chance.below(3) * chance.below(90);
            torn += usize::from(half > 0);
            cluster.take_up(&path, half);

            let path = cluster.view(|length| Some(chance.below(2 * length).min(length)));
            match finished(&path) {
                Err(error) if error.kind() == ErrorKind::Refuted => refused += 1,
                Ok(_) => break,
                Err(other) => panic!("round {round}: {other}"),
            }
        }
        let path = cluster.view(Some);
        assert_eq!(finished(&path).unwrap(), wanted);
        let lines = |bytes: &Vec<u8>| bytes.iter().filter(|byte| **byte == b'\n').count();
        let kept: usize = cluster
            .written
            .values()
            .map(|journal| lines(journal).saturating_sub(1))
            .sum();
        twice += kept - TRIALS;
    }
    // Controls: the file system did lie, and it did cost something.
    assert!(
        twice > 5 && refused > 5 && torn > 5,
        "{twice} {refused} {torn}"
    );
}
