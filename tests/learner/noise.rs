//! Percepts of which bits flip, and moves that slip.

use std::sync::Arc;

use xcscr::agent::{Knowledge, Method};
use xcscr::trial::{Plan, Trial};

use crate::learned::{Learned, gridded, learned, limited, mapped, with, world};

/// A plan with 100 steps for an episode at most, and a probability that a bit flips.
fn flipping(world: &str, method: Method, episodes: u32, flips: f64) -> Plan {
    let plan = limited(world, method).episodes(episodes).seed(3);
    with(plan, |settings| settings.sensor.flip_probability = flips)
}

#[test]
fn a_map_tells_two_goals_apart_where_observations_have_errors() {
    let ratio = |maps| {
        let ratio = |seed| {
            let plan = flipping("classic/woods102", Method::XcscrPlus, 60, 0.01);
            learned(with(plan.seed(seed), |settings| {
                settings.map.max_maps = maps
            }))
            .ratio()
        };
        (5501..5505).map(ratio).sum::<f64>() / 4.0
    };
    let (two, one) = (ratio(6), ratio(1));
    assert!(two < 1.1, "{two} times the bound");
    assert!(one > 1.5, "control, with one map: {one}");
}

#[test]
fn moves_that_never_slip_are_not_held_for_slipping_where_observations_have_errors() {
    for (world, slip, [least, most]) in [
        ("classic/mazef4", 0.0, [0.0, 0.0]),
        ("classic/woods14", 0.0, [0.0, 0.0]),
        // Where nearly all cells share a percept, some observation errors are taken for slips: in about half of the trials
        // for one move in 50, in some for one in 25.
        ("classic/mazee2", 0.0, [0.0, 0.05]),
        // Control.
        ("classic/mazef4", 0.25, [0.15, 0.35]),
    ] {
        let plan = flipping(world, Method::XcscrPlus, 40, 0.02).seed(5502);
        let found = learned(with(plan, |settings| settings.arena.slip = slip)).slip();
        assert!((least..=most).contains(&found), "{world}, {slip}: {found}");
    }
}

#[test]
fn where_moves_slip_maps_are_drawn_and_plans_made_all_the_same() {
    for (method, estimator) in [(Method::XcscrPlus, "rules"), (Method::RMax, "a plan")] {
        let plan = limited("classic/woods101", method).episodes(60).seed(5);
        let trial = learned(with(plan, |settings| settings.arena.slip = 0.21875));
        let steps = trial.steps();
        // The estimate of the belief bound is 4.06, the mean of 500 episodes good to some 0.25 steps.
        assert!(steps < 4.8, "{estimator}: {steps} steps");
        assert_eq!(trial.progress.first_optimal_episode, None, "{estimator}");
    }
}

/// The steps of eight trials in MazeF4, and how far the median of them is from the bound at the end.
fn learned_in_mazef4(bumps: bool, flips: f64) -> (u64, f64) {
    let trial = |seed| {
        let plan = flipping("classic/mazef4", Method::XcscrPlus, 40, flips).seed(seed);
        learned(with(plan, |settings| settings.map.feels_bumps = bumps))
    };
    let trials: Vec<Arc<Learned>> = (1..=8).map(trial).collect();
    let mut ratios: Vec<f64> = trials.iter().map(|trial| trial.ratio()).collect();
    ratios.sort_by(f64::total_cmp);
    let steps = trials.iter().map(|trial| trial.progress.steps).sum();
    (steps, ratios[4])
}

#[test]
fn a_robot_that_feels_no_bumps_needs_more_steps_to_learn_only_where_observations_have_errors() {
    let [felt, unfelt] = [true, false].map(|bumps| learned_in_mazef4(bumps, 0.0));
    assert_eq!(unfelt, felt, "control: steps, and times the bound");
    let [felt, unfelt] = [true, false].map(|bumps| learned_in_mazef4(bumps, 0.02));
    assert!(unfelt.0 > felt.0, "{unfelt:?} and {felt:?}");
    assert!(felt.1 < 1.1 && unfelt.1 < 1.1, "{unfelt:?} and {felt:?}");
}

#[test]
fn rules_tell_that_bumps_are_not_felt() {
    for bumps in [true, false] {
        let plan = mapped(world("maze4"), Method::XcscrPlus).episodes(6);
        let mut plan = with(plan, |settings| settings.map.feels_bumps = bumps);
        let knowledge = learned(plan.clone()).knowledge.clone();
        let json = serde_json::to_string(&knowledge).unwrap();
        assert_eq!(json.contains("unfelt"), !bumps);
        assert_eq!(serde_json::from_str::<Knowledge>(&json).unwrap(), knowledge);
        plan.config.initial = Some(knowledge);
        assert!(Trial::new(plan).is_ok());
    }
}

#[test]
fn as_many_percepts_have_errors_as_flipped_bits_predict() {
    let errors = |episodes, flips| {
        let plan = gridded(world("maze5"), Method::QLearning).seed(3);
        let plan = with(plan, |settings| settings.sensor.flip_probability = flips);
        let progress = learned(plan.episodes(episodes)).progress.clone();
        progress.mistakes.observation_error as f64 / progress.steps as f64
    };
    // Of sixteen bits none flips in 85.1 % of the percepts.
    let share = errors(200, 0.01);
    assert!((share - 0.149).abs() < 0.02, "{share}");
    assert_eq!(errors(20, 0.0), 0.0, "control");
}
