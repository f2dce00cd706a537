//! `evaluate --robustness` as its users call it.

use crate::kit::chance::rounds;
use crate::kit::desk::Desk;
use crate::kit::flat::Flat;
use serde_json::Value;

/// A run in Maze4 by a robot that senses.
const SENSING: &str = "maze4 --record none --episodes 60";

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
    let desk = Desk::new();
    desk.train("run", SENSING);
    let episodes = rounds([4, 40, 40]);
    let sweep = &format!("evaluate @run --robustness --episodes {episodes}");
    let as_json = format!("{sweep} --json");
    let table = desk.json(&as_json);
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
    assert_eq!(table, desk.json(&as_json), "the same each time");
    let text = desk.ok(sweep);
    let widest = text.lines().map(|line| line.chars().count()).max();
    assert!(widest <= Some(80), "{text}");
    assert_eq!(text.lines().count(), found.len() + 5, "{text}");
}

/// The policy is by position, for an empty hall, and was learned on the grid: a robot that is
/// mislocalised there goes mislocalised.
#[test]
fn worse_conditions_have_worse_results() {
    let desk = Desk::new();
    let inner = 12;
    let mut rows = vec![format!("#{}#", ".".repeat(inner)); inner + 2];
    rows[0] = "#".repeat(inner + 2);
    rows[inner + 1] = rows[0].clone();
    rows[1].replace_range(1..2, "S");
    rows[inner].replace_range(inner..=inner, "G");
    desk.write("hall.json", serde_json::json!({ "rows": rows }).to_string());
    desk.ok(
        "train @hall.json --arena grid --sensor position --method q-learning \
             --episodes 300 --record none --out @run",
    );
    let table = desk.json(
        "evaluate @run --robustness --json --episodes 20 --arena physics \
         --set physics.localisation=estimated",
    );
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
    let desk = Desk::new();
    desk.train("run", &format!("{SENSING} --set physics.noise=2"));
    let plain = "evaluate @run --episodes 15 --seed 9 --json";
    let evaluation = desk.json(plain);
    let table = desk.json(&format!("{plain} --robustness"));
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
    let desk = Desk::new();
    desk.train("run", &format!("{SENSING} --arena grid"));
    let episodes = rounds([1, 5, 5]);
    let sweep = &format!("evaluate @run --robustness --episodes {episodes}");
    let on_grid = desk.json(&format!("{sweep} --json"));
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
    let text = desk.ok(sweep);
    let words = "Left out, because the grid has no wheels";
    assert!(text.contains(words), "{text}");
    // Driven by the true pose, the robot has noise and slippery floors, but no sensors.
    let told = desk.json(&format!("{sweep} --json --arena physics"));
    let left_out = told["left_out"].as_array().unwrap();
    assert_eq!(left_out.len(), 4, "{told}");
    let reasons = left_out.iter().map(|one| &one["reason"]);
    let true_pose = "the robot has access to its true pose";
    assert!(reasons.into_iter().all(|why| why == true_pose), "{told}");
    assert_eq!(names(&told["conditions"]).len(), 13);
    // A lidar that is not there cannot have a dead sector.
    let blind = "--arena physics --sensor lidar --json --set physics.lidar.fitted=false";
    let blind = desk.json(&format!("{sweep} {blind}"));
    assert_eq!(names(&blind["left_out"]), ["dead sector 90 deg"]);
}

#[test]
fn in_a_world_from_a_map_a_box_stands_on_the_route() {
    let desk = Desk::new();
    let maze = Flat::new().gridded(0.5).maze;
    desk.write("flat.json", maze.to_json());
    desk.ok("train @flat.json --robot turtlebot3-burger --record none --episodes 40 --out @run");
    let episodes = rounds([2, 10, 10]);
    let line = format!("evaluate @run --robustness --json --episodes {episodes}");
    let table = desk.json(&line);
    assert_eq!(names(&table["conditions"]).len(), 18, "{table}");
    let found = number(&table, "one box on the route", "successes");
    assert!(found >= 0.9 * episodes as f64, "{table}");
}
