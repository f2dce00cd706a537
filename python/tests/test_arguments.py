"""Every number from Python is checked: a wrong one is refused by ValueError with the value, whatever its type."""

import math
from fractions import Fraction
from pathlib import Path

import gymnasium
import numpy as np
import pytest
import xcscr

WORLD = '{ "rows": ["#####", "#S.G#", "#####"] }'
#: Values that are not whole numbers from 0 to a small limit.
NO_COUNTS = [-1, 2**40, 2**64, 10**400, 1.5, 2.0, math.nan, math.inf, "1", b"1", None, [1], (1,), object(), np.float64(1), np.array([1, 2]), 1j]
#: Values that are not finite numbers of moderate size.
NO_NUMBERS = [math.nan, math.inf, -math.inf, 1e300, 10**400, "1", b"1", None, [1.0], object(), np.array([1.0, 2.0]), 1j]


def refused(call, *words):
    with pytest.raises(ValueError) as caught:
        call()
    message = str(caught.value)
    assert all(word in message for word in words) and len(message) < 1000, message
    assert "--" not in message and "TOML" not in message, message


class Own:
    """An agent that returns what a test says."""

    answers = {}

    def __init__(self, n_actions, n_bits, seed):
        pass

    def values(self, percept):
        return self.answers.get("values", [0.0] * 4)

    def learn(self, *step):
        pass

    def end_episode(self, reached_goal):
        pass


def grid(**more):
    return xcscr.MazeEnv(world=WORLD, arena="grid", **more)


def many(**more):
    return xcscr.MazeVectorEnv(**{"num_envs": 2, "world": WORLD, "arena": "grid"} | more)


def begun(env, **reset):
    env.reset(seed=1, **reset)
    return env


def study(**more):
    return xcscr.study(**{"worlds": ["maze4"], "methods": ["q-learning"], "trials": 1, "episodes": 1} | more)


def xcs(**more):
    return xcscr.XCS(**{"n_actions": 2, "n_bits": 2} | more)


def classifier(**more):
    pytest.importorskip("sklearn")
    return xcscr.XCSClassifier(**{"iterations": 10} | more).fit([[0.0], [1.0]], [0, 1])


class Constant(gymnasium.Env):
    """An environment that always gives the same reward."""

    observation_space, action_space = gymnasium.spaces.MultiBinary(2), gymnasium.spaces.Discrete(2)

    def __init__(self, reward):
        self.reward = reward

    def reset(self, **given):
        return np.zeros(2, np.int8), {}

    def step(self, action):
        return np.zeros(2, np.int8), self.reward, False, False, {}


#: For each argument that counts: a call with a value, and the values of `NO_COUNTS` that it may have.
LARGE, OMITTED = [2**40], [None]
COUNTS = {
    "action": (lambda value: begun(grid()).step(value), []),
    "seed": (lambda value: grid().reset(seed=value), LARGE + OMITTED),
    "start": (lambda value: grid().reset(options={"start": (value, 1)}), []),
    "goal": (lambda value: grid().reset(options={"goal": (1, value)}), []),
    "max_steps": (lambda value: grid(max_steps=value), LARGE + OMITTED),
    "actions": (lambda value: begun(many()).step([value, value]), []),
    "num_envs": (lambda value: many(num_envs=value), []),
    "seed of several": (lambda value: many().reset(seed=[value, value]), LARGE + OMITTED),
    "beams": (lambda value: xcscr.WheelsEnv(beams=value), []),
    "episodes": (lambda value: xcscr.train("maze4", "q-learning", arena="grid", episodes=value), []),
    "trials": (lambda value: study(trials=value), []),
    "jobs": (lambda value: study(jobs=value), []),
    "n_bits": (lambda value: xcs(n_bits=value), []),
    "n_features": (lambda value: xcscr.XCS(2, n_features=value), []),
    "n_actions": (lambda value: xcs(n_actions=value), []),
    "population_size": (lambda value: xcs(population_size=value), []),
    "theta_ga": (lambda value: xcs(theta_ga=value), []),
    "steps": (lambda value: xcs().fit(Constant(1.0), steps=value), LARGE),
    "trials of a table": (lambda value: xcs().fit_table([[0, 1]], [1], trials=value), LARGE),
    "action of a table": (lambda value: xcs().fit_table([[0, 1]] * 2, [value, value], trials=1), NO_COUNTS[11:13]),
    "iterations": (lambda value: classifier(iterations=value), LARGE),
}


