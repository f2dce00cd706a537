"""Environments, learners and recordings in threads and in other processes."""

import multiprocessing
import os
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import gymnasium
import numpy as np
import pytest
import xcscr
from gymnasium.vector import AsyncVectorEnv

ACTIONS = [1, 2, 2, 1, 0, 3]


def drive(env, action=lambda env, number: np.int64(number)):
    env.reset(seed=3)
    return repr([[str(part) for part in env.step(action(env, number))] for number in ACTIONS])


def wheels(env, number):
    return np.array([number / 4, 0.5])


@pytest.mark.parametrize(("name", "action"), [("xcscr/Maze4-v0", None), ("xcscr/Wheels-v0", wheels)])
def test_an_environment_goes_on_in_another_thread_than_its_own(name, action):
    arguments = [action] if action else []
    here = drive(gymnasium.make(name), *arguments)
    env = gymnasium.make(name)
    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(drive, env, *arguments).result() == here
        # Its last owner may also be another thread.
        dropped = [gymnasium.make(name)]
        pool.submit(dropped.clear).result()


def test_a_recording_goes_on_in_another_thread_than_its_own(tmp_path):
    with ThreadPoolExecutor(1) as pool:
        env = xcscr.Record(gymnasium.make("xcscr/Maze4-v0"), tmp_path / "recorded")
        pool.submit(drive, env).result()
        env.close()
    assert xcscr.verify_recording(tmp_path / "recorded" / "run.mcap") is None


class Idle:
    """An agent that knows nothing."""

    def __init__(self, n_actions, n_bits, seed):
        self.values_of_all = [0.0] * n_actions

    def values(self, percept):
        return self.values_of_all

    def learn(self, *step):
        pass

    def end_episode(self, reached_goal):
        pass


LONG = {
    "train": lambda: xcscr.train("maze6", "xcscr", arena="grid", episodes=300),
    "study": lambda: xcscr.study(["maze6"], ["xcscr"], trials=1, episodes=300, jobs=1),
    "episodes of a study": lambda: xcscr.study(["maze6"], ["xcscr"], trials=1, episodes=150, jobs=1).episodes(),
    "batch": lambda: _steps(xcscr.MazeVectorEnv(num_envs=512), 20),
    "table": lambda: xcscr.XCS(2, n_bits=20).fit_table(np.eye(20, dtype=int), np.arange(20) % 2, trials=20_000),
}


def _steps(env, steps):
    env.reset(seed=1)
    for _ in range(steps):
        env.step(np.ones(env.num_envs, int))


@pytest.mark.parametrize("name", LONG)
def test_other_threads_run_during_a_long_call(name):
    counted, done = [], threading.Event()

    def count():
        while not done.is_set():
            counted.append(time.perf_counter())
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    begin = time.perf_counter()
    try:
        LONG[name]()
    finally:
        end = time.perf_counter()
        done.set()
        counter.join()
    during = [begin, *(at for at in counted if begin < at < end), end]
    longest = max(later - sooner for sooner, later in zip(during, during[1:]))
    assert end - begin > 0.02, "control: the call is long"
    assert longest < 0.8 * (end - begin), f"nothing else ran for {longest:.3f} of {end - begin:.3f} s"


def in_a_fork(act):
    """Returns what `act` returns in a fork of this process, or its exception as text."""
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe()

    def run():
        try:
            theirs.send(act())
        except Exception as error:
            theirs.send(f"{type(error).__name__}: {error}")

    child = context.Process(target=run)
    child.start()
    answered = ours.poll(60)
    answer = ours.recv() if answered else "it hangs"
    child.terminate()
    child.join()
    return answer


needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")


@needs_fork
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_fork_makes_environments_of_its_own_and_is_refused_those_of_its_parent(tmp_path):
    vector = xcscr.MazeVectorEnv(num_envs=4)
    _steps(vector, 3)
    result = xcscr.study(["maze4"], ["q-learning"], trials=2, episodes=5)
    recorded = xcscr.Record(gymnasium.make("xcscr/Maze4-v0"), tmp_path / "recorded")
    drive(recorded)
    assert in_a_fork(lambda: _steps(xcscr.MazeVectorEnv(num_envs=4), 3)) is None
    assert in_a_fork(lambda: drive(gymnasium.make("xcscr/Maze4-v0"))) == drive(gymnasium.make("xcscr/Maze4-v0"))
    assert in_a_fork(lambda: len(result.episodes())) == 10
    assert in_a_fork(lambda: len(xcscr.study(["maze4"], ["q-learning"], trials=2, episodes=5).trials())) == 2
    assert "make one in each process" in in_a_fork(lambda: _steps(vector, 3))
    assert "make one in each process" in in_a_fork(lambda: drive(recorded))
    # The parent goes on.
    _steps(vector, 3)
    recorded.close()
    assert xcscr.verify_recording(tmp_path / "recorded" / "run.mcap") is None


@pytest.mark.parametrize("context", ["fork", "spawn", "forkserver"])
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_an_id_with_its_module_works_in_new_processes(context):
    if context not in multiprocessing.get_all_start_methods():
        pytest.skip("no such start method here")
    name = "xcscr:xcscr/Maze4-v0"
    env = AsyncVectorEnv([lambda: gymnasium.make(name)] * 2, context=context)
    try:
        env.reset(seed=3)
        rewards = [env.step([number, number])[1].tolist() for number in ACTIONS]
    finally:
        env.close()
    alone = gymnasium.make(name)
    alone.reset(seed=3)
    assert [row[0] for row in rewards] == [alone.step(number)[1] for number in ACTIONS]
