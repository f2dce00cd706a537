//! The robot that knows only what it senses: it drives where it is told to, notices walls and
//! goals, makes out its surroundings, and does the same again, to the bit.
//!
//! The counts are small; `SENSING_MOVES=100000 cargo test --release --test suite world::sensing` runs the
//! whole claim. Each mechanism has its control: without it the same course goes wrong.

use crate::kit::tally::{Tally, mean, quantile, script, true_cell};
use crate::kit::trial::maze;
use crate::world::worlds::drawn;
use xcscr::agent::Method;
use xcscr::arena::{
    Arena, CautiousDriving, FaultParams, Localisation, PhysicsArena, PhysicsParams,
};
use xcscr::episode::Mistakes;
use xcscr::sensor::Sensor;
use xcscr::trial::{Evaluation, Plan, Trial};
use xcscr::world::{Cell, Recipe};
use xcscr::xcs::Action;

pub const MAZES: [&str; 3] = ["maze4", "maze5", "maze6"];

/// A robot that senses, at a noise level.
fn senses(noise: f64) -> PhysicsParams {
    PhysicsParams {
        noise,
        localisation: Localisation::Estimated,
        ..PhysicsParams::default()
    }
}

fn arena(world: &str, params: &PhysicsParams, seed: u64) -> PhysicsArena {
    PhysicsArena::new(maze(world), params.clone(), seed).unwrap()
}

/// Random moves in a world that ships.
fn drive_at_random(world: &str, params: &PhysicsParams, seed: u64, moves: usize) -> Tally {
    Tally::of(&mut arena(world, params, seed), seed, moves)
}

/// So many moves, unless the environment asks for the whole claim.
pub fn moves(few: usize) -> usize {
    let wanted = std::env::var("SENSING_MOVES").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(few)
}

#[test]
fn a_robot_that_only_senses_goes_where_it_is_told_at_every_noise_level() {
    // Level, error in cm (mean, 99 %), heading in degrees (99 %), wrong percepts as a share. Level
    // 2 may miss by as much as is wanted of level 3.
    let claims = [
        (1.0, [1.0, 3.5], 1.2, 1e-4),
        (2.0, [3.0, 11.0], 4.5, 2e-3),
        (3.0, [3.0, 11.0], 4.5, 1e-2),
    ];
    for world in MAZES {
        for (level, error, heading, percepts) in claims {
            let moves = moves(300);
            let mut tally = drive_at_random(world, &senses(level), 1, moves);
            let error_cm = [mean(&tally.error_cm), quantile(&mut tally.error_cm, 0.99)];
            let heading_deg = quantile(&mut tally.heading_deg, 0.99);
            let nees = mean(&tally.nees);
            let told = format!(
                "{world} at level {level}: {} faults, {} wrong percepts in {moves} moves, error {error_cm:.2?} cm, heading {heading_deg:.2} deg, NEES {nees:.2}",
                tally.faults(),
                tally.wrong_percepts
            );
            assert_eq!(tally.faults(), 0, "{told}: {} lost", tally.lost);
            assert!(error_cm[0] < error[0] && error_cm[1] < error[1], "{told}");
            assert!(heading_deg < heading, "{told}");
            assert!((1.5..3.5).contains(&nees), "{told}");
            // Three of few moves are within what chance makes of the share.
            let allowed = (percepts * f64::from(tally.moves)).max(3.0);
            assert!(f64::from(tally.wrong_percepts) <= allowed, "{told}");
        }
    }
}

/// Wrong cells and lost robots of one course, with something changed.
fn faults(change: impl Fn(&mut PhysicsParams)) -> u32 {
    let mut params = senses(1.0);
    change(&mut params);
    drive_at_random("maze5", &params, 2, 600).faults()
}

/// What of the claims at level 1 does not hold with something changed.
fn broken_claims(change: impl Fn(&mut PhysicsParams)) -> Vec<&'static str> {
    let mut params = senses(1.0);
    change(&mut params);
    let mut tally = drive_at_random("maze5", &params, 1, 600);
    let (faults, nees) = (tally.faults(), mean(&tally.nees));
    let error_cm = quantile(&mut tally.error_cm, 0.99);
    let heading_deg = quantile(&mut tally.heading_deg, 0.99);
    let claims = [
        ("no faults", faults > 0),
        ("position", error_cm > 3.5),
        ("heading", heading_deg > 1.2),
        ("sure as it may be", nees > 3.5),
    ];
    let broken = claims.into_iter().filter(|(_, is_broken)| *is_broken);
    broken.map(|(claim, _)| claim).collect()
}

#[test]
fn control_without_gyro_gate_or_bump_inflation_the_claims_do_not_hold() {
    assert_eq!(broken_claims(|_| {}), [""; 0]);
    let without = [
        broken_claims(|params| params.gyro.fitted = false),
        broken_claims(|params| params.estimator.gate = 10_000.0),
        broken_claims(|params| params.estimator.bump_inflation = false),
    ];
    // Without a gate every beam may end on two lines, and tells nothing.
    for one in &without[..2] {
        let claims = ["no faults", "position", "heading"];
        assert!(
            claims.iter().all(|claim| one.contains(claim)),
            "{without:?}"
        );
    }
    assert!(without[2].contains(&"sure as it may be"), "{without:?}");
}

