//! Settings at their bounds and beyond.

use crate::kit::trial::on_the_grid;
use serde_json::Value;
use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::trial::{Resolved, Settings, SettingsError, Trial};
use xcscr::world::Maze;

/// The values at which a number tends to be treated wrongly.
const NUMBERS: &str = "nan inf -inf -1 0 -0.0 1 1e308 -1e308 5e-324 1e-320 \
                       9223372036854775807 -9223372036854775808 4294967295 4294967296";

/// The bounds that a refusal names, with their nearest neighbours on both sides.
fn bounds(message: &str) -> Vec<String> {
    let range = message.split_once("from ").unwrap().1;
    let (low, high) = range.split_once(" to ").unwrap();
    let (low, high) = (low.trim(), high.trim());
    let mut all = vec![low.to_owned(), high.to_owned()];
    if let (Ok(low), Ok(high)) = (low.parse::<f64>(), high.parse::<f64>()) {
        let nearest = [low, high].map(|end| [end.next_down(), end.next_up()]);
        all.extend(nearest.concat().iter().map(|x| format!("{x:e}")));
        all.extend([low - 1.0, high + 1.0].map(|x| format!("{x}")));
    }
    all
}

/// What becomes of a setting: its value is in range and finite, or the message says the range.
fn set(key: &str, value: &str) -> Result<Settings, SettingsError> {
    let resolved = Resolved::new(&Settings::default(), &[], &[format!("{key}={value}")])?;
    resolved
        .settings
        .check()
        .unwrap_or_else(|fault| panic!("{key}={value}: {fault}"));
    Ok(resolved.settings)
}

/// Returns the range of a setting as a refusal names it. It is the declared one, if one is declared.
fn range(key: &str) -> String {
    let refusals = NUMBERS.split(' ').filter_map(|value| set(key, value).err());
    let refusals: Vec<String> = refusals.map(|refusal| refusal.to_string()).collect();
    let ranged = refusals.iter().find(|text| text.contains("from "));
    let named = ranged.unwrap_or_else(|| panic!("{key} has no range: {refusals:?}"));
    let all = Settings::declared();
    let declared = all.iter().find(|setting| setting.key == key).unwrap();
    if let Some(range) = &declared.range {
        assert!(
            named.contains(key) && named.contains(range),
            "{key}: {named}"
        );
        for outside in bounds(range).iter().rev().take(2) {
            assert!(set(key, outside).is_err(), "{key}={outside}");
        }
    }
    named.clone()
}

#[test]
fn every_number_among_the_settings_is_refused_beyond_its_range_and_works_at_its_bounds() {
    let defaults = Resolved::new(&Settings::default(), &[], &[]).unwrap();
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let numbers = defaults.entries().filter(|(_, value, _)| is_number(value));
    let mut tried = 0;
    for (key, ..) in numbers {
        let bounds = bounds(&range(key));
        for value in bounds.iter().map(String::as_str).chain(NUMBERS.split(' ')) {
            let Ok(mut settings) = set(key, value) else {
                continue;
            };
            tried += 1;
            // Short, or the largest step-thresholds would take minutes.
            settings.reward.step_threshold = settings.reward.step_threshold.min(20);
            for &method in users(key) {
                for &arena in arenas(key) {
                    assert_stays_finite(method, arena, &settings, &format!("{key}={value}"));
                }
            }
        }
    }
    assert!(tried > 100, "{tried} values");
}

/// The methods in which a setting matters.
fn users(key: &str) -> &'static [Method] {
    match key.split('.').next() {
        Some("plus") => &[Method::XcscrPlus],
        Some("tabular") => &[Method::SarsaLambda, Method::DynaQ, Method::RMax],
        Some("reward") => &[Method::Xcscr, Method::XcscrPlus, Method::QLearning],
        _ => &[Method::Xcscr],
    }
}

/// The arenas in which a setting matters: a learner is not told in which one it is.
fn arenas(key: &str) -> &'static [ArenaKind] {
    match key.split('.').next() {
        Some("xcs" | "plus" | "tabular" | "reward") => &[ArenaKind::Grid],
        _ => ArenaKind::ALL,
    }
}

/// The same maze, with larger cells if the robot needs them.
fn with_room_for(maze: &Maze, least_cell_m: f64) -> Maze {
    if maze.cell_size_m() >= least_cell_m {
        return maze.clone();
    }
    let mut world: Value = serde_json::from_str(&maze.to_json()).unwrap();
    world["cell_size_m"] = least_cell_m.into();
    Maze::from_json(world.to_string().as_bytes(), "larger.json").unwrap()
}

/// Two episodes, after which no rule may hold a number that is none.
fn assert_stays_finite(method: Method, arena: ArenaKind, settings: &Settings, what: &str) {
    let mut plan = on_the_grid("maze4", method).arena(arena).episodes(2);
    plan.config.settings = settings.clone();
    plan.maze = with_room_for(&plan.maze, settings.physics.least_cell_m());
    let mut trial = Trial::new(plan).unwrap();
    let _ = trial.run(&mut ());
    if let Knowledge::Rules(population) = trial.method().knowledge() {
        for rule in population.rules() {
            let figures = [rule.prediction, rule.error, rule.fitness, rule.set_size];
            let finite = figures.iter().all(|figure| figure.is_finite());
            assert!(finite, "{what} on {}: {rule:?}", arena.name());
        }
    }
}
