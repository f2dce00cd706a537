"""Many environments at a time are the single ones, to the bit."""

import gymnasium
import numpy as np
import pytest
import xcscr
from gymnasium.vector import AutoresetMode, SyncVectorEnv

ARENAS = ["grid", "physics"]
# Short episodes, so that all modes reset often.
SHORT = {"sensor": "neighbours", "slip": 0.2, "max_steps": 9, "collision_reward": -0.5}


def arguments(arena):
    return SHORT | {"arena": arena, "world": {"grid": "maze4-classic", "physics": "maze4"}[arena]}


def native(lanes, mode, **more):
    name, kind = "xcscr:xcscr/Maze-v0", "vector_entry_point"
    return gymnasium.make_vec(name, num_envs=lanes, vectorization_mode=kind, autoreset_mode=mode, **more)


def singles(lanes, mode, **more):
    return SyncVectorEnv([lambda: xcscr.MazeEnv(**more)] * lanes, autoreset_mode=mode)


def actions(lanes, steps, count):
    """The same actions for a lane, however many there are."""
    return np.stack([np.random.default_rng(100 + lane).integers(count, size=steps) for lane in range(lanes)], axis=1)


def facts(infos, lane):
    """What infos say of a lane, in one form."""
    known = {}
    for name, values in sorted(infos.items()):
        if name.startswith("_") or not infos.get("_" + name, np.ones(len(values), bool))[lane]:
            continue
        if isinstance(values, dict):
            known[name] = facts(values, lane)
        elif name == "final_obs":
            known[name] = values[lane].tolist()
        elif name == "outcome":
            known[name] = str(values[lane])
        else:
            known[name] = np.asarray(values[lane], float).round(12).tolist()
    return known


def run(env, lanes, steps):
    observations, infos = env.reset(seed=5)
    history = [(observations, None, None, None, infos)]
    for action in actions(lanes, steps, env.single_action_space.n):
        history.append(env.step(action))
    return [[(o[lane].tolist(), *(x if x is None else x[lane] for x in rest), facts(infos, lane)) for o, *rest, infos in history] for lane in range(lanes)]


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("arena", ARENAS)
def test_every_lane_is_the_single_environment_in_both_modes(arena, mode):
    more = arguments(arena)
    ours, theirs = run(native(3, mode, **more), 3, 40), run(singles(3, mode, **more), 3, 40)
    for lane, (one, other) in enumerate(zip(ours, theirs)):
        for step, (a, b) in enumerate(zip(one, other)):
            assert repr(a) == repr(b), f"lane {lane}, step {step}"
    assert ours[0] != ours[1], "control: lanes differ"


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("arena", ARENAS)
def test_a_lane_does_not_depend_on_how_many_others_there_are(arena, mode):
    runs = [run(native(lanes, mode, **arguments(arena)), lanes, 30) for lanes in (1, 8, 64)]
    assert repr(runs[0][0]) == repr(runs[1][0]) == repr(runs[2][0])
    assert repr(runs[1]) == repr(runs[2][:8])


def test_without_autoreset_lanes_that_are_over_must_be_reset_by_a_mask():
    env = native(2, AutoresetMode.DISABLED, world='{ "rows": ["#####", "#S.G#", "#####"] }', arena="grid")
    assert env.metadata["autoreset_mode"] is AutoresetMode.DISABLED
    env.reset(seed=1)
    env.step(np.array([1, 0]))
    _, rewards, over, _, infos = env.step(np.array([1, 0]))
    assert over.tolist() == [True, False] and rewards.tolist() == [1.0, 0.0]
    assert infos["outcome"].tolist() == ["reached-goal", "collided"] and infos["shortest_distance"].tolist() == [0, 2]
    with pytest.raises(gymnasium.error.ResetNeeded, match="environments \\[0\\]"):
        env.step(np.array([0, 0]))
    _, infos = env.reset(options={"reset_mask": np.array([True, False])})
    assert infos["cell"].tolist() == [[1, 1], [1, 1]] and infos["_cell"].tolist() == [True, False]
    _, _, over, _, _ = env.step(np.array([1, 1]))
    assert not over.any()


def test_the_step_limit_of_make_vec_only_shortens_episodes():
    for limit, last in ((3, 3), (60, 50)):
        env = gymnasium.make_vec("xcscr/Maze4-v0", num_envs=1, arena="grid", max_episode_steps=limit)
        env.reset(seed=1)
        truncated = [bool(env.step(np.array([0]))[3][0]) for _ in range(last)]
        assert truncated.index(True) == last - 1, limit
    with pytest.raises(ValueError, match="`max_episode_steps` is 0"):
        gymnasium.make_vec("xcscr/Maze4-v0", num_envs=1, max_episode_steps=0)


def test_options_of_reset_hold_for_all_lanes_and_mistakes_are_said():
    env = native(3, AutoresetMode.NEXT_STEP, world="maze4", arena="grid")
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(3, int))
    _, infos = env.reset(seed=[3, None, 5], options={"start": (2, 1), "goal": (3, 4)})
    assert infos["cell"].tolist() == [[2, 1]] * 3 and len(set(infos["shortest_distance"].tolist())) == 1
    for wrong in [np.array([0, 0]), np.array([0, 4, 0]), np.array([-1, 0, 0])]:
        with pytest.raises(ValueError, match="3 whole numbers from 0 to 3"):
            env.step(wrong)
    for options, words in [({"seat": 1}, "unknown options"), ({"start": (0, 0)}, "not a free cell"), ({"reset_mask": [True]}, "3 entries")]:
        with pytest.raises(ValueError, match=words):
            env.reset(options=options)
    with pytest.raises(ValueError, match="`num_envs` is 0, but must be from 1"):
        xcscr.MazeVectorEnv(num_envs=0)


def test_spaces_hold_what_comes_out():
    env = native(4, AutoresetMode.NEXT_STEP, arena="grid", world="maze5")
    observations, _ = env.reset(seed=2)
    assert env.observation_space.contains(observations)
    assert env.action_space.sample().shape == (4,)
