//! `r-max`: the learner of `xcscr-plus` whose plan chooses, without rules.

use serde_json::Value;
use xcscr::agent::{Estimator, Knowledge, Method};
use xcscr::sensor::Sensor;
use xcscr::trial::{GreedySteps, Plan};

use crate::learned::{Learned, learned, limited, with};

fn plan(world: &str, map: bool) -> Plan {
    let plan = limited(&format!("classic/{world}"), Method::RMax).seed(5);
    with(plan, |settings| {
        settings.plus.estimator = match map {
            true => Estimator::Map,
            false => Estimator::Percept,
        };
    })
}

fn as_json(learned: &Learned) -> Value {
    serde_json::to_value(&learned.knowledge).unwrap()
}

#[test]
fn by_its_plan_alone_it_reaches_the_bound_and_without_a_map_it_stays_far_from_it() {
    for world in ["woods101", "maze10", "mazef4"] {
        let [trial, without] = [true, false].map(|map| learned(plan(world, map).episodes(60)));
        let (bound, steps) = (trial.bound(), trial.steps());
        assert!(
            steps <= bound + 1e-9,
            "{world}: {steps} steps, bound {bound}"
        );
        assert!(trial.progress.optimal, "{world}");
        assert!(trial.knowledge.rules().is_none(), "{world}: rules");
        let chosen = trial.progress.chosen;
        assert!(chosen.rules == 0 && chosen.chance == 0, "{world}: {chosen}");
        assert!(chosen.table > 0 && chosen.planner > 0, "{world}: {chosen}");
        let steps = without.steps();
        assert!(steps > 2.0 * bound, "control, {world}: {steps} steps");
    }
}

#[test]
fn it_draws_the_same_maps_as_the_learner_of_rules() {
    let own = |episodes| {
        let trial = learned(plan("maze10", true).episodes(episodes));
        as_json(&trial)["planned"]["map"].clone()
    };
    let rules = learned(plan("maze10", true).method(Method::XcscrPlus).episodes(60));
    assert!(own(60)["states"].is_array());
    assert_eq!(
        own(60),
        as_json(&rules)["map-rules"]["map"],
        "once all is seen"
    );
    assert_ne!(own(60), own(1), "control");
}

#[test]
fn what_is_chosen_is_what_is_planned() {
    let trial = learned(plan("mazef4", true).episodes(60));
    // The same maps; every belief that was planned for is said to cost more than any way.
    let mut spoilt = as_json(&trial);
    let costs = spoilt["planned"]["planner"]["costs"].as_object_mut();
    for cost in costs.unwrap().values_mut() {
        *cost = 1e4.into();
    }
    let spoilt: Knowledge = serde_json::from_value(spoilt).unwrap();
    let (before, after) = (trial.steps(), GreedySteps::of(&trial.plan, &spoilt).mean);
    assert!(before < 5.0 && after > 5.0, "{before} and {after} steps");
}

#[test]
fn it_needs_to_perceive_the_eight_cells_around_and_is_then_not_misled_where_cells_look_alike() {
    let on = |sensor, map| plan("woods101", map).sensor(sensor);
    let refused = on(Sensor::Position, true).check().unwrap_err().to_string();
    assert!(refused.contains("choose `neighbours`"), "{refused}");
    assert!(on(Sensor::Position, false).check().is_ok(), "control");
    let warned = |map| on(Sensor::Neighbours, map).warnings().len();
    assert_eq!((warned(true), warned(false)), (0, 1));
}

#[test]
fn a_plan_that_is_not_one_for_its_maps_is_refused() {
    let sound = as_json(&learned(plan("woods101", true).episodes(60)));
    let read = |json: &Value| serde_json::from_value::<Knowledge>(json.clone());
    let mut forged = sound.clone();
    let seen = forged["planned"]["planner"]["seen"].as_array_mut().unwrap();
    seen.pop();
    let error = read(&forged).unwrap_err().to_string();
    assert!(error.contains("does not fit its map"), "{error}");
    assert!(read(&sound).is_ok(), "control");
}

#[test]
fn where_observations_have_errors_it_plans_on_in_each_step() {
    let plan = plan("woods101", true).episodes(30);
    let trial = learned(with(plan, |settings| {
        settings.sensor.flip_probability = 0.02
    }));
    let found = as_json(&trial)["planned"]["map"]["observation_error"].as_f64();
    assert!(found.unwrap() > 0.01, "control: {found:?}");
    let (steps, bound) = (trial.steps(), trial.bound());
    assert!(steps < 1.1 * bound, "{steps} steps, bound {bound}");
}
