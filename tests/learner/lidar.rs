//! A learner with a memory that senses: a lidar shows neither goals nor hidden corners.

use crate::kit::trial::{maze, on_a_map};
use xcscr::agent::{Knowledge, Method, MotionPrior};
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{Bounds, GreedySteps, Plan, Trial};
use xcscr::world::{Maze, Recipe};

/// A trial that is over, on the percept `lidar`.
fn finished(world: &str, method: Method, arena: ArenaKind, episodes: u32, flips: f64) -> Trial {
    let maze = match world.parse::<Recipe>() {
        Ok(recipe) => recipe.maze().unwrap(),
        Err(_) => maze(world),
    };
    let plan = on_a_map(Plan::new(maze).method(method).arena(arena));
    let mut plan = plan.sensor(Sensor::Lidar).episodes(episodes);
    plan.config.settings.sensor.flip_probability = flips;
    plan.config.settings.physics.noise = 3.0;
    plan.run().unwrap()
}

/// Does it believe that all episodes begin in one place?
fn knows_its_start(trial: &Trial) -> bool {
    match trial.method().knowledge() {
        Knowledge::Remembering { map, .. } => map.begin.is_some(),
        _ => false,
    }
}

fn greedy(trial: &Trial) -> f64 {
    GreedySteps::of(trial.plan(), &trial.method().knowledge()).mean
}

#[test]
fn a_robot_that_only_senses_is_optimal_once_it_has_a_map() {
    for world in ["maze4", "maze5", "maze6"] {
        let trial = finished(world, Method::XcscrPlus, ArenaKind::Physics, 4, 0.0);
        assert!(trial.progress().optimal, "{world}: {:?}", trial.progress());
        assert!(trial.method().rule_count() <= 25, "{world}");
        let without = finished(world, Method::QLearning, ArenaKind::Physics, 4, 0.0);
        assert!(!without.progress().optimal, "control: {world}");
    }
}

#[test]
fn where_places_look_alike_to_a_lidar_rules_with_a_memory_reach_the_belief_bound() {
    for world in ["classic/woods101", "classic/maze10", "classic/mazef4"] {
        let trial = finished(world, Method::XcscrPlus, ArenaKind::Grid, 60, 0.0);
        let bound = Bounds::of_belief(&trial.plan().maze, Sensor::Lidar).unwrap();
        let steps = greedy(&trial);
        assert!(
            steps <= 1.02 * bound,
            "{world}: {steps} steps, bound {bound}"
        );
        let without = finished(world, Method::QLearning, ArenaKind::Grid, 60, 0.0);
        let steps = greedy(&without);
        assert!(steps > 2.0 * bound, "control: {world}: {steps} steps");
    }
}

#[test]
fn flipped_bits_of_a_lidar_open_no_ghost_places() {
    let trial = finished("maze4", Method::XcscrPlus, ArenaKind::Grid, 60, 0.01);
    let Knowledge::Remembering { map, .. } = trial.method().knowledge() else {
        panic!("the method remembers");
    };
    let maze = &trial.plan().maze;
    let cells = maze.free_cells().count() - maze.goals().len();
    assert!(map.states.len() <= cells, "{} places", map.states.len());
    let bound = Bounds::of_belief(maze, Sensor::Lidar).unwrap();
    let steps = greedy(&trial);
    assert!(steps <= 1.1 * bound, "{steps} steps, bound {bound}");
    let without = greedy(&finished(
        "maze4",
        Method::QLearning,
        ArenaKind::Grid,
        60,
        0.01,
    ));
    assert!(without > 2.0 * bound, "control: {without} steps");
}

#[test]
fn who_learns_that_all_episodes_begin_in_one_place_is_optimal_in_rooms_that_look_alike() {
    let finished = |method| finished("rooms-20-1", method, ArenaKind::Grid, 12, 0.0);
    let trial = finished(Method::XcscrPlus);
    assert!(trial.progress().optimal, "{:?}", trial.progress());
    assert!(trial.method().rule_count() <= 50);
    assert!(knows_its_start(&trial));
    assert!(!finished(Method::QLearning).progress().optimal, "control");
}

/// Of a start in a dead end a lidar shows one free cell, and hides the corners.
#[test]
fn who_does_not_know_its_moves_gets_out_of_a_dead_end() {
    let rows = ["######", "#S...#", "###G##", "######"];
    let world = format!(r#"{{"rows": {rows:?}}}"#);
    let maze = Maze::from_json(world.as_bytes(), "dead-end.json").unwrap();
    for seed in 1..=5 {
        let plan = Plan::new(maze.clone()).method(Method::XcscrPlus).seed(seed);
        let mut plan = on_a_map(plan)
            .arena(ArenaKind::Grid)
            .sensor(Sensor::Lidar)
            .episodes(20);
        plan.config.settings.map.motion_model = MotionPrior::Learned;
        let trial = plan.run().unwrap();
        let progress = trial.progress();
        assert!(
            progress.optimal && progress.collisions < 60,
            "seed {seed}: {progress:?}"
        );
    }
}

#[test]
fn who_begins_anywhere_does_not_believe_to_begin_in_one_place() {
    let trial = finished(
        "classic/maze10",
        Method::XcscrPlus,
        ArenaKind::Grid,
        30,
        0.0,
    );
    let rules = trial.method().rule_count();
    assert!(rules > 0 && !knows_its_start(&trial), "{rules} rules");
}

/// How often moves slip, as a robot believes that learned in a corridor of thirty cells, of which all
/// but the ends and those at the goal's niche look alike.
fn slip_believed_in_a_corridor(seed: u64, slip: f64) -> (Trial, f64) {
    let (walls, niche) = (
        "#".repeat(32),
        format!("{}G{}", "#".repeat(8), "#".repeat(23)),
    );
    let corridor = format!("#{}S{}#", ".".repeat(14), ".".repeat(15));
    let json = format!(
        r##"{{"name": "corridor", "cell_size_m": 1.0, "moves": 4, "rows": ["{walls}", "{niche}", "{corridor}", "{walls}"]}}"##
    );
    let plan = Plan::new(Maze::from_json(json.as_bytes(), "corridor.json").unwrap());
    let plan = on_a_map(plan.method(Method::XcscrPlus).arena(ArenaKind::Grid));
    let mut plan = plan.sensor(Sensor::Lidar).episodes(30).seed(seed);
    plan.config.settings.arena.slip = slip;
    let trial = plan.settled().run().unwrap();
    let Knowledge::Remembering { map, .. } = trial.method().knowledge() else {
        panic!("the method remembers");
    };
    (trial, map.pomdp.slip())
}

#[test]
fn in_a_corridor_of_cells_that_look_alike_only_moves_that_slip_are_held_for_slipping() {
    for seed in 1..=4 {
        let (trial, slip) = slip_believed_in_a_corridor(seed, 0.0);
        assert!(slip == 0.0, "seed {seed}: {slip}");
        assert!(
            trial.progress().optimal,
            "seed {seed}: {:?}",
            trial.progress()
        );
        let (_, slip) = slip_believed_in_a_corridor(seed, 0.25);
        assert!((slip - 0.25).abs() < 0.08, "control: seed {seed}: {slip}");
    }
}