#[test]
fn control_without_lidar_the_robot_gets_lost() {
    let without = faults(|params| params.lidar.fitted = false);
    let neither = faults(|params| {
        params.lidar.fitted = false;
        params.gyro.fitted = false;
    });
    assert_eq!(faults(|_| {}), 0);
    assert!(without > 3 && neither > without, "{without} {neither}");
}

/// Of ten robots that drive from one end of a corridor of 30 cells to the other, those that get lost. Far
/// from both ends all beams end at its sides, some of them so nearly along these that they tell
/// nothing.
fn lost_in_a_corridor(noise: f64, lidar: bool) -> u32 {
    let (wall, free) = ("#".repeat(32), ".".repeat(28));
    let rows = [wall.clone(), format!("#S{free}G#"), wall];
    let maze = drawn(serde_json::json!({}), &rows);
    let mut params = senses(noise);
    params.lidar.fitted = lidar;
    let is_lost = |seed: &u64| {
        let mut arena = PhysicsArena::new(maze.clone(), params.clone(), *seed).unwrap();
        arena.reset(maze.start().unwrap());
        (0..28).any(|_| {
            arena.act(Action::new(1).unwrap());
            arena.view().sensed.unwrap().mislocalised
        })
    };
    (1..=10).filter(is_lost).count() as u32
}

#[test]
fn in_a_long_corridor_a_robot_that_only_senses_does_not_get_lost() {
    assert_eq!(lost_in_a_corridor(0.0, true), 0);
    let lost = lost_in_a_corridor(1.0, true);
    assert!(lost <= 1, "{lost} of 10");
    let without = lost_in_a_corridor(1.0, false);
    assert!(without >= 3, "control: {without} of 10 without a lidar");
}

/// Random moves where a quarter of the cells has a friction of 0.3.
fn on_wet_floor(when: CautiousDriving) -> Tally {
    let mut params = senses(1.0);
    params.cautious.when = when;
    drive_at_random("maze5-wet", &params, 1, moves(1_000))
}

#[test]
fn on_slippery_floor_the_robot_notices_that_its_wheels_slip_and_with_care_no_move_goes_wrong() {
    let [fast, watchful, careful] = [
        CautiousDriving::Never,
        CautiousDriving::Slipping,
        CautiousDriving::Always,
    ]
    .map(on_wet_floor);
    let all = [&fast, &watchful, &careful];
    let steps = all.map(|tally| tally.steps);
    assert!(steps[0] < steps[1] && steps[1] < steps[2], "{steps:?}");
    let wrong = all.map(|tally| f64::from(tally.wrong) / f64::from(tally.moves));
    assert!(wrong[0] <= 0.006 && wrong[1] <= 0.001, "{wrong:?}");
    assert_eq!(careful.faults(), 0);
    let p99 = all.map(|tally| quantile(&mut tally.error_cm.clone(), 0.99));
    assert!(p99[0] > 5.0, "control: does it slip at all? {p99:?}");
    assert!(p99[1] < p99[0], "{p99:?}");
    // Control: where nothing slips it never slows down, at no noise level.
    for level in [1.0, 3.0] {
        let mut params = senses(level);
        let watchful = drive_at_random("maze5", &params, 1, 300).steps;
        params.cautious.when = CautiousDriving::Never;
        let fast = drive_at_random("maze5", &params, 1, 300).steps;
        assert_eq!(watchful, fast, "level {level}");
    }
}

#[test]
fn on_slippery_floor_the_filter_is_as_sure_as_it_may_be() {
    // With three degrees of freedom an honest filter has 3; its caution makes it less.
    let honest = 1.5..4.0;
    for seed in 1..=3 {
        let nees = mean(&drive_at_random("maze5-wet", &senses(1.0), seed, moves(1_000)).nees);
        assert!(honest.contains(&nees), "seed {seed}: {nees}");
    }
    let mut params = senses(1.0);
    params.estimator.caution = 0.5;
    let control = mean(&drive_at_random("maze5-wet", &params, 1, moves(1_000)).nees);
    assert!(!honest.contains(&control), "control: {control}");
}

#[test]
fn a_gyro_that_drifts_is_followed() {
    let driven = |gyro_walk_radps| {
        let mut params = senses(1.0);
        params.faults.gyro_drift_radps2 = 0.001;
        params.estimator.gyro_walk_radps = gyro_walk_radps;
        let mut robot = arena("maze5", &params, 2);
        // Faults begin with the first episode.
        robot.reset(robot.view().maze.start_cells()[0]);
        let mut tally = Tally::of(&mut robot, 2, moves(1_000));
        (tally.faults(), quantile(&mut tally.heading_deg, 0.99))
    };
    let (faults, heading_deg) = driven(senses(1.0).estimator.gyro_walk_radps);
    assert!(faults == 0 && heading_deg < 1.2, "{faults} {heading_deg}");
    let (_, control) = driven(0.0);
    assert!(control > 3.0 * heading_deg, "control: {control}");
}

