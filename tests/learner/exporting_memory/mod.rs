//! Exported policies with a memory are compiled or run as their users would, and drive through whole
//! episodes as the learner does.

pub mod driver;
mod programs;

use std::fs;
use std::process::Command;

use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::export::{ExportError, Target};
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::{Maze, Recipe};

use crate::exporting::{compile_c, compile_rust, fed, folder, with_another_action};
use crate::kit::trial::{maze, on_a_map, on_the_grid};
use driver::{Learned, drives_alike};
use programs::{C_SIZES, LANGUAGES, Maker, RUST_SIZES, compiled, compiled_rust};

/// A plan on the grid of a maze of one's own.
fn own(json: &str) -> Plan {
    let plan = Plan::new(Maze::from_json(json.as_bytes(), "own.json").unwrap());
    let plan = on_a_map(plan.method(Method::XcscrPlus).arena(ArenaKind::Grid));
    plan.sensor(Sensor::Neighbours).episodes(60).seed(3)
}

fn classic(world: &str) -> Plan {
    let mut plan = on_a_map(on_the_grid(&format!("classic/{world}"), Method::XcscrPlus));
    plan.config.settings.reward.step_threshold = 100;
    plan.episodes(60).seed(5)
}

#[test]
fn rules_with_a_memory_drive_as_the_learner_in_every_step_in_all_languages() {
    for world in [
        "maze7",
        "maze10",
        "woods101",
        "mazee1",
        "mazef4",
        "littman57",
        "sutton",
    ] {
        checked(world, classic(world));
    }
}

#[test]
fn control_a_rule_or_a_state_that_is_forged_is_found() {
    let (learned, folder) = (Learned::new(classic("maze7")), folder());
    let header = learned.text(Target::C99);
    let rule = with_another_action(&header);
    let tally = learned.driven(&mut compiled(folder.path(), &rule), 4, 0.3);
    assert!(tally.differences > 0, "{tally:?}");
    let [first, second] =
        ["/* 0 */", "/* 1 */"].map(|end| header.lines().find(|line| line.ends_with(end)).unwrap());
    let state = header.replacen(second, first, 1);
    let tally = learned.driven(&mut compiled(folder.path(), &state), 4, 0.3);
    assert!(tally.elsewhere > 0, "{tally:?}");
}

#[test]
fn it_drives_so_where_moves_slip_percepts_have_errors_and_both() {
    for (world, slip, flips) in [
        ("woods101", 0.2, 0.0),
        ("mazef4", 0.1, 0.0),
        ("maze7", 0.0, 0.02),
        ("littman57", 0.0, 0.02),
        ("mazee1", 0.1, 0.02),
    ] {
        let mut plan = classic(world);
        plan.config.settings.arena.slip = slip;
        plan.config.settings.sensor.flip_probability = flips;
        let learned = checked(&format!("{world}, slip {slip}, flips {flips}"), plan);
        let header = learned.text(Target::C99);
        assert!(header.contains("XCSCR_SLIPS") || slip == 0.0, "{world}");
        assert!(
            header.contains("XCSCR_MISPERCEIVES") || flips == 0.0,
            "{world}"
        );
    }
}

#[test]
fn it_drives_so_where_bumps_are_not_felt_and_does_not_look_at_them() {
    let mut plan = classic("mazef4").episodes(30);
    plan.config.settings.arena.slip = 0.1;
    plan.config.settings.sensor.flip_probability = 0.02;
    plan.config.settings.map.feels_bumps = false;
    let mut learned = checked("mazef4 without bumps", plan);
    let (folder, header) = (folder(), learned.text(Target::C99));
    assert!(header.contains("is ignored"), "{header}");
    let Knowledge::Remembering { map, .. } = &mut learned.knowledge else {
        panic!("it remembers");
    };
    map.unfelt = false;
    let tally = learned.driven(&mut compiled(folder.path(), &header), 8, 0.3);
    assert!(
        tally.elsewhere > 0,
        "control, who feels them believes something else: {tally:?}"
    );
    assert!(!learned.text(Target::C99).contains("is ignored"), "control");
}

/// Learns, exports to all languages and drives, and returns what was learned.
fn checked(name: &str, plan: Plan) -> Learned {
    let learned = Learned::new(plan);
    for (target, program) in LANGUAGES {
        let folder = folder();
        let mut program = program(folder.path(), &learned.text(target));
        drives_alike(
            &format!("{name} in {}", target.name()),
            &learned,
            &mut program,
        );
    }
    learned
}

const PAID: [&str; 7] = [
    "##########",
    "#..#...#.#",
    "#*.....#.#",
    "#..#.#...#",
    "####.#.#.#",
    "#*...#G#*#",
    "##########",
];

