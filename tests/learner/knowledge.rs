//! What was learned, apart from the learner.

use crate::kit::trial::on_the_grid;
use xcscr::agent::Method;
use xcscr::sensor::Sensor;
use xcscr::trial::{Compacted, Settings, Trial};
use xcscr::world::Paths;

/// A finished trial of a few episodes in Maze4.
fn finished(method: Method, over_match_set: bool) -> Trial {
    let mut settings = Settings::default();
    settings.xcs.value_over_match_set = over_match_set;
    let plan = on_the_grid("maze4", method).episodes(12);
    plan.seed(3).settings(settings).run().unwrap()
}

#[test]
fn what_was_learned_rates_actions_as_the_learner_does() {
    for (method, over_match_set) in Method::ALL.iter().flat_map(|&m| [(m, false), (m, true)]) {
        let trial = finished(method, over_match_set);
        let maze = &trial.plan().maze;
        let knowledge = trial.method().knowledge();
        let mut rated = 0;
        for percept in Sensor::Neighbours.percepts(maze) {
            let values = trial.method().values(&percept);
            let known = knowledge.values(&percept, maze.action_count());
            if known.greatest().is_none() {
                // Some tables rate what was never met; all actions alike.
                let actions = values.best_actions().count();
                assert!(
                    [0, maze.action_count()].contains(&actions),
                    "{method:?}: {values:?}"
                );
                continue;
            }
            rated += 1;
            assert_eq!(
                known, values,
                "{method:?}, over [M]: {over_match_set}, {percept}"
            );
        }
        assert!(rated > 5, "{method:?} knows only {rated} percepts");
    }
}

#[test]
fn the_two_readings_of_equation_6_are_told_apart_in_a_file() {
    let knowledge = [false, true].map(|over| finished(Method::Xcs, over).method().knowledge());
    for (knowledge, kind) in knowledge.iter().zip(["rules", "rules-over-match-set"]) {
        let text = serde_json::to_string(knowledge).unwrap();
        assert!(text.starts_with(&format!("{{\"{kind}\":")), "{text:.40}");
        assert_eq!(
            &serde_json::from_str::<xcscr::agent::Knowledge>(&text).unwrap(),
            knowledge
        );
    }
}

#[test]
fn rules_are_condensed_to_the_same_choices_in_both_readings_of_equation_6() {
    for over_match_set in [false, true] {
        let trial = finished(Method::Xcscr, over_match_set);
        let maze = &trial.plan().maze;
        let knowledge = trial.method().knowledge();
        let compacted =
            Compacted::new(&knowledge, Sensor::Neighbours, maze, &Paths::new(maze)).unwrap();
        assert!(compacted.percepts > 5, "{} percepts", compacted.percepts);
        assert_eq!(
            compacted.agreeing, compacted.percepts,
            "over [M]: {over_match_set}"
        );
    }
}
