"""Measures the CPU time of a step of our environments and of others, in one process.

pip install ./python minigrid gymnasium-robotics mujoco ir-sim
python assets/results/python-learners/steps.py      # writes steps.json and prints the table

All agents act at random. The time is that of the whole process, with all its threads, divided by the number of steps of
all environments. Environments take turns; the median of the rounds counts.
"""

import argparse
import json
import os
import statistics
import tempfile
import time
from pathlib import Path

import gymnasium
import numpy

ROUNDS = 5
LANES = 64
BUILDS = {}


def build(name):
    """Adds a function that returns (step, environments): `step()` steps all environments once."""

    def add(function):
        BUILDS[name] = function
        return function

    return add


def single(env):
    rng = numpy.random.default_rng(1)
    is_discrete = isinstance(env.action_space, gymnasium.spaces.Discrete)
    env.reset(seed=1)

    def step():
        action = rng.integers(env.action_space.n) if is_discrete else rng.uniform(-1, 1, env.action_space.shape)
        *_, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()

    return step, 1


def many(**arguments):
    import xcscr  # noqa: F401

    env = gymnasium.make_vec("xcscr/Maze4-v0", num_envs=LANES, vectorization_mode="vector_entry_point", **arguments)
    rng = numpy.random.default_rng(1)
    env.reset(seed=1)
    return lambda: env.step(rng.integers(0, 4, LANES)), LANES


def ours(name, **arguments):
    import xcscr  # noqa: F401

    return single(gymnasium.make(name, disable_env_checker=True, **arguments))


build("xcscr, grid, 1")(lambda: ours("xcscr/Maze4-v0", arena="grid"))
build(f"xcscr, grid, {LANES}")(lambda: many(arena="grid"))
build("xcscr, physics, 1")(lambda: ours("xcscr/Maze4-v0", arena="physics", sensor="neighbours"))
build(f"xcscr, physics, {LANES}")(lambda: many(arena="physics", sensor="neighbours"))
build("xcscr, physics with lidar, 1")(lambda: ours("xcscr/Maze4-v0", arena="physics", sensor="lidar"))
build(f"xcscr, physics with lidar, {LANES}")(lambda: many(arena="physics", sensor="lidar"))
build("xcscr, wheels with 16 beams, 1")(lambda: ours("xcscr/Wheels-v0"))


@build("Minigrid FourRooms, 1")
def minigrid():
    import minigrid  # noqa: F401

    return single(gymnasium.make("MiniGrid-FourRooms-v0", disable_env_checker=True))


@build("PointMaze_Medium, 1")
def point_maze():
    import gymnasium_robotics

    gymnasium.register_envs(gymnasium_robotics)
    return single(gymnasium.make("PointMaze_Medium-v3", disable_env_checker=True))


@build("ir-sim with 16 beams, 1")
def ir_sim():
    import irsim

    lidar = {"name": "lidar2d", "range_min": 0, "range_max": 4, "angle_range": 6.28, "number": 16, "noise": False}
    walls = [[[0, y], [8, y]] for y in (0, 8)] + [[[x, 0], [x, 8]] for x in (0, 8)]
    robot = {"kinematics": {"name": "diff"}, "shape": {"name": "circle", "radius": 0.2}, "state": [1.5, 1.5, 0]}
    world = {
        "world": {"height": 8, "width": 8, "step_time": 0.05, "control_mode": "manual", "collision_mode": "stop"},
        "robot": [robot | {"goal": [6.5, 6.5, 0], "sensors": [lidar]}],
        "obstacle": [{"shape": {"name": "linestring", "vertices": wall}, "state": [0, 0, 0]} for wall in walls],
    }
    file = Path(tempfile.mkdtemp()) / "world.yaml"
    file.write_text(json.dumps(world))
    env = irsim.make(str(file), display=False, disable_all_plot=True)
    rng = numpy.random.default_rng(1)

    def step():
        env.step(rng.uniform(-0.3, 0.3, (2, 1)))
        env.get_lidar_scan()

    return step, 1


def microseconds(step, environments, seconds):
    """Returns the CPU time of a step of one environment, measured for about this time."""
    steps, begin = 0, time.process_time()
    while (spent := time.process_time() - begin) < seconds or steps < 20:
        for _ in range(10):
            step()
        steps += 10 * environments
    return spent / steps * 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=1.0, help="CPU seconds of each measurement")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("steps.json"))
    given = parser.parse_args()
    built = {name: make() for name, make in BUILDS.items()}
    for step, _ in built.values():
        step()
    found = {name: [] for name in built}
    for _ in range(ROUNDS):
        for name, (step, environments) in built.items():
            found[name].append(microseconds(step, environments, given.seconds))
    rows = [
        {"environment": name, "us": round(statistics.median(us), 2), "least": round(min(us), 2), "greatest": round(max(us), 2)}
        for name, us in found.items()
    ]
    given.out.write_text(json.dumps({"cores": os.cpu_count(), "rounds": ROUNDS, "rows": rows}, indent=1) + "\n")
    print("| environment, number of robots | us per step and robot | least | greatest |\n|---|---|---|---|")
    for row in rows:
        print(f"| {row['environment']} | {row['us']:.2f} | {row['least']:.2f} | {row['greatest']:.2f} |")


if __name__ == "__main__":
    main()
