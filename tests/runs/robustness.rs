//! `evaluate --robustness` as its users call it.

use std::path::Path;

use crate::kit::program::expect;
use serde_json::Value;

/// Trains without recordings.
#[track_caller]
fn train_in(world: &str, folder: &Path, more: &[&str]) -> String {
    let run = folder.join("run").to_str().unwrap().to_owned();
    let train = ["train", world, "--record", "none", "--out", &run];
    expect(0, &[&train[..], more].concat());
    run
}

/// Trains in Maze4 without recordings.
#[track_caller]
fn train(folder: &Path, more: &[&str]) -> String {
    train_in("worlds/maze4.json", folder, more)
}

/// A policy by position for an empty hall, learned on the grid: a robot that is mislocalised there
/// goes mislocalised.
#[track_caller]
fn train_for_a_hall(folder: &Path) -> String {
    let inner = 12;
    let mut rows = vec![format!("#{}#", ".".repeat(inner)); inner];
    rows[0].replace_range(1..2, "S");
    rows[inner - 1].replace_range(inner..=inner, "G");
    let border = "#".repeat(inner + 2);
    rows.insert(0, border.clone());
    rows.push(border);
    let world = folder.join("hall.json");
    let text = serde_json::json!({ "rows": rows }).to_string();
    std::fs::write(&world, text).unwrap();
    let how = "--arena grid --sensor position --method q-learning --episodes 300";
    let how: Vec<&str> = how.split(' ').collect();
    train_in(world.to_str().unwrap(), folder, &how)
}

#[track_caller]
fn json(args: &[&str]) -> Value {
    serde_json::from_str(&expect(0, args).0).unwrap()
}

fn names(conditions: &Value) -> Vec<&str> {
    let conditions = conditions.as_array().unwrap().iter();
    conditions
        .map(|row| row["condition"].as_str().unwrap())
        .collect()
}

fn row<'a>(table: &'a Value, condition: &str) -> &'a Value {
    let rows = table["conditions"].as_array().unwrap();
    let found = rows.iter().find(|row| row["condition"] == condition);
    found.unwrap_or_else(|| panic!("no {condition} in {table}"))
}

fn number(table: &Value, condition: &str, field: &str) -> f64 {
    row(table, condition)[field].as_f64().unwrap()
}

#[test]
fn a_robot_that_senses_is_driven_under_every_condition_from_the_same_seed() {
    let folder = tempfile::tempdir().unwrap();
    let run = train(folder.path(), &["--episodes", "60"]);
    let sweep = ["evaluate", &run, "--robustness", "--episodes", "40"];
    let as_json = [&sweep[..], &["--json"]].concat();
    let table = json(&as_json);
    assert_eq!(table["left_out"].as_array().unwrap().len(), 0, "{table}");
    let found = names(&table["conditions"]);
    for wanted in [
        "unchanged",
        "noise 0",
        "noise 5",
        "slip 0.25",
        "flips 0.05",
        "floor friction 0.3",
        "dead sector 90 deg",
        "stuck encoder",
        "gyro drift 0.001 rad/s2",
        "dead bumper",
    ] {
        assert!(found.contains(&wanted), "{wanted} in {found:?}");
    }
    // The bytes are the same each time.
    assert_eq!(expect(0, &as_json), expect(0, &as_json));
    let (text, _) = expect(0, &sweep);
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
    assert_eq!(text.lines().count(), found.len() + 5, "{text}");
}

