//! Moves that slip, in a world of rooms.

use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{Bounds, Checkpoint, GreedySteps, Plan, Trial, seal, unseal};
use xcscr::world::{MazeKind, Recipe};

/// Rooms of 12 x 12 cells, in which every fourth move slips.
fn plan(method: Method, episodes: u32) -> Plan {
    let recipe = Recipe {
        kind: MazeKind::Rooms,
        size: 12,
        seed: 4711,
    };
    let plan = Plan::new(recipe.maze().unwrap()).method(method);
    let plan = plan.arena(ArenaKind::Grid);
    let mut plan = plan.sensor(Sensor::NeighboursPosition).episodes(episodes);
    plan.config.settings.arena.slip = 0.25;
    plan.settled()
}

fn finished(plan: Plan) -> Trial {
    let mut trial = Trial::new(plan).unwrap();
    let _ = trial.run(&mut ());
    trial
}

/// How many times the steps of an optimal policy the greedy policy takes.
fn ratio(trial: &Trial) -> f64 {
    let plan = trial.plan();
    let bound = Bounds::new(&plan.maze, plan.config.sensor, 0.25).full;
    GreedySteps::of(plan, &trial.method().knowledge()).mean / bound
}

#[test]
fn in_rooms_where_a_quarter_of_the_moves_slip_few_rules_come_close_to_the_bound() {
    for seed in [1, 2, 3] {
        let trial = finished(plan(Method::XcscrPlus, 60).seed(seed));
        let (ratio, most) = (ratio(&trial), trial.progress().most_rules);
        assert!(ratio < 1.1, "seed {seed}: {ratio} times the bound");
        assert!(most <= 60, "seed {seed}: {most} rules");
    }
}

#[test]
fn control_q_learning_does_not_in_as_many_episodes() {
    let ratio = ratio(&finished(plan(Method::QLearning, 60).seed(1)));
    assert!(ratio > 1.5, "{ratio} times the bound");
}

#[test]
fn a_trial_in_which_slips_were_noticed_goes_on_from_a_checkpoint_as_if_it_had_never_stopped() {
    let whole = finished(plan(Method::XcscrPlus, 16));
    let mut half = Trial::new(plan(Method::XcscrPlus, 16)).unwrap();
    for _ in 0..8 {
        let _ = half.run_episode(&mut ());
    }
    let saved: Checkpoint = unseal(&seal(&half.checkpoint())).unwrap();
    let mut resumed = Trial::resume(&saved).unwrap();
    let _ = resumed.run(&mut ());
    assert_eq!(whole.checkpoint(), resumed.checkpoint());
}
