//! Policies with a map drive through whole episodes as the learner does.

use std::sync::Arc;

use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::Maze;

use super::episodes::{Differences, Drive};
use super::program::{LANGUAGES, Program, Questions};
use super::{policy, text, with_another_action};
use crate::auxiliary::{SIX, paid};
use crate::learned::{Learned, drawn, learned, limited, mapped, with, world};

fn classic(world: &str) -> Plan {
    let plan = limited(&format!("classic/{world}"), Method::XcscrPlus);
    plan.episodes(60).seed(5)
}

fn noisy(plan: Plan, slip: f64, flips: f64) -> Plan {
    with(plan, |settings| {
        settings.arena.slip = slip;
        settings.sensor.flip_probability = flips;
    })
}

/// Learns, and drives straight and with random steps. Programs in all languages do the same. Returns what was
/// learned.
fn checked(name: &str, plan: Plan) -> Arc<Learned> {
    let learned = learned(plan);
    let drives = [(1, 0.0), (4, 0.3)].map(|(times, chance)| Drive::new(&learned, times, chance));
    for target in LANGUAGES {
        let program = Program::new(target, &text(&learned, target));
        for drive in &drives {
            let found = drive.differences(&program);
            let name = format!("{name} in {}", target.name());
            assert_eq!(found, Differences::default(), "{name}");
        }
    }
    learned
}

#[test]
fn rules_with_a_map_drive_as_the_learner_in_every_step_in_all_languages() {
    for (world, slip, flips) in [
        ("maze7", 0.0, 0.0),
        ("maze10", 0.0, 0.0),
        ("woods101", 0.0, 0.0),
        ("mazee1", 0.0, 0.0),
        ("mazef4", 0.0, 0.0),
        ("littman57", 0.0, 0.0),
        ("sutton", 0.0, 0.0),
        ("woods101", 0.2, 0.0),
        ("mazef4", 0.1, 0.0),
        ("maze7", 0.0, 0.02),
        ("littman57", 0.0, 0.02),
        ("mazee1", 0.1, 0.02),
    ] {
        let name = format!("{world}, slip {slip}, flips {flips}");
        let learned = checked(&name, noisy(classic(world), slip, flips));
        let header = text(&learned, Target::C99);
        assert_eq!(header.contains("XCSCR_SLIPS\n"), slip > 0.0, "{name}");
        assert_eq!(
            header.contains("XCSCR_MISPERCEIVES\n"),
            flips > 0.0,
            "{name}"
        );
    }
}

#[test]
fn control_a_rule_or_a_state_that_is_forged_is_found() {
    let learned = learned(classic("maze7"));
    let header = text(&learned, Target::C99);
    let drive = Drive::new(&learned, 4, 0.3);
    let differences = |text: &str| drive.differences(&Program::new(Target::C99, text));
    let found = differences(&with_another_action(&header));
    assert!(found.actions > 0, "{found:?}");
    let [first, second] =
        ["/* 0 */", "/* 1 */"].map(|end| header.lines().find(|line| line.ends_with(end)).unwrap());
    let found = differences(&header.replacen(second, first, 1));
    assert!(found.states > 0, "{found:?}");
}

#[test]
fn where_bumps_are_not_felt_a_program_does_not_look_at_them() {
    let plan = noisy(classic("mazef4").episodes(30), 0.1, 0.02);
    let plan = with(plan, |settings| settings.map.feels_bumps = false);
    let mut learned = Learned::clone(&checked("mazef4 without bumps", plan));
    let header = text(&learned, Target::C99);
    assert!(header.contains("is ignored"), "{header}");
    let Knowledge::MapRules { map, .. } = &mut learned.knowledge else {
        panic!("no map");
    };
    map.unfelt = false;
    // Control: who feels them believes something else.
    let program = Program::new(Target::C99, &header);
    let found = Drive::new(&learned, 8, 0.3).differences(&program);
    assert!(found.states > 0, "{found:?}");
    assert!(
        !text(&learned, Target::C99).contains("is ignored"),
        "control"
    );
}