#[test]
fn it_drives_so_where_cells_pay_by_themselves() {
    for (reward, slip, flips) in [(400.0, 0.0, 0.0), (400.0, 0.1, 0.0), (400.0, 0.0, 0.01)] {
        let mut plan = own(&format!(r#"{{ "rows": {PAID:?}, "reward": {reward} }}"#));
        plan.config.settings.arena.slip = slip;
        plan.config.settings.sensor.flip_probability = flips;
        let name = format!("reward {reward}, slip {slip}, flips {flips}");
        let learned = checked(&name, plan);
        let collected = learned.mapped().most_eaten;
        assert!(collected > Some(0), "{name}: no reward is on the map");
    }
}

#[test]
fn it_drives_so_with_several_maps_and_where_all_episodes_begin_in_one_place() {
    let two = [
        "#########",
        "#...#...#",
        "#.#...#.#",
        "#.##.##.#",
        "#G#...#.#",
        "###.#.#.#",
        "#...#...#",
        "#.###.#G#",
        "#########",
    ];
    let learned = checked("two goals", own(&format!(r#"{{ "rows": {two:?} }}"#)));
    let last = learned.mapped().last_map;
    assert!(last > Some(0), "{last:?}: one map");
    for flips in [0.0, 0.01] {
        let maze = "rooms-20-1".parse::<Recipe>().unwrap().maze().unwrap();
        let plan = on_a_map(Plan::new(maze).method(Method::XcscrPlus));
        let mut plan = plan
            .arena(ArenaKind::Grid)
            .sensor(Sensor::Lidar)
            .episodes(32);
        plan.config.settings.sensor.flip_probability = flips;
        let learned = checked(&format!("rooms, flips {flips}"), plan);
        assert!(learned.mapped().begins_in_one_place, "flips {flips}");
    }
}

#[test]
fn it_drives_so_in_physics_with_all_senses_of_its_own() {
    let mut plan = on_a_map(Plan::new(maze("maze4")).method(Method::XcscrPlus));
    plan = plan
        .arena(ArenaKind::Physics)
        .sensor(Sensor::Lidar)
        .episodes(6);
    plan.config.settings.physics.noise = 3.0;
    checked("maze4 in physics", plan);
}

#[test]
fn the_source_code_tells_how_much_memory_a_tracker_takes() {
    for flips in [0.0, 0.02] {
        let mut plan = classic("maze7");
        plan.config.settings.sensor.flip_probability = flips;
        let learned = Learned::new(plan);
        for (target, program, main, sizes) in [
            (Target::C99, compiled as Maker, "main.c", C_SIZES),
            (Target::Rust, compiled_rust, "main.rs", RUST_SIZES),
        ] {
            let (folder, text) = (folder(), learned.text(target));
            program(folder.path(), &text);
            fs::write(folder.path().join(main), sizes).unwrap();
            match target {
                Target::C99 => compile_c(folder.path()),
                _ => compile_rust(folder.path()),
            }
            let printed = fed(&mut Command::new(folder.path().join("decide")), Vec::new());
            let printed = String::from_utf8(printed).unwrap();
            let (constants, tracker) = printed.trim().split_once(' ').unwrap();
            let told = format!("{constants} bytes of constants, and {tracker} bytes of memory");
            assert!(
                text.contains(&told),
                "{}, flips {flips}: {told}",
                target.name()
            );
        }
    }
}

#[test]
fn data_of_rules_with_a_memory_tell_what_they_look_at_and_json_has_the_maps() {
    let learned = Learned::new(classic("maze7"));
    let json: serde_json::Value = serde_json::from_str(&learned.text(Target::Json)).unwrap();
    let [rules, states] = [&json["rules"], &json["maps"]["states"]];
    assert_eq!(states.as_array().unwrap().len(), 9, "{states}");
    assert!(
        states[0]["next"]
            .as_array()
            .unwrap()
            .iter()
            .any(|next| next.is_null()),
        "{states}"
    );
    let places = |words: &str| words.contains("x >") || words.contains("x <=");
    let rules = rules.as_array().unwrap();
    assert!(
        rules
            .iter()
            .any(|rule| places(rule["if"].as_str().unwrap())),
        "{rules:?}"
    );
    for target in [Target::Csv, Target::Dot] {
        assert!(places(&learned.text(target)), "{}", target.name());
    }
}

#[test]
fn worths_too_close_for_whole_numbers_are_refused_with_a_memory_too() {
    let mut learned = Learned::new(classic("maze7"));
    let mut json = serde_json::to_value(&learned.knowledge).unwrap();
    let rules = json["remembering"]["rules"].as_array_mut().unwrap();
    rules.truncate(3);
    let values = [1000.0, f64::from_bits(1000_f64.to_bits() + 1), 0.0];
    for ((at, rule), value) in rules.iter_mut().enumerate().zip(values) {
        rule["condition"] = "#".repeat(255).into();
        rule["action"] = at.into();
        rule["prediction"] = value.into();
    }
    learned.knowledge = serde_json::from_value(json).unwrap();
    let refused = learned.policy().unwrap_err();
    assert_eq!(refused, ExportError::CloseInContext);
    assert!(refused.to_string().contains("another seed"), "{refused}");
}