@pytest.mark.parametrize("name", COUNTS)
def test_a_value_that_is_no_count_is_refused_with_the_value(name):
    call, allowed = COUNTS[name]
    for value in NO_COUNTS:
        if not any(value is each or type(value) is int and value == each for each in allowed):
            refused(lambda: call(value))


#: For each argument that is a number: a call with a value, and the values of `NO_NUMBERS` that it may have.
NUMBERS = {
    "goal_reward": (lambda value: grid(goal_reward=value), []),
    "step_reward": (lambda value: many(step_reward=value), []),
    "collision_reward": (lambda value: xcscr.WheelsEnv(collision_reward=value), []),
    "noise": (lambda value: xcscr.MazeEnv(noise=value), OMITTED),
    "slip": (lambda value: grid(slip=value), []),
    "range_m": (lambda value: xcscr.WheelsEnv(range_m=value), []),
    "heading": (lambda value: xcscr.WheelsEnv().reset(options={"heading": value}), OMITTED),
    "action of the wheels": (lambda value: begun(xcscr.WheelsEnv()).step([0.0, value]), [NO_NUMBERS[3]]),
    "setting": (lambda value: grid(settings={"arena.slip": value}), []),
    "setting of a study": (lambda value: study(settings={"tabular.alpha": value}), []),
    "gamma": (lambda value: xcs(gamma=value), []),
    "beta": (lambda value: xcs(beta=value), []),
    "reward": (lambda value: (learner := xcs(), learner.act([0, 1]), learner.update(value)), []),
    "reward of an environment": (lambda value: xcs().fit(Constant(value), steps=3), []),
    "low": (lambda value: xcscr.XCS(2, n_features=1, low=value), NO_NUMBERS[8:9]),
}


@pytest.mark.parametrize("name", NUMBERS)
def test_a_value_that_is_no_finite_number_is_refused_with_the_value(name):
    call, allowed = NUMBERS[name]
    for value in NO_NUMBERS:
        if not any(value is each for each in allowed):
            refused(lambda: call(value))


def test_messages_name_the_argument_and_the_value():
    refused(lambda: begun(grid()).step(-1), "`action` is -1", "from 0 to 3")
    refused(lambda: begun(grid()).step(1.9), "`action` is 1.9", "whole number")
    refused(lambda: grid().reset(options={"start": (1.5, 1)}), "`start` is (1.5, 1)", "(column, row)")
    refused(lambda: grid().reset(options={"start": (-1, 1)}), "(-1, 1)", "not a free cell")
    refused(lambda: many(num_envs=2**40), "`num_envs` is 1099511627776")
    refused(lambda: study(arena=["grid"]), "`arena` is ['grid']")
    refused(lambda: study(settings={"xcs": {"beta": 0.1}}), "'xcs'", '"xcs.<name>"')
    refused(lambda: study(methods="q-learning"), "`methods` is 'q-learning'", "a list")
    refused(lambda: study(worlds="maze4"), "`worlds` is 'maze4'", "a list")
    refused(lambda: study(sensor="positon"), "did you mean `position`")
    refused(lambda: study(methods=["q-learning", lambda **given: None]), "<lambda>", "a pair of a name and a function")
    refused(lambda: xcs(update_order="last"), "'last'", "error-first")
    refused(lambda: xcs(ga=1), "`ga` is 1", "True or False")


@pytest.mark.parametrize("answer", [math.nan, math.inf, "high", object(), 10**400, [1.0]])
def test_an_agent_that_returns_another_value_than_a_finite_number_is_refused(answer):
    class Wrong(Own):
        answers = {"values": [0.0, 0.0, answer, 0.0]}

    refused(lambda: study(methods=["q-learning", Wrong]), "`values` returned [0.0, 0.0, ", "a finite number, or `None`")


