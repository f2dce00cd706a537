//! The table of what reads each setting, against what the program does.

use std::collections::BTreeMap;

use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::episode::{Observer, Step};
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Resolved, Scope, Settings, Trial};

use crate::kit;

/// What runs, where, and on which percept.
type Choice = (Method, ArenaKind, Sensor);

/// Settings under which others count.
const BASES: [&str; 23] = [
    "xcs.population_size=60",
    "arena.slip=0.1",
    "sensor.flip_probability=0.02",
    "episode.alternate=true",
    "plus.planned_exploration=false",
    "reward.sharing=even",
    "reward.learning_rate_switching=false",
    "reward.imprinting=false",
    "reward.short_term_filter=false",
    "reward.learning_step_threshold=false",
    "xcs.ga=false",
    "xcs.ga_subsumption=false",
    "xcs.action_set_subsumption=false",
    "plus.collision_rules=false",
    "plus.estimator=map",
    "plus.estimator=percept",
    "physics.cautious.when=always",
    "physics.cautious.when=never",
    "physics.localisation=estimated",
    "physics.noise=0",
    "physics.faults.stuck_encoder=true",
    "physics.lidar.fitted=false",
    "physics.gyro.fitted=false",
];

fn settings(sets: &[String]) -> Option<Settings> {
    let resolved = Resolved::new(&Settings::default(), &[], sets).ok()?;
    Some(resolved.settings)
}

/// All that is seen of a trial: what is perceived, expected and done in each step.
#[derive(Default)]
struct Seen(String);

impl Observer for Seen {
    fn stepped(&mut self, step: &Step<'_>) {
        let (sensed, values) = (
            step.view
                .sensed
                .map(|sensed| (sensed.estimates, sensed.beams)),
            step.values,
        );
        let Step {
            cell,
            percept,
            action,
            outcome,
            view,
            ..
        } = step;
        let now = view.now();
        self.0 +=
            &format!("{cell:?} {percept} {values:?} {action:?} {outcome:?} {now:?} {sensed:?}\n");
    }
}

/// All that is seen of a trial and that it leaves behind.
fn outcome((method, arena, sensor): Choice, sets: &[String]) -> String {
    let plan = Plan::new(kit::trial::maze("maze4")).method(method);
    let plan = plan.arena(arena).sensor(sensor);
    let episodes = match arena {
        ArenaKind::Grid => 12,
        ArenaKind::Physics => 2,
    };
    let plan = plan.episodes(episodes).settings(settings(sets).unwrap());
    let mut trial = Trial::new(plan).unwrap();
    let mut seen = Seen::default();
    let _ = trial.run(&mut seen);
    let learned = serde_json::to_string(&trial.method().knowledge()).unwrap();
    format!("{}{:?}{learned}", seen.0, trial.progress())
}

/// Other values than the default one of a setting: the ends of its range and one between, or the other names.
fn other_values(key: &str, range: Option<&str>, default: &str) -> Vec<String> {
    let set = |value: &str| format!("{key}={value}");
    if let Ok(truth) = default.parse::<bool>() {
        return vec![set(&(!truth).to_string())];
    }
    let Ok(number) = default.parse::<f64>() else {
        let refusal = Resolved::new(&Settings::default(), &[], &[set("?")]).unwrap_err();
        let refusal = refusal.to_string();
        let names = refusal
            .split("must be")
            .nth(1)
            .unwrap()
            .split('`')
            .skip(1)
            .step_by(2);
        let others = names.filter(|name| !default.contains(name));
        return others.map(set).collect();
    };
    let is_whole = !default.contains('.');
    let ends = range.and_then(|range| range.strip_prefix("from ")?.split_once(" to "));
    let ends: Vec<f64> = ends.map_or(vec![], |(low, high)| {
        vec![low.parse().unwrap(), high.parse().unwrap()]
    });
    let between = [0.9 * number, 0.5 * number, 2.0 * number];
    let values = between.into_iter().chain(ends.into_iter().rev());
    let values = values.map(|value| if is_whole { value.round() } else { value });
    let values = values.filter(|value| *value != number);
    let words = values.map(|value| match is_whole {
        true => set(&format!("{value}")),
        false => set(&format!("{value:?}")),
    });
    words
        .filter(|set| settings(std::slice::from_ref(set)).is_some())
        .collect()
}

