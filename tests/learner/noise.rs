//! Percepts of which bits flip.

use crate::kit::trial::on_the_grid;
use xcscr::agent::{Knowledge, Method};
use xcscr::trial::{Checkpoint, GreedySteps, Settings, Trial, seal, unseal};

/// A trial in a world of which each bit of a percept flips with this probability.
fn trial(world: &str, method: Method, episodes: u32, flips: f64) -> Trial {
    let mut settings = Settings::default();
    settings.reward.step_threshold = 100;
    settings.sensor.flips = flips;
    let plan = on_the_grid(world, method).episodes(episodes);
    Trial::new(plan.seed(3).settings(settings)).unwrap()
}

fn finished(mut trial: Trial) -> Trial {
    let _ = trial.run(&mut ());
    trial
}

#[test]
fn a_trial_with_flipping_bits_goes_on_from_a_checkpoint_as_if_it_had_never_stopped() {
    for method in [Method::Xcscr, Method::XcscrMemory] {
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
fn a_memory_tells_what_was_misread_from_what_is_new_and_one_without_does_not() {
    for world in ["classic/mazef4", "classic/maze7"] {
        let steps = |method| {
            let trial = finished(trial(world, method, 60, 0.02));
            let greedy = GreedySteps::of(trial.plan(), &trial.method().knowledge());
            (greedy.ratio(trial.plan()).unwrap(), trial)
        };
        let (ratio, trial) = steps(Method::XcscrMemory);
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
            map.spots.len(),
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
fn as_many_percepts_are_misread_as_bits_that_flip_foretell() {
    let progress = finished(trial("maze5", Method::QLearning, 200, 0.01));
    let (misread, steps) = (
        progress.progress().mistakes.misread,
        progress.progress().steps,
    );
    // Of sixteen bits none flips in 85.1 % of the percepts.
    let share = misread as f64 / steps as f64;
    assert!((share - 0.149).abs() < 0.02, "{misread} of {steps}");
    let clean = finished(trial("maze5", Method::QLearning, 20, 0.0));
    assert_eq!(clean.progress().mistakes.misread, 0, "control");
}
