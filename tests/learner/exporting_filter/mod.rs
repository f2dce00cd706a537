//! Exported policies with a filter of misread percepts are compiled or run as their users would, and drive
//! through whole episodes as the learner does.

mod programs;

use std::fs;
use std::process::Command;

use xcscr::agent::{Knowledge, Method};
use xcscr::export::{ExportError, Target};
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;

use crate::exporting::{compile_c, compile_rust, fed, folder};
use crate::exporting_memory::driver::Learned;
use crate::kit::trial::on_the_grid;
use programs::{C_SIZES, LANGUAGES, RUST_SIZES, compiled};

/// How often is driven, and how many of the steps are done by chance.
const TIMES: u32 = 60;
const CHANCE: f64 = 0.3;

/// Maze4 where one percept in four is misread.
fn misread() -> Plan {
    misreading(Method::XcscrPlus, Sensor::Neighbours, 0.02)
}

fn misreading(method: Method, sensor: Sensor, flips: f64) -> Plan {
    let mut plan = on_the_grid("maze4", method).sensor(sensor);
    plan.config.settings.sensor.flips = flips;
    plan.config.settings.tabular.doubts = 20_000;
    plan.episodes(25).seed(2)
}

/// Drives with the exported programs in so many languages as the learner does.
fn checked(name: &str, learned: &Learned, languages: usize) {
    let awake = matches!(learned.knowledge, Knowledge::Doubting { .. });
    assert!(awake, "{name}: the filter sleeps");
    for (target, program) in &LANGUAGES[..languages] {
        let folder = folder();
        let mut program = program(folder.path(), &learned.text(*target));
        let tally = learned.driven(&mut program, TIMES, CHANCE);
        let name = format!("{name} in {}", target.name());
        assert_eq!(tally.differences, 0, "{name}: {tally:?}");
        assert_eq!(tally.elsewhere, 0, "{name}: {tally:?}");
    }
}

#[test]
fn an_exported_filter_believes_and_chooses_as_the_learner_in_every_step_in_all_languages() {
    let mut learned = Learned::new(misread());
    checked("maze4", &learned, 3);
    learned.plan.config.settings.sensor.flips = 0.05;
    checked("maze4, worse", &learned, 3);
}

#[test]
fn it_does_so_with_wide_percepts_where_moves_slip_and_with_a_table() {
    let wide = misreading(Method::XcscrPlus, Sensor::NeighboursPosition, 0.01);
    checked("wide", &Learned::new(wide), 3);
    let mut slipping = misread();
    slipping.config.settings.arena.slip = 0.1;
    checked("slipping", &Learned::new(slipping), 1);
    let table = misreading(Method::DynaQ, Sensor::Neighbours, 0.02);
    checked("table", &Learned::new(table), 1);
}

#[test]
fn control_without_the_filter_or_with_a_forged_one_the_steps_differ() {
    let (learned, folder) = (Learned::new(misread()), folder());
    let header = learned.text(Target::C99);
    let forged = |from: &str, to: &str| {
        assert!(header.contains(from), "{from}");
        let header = header.replacen(from, to, 1);
        learned.driven(&mut compiled(folder.path(), &header), TIMES, CHANCE)
    };
    // Whatever is likeliest, the rules are asked what to do on what is perceived.
    let removed = forged("likeliest == XCSCR_PLACES ?", "likeliest <= XCSCR_PLACES ?");
    assert!(removed.differences > 20, "removed: {removed:?}");
    let deaf = forged("} else if (bumped) {", "} else if (0 && bumped) {");
    assert!(deaf.elsewhere > 0, "deaf: {deaf:?}");
}

#[test]
fn where_percepts_are_right_nothing_of_a_filter_is_exported() {
    let clean = Learned::new(misreading(Method::XcscrPlus, Sensor::Neighbours, 0.0));
    let control = Learned::new(misread()).text(Target::C99);
    assert!(control.contains("misread"), "control");
    for target in Target::ALL {
        let text = clean.text(*target).to_lowercase();
        assert!(!text.contains("misread"), "{}", target.name());
    }
}

#[test]
fn the_source_code_tells_how_much_memory_a_filter_takes_and_json_has_its_places() {
    let learned = Learned::new(misread());
    for (target, file, main, sizes) in [
        (Target::C99, "policy.h", "main.c", C_SIZES),
        (Target::Rust, "policy.rs", "main.rs", RUST_SIZES),
    ] {
        let (folder, text) = (folder(), learned.text(target));
        fs::write(folder.path().join(file), &text).unwrap();
        fs::write(folder.path().join(main), sizes).unwrap();
        match target {
            Target::C99 => compile_c(folder.path()),
            _ => compile_rust(folder.path()),
        }
        let printed = fed(&mut Command::new(folder.path().join("decide")), Vec::new());
        let printed = String::from_utf8(printed).unwrap();
        let (constants, memory) = printed.trim().split_once(' ').unwrap();
        let name = target.name();
        for told in [
            format!("The filter takes {constants} bytes of constants"),
            format!("and {memory} bytes of memory"),
        ] {
            assert!(text.contains(&told), "{name}: {told}");
        }
    }
    let Knowledge::Doubting { places, .. } = &learned.knowledge else {
        panic!("the filter sleeps");
    };
    let json: serde_json::Value = serde_json::from_str(&learned.text(Target::Json)).unwrap();
    let exported = json["filter"]["places"].as_array().unwrap();
    assert_eq!(exported.len(), places.len());
    let first = exported[0]["percept"].as_str().unwrap();
    assert_eq!(first, places.percept(0).to_string());
}

#[test]
fn a_filter_that_knows_more_places_than_16_bits_count_is_refused() {
    let mut learned = Learned::new(misreading(
        Method::XcscrPlus,
        Sensor::NeighboursPosition,
        0.01,
    ));
    let mut json = serde_json::to_value(&learned.knowledge).unwrap();
    let places = json["doubting"]["places"]["places"].as_array_mut().unwrap();
    let mut place = places[0].clone();
    let width = place["percept"].as_str().unwrap().len();
    place["follows"] = Vec::<u8>::new().into();
    *places = (0..65_535_u32)
        .map(|number| {
            place["percept"] = format!("{number:0width$b}").into();
            place.clone()
        })
        .collect();
    learned.knowledge = serde_json::from_value(json).unwrap();
    let refused = learned.policy().unwrap_err();
    assert_eq!(refused, ExportError::Places(65_535));
    assert!(refused.to_string().contains("plus.doubts"), "{refused}");
}