/// All faults from the third episode on.
fn breaks() -> PhysicsParams {
    let mut params = senses(1.0);
    params.faults = FaultParams {
        from_episode: 3,
        dead_sector_deg: 90.0,
        stuck_encoder: true,
        gyro_drift_radps2: 0.001,
        dead_bumper: true,
    };
    params
}

/// What is seen of an episode.
fn episode(robot: &mut PhysicsArena, number: u64) -> Vec<String> {
    let start = robot.view().maze.start_cells()[0];
    robot.reset(start);
    let act = |action| {
        robot.act(action);
        shown(robot)
    };
    script(number, 15).map(act).collect()
}

#[test]
fn sensors_break_in_the_episode_that_was_said() {
    let mut sound = arena("maze5", &senses(1.0), 3);
    let mut broken = arena("maze5", &breaks(), 3);
    for number in 1..=4 {
        let is_sound = episode(&mut sound, number) == episode(&mut broken, number);
        assert_eq!(is_sound, number < 3, "episode {number}");
    }
}

#[test]
fn the_sensed_percept_does_not_come_from_the_map() {
    let mut params = senses(1.0);
    params.lidar.fitted = false;
    let mut blind = arena("maze4", &params, 1);
    let start = blind.view().cell;
    blind.reset(start);
    let perceived = Sensor::Lidar.perceive(&blind.view());
    assert_ne!(perceived, Sensor::Lidar.perceive_at(&maze("maze4"), start));
    assert_eq!(perceived.to_string(), "01".repeat(8), "nothing is seen");
}

#[test]
fn a_robot_whose_estimate_lies_in_a_wall_or_outside_is_lost_and_perceives_that_cell() {
    let mut params = senses(1.0);
    params.lidar.fitted = false;
    let (mut robot, mut in_walls) = (arena("maze5", &params, 1), 0);
    for action in script(1, 600) {
        robot.act(action);
        let view = robot.view();
        let sensed = view.sensed.unwrap();
        let at = sensed.estimates.last().unwrap().robot_in_map;
        let at = at.translation.vector;
        let cell = view.maze.cell_at(at.into());
        assert_eq!(
            sensed.mislocalised,
            cell != Some(true_cell(&view)),
            "{cell:?}"
        );
        // The percept has the cell of the estimate, outside of the grid the nearest one.
        let within = |at: f64, size: u16| at.floor().clamp(0.0, f64::from(size) - 1.0) as u16;
        let (width, height) = (view.maze.width(), view.maze.height());
        let nearest = Cell {
            col: within(at.x, width),
            row: height - 1 - within(at.y, height),
        };
        let told = Sensor::LidarPosition.perceive(&view).to_string();
        let position = Sensor::Position.perceive_at(view.maze, nearest);
        assert!(
            told.ends_with(&position.to_string()),
            "{told} at {nearest:?}"
        );
        in_walls += u32::from(view.maze.is_wall(nearest));
    }
    assert!(
        in_walls > 0,
        "control: a lost robot believes to stand in a wall"
    );
}

/// Learned by `xcscr-plus` in a world of 20 x 20 rooms, from what the robot senses.
fn learned_in_rooms(sensor: Sensor) -> Trial {
    let recipe: Recipe = "rooms-20-1".parse().unwrap();
    let plan = Plan::new(recipe.maze().unwrap()).method(Method::XcscrPlus);
    plan.sensor(sensor).episodes(10).run().unwrap()
}

#[test]
fn a_world_of_20_x_20_rooms_is_learned_and_driven_on_sensed_percepts_alone() {
    let mut trial = learned_in_rooms(Sensor::LidarPosition);
    assert!(trial.progress().optimal, "{:?}", trial.progress());
    let driven = Evaluation::after(&mut trial, 3).unwrap();
    assert!(driven.is_optimal(), "54 steps each: {driven:?}");
    let control = learned_in_rooms(Sensor::Lidar);
    assert!(
        !control.progress().optimal,
        "the lidar alone does not tell all cells apart"
    );
}

#[test]
fn mistakes_of_the_senses_are_counted_and_there_are_none_without_noise() {
    let mistakes = |noise, sensor| {
        let mut plan = Plan::new(maze("maze5"))
            .method(Method::QLearning)
            .sensor(sensor);
        plan.config.settings.physics.noise = noise;
        plan.episodes(90).run().unwrap().progress().mistakes
    };
    let noisy = mistakes(5.0, Sensor::Lidar);
    assert!(noisy.observation_error > 0, "{noisy:?}");
    assert_eq!(mistakes(0.0, Sensor::Lidar), Mistakes::default());
    assert_eq!(
        mistakes(5.0, Sensor::Neighbours),
        Mistakes::default(),
        "told where it is"
    );
}

/// Everything that can be seen of the last action, as text.
fn shown(arena: &PhysicsArena) -> String {
    let view = arena.view();
    let sensed = view.sensed.unwrap();
    format!(
        "{:?} {:?} {:?} {:?}",
        view.trace,
        sensed.estimates,
        sensed.beams,
        Sensor::Lidar.perceive(&view)
    )
}
