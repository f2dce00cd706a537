//! A percept of the last steps, for the learners that choose by the percept alone.

use xcscr::agent::{Knowledge, Method};
use xcscr::episode::PolicyMap;
use xcscr::trial::{Compacted, Evaluation, Plan, Trial};
use xcscr::world::{Cell, Maze};

use super::learned::{gridded, with};

/// A corridor with two cells that share a percept: the lower one needs a move to the east, the upper one to the west.
const HOOK: &str =
    r##########"{ "rows": ["########", "##G....#", "######.#", "###S...#", "########"] }"##########;
/// The cells that share a percept.
const ALIASED: [Cell; 2] = [Cell { col: 4, row: 1 }, Cell { col: 4, row: 3 }];

fn learned(method: Method, history: u32) -> Trial {
    let maze = Maze::from_json(HOOK.as_bytes(), "hook.json").unwrap();
    let plan = with(gridded(maze, method).episodes(40), |settings| {
        settings.sensor.history = history;
    });
    plan.run().unwrap()
}

#[test]
fn an_aliased_corridor_that_no_policy_without_history_solves_is_solved_with_one_step() {
    for method in [Method::XcscrPlus, Method::RMax] {
        let [without, with] = [0, 1].map(|history| learned(method, history));
        let name = method.name();
        let first = |trial: &Trial| trial.progress().first_optimal_episode;
        assert_eq!(first(&without), None, "control: {name} without history");
        assert!(first(&with).is_some(), "{name}");
        assert!(with.progress().optimal, "{name}");
        assert_eq!(
            with.greedy_path().map(|path| path.len()),
            Some(10),
            "{name}"
        );
        let evaluation = Evaluation::run(with.plan(), &with.method().knowledge(), 20).unwrap();
        assert!(evaluation.is_optimal(), "{name}: {evaluation:?}");
    }
}

#[test]
fn on_the_path_the_aliased_cells_have_the_values_of_their_history() {
    let trial = learned(Method::XcscrPlus, 1);
    let best = |map: &PolicyMap, cell| {
        let values = map.values(cell).unwrap();
        values
            .best_actions()
            .map(|action| action.index())
            .collect::<Vec<_>>()
    };
    let policy = trial.policy();
    assert_eq!(ALIASED.map(|cell| best(&policy, cell)), [[3], [1]]);
    let perception = trial.plan().config.perception();
    let [upper, lower] = ALIASED.map(|cell| perception.at(&trial.plan().maze, cell));
    assert_eq!(upper, lower, "control: at the beginning of an episode");
}

#[test]
fn the_rules_of_every_xcs_method_are_selected_for_the_percepts_that_the_policy_meets() {
    let trial = learned(Method::Xcscr, 1);
    let (knowledge, config) = (trial.method().knowledge(), &trial.plan().config);
    let maze = &trial.plan().maze;
    let met = knowledge.decided(config.perception(), maze, 999).unwrap();
    let beginnings = config.perception().at_most_percepts(maze, 999).unwrap();
    assert!(met.iter().any(|percept| !beginnings.contains(percept)));
    let few = Compacted::new(&knowledge, config.perception(), maze, trial.paths()).unwrap();
    assert_eq!(few.optimal, trial.progress().optimal);
    let count = trial.method().rule_count();
    assert!(
        few.rules.len() <= met.len() && met.len() < count,
        "{} rules, {count}",
        few.rules.len()
    );
    let covered = |percept| {
        few.rules
            .rules()
            .iter()
            .any(|rule| rule.condition.matches(percept))
    };
    assert!(met.iter().all(covered));
}

#[test]
fn the_fewest_rules_keep_the_decisions_and_only_fit_the_same_history() {
    let trial = learned(Method::XcscrPlus, 1);
    let Plan { maze, config } = trial.plan();
    let knowledge = trial.method().knowledge();
    let few = Compacted::new(&knowledge, config.perception(), maze, trial.paths()).unwrap();
    let all = trial.method().rule_count();
    assert!(
        few.optimal && few.rules.len() < all,
        "{} of {all}",
        few.rules.len()
    );
    let rules = Knowledge::Rules(few.rules);
    assert!(rules.check(config.perception(), maze).is_ok());
    let fault = rules.check(config.sensor, maze).unwrap_err().to_string();
    let hint = "is as wide as percepts with `sensor.history` 1, but here it is 0: use the percept";
    assert!(fault.contains(hint), "{fault}");
    let words: Vec<String> = rules
        .rules()
        .into_iter()
        .flat_map(|rules| rules.rules())
        .map(|rule| config.sensor.words(maze, &rule.condition))
        .collect();
    assert!(
        words.iter().any(|words| words.contains("one step ago: ")),
        "{words:?}"
    );
}
