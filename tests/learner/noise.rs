//! Percepts of which bits flip.

use crate::kit::trial::{on_a_map, on_the_grid};
use xcscr::agent::{Knowledge, Method};
use xcscr::trial::{Checkpoint, GreedySteps, Settings, Trial, seal, unseal};

/// A trial in a world of which each bit of a percept flips with this probability.
fn trial(world: &str, method: Method, episodes: u32, flips: f64) -> Trial {
    let mut settings = Settings::default();
    settings.reward.step_threshold = 100;
    settings.sensor.flip_probability = flips;
    let plan = on_the_grid(world, method).episodes(episodes);
    Trial::new(plan.seed(3).settings(settings)).unwrap()
}

fn finished(mut trial: Trial) -> Trial {
    let _ = trial.run(&mut ());
    trial
}

#[test]
fn a_trial_with_flipping_bits_goes_on_from_a_checkpoint_as_if_it_had_never_stopped() {
    for method in [Method::Xcscr, Method::XcscrPlus, Method::RMax] {
        let plan = || trial("maze4", method, 12, 0.02);
        let whole = finished(plan());
        let mut half = plan();
        for _ in 0..6 {
            let _ = half.run_episode(&mut ());
        }
        let saved: Checkpoint = unseal(&seal(&half.checkpoint())).unwrap();
        let resumed = finished(Trial::resume(&saved).unwrap());
        assert_eq!(whole.checkpoint(), resumed.checkpoint());
    }
}

#[test]
fn a_memory_tells_two_goals_apart_where_observations_have_errors() {
    let ratio = |cell_maps| {
        let mut settings = Settings::default();
        settings.reward.step_threshold = 100;
        settings.sensor.flip_probability = 0.01;
        settings.map.max_maps = cell_maps;
        let ratio = |seed| {
            let plan = on_the_grid("classic/woods102", Method::XcscrPlus).episodes(60);
            let plan = on_a_map(plan.seed(seed).settings(settings.clone()));
            let trial = plan.run().unwrap();
            let greedy = GreedySteps::of(trial.plan(), &trial.method().knowledge());
            greedy.ratio(trial.plan()).unwrap()
        };
        (5501..5505).map(ratio).sum::<f64>() / 4.0
    };
    let (two, one) = (ratio(6), ratio(1));
    assert!(two < 1.1, "{two} times the bound");
    assert!(one > 1.5, "control, with one cell_map: {one}");
}

#[test]
fn a_memory_does_not_hold_moves_that_never_slip_for_slipping_where_observations_have_errors() {
    let slip = |world: &str, slip| {
        let mut settings = Settings::default();
        settings.reward.step_threshold = 100;
        settings.sensor.flip_probability = 0.02;
        settings.arena.slip = slip;
        let plan = on_the_grid(world, Method::XcscrPlus).episodes(40);
        let trial = on_a_map(plan.seed(5502).settings(settings)).run().unwrap();
        match trial.method().knowledge() {
            Knowledge::Remembering { map, .. } => map.pomdp.slip(),
            _ => panic!("it remembers"),
        }
    };
    for world in ["classic/mazef4", "classic/woods14"] {
        assert_eq!(slip(world, 0.0), 0.0, "{world}");
    }
    // Where nearly all places look alike some misread cells are taken for slips: in about half of the trials
    // for one move in 50, in some for one in 25.
    let slips = slip("classic/mazee2", 0.0);
    assert!(slips < 0.05, "{slips}");
    let slips = slip("classic/mazef4", 0.25);
    assert!((0.15..0.35).contains(&slips), "control: {slips}");
}

