//! `r-max`: the learner of `xcscr-plus` whose plan chooses, without rules.

use crate::kit::trial::on_the_grid;
use serde_json::Value;
use xcscr::agent::{Estimator, Knowledge, Method};
use xcscr::sensor::Sensor;
use xcscr::trial::{Bounds, GreedySteps, Plan, Trial, seal};

fn plan(world: &str, method: Method, map: bool) -> Plan {
    let mut plan = on_the_grid(&format!("classic/{world}"), method).seed(5);
    plan.config.settings.reward.step_threshold = 100;
    plan.config.settings.plus.estimator = match map {
        true => Estimator::Map,
        false => Estimator::Percept,
    };
    plan
}

fn greedy(trial: &Trial) -> f64 {
    GreedySteps::of(trial.plan(), &trial.method().knowledge()).mean
}

fn as_json(trial: &Trial) -> Value {
    serde_json::to_value(trial.method().knowledge()).unwrap()
}

#[test]
fn by_its_plan_alone_it_reaches_the_bound_and_without_a_map_it_stays_far_from_it() {
    for world in ["woods101", "maze10", "mazef4"] {
        let run = |map| {
            let plan = plan(world, Method::RMax, map);
            plan.episodes(50).run().unwrap()
        };
        let trial = run(true);
        let bound = Bounds::of_belief(&trial.plan().maze, Sensor::Neighbours).unwrap();
        let steps = greedy(&trial);
        assert!(
            steps <= bound + 1e-9,
            "{world}: {steps} steps, bound {bound}"
        );
        assert!(trial.progress().optimal, "{world}");
        assert!(
            trial.method().knowledge().rules().is_none(),
            "{world}: rules"
        );
        let chosen = trial.progress().chosen;
        assert!(chosen.rules == 0 && chosen.chance == 0, "{world}: {chosen}");
        assert!(chosen.table > 0 && chosen.planner > 0, "{world}: {chosen}");
        let without = greedy(&run(false));
        assert!(
            without > 2.0 * bound,
            "control, {world}: {without} steps without a map, bound {bound}"
        );
    }
}

#[test]
fn it_draws_the_same_maps_as_the_learner_of_rules() {
    let cell_maps = |method, kind, episodes| {
        let plan = plan("maze10", method, true).episodes(episodes);
        as_json(&plan.run().unwrap())[kind]["map"].clone()
    };
    let own = |episodes| cell_maps(Method::RMax, "planned", episodes);
    assert!(own(60)["states"].is_array());
    assert_eq!(
        own(60),
        cell_maps(Method::XcscrPlus, "remembering", 60),
        "once all is seen"
    );
    assert_ne!(own(60), own(1), "control");
}

#[test]
fn what_is_chosen_is_what_is_planned() {
    let trial = plan("mazef4", Method::RMax, true).episodes(60).run();
    let trial = trial.unwrap();
    let before = greedy(&trial);
    // The same maps; every belief that was planned for is said to cost more than any way.
    let mut spoilt = as_json(&trial);
    let costs = spoilt["planned"]["planner"]["costs"].as_object_mut();
    for cost in costs.unwrap().values_mut() {
        *cost = 1e4.into();
    }
    let spoilt: Knowledge = serde_json::from_value(spoilt).unwrap();
    let after = GreedySteps::of(trial.plan(), &spoilt).mean;
    assert!(before < 5.0 && after > 5.0, "{before} and {after} steps");
}

#[test]
fn where_moves_slip_it_plans_too() {
    let mut plan = plan("woods101", Method::RMax, true).episodes(60);
    plan.config.settings.arena.slip = 0.21875;
    let steps = greedy(&plan.run().unwrap());
    // As for the rules: the estimate of the belief bound is 4.06.
    assert!(steps < 4.8, "{steps} steps");
}

#[test]
fn it_needs_to_perceive_the_eight_cells_around_and_is_then_not_misled_where_cells_look_alike() {
    let on = |sensor, map| plan("woods101", Method::RMax, map).sensor(sensor);
    let refused = on(Sensor::Position, true).check().unwrap_err().to_string();
    assert!(refused.contains("choose `neighbours`"), "{refused}");
    assert!(on(Sensor::Position, false).check().is_ok(), "control");
    let warned = |map| on(Sensor::Neighbours, map).warnings().len();
    assert_eq!((warned(true), warned(false)), (0, 1));
}

#[test]
fn a_plan_that_is_not_one_for_its_maps_is_refused() {
    let trial = plan("woods101", Method::RMax, true).episodes(20).run();
    let sound = as_json(&trial.unwrap());
    let read = |json: &Value| serde_json::from_value::<Knowledge>(json.clone());
    let mut forged = sound.clone();
    let seen = forged["planned"]["planner"]["seen"].as_array_mut().unwrap();
    seen.pop();
    let error = read(&forged).unwrap_err().to_string();
    assert!(error.contains("does not fit its map"), "{error}");
    assert!(read(&sound).is_ok(), "control");
}

#[test]
fn where_observations_have_errors_it_plans_on_in_each_step_and_resumes_to_the_same_bytes() {
    let mut plan = plan("woods101", Method::RMax, true).episodes(30);
    plan.config.settings.sensor.flip_probability = 0.02;
    let mut whole = Trial::new(plan).unwrap();
    let mut stopped = Trial::resume(&whole.checkpoint()).unwrap();
    for episode in 1..=30 {
        let _ = (whole.run_episode(&mut ()), stopped.run_episode(&mut ()));
        if episode % 5 == 0 {
            stopped = Trial::resume(&stopped.checkpoint()).unwrap();
            let same = seal(&whole.checkpoint()) == seal(&stopped.checkpoint());
            assert!(same, "after episode {episode}");
        }
    }
    let observation_error = as_json(&whole)["planned"]["map"]["observation_error"].as_f64();
    assert!(
        observation_error.unwrap() > 0.01,
        "control: {observation_error:?}"
    );
    let bound = Bounds::of_belief(&whole.plan().maze, Sensor::Neighbours).unwrap();
    let steps = greedy(&whole);
    assert!(steps < 1.1 * bound, "{steps} steps, bound {bound}");
}
