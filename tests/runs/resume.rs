//! A run that was stopped goes on to the same bytes as one that never was.
//!
//! `XCSCR_LONG=1 cargo test --test runs resume` stops ten times as often in runs that are
//! twice as long.

use std::ops::ControlFlow;
use std::path::Path;

use crate::kit::chance::{dice, rounds};
use crate::kit::desk::Desk;
use crate::kit::folder::assert_same;
use crate::kit::trial::on_the_grid;
use xcscr::agent::{Estimator, Method, MotionPrior};
use xcscr::arena::ArenaKind;
use xcscr::episode::{Episode, Learned, Observer};
use xcscr::record::{RecordMode, Recorder, RecorderMemory, RobotShape, RunInfo, RunKind};
use xcscr::run::{Resumed, RunFolder, Session};
use xcscr::sensor::Sensor;
use xcscr::trial::{Checkpoint, Plan, Settings, Trial, seal, unseal};
use xcscr::xcs::random::Stream;

fn plan(method: Method, arena: ArenaKind, episodes: u32) -> Plan {
    let plan = on_the_grid("maze4", method).arena(arena);
    plan.episodes(episodes).seed(3)
}

fn info(plan: &Plan) -> RunInfo {
    RunInfo {
        world_json: plan.maze.to_json(),
        config_json: serde_json::to_string(&plan.config).unwrap(),
        seed: plan.config.seed,
        method: plan.config.method.name().to_owned(),
        arena: plan.config.arena.name().to_owned(),
        sensor: plan.config.sensor,
        episodes: plan.config.episodes,
        robot: RobotShape::for_cell(plan.maze.cell_size_m()),
        slip: 0.0,
        goal: 1000.0,
        kind: RunKind::Training,
    }
}

/// A trial with its recorder.
struct Run(Trial, Recorder);

impl Run {
    fn begin(plan: &Plan, folder: &Path, mode: RecordMode) -> Self {
        let recorder = Recorder::create(folder, &plan.maze, info(plan), mode).unwrap();
        Self(Trial::new(plan.clone()).unwrap(), recorder)
    }

    fn resume(bytes: &[u8], folder: &Path) -> Self {
        let (trial, recorder): (Checkpoint, RecorderMemory) = unseal(bytes).unwrap();
        let trial = Trial::resume(&trial).unwrap();
        let (maze, info, policy) = (&trial.plan().maze, info(trial.plan()), trial.policy());
        let recorder = Recorder::resume(folder, maze, info, recorder, policy).unwrap();
        Self(trial, recorder)
    }

    fn save(&mut self) -> Vec<u8> {
        seal(&(self.0.checkpoint(), self.1.memory().unwrap()))
    }

    fn episodes(&mut self, up_to: u32) {
        while self.0.progress().episodes < up_to {
            let _ = self.0.run_episode(&mut self.1);
        }
    }

    /// Ends the run; gives the state of everything that decides about what would come next.
    fn end(self) -> Vec<u8> {
        let Self(trial, recorder) = self;
        let end = seal(&(trial.checkpoint(), trial.method().knowledge()));
        recorder.finish(trial.method()).unwrap();
        end
    }
}

/// Stops a run after these episodes: makes a checkpoint, goes on for a while, is killed, resumes there.
fn run_with_stops(
    plan: &Plan,
    folder: &Path,
    mode: RecordMode,
    stops: &[u32],
    dice: &mut Stream,
) -> (String, Vec<u8>) {
    let all = plan.config.episodes;
    let mut run = Run::begin(plan, folder, mode);
    let mut history = String::new();
    for &stop in stops {
        run.episodes(stop);
        let bytes = run.save();
        let killed = stop + (dice.below((all - stop + 1) as usize) as u32).min(4);
        run.episodes(killed);
        history += &format!("checkpoint after episode {stop}, killed after {killed}; ");
        // As a kill would leave it: the unfinished file is dropped where it is.
        drop(run);
        run = Run::resume(&bytes, folder);
    }
    run.episodes(all);
    (history, run.end())
}

/// A run with these stops ends as one without.
fn stops_and_resumes(plan: &Plan, mode: RecordMode, stops: &[u32], dice: &mut Stream) {
    let desk = Desk::new();
    let [wanted, found] = ["wanted", "found"].map(|name| desk.path(name));
    let mut whole = Run::begin(plan, &wanted, mode);
    whole.episodes(plan.config.episodes);
    let end = whole.end();
    let (history, stopped) = run_with_stops(plan, &found, mode, stops, dice);
    let (method, arena) = (plan.config.method.name(), plan.config.arena.name());
    let what = format!("{method} on {arena}, {mode}: {history}");
    assert!(
        stopped == end,
        "{what}the learner or a random stream differs"
    );
    if mode != RecordMode::None {
        assert_same(&found, &wanted, &what);
    }
}