/// The steps of eight trials in MazeF4, and how far the median of them is from the bound at the end.
fn learned_in_mazef4(bumps: bool, flips: f64) -> (u64, f64) {
    let mut settings = Settings::default();
    settings.reward.step_threshold = 100;
    settings.sensor.flip_probability = flips;
    settings.map.feels_bumps = bumps;
    let (mut steps, mut ratios) = (0, Vec::new());
    for seed in 1..=8 {
        let plan = on_the_grid("classic/mazef4", Method::XcscrPlus).episodes(40);
        let trial = on_a_map(plan.seed(seed).settings(settings.clone()))
            .run()
            .unwrap();
        let greedy = GreedySteps::of(trial.plan(), &trial.method().knowledge());
        steps += trial.progress().steps;
        ratios.push(greedy.ratio(trial.plan()).unwrap());
    }
    ratios.sort_by(f64::total_cmp);
    (steps, ratios[4])
}

#[test]
fn a_memory_that_feels_no_bumps_needs_more_steps_to_learn_only_where_observations_have_errors() {
    let [felt, unfelt] = [true, false].map(|bumps| learned_in_mazef4(bumps, 0.0));
    assert_eq!(unfelt, felt, "control: steps, and times the bound");
    let [felt, unfelt] = [true, false].map(|bumps| learned_in_mazef4(bumps, 0.02));
    assert!(unfelt.0 > felt.0, "{unfelt:?} and {felt:?}");
    assert!(felt.1 < 1.1 && unfelt.1 < 1.1, "{unfelt:?} and {felt:?}");
}

#[test]
fn rules_and_checkpoints_tell_that_bumps_are_not_felt() {
    for bumps in [true, false] {
        let plan = || {
            let mut plan = on_a_map(on_the_grid("maze4", Method::XcscrPlus)).episodes(6);
            plan.config.settings.map.feels_bumps = bumps;
            plan
        };
        let learned = plan().run().unwrap().method().knowledge();
        let json = serde_json::to_string(&learned).unwrap();
        assert_eq!(json.contains("unfelt"), !bumps);
        assert_eq!(serde_json::from_str::<Knowledge>(&json).unwrap(), learned);
        let mut brings = plan();
        brings.config.initial = Some(learned);
        let begun = Trial::new(brings).unwrap();
        let saved: Checkpoint = unseal(&seal(&begun.checkpoint())).unwrap();
        assert_eq!(saved, begun.checkpoint());
    }
}

#[test]
fn a_memory_tells_an_observation_error_from_what_is_new_and_one_without_does_not() {
    for world in ["classic/mazef4", "classic/maze7"] {
        let steps = |method| {
            let trial = finished(trial(world, method, 60, 0.02));
            let greedy = GreedySteps::of(trial.plan(), &trial.method().knowledge());
            (greedy.ratio(trial.plan()).unwrap(), trial)
        };
        let (ratio, trial) = steps(Method::XcscrPlus);
        assert!(
            ratio < 1.2,
            "{world}: {ratio} times the bound of percepts that are right"
        );
        assert!(trial.progress().most_rules <= 50, "{:?}", trial.progress());
        let Knowledge::Remembering { map, .. } = trial.method().knowledge() else {
            panic!("the method remembers");
        };
        let maze = &trial.plan().maze;
        let cells = maze.free_cells().count() - maze.goals().len();
        assert_eq!(
            map.states.len(),
            cells,
            "{world}: a place for each cell, and no others"
        );
        let (ratio, _) = steps(Method::QLearning);
        assert!(
            ratio > 2.0,
            "{world}: {ratio} times the bound without a memory"
        );
    }
}

#[test]
fn as_many_percepts_have_errors_as_flipped_bits_predict() {
    let progress = finished(trial("maze5", Method::QLearning, 200, 0.01));
    let (observation_error, steps) = (
        progress.progress().mistakes.observation_error,
        progress.progress().steps,
    );
    // Of sixteen bits none flips in 85.1 % of the percepts.
    let share = observation_error as f64 / steps as f64;
    assert!(
        (share - 0.149).abs() < 0.02,
        "{observation_error} of {steps}"
    );
    let clean = finished(trial("maze5", Method::QLearning, 20, 0.0));
    assert_eq!(clean.progress().mistakes.observation_error, 0, "control");
}
