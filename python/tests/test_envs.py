"""The environments keep Gymnasium's contract, and are those of the program."""

import pickle
import warnings

import gymnasium
import numpy as np
import pytest
import xcscr
from gymnasium.utils.env_checker import check_env

EAST = 1


def made(**arguments):
    return gymnasium.make("xcscr:xcscr/Maze-v0", **arguments)


@pytest.mark.parametrize("arguments", [{"arena": "grid"}, {"arena": "physics"}, {"world": "maze4-classic", "arena": "grid", "slip": 0.25}])
def test_check_env_has_no_complaints(arguments):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Wrappers of `make` warn about themselves.
        check_env(made(**arguments).unwrapped, skip_render_check=True)


def test_every_bundled_world_is_registered():
    names = {"maze4": "xcscr/Maze4-v0", "maze5-wet": "xcscr/Maze5Wet-v0", "woods101demi": "xcscr/Woods101demi-v0"}
    for world, name in names.items():
        assert gymnasium.make(name, arena="grid").unwrapped._robot.world == world
    registered = [name for name in gymnasium.registry if name.startswith("xcscr/")]
    assert len(registered) == len(xcscr.bundled_worlds()) + 2, "also Maze-v0 and Wheels-v0"


def drive(env, actions, **reset):
    steps = [env.reset(**reset)]
    steps += [env.step(np.int64(action)) for action in actions]
    return steps


def same(one, other):
    return repr([str(step) for step in one]) == repr([str(step) for step in other])


@pytest.mark.parametrize("arena", ["grid", "physics"])
def test_the_same_seed_gives_the_same_episodes_and_another_one_others(arena):
    actions = [1, 2, 2, 1, 0, 3, 2, 1] * 3
    world = {"grid": "maze4-classic", "physics": "maze4"}[arena]
    env = made(world=world, arena=arena, sensor="neighbours", slip=0.2)
    first, again, other = (drive(env, actions, seed=seed) for seed in (7, 7, 8))
    assert same(first, again)
    assert not same(first, other), "control"


def test_an_episode_ends_at_the_goal_or_is_truncated_and_rewards_are_those_of_the_arguments():
    world = '{ "rows": ["#####", "#S.G#", "#####"] }'
    env = made(world=world, arena="grid", step_reward=-0.1, collision_reward=-2.0, max_steps=2)
    steps = drive(env, [0, EAST], seed=1)
    assert [step[1:4] for step in steps[1:]] == [(-2.1, False, False), (-0.1, False, True)]
    assert steps[1][4]["outcome"] == "collided" and steps[1][4]["shortest_distance"] == 2
    steps = drive(env, [EAST, EAST], seed=1)
    assert steps[2][1:4] == (1.0, True, False)


def test_the_start_can_be_chosen_and_poses_are_in_metres_of_the_map():
    world = '{ "rows": ["#####", "#...#", "#..G#", "#####"], "origin": [10.0, 20.0, 0.0], "cell_size_m": 0.5 }'
    env = made(world=world, arena="grid")
    _, info = env.reset(seed=3, options={"start": (2, 1)})
    assert info["cell"] == (2, 1)
    assert np.allclose(info["pose"][:2], [10.0 + 2.5 * 0.5, 20.0 + 2.5 * 0.5])
    with pytest.raises(ValueError, match="not a free cell"):
        env.reset(options={"start": (0, 0)})


def test_the_goal_can_be_chosen_and_holds_until_it_is_taken_back():
    env = made(world="maze4", arena="grid")
    _, info = env.reset(seed=1, options={"goal": (2, 1)})
    assert info["shortest_distance"] == 1
    assert env.step(np.int64(EAST))[1:3] == (1.0, True)
    assert env.reset()[1]["shortest_distance"] == 1
    assert env.reset(options={"goal": None})[1]["shortest_distance"] == 10
    with pytest.raises(ValueError, match="not a free cell"):
        env.reset(options={"goal": (0, 0)})


@pytest.mark.parametrize("arena", ["grid", "physics"])
def test_a_pickled_environment_goes_on_as_the_original(arena):
    env = made(arena=arena, sensor="neighbours", slip=0.3).unwrapped
    drive(env, [1, 2, 2], seed=5)
    copy = pickle.loads(pickle.dumps(env))
    assert same([env.step(1), env.step(2)], [copy.step(1), copy.step(2)])
    assert same([env.reset()], [copy.reset()])


def test_pictures_show_the_robot():
    env = made(arena="grid", render_mode="ansi")
    env.reset(seed=1)
    rows = env.render().split("\n")
    assert rows[1][1] == "R" and len(rows) == 8 and rows[6][6] == "G"
    env = made(arena="grid", render_mode="rgb_array")
    env.reset(seed=1)
    assert env.render().shape == (256, 256, 3)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"world": "maze77"}, "did you mean"),
        ({"arena": "moon"}, "unknown arena"),
        ({"sensor": "sonar"}, "unknown sensor"),
        ({"arena": "grid", "slip": 2.0}, "`slip` is 2.0"),
        ({"settings": {"beta": 0.1}}, "^settings: .*xcs.beta"),
        ({"robot": "nothere"}, "nothere"),
    ],
)
def test_bad_arguments_raise_the_messages_of_the_program(arguments, words):
    with pytest.raises(ValueError, match=words):
        xcscr.MazeEnv(**arguments)


@pytest.mark.parametrize("name", ["xcscr/Maze4-v0", "xcscr/Wheels-v0"])
def test_no_collision_has_an_impulse_of_plus_zero(name):
    env = gymnasium.make(name)
    env.reset(seed=1)
    action = EAST if name == "xcscr/Maze4-v0" else np.zeros(2, np.float32)
    impulses = [env.step(action)[4]["collision_impulse"] for _ in range(3)]
    assert 0.0 in impulses and "-0.0" not in map(str, impulses)
