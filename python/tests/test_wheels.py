"""The environment whose wheels are driven: the contract of Gymnasium, and the physics of the program."""

import pickle
import warnings

import gymnasium
import numpy as np
import pytest
import xcscr
from gymnasium.utils.env_checker import check_env

CORRIDOR = '{ "rows": ["#####", "#S.G#", "#####"] }'
AHEAD = np.ones(2, np.float32)


def made(**arguments):
    return gymnasium.make("xcscr:xcscr/Wheels-v0", **arguments).unwrapped


def test_check_env_has_no_complaints():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(made(), skip_render_check=True)


def test_full_speed_ahead_reaches_the_goal_of_a_corridor_within_two_seconds():
    env = made(world=CORRIDOR, noise=0, step_reward=-0.01)
    observation, info = env.reset(seed=1, options={"heading": 0.0})
    assert info["goal_distance"] == pytest.approx(2.0)
    assert observation[-3:-1] == pytest.approx([0.0, 1.0], abs=1e-6), "the goal is straight ahead"
    # Ahead 2.5 m to the wall, beside half a cell, in shares of 4 m.
    assert observation[[0, 4, 8, 12]] == pytest.approx([2.5 / 4, 0.5 / 4, 0.5 / 4, 0.5 / 4], abs=1e-4)
    for step in range(1, 41):
        _, reward, terminated, truncated, info = env.step(AHEAD)
        if terminated:
            break
        assert (reward, truncated) == (-0.01, False)
    assert terminated and reward == 1.0 and 20 < step < 40


def test_a_wall_gives_an_impulse_and_an_episode_is_truncated():
    env = made(world=CORRIDOR, noise=0, collision_reward=-1.0, max_steps=30)
    env.reset(seed=1, options={"heading": np.pi})
    steps = [env.step(AHEAD) for _ in range(30)]
    assert any(step[4]["collision_impulse"] > 0 and step[1] == -1.0 for step in steps)
    assert [step[3] for step in steps] == [False] * 29 + [True]


def path(env, **reset):
    env.reset(**reset)
    actions = [np.array([0.5, 0.1 * (step % 10)]) for step in range(40)]
    return np.array([env.step(action)[4]["pose"] for action in actions])


def test_the_same_seed_gives_the_same_path_and_another_one_another():
    env = made()
    assert (path(env, seed=3) == path(env, seed=3)).all()
    assert not (path(env, seed=3) == path(env, seed=4)).all(), "control"


def test_a_pickled_environment_goes_on_as_the_original():
    env = made()
    path(env, seed=5)
    copy = pickle.loads(pickle.dumps(env))
    for _ in range(20):
        one, other = env.step(AHEAD), copy.step(AHEAD)
        assert (one[0] == other[0]).all() and (one[4]["pose"] == other[4]["pose"]).all()


def test_bad_actions_and_options_are_refused():
    env = made()
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(AHEAD)
    env.reset(seed=1)
    with pytest.raises(ValueError, match="two finite numbers"):
        env.step(np.array([np.nan, 0.0]))
    with pytest.raises(ValueError, match="unknown options"):
        env.reset(options={"stat": (1, 1)})
    with pytest.raises(ValueError, match="free cell"):
        env.reset(options={"goal": (0, 0)})
    with pytest.raises(ValueError, match="eight"):
        xcscr.WheelsEnv(world="maze4-classic")