#[test]
fn a_program_drives_so_where_cells_pay_by_themselves() {
    for (slip, flips) in [(0.0, 0.0), (0.1, 0.0), (0.0, 0.01)] {
        let plan = mapped(paid(&SIX, 400.0), Method::XcscrPlus);
        let plan = noisy(plan.episodes(60).seed(3), slip, flips);
        let name = format!("rewards, slip {slip}, flips {flips}");
        let learned = checked(&name, plan);
        let Knowledge::MapRules { map, .. } = &learned.knowledge else {
            panic!("no map");
        };
        let is_found = map.states.iter().any(|state| state.collected > 0);
        assert!(is_found, "{name}: no reward is on the map");
    }
}

/// A world with two goals that share their percepts from far away.
fn two_goals() -> Maze {
    drawn(&[
        "#########",
        "#...#...#",
        "#.#...#.#",
        "#.##.##.#",
        "#G#...#.#",
        "###.#.#.#",
        "#...#...#",
        "#.###.#G#",
        "#########",
    ])
}

#[test]
fn a_program_drives_so_with_several_maps_from_one_known_start_and_in_physics() {
    let plan = mapped(two_goals(), Method::XcscrPlus).episodes(60).seed(3);
    let learned = checked("two goals", plan);
    let Knowledge::MapRules { map, .. } = &learned.knowledge else {
        panic!("no map");
    };
    assert!(map.states.iter().any(|state| state.cell_map > 0), "one map");
    for flips in [0.0, 0.01] {
        let plan = mapped(world("rooms-20-1"), Method::XcscrPlus);
        let plan = noisy(plan.sensor(Sensor::Lidar).episodes(32), 0.0, flips);
        let learned = checked(&format!("rooms, flips {flips}"), plan);
        assert!(learned.knows_its_start(), "flips {flips}");
    }
    let plan = mapped(world("maze4"), Method::XcscrPlus).arena(ArenaKind::Physics);
    let plan = plan.sensor(Sensor::Lidar).episodes(6);
    let plan = with(plan, |settings| settings.physics.noise = 3.0);
    checked("maze4 in physics", plan);
}

#[test]
fn the_source_code_tells_how_much_memory_a_tracker_takes() {
    for flips in [0.0, 0.02] {
        let learned = learned(noisy(classic("maze7"), 0.0, flips));
        let target = Target::C99;
        let (source, mut questions) = (text(&learned, target), Questions::default());
        questions.ask('s', &[]);
        let answer = &Program::new(target, &source).answers(&questions)[0];
        let (constants, tracker) = answer.split_once(' ').unwrap();
        let told = format!("{constants} bytes of constants, and {tracker} bytes of memory");
        let name = format!("{}, flips {flips}: {told}", target.name());
        assert!(source.contains(&told), "{name}");
    }
}

#[test]
fn data_of_rules_with_a_map_tell_what_they_look_at_and_json_has_the_maps() {
    let learned = learned(classic("maze7"));
    let json: serde_json::Value = serde_json::from_str(&text(&learned, Target::Json)).unwrap();
    let [rules, states] = [&json["rules"], &json["maps"]["states"]].map(|list| list.as_array());
    let (rules, states) = (rules.unwrap(), states.unwrap());
    assert_eq!(states.len(), 9, "{states:?}");
    let next = states[0]["next"].as_array().unwrap();
    assert!(next.iter().any(|next| next.is_null()), "{states:?}");
    let places = |words: &str| words.contains("x >") || words.contains("x <=");
    let mut conditions = rules.iter().map(|rule| rule["if"].as_str().unwrap());
    assert!(conditions.any(places), "{rules:?}");
    for target in [Target::Csv, Target::Dot] {
        assert!(places(&text(&learned, target)), "{}", target.name());
    }
}

#[test]
fn values_too_close_for_whole_numbers_are_refused_with_a_map_too() {
    let mut learned = Learned::clone(&learned(classic("maze7")));
    let mut json = serde_json::to_value(&learned.knowledge).unwrap();
    let rules = json["map-rules"]["rules"].as_array_mut().unwrap();
    rules.truncate(3);
    let values = [1000.0, f64::from_bits(1000_f64.to_bits() + 1), 0.0];
    for ((at, rule), value) in rules.iter_mut().enumerate().zip(values) {
        rule["condition"] = "#".repeat(255).into();
        rule["action"] = at.into();
        rule["prediction"] = value.into();
    }
    learned.knowledge = serde_json::from_value(json).unwrap();
    let refused = policy(&learned).unwrap_err();
    let words = "too close in a context to be distinguished with integers of 32 bits: train with another seed";
    assert!(refused.to_string().contains(words), "{refused}");
}
