//! What was learned, apart from the learner.

use xcscr::agent::{Knowledge, Method};
use xcscr::sensor::Sensor;
use xcscr::trial::{Compacted, Trial};
use xcscr::world::Paths;

use crate::learner::learned::{gridded, with, world};

/// A finished trial of a few episodes in Maze4.
fn finished(method: Method, over_match_set: bool) -> Trial {
    let plan = gridded(world("maze4"), method).episodes(12).seed(3);
    let plan = with(plan, |settings| {
        settings.xcs.value_over_match_set = over_match_set;
    });
    plan.run().unwrap()
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
                let alike = [0, maze.action_count()].contains(&actions);
                assert!(alike, "{method:?}: {values:?}");
                continue;
            }
            rated += 1;
            let what = format!("{method:?}, over [M]: {over_match_set}, {percept}");
            assert_eq!(known, values, "{what}");
        }
        assert!(rated > 5, "{method:?} knows only {rated} percepts");
    }
}

#[test]
fn the_two_readings_of_equation_6_are_told_apart_in_a_file_and_condensed_to_the_same_choices() {
    for (over_match_set, kind) in [(false, "rules"), (true, "rules-over-match-set")] {
        let trial = finished(Method::Xcscr, over_match_set);
        let (maze, knowledge) = (&trial.plan().maze, trial.method().knowledge());
        let text = serde_json::to_string(&knowledge).unwrap();
        assert!(text.starts_with(&format!("{{\"{kind}\":")), "{text:.40}");
        assert_eq!(serde_json::from_str::<Knowledge>(&text).unwrap(), knowledge);
        let paths = Paths::new(maze);
        let compacted = Compacted::new(&knowledge, Sensor::Neighbours, maze, &paths).unwrap();
        let few = knowledge.with_rules(compacted.rules);
        assert!(few.len() < knowledge.len(), "{kind}: {} rules", few.len());
        for percept in Sensor::Neighbours.percepts(maze) {
            let [few, all] = [&few, &knowledge].map(|known| known.values(&percept, 4));
            let mut chosen = few.best_actions();
            assert!(
                chosen.all(|action| all.is_nearly_best(action)),
                "{kind}, {percept}"
            );
        }
    }
}
