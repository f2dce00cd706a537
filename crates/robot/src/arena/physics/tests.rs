use super::*;
use crate::streams::StreamName;
use xcs::random::Stream;

/// Returns a maze with many corners; `settings` are further keys of its world file.
fn maze(settings: &str) -> Maze {
    let rows = [
        "#######", "#S..#.#", "#.#...#", "#...#.#", "#.#..G#", "#######",
    ];
    let text = format!(r#"{{ "name": "corners", {settings} "rows": {rows:?} }}"#);
    Maze::from_json(text.as_bytes(), "corners.json").unwrap()
}

fn arena(settings: &str, params: &PhysicsParams, seed: u64) -> Result<PhysicsArena, PhysicsError> {
    PhysicsArena::new(maze(settings), params.clone(), seed)
}

/// Noise and short timeouts bring the robot into corners, where the order of contacts matters.
#[test]
fn a_reset_arena_continues_like_a_new_one_with_the_same_clock_and_noise() {
    for (level, time_out_s) in [(1.0, 10.0), (3.0, 10.0), (5.0, 0.5)] {
        let params = PhysicsParams {
            noise: level,
            time_out_s,
            ..PhysicsParams::default()
        };
        let mut used = arena("", &params, 1).unwrap();
        let mut actions = Stream::new(1, StreamName::Exploration);
        for episode in 0..50 {
            let start = used.robot.maze().start_cells()[0];
            used.reset(start);
            let mut fresh = arena("", &params, 2).unwrap();
            fresh.robot.steps = used.robot.steps;
            fresh.robot.noise.stream = used.robot.noise.stream.clone();
            for _ in 0..25 {
                let action = Action::new(actions.below(4)).unwrap();
                let outcomes = (used.act(action), fresh.act(action));
                assert_eq!(outcomes.0, outcomes.1, "noise {level}, episode {episode}");
                assert_eq!(
                    used.view().trace,
                    fresh.view().trace,
                    "noise {level}, episode {episode}"
                );
                assert_eq!(used.view().contacts, fresh.view().contacts);
            }
        }
    }
}

#[test]
fn sensing_draws_from_streams_of_its_own() {
    let wheels = |dropouts| {
        let mut params = PhysicsParams {
            localisation: Localisation::Estimated,
            position_noise_m: 0.0,
            heading_noise_rad: 0.0,
            ..PhysicsParams::default()
        };
        params.lidar.dropouts = dropouts;
        let mut robot = arena("", &params, 1).unwrap();
        for action in [1, 1, 2].map(|action| Action::new(action).unwrap()) {
            robot.act(action);
        }
        (robot.robot.steps, robot.robot.noise.stream)
    };
    let ((steps, usual), (other_steps, other)) = (wheels(0.0), wheels(0.2));
    assert_eq!(
        steps, other_steps,
        "choose other actions: the courses differ"
    );
    assert_eq!(usual, other);
}

#[test]
fn a_world_that_cannot_be_simulated_is_refused_with_a_hint() {
    for settings in [r#""moves": 8,"#, r#""wrap": true,"#] {
        let error = arena(settings, &PhysicsParams::default(), 1).map(|_| ());
        let message = error.unwrap_err().to_string();
        assert!(
            message.contains("`corners`") && message.contains("--arena grid"),
            "{message}"
        );
    }
}

#[test]
fn a_setting_out_of_range_is_refused() {
    let params = PhysicsParams {
        noise: -1.0,
        ..PhysicsParams::default()
    };
    let error = arena("", &params, 1).map(|_| ()).unwrap_err();
    assert!(matches!(error, PhysicsError::Setting(_)), "{error}");
}

#[test]
fn an_action_that_the_world_does_not_have_does_not_move_the_robot() {
    let mut arena = arena("", &PhysicsParams::default(), 1).unwrap();
    let action = Action::new(4).unwrap();
    assert_eq!(arena.act(action), Outcome::Stalled);
    assert_eq!(arena.view().trace.len(), 1);
}

#[test]
fn an_arena_can_be_handed_to_another_thread() {
    fn needs_send(_: impl Send) {}
    needs_send(arena("", &PhysicsParams::default(), 1));
}