#[test]
fn worse_conditions_have_worse_results() {
    let folder = tempfile::tempdir().unwrap();
    let run = train_for_a_hall(folder.path());
    let how = "--robustness --json --episodes 20 --arena physics";
    let how: Vec<&str> = how.split(' ').collect();
    let sensing = ["--set", "physics.localisation=estimated"];
    let table = json(&[&["evaluate", &run][..], &how, &sensing].concat());
    let success = |condition| number(&table, condition, "successes");
    assert_eq!(success("noise 0"), 20.0, "{table}");
    assert!(success("noise 5") < 20.0, "{table}");
    let lost = |condition| number(&table, condition, "mislocalised_episodes");
    assert_eq!([lost("noise 0"), lost("unchanged")], [0.0; 2], "{table}");
    assert!(lost("noise 5") > 10.0, "{table}");
    // The run's own noise is 1, so that two rows are the same drives.
    let figures = |condition| {
        let mut figures = row(&table, condition).clone();
        figures["condition"] = Value::Null;
        figures
    };
    assert_eq!(figures("unchanged"), figures("noise 1"));
    assert_ne!(figures("unchanged"), figures("noise 3"), "control");
    for worse in ["slip 0.25", "flips 0.05"] {
        let steps = |condition| number(&table, condition, "mean_steps");
        assert!(steps(worse) > steps("unchanged"), "{worse} in {table}");
    }
}

#[test]
fn the_unchanged_row_is_a_plain_evaluation_with_the_same_seed() {
    let folder = tempfile::tempdir().unwrap();
    let noisy = ["--episodes", "60", "--set", "physics.noise=2"];
    let run = train(folder.path(), &noisy);
    let plain = [
        "evaluate",
        &run,
        "--episodes",
        "15",
        "--seed",
        "9",
        "--json",
    ];
    let evaluation = json(&plain);
    let table = json(&[&plain[..], &["--robustness"]].concat());
    assert_eq!(table["seed"], 9);
    let base = row(&table, "unchanged");
    for field in ["episodes", "successes", "mean_steps"] {
        assert_eq!(base[field], evaluation[field], "{field} of {base}");
    }
    let collisions = evaluation["collisions"].as_f64().unwrap() / 15.0;
    assert_eq!(base["collisions_per_episode"], collisions, "{base}");
    assert_eq!(base["success"]["value"], 1.0, "{base}");
    // Wilson's lower limit of 15 of 15.
    let low = base["success"]["low"].as_f64().unwrap();
    assert!((low - 15.0 / (15.0 + 1.959_964_f64.powi(2))).abs() < 1e-6);
}

#[test]
fn conditions_that_cannot_apply_are_named_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let grid = ["--arena", "grid", "--episodes", "60"];
    let run = train(folder.path(), &grid);
    let sweep = ["evaluate", &run, "--robustness", "--episodes", "5"];
    let on_grid = json(&[&sweep[..], &["--json"]].concat());
    let applied = [
        "unchanged",
        "slip 0.1",
        "slip 0.25",
        "flips 0.01",
        "flips 0.05",
    ];
    assert_eq!(names(&on_grid["conditions"]), applied);
    assert_eq!(on_grid["left_out"].as_array().unwrap().len(), 12);
    assert!(row(&on_grid, "unchanged")["mislocalised_episodes"].is_null());
    let (text, _) = expect(0, &sweep);
    assert!(
        text.contains("Left out, because the grid has no wheels"),
        "{text}"
    );
    // Driven by the true pose, the robot has noise and slippery floors, but no sensors.
    let told = json(&[&sweep[..], &["--json", "--arena", "physics"]].concat());
    let left_out = told["left_out"].as_array().unwrap();
    assert_eq!(left_out.len(), 4, "{told}");
    assert!(
        left_out
            .iter()
            .all(|l| l["reason"] == "the robot has access to its true pose")
    );
    assert_eq!(names(&told["conditions"]).len(), 13);
    // A lidar that is not there cannot have a dead sector.
    let blind = "--arena physics --sensor lidar --json --set physics.lidar.fitted=false";
    let blind: Vec<&str> = blind.split(' ').collect();
    let blind = json(&[&sweep[..], &blind].concat());
    assert_eq!(names(&blind["left_out"]), ["dead sector 90 deg"]);
}

#[test]
fn robustness_is_refused_with_what_belongs_to_one_evaluation() {
    for other in ["--record", "--require-optimal"] {
        let (_, stderr) = expect(2, &["evaluate", "run", "--robustness", other]);
        assert!(stderr.contains("--robustness"), "{stderr}");
    }
}
