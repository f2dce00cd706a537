//! A run that was stopped goes on to the same bytes as one that never was.
//!
//! With `XCSCR_LONG=1` the long suite stops ten times as often in runs that are
//! twice as long.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use crate::kit::chance::{dice, rounds};
use crate::kit::desk::Desk;
use crate::kit::folder::{assert_same, names};
use crate::kit::trial::on_the_grid;
use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::episode::{AfterEpisode, Episode, Observer};
use xcscr::record::RecordMode;
use xcscr::run::{Resumed, RunFolder, Session};
use xcscr::trial::{Plan, Trial};
use xcscr::xcs::random::Stream;
use xcscr::{Error, ErrorKind};

fn plan(method: Method, arena: ArenaKind, episodes: u32) -> Plan {
    let plan = on_the_grid("maze4", method).arena(arena);
    plan.episodes(episodes).seed(3)
}

fn begun(plan: &Plan, folder: &Path, mode: RecordMode) -> Session {
    let run = RunFolder::create(folder, false).unwrap();
    Session::begin(run, Trial::new(plan.clone()).unwrap(), mode).unwrap()
}

fn resumed(folder: &Path) -> Session {
    match Session::resume(RunFolder::resume(folder).unwrap()).unwrap() {
        Resumed::Unfinished(session) => *session,
        Resumed::Finished(_) => panic!("the run is not finished"),
    }
}

/// Ends a run after this episode.
struct Until(u32);

impl Observer for Until {
    fn ended(&mut self, episode: &Episode, _: &AfterEpisode<'_>) -> ControlFlow<()> {
        match episode.episode < self.0 {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    }
}

fn ended_after(session: Session, episode: u32) -> Error {
    let ended = session.run(&mut Until(episode), &|| false);
    ended.err().expect("it was stopped")
}

/// Loses the file of a random episode, if there is one. Returns its name.
fn lose_an_episode(folder: &Path, dice: &mut Stream) -> Option<String> {
    let mut names = names(folder);
    names.retain(|name| name.starts_with("ep-") && name.ends_with(".mcap"));
    let lost = dice.choose(&names)?;
    fs::remove_file(folder.join(lost)).unwrap();
    Some(lost.clone())
}

/// A run that is stopped after these episodes, and loses a file each time, ends as one without stops.
fn stops_and_resumes(plan: &Plan, mode: RecordMode, stops: &[u32], dice: &mut Stream) {
    let desk = Desk::new();
    let [wanted, found] = ["wanted", "found"].map(|name| desk.path(name));
    begun(plan, &wanted, mode).run(&mut (), &|| false).unwrap();
    let mut what = format!("{:?}, {mode}: ", plan.config.arena);
    for (number, &stop) in stops.iter().enumerate() {
        let session = match number {
            0 => begun(plan, &found, mode),
            _ => resumed(&found),
        };
        let error = ended_after(session, stop);
        assert_eq!(error.kind(), ErrorKind::Interrupted, "{what}{error}");
        let lost = lose_an_episode(&found, dice);
        what += &format!("stopped after {stop}, lost {lost:?}; ");
    }
    resumed(&found).run(&mut (), &|| false).unwrap();
    assert_same(&found, &wanted, &what);
}

#[test]
fn every_mode_of_recording_in_both_arenas_resumes_to_the_same_bytes() {
    let episodes = rounds([12, 12, 24]) as u32;
    let cases = [
        (Method::XcscrPlus, ArenaKind::Physics, "all"),
        (Method::XcscrPlus, ArenaKind::Physics, "beams"),
        (Method::Xcscr, ArenaKind::Grid, "all"),
        (Method::Xcscr, ArenaKind::Grid, "every:3"),
        (Method::Xcscr, ArenaKind::Grid, "none"),
    ];
    for (number, (method, arena, mode)) in cases.into_iter().enumerate() {
        let mut dice = dice(number as u64);
        let stops = (0..rounds([1, 4, 40])).map(|_| 1 + dice.below(episodes as usize) as u32);
        let stops: Vec<u32> = stops.collect();
        let plan = plan(method, arena, episodes);
        stops_and_resumes(&plan, mode.parse().unwrap(), &stops, &mut dice);
    }
}

#[test]
fn an_observer_ends_a_recorded_run_with_the_way_to_resume_it() {
    let desk = Desk::new();
    let plan = plan(Method::Xcscr, ArenaKind::Grid, 3);
    let error = ended_after(begun(&plan, &desk.path("run"), RecordMode::All), 1);
    let words = "interrupted after episode 1 of 3; resume it with";
    assert!(error.to_string().starts_with(words), "{error}");
}

/// Resumes a run of four episodes that was stopped after two, whose first episode was changed.
fn resumed_after(change: impl Fn(&Path)) -> Result<(), Error> {
    let desk = Desk::new();
    let folder = desk.path("run");
    let plan = plan(Method::Xcscr, ArenaKind::Grid, 4);
    ended_after(begun(&plan, &folder, RecordMode::All), 2);
    change(&folder);
    let changed = fs::read(folder.join("ep-0001.mcap")).unwrap();
    let ended = resumed(&folder).run(&mut (), &|| false).map(drop);
    let left = fs::read(folder.join("ep-0001.mcap")).unwrap();
    assert!(left == changed, "a complete file was written");
    ended
}

#[test]
fn an_episode_that_is_not_what_the_run_gives_is_refused() {
    let edited = |edit: fn(&mut Vec<u8>)| {
        resumed_after(|folder| {
            let path = folder.join("ep-0001.mcap");
            let mut bytes = fs::read(&path).unwrap();
            edit(&mut bytes);
            fs::write(path, bytes).unwrap();
        })
    };
    edited(|_| {}).expect("control");
    let another = resumed_after(|folder| {
        fs::copy(folder.join("ep-0002.mcap"), folder.join("ep-0001.mcap")).unwrap();
    });
    for ended in [
        another,
        edited(|bytes| {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
        }),
        edited(|bytes| *bytes.last_mut().unwrap() ^= 1),
        edited(|bytes| bytes.push(0)),
        edited(|bytes| bytes.truncate(bytes.len() - 1)),
    ] {
        let error = ended.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::BadData, "{error}");
        let words = "ep-0001.mcap is not what the repeated run records";
        assert!(error.to_string().contains(words), "{error}");
        assert!(error.to_string().contains("remove it, or begin"), "{error}");
    }
}