@pytest.mark.parametrize("answer", [-1, 4, 2**70, 1.0, "1", None, math.nan])
def test_an_agent_that_chooses_no_action_is_refused(answer):
    class Wrong(Own):
        def choose(self, percept):
            return answer

    refused(lambda: study(methods=["q-learning", Wrong]), f"`choose` returned {answer!r}", "from 0 to 3")


def test_numbers_of_numpy_and_paths_are_accepted_everywhere(tmp_path):
    world, robot = tmp_path / "world.json", tmp_path / "robot.toml"
    world.write_text(WORLD)
    robot.write_text("[settings]\n")
    small, one = np.int8(2), np.uint64(1)
    env = xcscr.MazeEnv(world=world, arena="grid", max_steps=small, goal_reward=np.float32(2.0), slip=Fraction(0))
    env.reset(seed=one, options={"start": np.array([1, 1]), "goal": (np.int64(3), one)})
    assert env.step(one)[1] == 0.0 and env.step(np.array(1))[1] == 2.0
    vector = many(world=world, num_envs=small)
    vector.reset(seed=np.int64(5), options={"start": np.array([1, 1])})
    vector.reset(seed=np.array([1, 2]))
    vector.step(np.array([1, 1], np.uint8))
    xcscr.WheelsEnv(world=world, robot="default", beams=small, range_m=small).reset(seed=one, options={"heading": small})
    xcscr.train(world, "q-learning", arena="grid", episodes=small, seed=one, settings={"tabular.alpha": np.float32(0.5)})
    result = study(worlds=[world], trials=small, episodes=small, seed=one, jobs=small, out=tmp_path / "study", settings={"tabular.alpha": np.float64(0.5)})
    assert len(result.trials()) == 2 and result.folder == tmp_path / "study"
    learner = xcs(n_actions=small, n_bits=small, seed=one, theta_ga=np.int64(30), beta=np.float32(0.1), ga=np.bool_(True))
    learner.fit(Constant(np.float32(1.0)), steps=small, episodes=one, seed=one)
    learner.fit_table([[0, 1]], np.array([1], np.uint8), trials=small, seed=one)
    with xcscr.Record(gymnasium.make("xcscr/Maze-v0", world=world, arena="grid"), tmp_path / "recorded") as env:
        env.reset(seed=1)
        env.step(small)
    assert xcscr.verify_recording(tmp_path / "recorded" / "run.mcap") is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"arena": "grid", "noise": 2.0}, "`noise` has no effect"),
        ({"arena": "grid", "robot": "turtlebot3-burger"}, "`robot` has no effect"),
        ({"arena": "grid", "settings": {"physics.noise": 2.0}}, "`physics.noise` has no effect"),
        ({"settings": {"reward.goal": 5}}, "`reward.goal` in `settings` has no effect"),
        ({"settings": {"xcs.beta": 0.1}}, "`xcs.beta` in `settings` has no effect"),
        ({"max_steps": 0}, "`max_steps` is 0"),
        ({"max_steps": "5"}, "`max_steps` is '5'"),
        ({"goal_reward": "a"}, "`goal_reward` is 'a'"),
    ],
)
def test_arguments_of_make_without_effect_are_refused(arguments, words):
    refused(lambda: gymnasium.make("xcscr/Maze-v0", **arguments), words)
    refused(lambda: xcscr.MazeVectorEnv(**arguments), words)


def test_a_study_or_a_recording_in_the_way_is_explained_without_options_of_the_command_line(tmp_path):
    study(out=tmp_path / "study")
    refused(lambda: study(out=tmp_path / "study", episodes=2), "contains another study", "`out`")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    refused(lambda: study(out=tmp_path / "mine"), "`out`")
    refused(lambda: xcscr.Record(grid(), tmp_path / "mine"), "mine")
    eight = '{ "moves": 8, "rows": ["#####", "#S.G#", "#####"] }'
    refused(lambda: xcscr.MazeEnv(world=eight), 'arena="grid"')
    assert isinstance(Path(study(out=Path(tmp_path / "study")).folder), Path), "control"