/// Random stops in order.
fn random_stops(all: u32, times: usize, dice: &mut Stream) -> Vec<u32> {
    let mut stops: Vec<u32> = (0..times)
        .map(|_| dice.below(all as usize + 1) as u32)
        .collect();
    stops.sort();
    stops
}

#[test]
fn every_method_in_both_arenas_and_every_mode_of_recording_resume_to_the_same_bytes() {
    let episodes = rounds(12, 24) as u32;
    let methods = Method::ALL.iter().flat_map(|&method| {
        let arenas = ArenaKind::ALL.iter();
        arenas.map(move |&arena| (method, arena, "all", rounds(4, 40)))
    });
    let modes =
        ["every:3", "none"].map(|mode| (Method::Xcscr, ArenaKind::Grid, mode, rounds(8, 80)));
    for (number, (method, arena, mode, times)) in methods.chain(modes).enumerate() {
        let mut dice = dice(number as u64);
        let stops = random_stops(episodes, times, &mut dice);
        let plan = plan(method, arena, episodes);
        stops_and_resumes(&plan, mode.parse().unwrap(), &stops, &mut dice);
    }
}

/// Then a learner may have perceived what it could learn nothing of yet.
#[test]
fn every_method_resumes_after_episodes_of_one_step() {
    for &method in Method::ALL {
        let mut plan = plan(method, ArenaKind::Grid, 6);
        let reward = &mut plan.config.settings.reward;
        reward.step_threshold_from_maze = false;
        reward.step_threshold = 1;
        reward.learning_step_threshold = false;
        stops_and_resumes(&plan, RecordMode::None, &[1, 2], &mut dice(1));
    }
}

/// Between successes it learns which way its actions go, but plans with what it knew at the last one.
#[test]
fn a_memory_that_learns_its_moves_resumes_after_any_episode_on_any_percept() {
    let sensors = [(8, Sensor::Neighbours), (9, Sensor::Lidar)];
    let of = |method| sensors.map(|(seed, sensor)| (method, seed, sensor));
    for (method, seed, sensor) in [Method::XcscrPlus, Method::RMax].map(of).concat() {
        let plan = on_the_grid("classic/maze10", method).episodes(8);
        let mut plan = plan.seed(seed).sensor(sensor);
        let settings = &mut plan.config.settings;
        settings.plus.estimator = Estimator::Map;
        settings.map.motion_model = MotionPrior::Learned;
        (settings.arena.slip, settings.sensor.flip_probability) = (0.4, 0.02);
        settings.reward.step_threshold_from_maze = false;
        settings.reward.step_threshold = 9;
        let stops: Vec<u32> = (0..8).collect();
        stops_and_resumes(&plan, RecordMode::None, &stops, &mut dice(seed));
    }
}

#[test]
fn a_memory_holds_what_was_learned_and_no_settings() {
    let settings = |beta, gamma, theta_x, alpha| {
        let mut settings = Settings::default();
        settings.xcs.beta = beta;
        (settings.reward.gamma, settings.reward.theta_x) = (gamma, theta_x);
        settings.tabular.alpha = alpha;
        settings
    };
    let [one, other] = [settings(0.1, 0.5, 0.2, 0.3), settings(0.2, 0.6, 0.1, 0.4)];
    for &method in Method::ALL {
        let memory = |settings: &Settings, episodes| {
            let mut plan = plan(method, ArenaKind::Grid, 6);
            plan.config.settings = settings.clone();
            let mut trial = Trial::new(plan).unwrap();
            for _ in 0..episodes {
                let _ = trial.run_episode(&mut ());
            }
            trial.method().checkpoint()
        };
        let name = method.name();
        let untrained = memory(&one, 0);
        assert!(untrained == memory(&other, 0), "{name} keeps settings");
        assert!(untrained != memory(&one, 3), "control: {name}");
    }
}

/// Asks for the end after each episode.
struct Impatient;

impl Observer for Impatient {
    fn ended(&mut self, _: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

#[test]
fn an_observer_ends_a_recorded_run_which_resumes_to_the_same_bytes() {
    let desk = Desk::new();
    let plan = plan(Method::Xcscr, ArenaKind::Grid, 3);
    let [whole, stopped] = ["whole", "stopped"].map(|name| desk.path(name));
    let begin = |path: &Path| {
        let run = RunFolder::create(path, false).unwrap();
        Session::begin(run, Trial::new(plan.clone()).unwrap(), RecordMode::All).unwrap()
    };
    begin(&whole).run(&mut (), &|| false).unwrap();
    let error = begin(&stopped).run(&mut Impatient, &|| false).err();
    let message = error.map_or(String::new(), |error| error.to_string());
    let words = "interrupted after episode 1 of 3; resume it with";
    assert!(message.starts_with(words), "{message}");
    let Resumed::Unfinished(session) =
        Session::resume(RunFolder::resume(&stopped).unwrap()).unwrap()
    else {
        panic!("the run has a checkpoint");
    };
    session.run(&mut (), &|| false).unwrap();
    assert_same(&stopped, &whole, "after an observer's break");
}