/// Every setting, with the arguments of `--set` that change it.
fn changes() -> BTreeMap<String, Vec<String>> {
    let resolved = Resolved::new(&Settings::default(), &[], &[]).unwrap();
    let declared = Settings::declared();
    let all = declared.iter().zip(resolved.entries());
    all.map(|(setting, (key, value, _))| {
        let changes = other_values(key, setting.range.as_deref(), &value);
        assert!(!changes.is_empty(), "{key} = {value}");
        (key.to_owned(), changes)
    })
    .collect()
}

/// Does the table say that this choice of method, arena and percept reads the setting?
fn reads(choice: Choice, sets: &[String], key: &str) -> bool {
    let settings = settings(sets).unwrap();
    let (method, arena, sensor) = choice;
    let scope = Scope {
        method: Some(method),
        arena,
        sensor,
        settings: &settings,
    };
    scope.reads(key)
}

fn grid(method: Method) -> Choice {
    (method, ArenaKind::Grid, Sensor::Neighbours)
}

fn driven(sensor: Sensor) -> Choice {
    (Method::QLearning, ArenaKind::Physics, sensor)
}

/// The defaults, and each of the settings under which others count, as far as it counts itself. No learner builds a map
/// from a percept without the surroundings.
fn bases(choice: Choice) -> impl Iterator<Item = Vec<String>> {
    let can_map = choice.2.begins_with_neighbours();
    let counts = move |base: &&&str| {
        let is_map = **base == "plus.estimator=map";
        reads(choice, &[], base.split('=').next().unwrap()) && (can_map || !is_map)
    };
    let each = BASES.iter().filter(counts);
    std::iter::once(vec![]).chain(each.map(|base| vec![(*base).to_owned()]))
}

#[test]
fn a_setting_that_a_run_is_said_not_to_read_changes_nothing_in_it() {
    let all = changes();
    let on_the_grid = Method::ALL.iter().copied().map(grid);
    let in_physics = [Sensor::Neighbours, Sensor::Lidar].map(driven);
    let other_percepts = [Sensor::Position, Sensor::NeighboursPosition]
        .map(|sensor| (Method::XcscrPlus, ArenaKind::Grid, sensor));
    let mut compared = 0;
    for choice in on_the_grid.chain(in_physics).chain(other_percepts) {
        for base in bases(choice) {
            let unread = |key: &&String| !reads(choice, &base, key);
            let unread: Vec<&String> = all.keys().filter(unread).collect();
            let changed = unread.iter().map(|key| all[*key][0].clone());
            let changed: Vec<String> = base.iter().cloned().chain(changed).collect();
            let is_same = outcome(choice, &base) == outcome(choice, &changed);
            assert!(is_same, "{choice:?} {base:?} {changed:?}");
            compared += unread.len();
        }
    }
    assert!(compared > 3_000, "{compared}");
}

/// Settings whose effect these short trials in one small maze do not show: they need several goals, a
/// long way, wheels that slip; and `shortcut` is to change nothing but the time.
const UNSEEN: [&str; 5] = [
    "map.max_maps",
    "reward.step_threshold_from_maze",
    "physics.estimator.slip_mps",
    "physics.estimator.slip_s",
    "physics.shortcut",
];

#[test]
fn a_setting_that_some_run_is_said_to_read_changes_one() {
    // Cheap ones first.
    let mut methods = Method::ALL.to_vec();
    methods.sort_by_key(|method| matches!(method, Method::XcscrPlus | Method::RMax));
    let on_the_grid = methods.into_iter().map(grid);
    let in_physics = [Sensor::Lidar, Sensor::Neighbours].map(driven);
    let choices: Vec<Choice> = on_the_grid.chain(in_physics).collect();
    for (key, changes) in changes()
        .iter()
        .filter(|(key, _)| !UNSEEN.contains(&&key[..]))
    {
        let has_effect = choices.iter().any(|&choice| {
            let mut reading = bases(choice).filter(|base| reads(choice, base, key));
            reading.any(|base| {
                let plain = outcome(choice, &base);
                let differs = |change: &String| {
                    let sets: Vec<String> = base.iter().chain([change]).cloned().collect();
                    settings(&sets).is_some() && outcome(choice, &sets) != plain
                };
                changes.iter().any(differs)
            })
        });
        assert!(has_effect, "nothing reads `{key}`: {changes:?}");
    }
}
