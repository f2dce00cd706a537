#!/usr/bin/env python3
"""Times xcscr and its peers on the same work, in turn, and prints the ratios.

    python3 -m venv venv && venv/bin/pip install xcsf==1.5.0 Box2D pymunk gymnasium-robotics
    benches/peers/build          # the peers that are driven from C and C++
    cargo bench --no-run
    venv/bin/python benches/peers.py [xcs] [physics]

All times are CPU time of the process that does the work, and every program does its work in a
process of its own. Peers that are not installed are left out.
"""

import glob
import importlib.util
import json
import math
import os
import random
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
BUILT = TARGET / "peers"
ROUNDS = 5


# --- The classic Maze4 work of learning classifier systems -------------------------------------

def rows(world):
    return json.loads((ROOT / f"worlds/{world}.json").read_text())["rows"]


MAZE4 = rows("maze4-classic")
CLOCKWISE = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)]
SENSORS = {"#": 0.1, ".": 0.3, "G": 0.7}
STEP_LIMIT = 50


def xcsf_learner(population, seed, subsumption=False, error=0.001, dont_care=0.4):
    import xcsf

    return xcsf.XCS(
        x_dim=8, y_dim=1, n_actions=8, random_state=seed, omp_num_threads=1,
        pop_size=population, pop_init=False, max_trials=1, loss_func="mae",
        e0=error, alpha=0.1, nu=5, beta=0.2, delta=0.1, theta_del=20, init_fitness=0.01,
        init_error=0, m_probation=10_000_000, stateful=True, compaction=False,
        theta_sub=20, set_subsumption=subsumption, gamma=0.71, teletransportation=STEP_LIMIT, p_explore=1.0,
        ea={"select_type": "roulette", "theta_ea": 25, "lambda": 2, "p_crossover": 0.8,
            "err_reduc": 0.25, "fit_reduc": 0.1, "subsumption": subsumption, "pred_reset": False},
        condition={"type": "ternary", "args": {"bits": 2, "p_dontcare": dont_care}},
        prediction={"type": "constant"}, action={"type": "integer"},
    )  # fmt: skip


def xcsf_episode(learner, maze, percepts, free, explore):
    """One episode; gives back its steps."""
    col, row = random.choice(free)
    learner.init_trial()
    error = 0.0
    for step in range(1, STEP_LIMIT + 1):
        learner.init_step()
        action = learner.decision(percepts[col, row], explore)
        to = (col + CLOCKWISE[action][0], row + CLOCKWISE[action][1])
        letter = maze[to[1]][to[0]]
        if letter != "#":
            col, row = to
        done = letter == "G"
        reward = 1.0 if done else 0.0
        learner.update(reward, done)
        error += learner.error(reward, done, 1.0)
        learner.end_step()
        if done:
            break
    learner.end_trial()
    return step


def xcsf_work(population, seed, problems, world="maze4-classic", **settings):
    """What benches/classic.rs does, by the package xcsf."""
    import numpy

    random.seed(seed)
    maze = rows(world)
    cells = [(c, r) for r, row in enumerate(maze) for c, x in enumerate(row) if x != "#"]
    free = [(c, r) for c, r in cells if maze[r][c] == "."]
    look = lambda c, r: numpy.array([SENSORS[maze[r + y][c + x]] for x, y in CLOCKWISE])
    percepts = {cell: look(*cell) for cell in cells}
    learner = xcsf_learner(population, seed, **settings)
    total, exploits = 0, []
    begin = time.process_time()
    for _ in range(problems):
        total += xcsf_episode(learner, maze, percepts, free, True)
        exploits.append(xcsf_episode(learner, maze, percepts, free, False))
        total += exploits[-1]
    rate = total / (time.process_time() - begin)
    return {"rate": rate, "steps": total, "rules": learner.pset_size(),
            "exploits": statistics.mean(exploits[-100:])}  # fmt: skip


def newest(name):
    """The newest build of a bench."""
    found = glob.glob(str(TARGET / f"release/deps/{name}-*"))
    programs = [path for path in found if os.access(path, os.X_OK) and os.path.isfile(path)]
    if not programs:
        sys.exit(f"no bench `{name}`: run `cargo bench --no-run` first")
    return max(programs, key=os.path.getmtime)


def cpu_of(command):
    """The CPU time of a command, start-up and all, and its output."""
    before = os.times()
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    after = os.times()
    used = after.children_user + after.children_system
    return used - before.children_user - before.children_system, out


def xcscr_work(population, seed, problems):
    command = [newest("classic"), str(population), str(seed), str(problems)]
    # Repeated, because the clock of child processes is coarse.
    runs = [cpu_of(command) for _ in range(5)]
    report = json.loads(runs[0][1])
    rate = report["learning_steps"] * len(runs) / sum(cpu for cpu, _ in runs)
    return {"rate": rate, "steps": report["learning_steps"], "rules": report["rules"],
            "exploits": report["exploit_steps_in_last_100"]}  # fmt: skip


def in_own_process(work, *arguments):
    command = [sys.executable, __file__, "--work", work, *map(str, arguments)]
    return json.loads(cpu_of(command)[1])


def compare_xcs(problems=1000):
    for population in (800, 2000):
        rates = {"xcscr": []}
        for seed in range(1, ROUNDS + 1):
            found = {"xcscr": xcscr_work(population, seed, problems)}
            if importlib.util.find_spec("xcsf"):
                found["xcsf"] = in_own_process("xcsf", population, seed, problems)
            print(f"  N {population} seed {seed}: {found}", flush=True)
            for name, work in found.items():
                rates.setdefault(name, []).append(work["rate"])
        print(f"N {population}: learning steps per CPU second, seeds 1 to {ROUNDS}")
        for name, own in rates.items():
            print(f"  {name}: {statistics.median(own):.0f}, xcscr is {spread(rates['xcscr'], own)} "
                  "times as fast", flush=True)  # fmt: skip


def spread(above, below):
    """The median of ratios, and their range."""
    ratios = [a / b for a, b in zip(above, below)]
    return f"{statistics.median(ratios):.3g} [{min(ratios):.3g}-{max(ratios):.3g}]"


# --- The physics step: one disc that drives against a wall of Maze4 at 20 Hz ---------------------

DT, RADIUS, MASS, SPEED = 0.05, 0.3, 5.0, 1.4


def wall_cells():
    rows = MAZE4
    return [(c + 0.5, len(rows) - r - 0.5)
            for r, row in enumerate(rows) for c, x in enumerate(row) if x == "#"]  # fmt: skip


def box2d_work(pushing, steps):
    import Box2D

    world = Box2D.b2World(gravity=(0, 0))
    for x, y in wall_cells():
        world.CreateStaticBody(position=(x, y)).CreatePolygonFixture(box=(0.5, 0.5))
    robot = world.CreateDynamicBody(position=(3.5, 3.5))
    robot.CreateCircleFixture(radius=RADIUS, density=MASS / (math.pi * RADIUS**2), friction=0.3)
    begin = time.process_time()
    for step in range(steps):
        drive = SPEED if pushing or step // 20 % 2 == 0 else -SPEED
        impulse = MASS * (drive - robot.linearVelocity[0])
        robot.ApplyLinearImpulse((max(-2.0, min(2.0, impulse)), 0), robot.worldCenter, True)
        world.Step(DT, 4, 2)
    return {"microseconds": (time.process_time() - begin) / steps * 1e6}


def pymunk_work(pushing, steps):
    import pymunk

    space = pymunk.Space()
    for x, y in wall_cells():
        box = pymunk.Poly(space.static_body, [(x - 0.5, y - 0.5), (x + 0.5, y - 0.5),
                                              (x + 0.5, y + 0.5), (x - 0.5, y + 0.5)])  # fmt: skip
        space.add(box)
    robot = pymunk.Body(MASS, pymunk.moment_for_circle(MASS, 0, RADIUS))
    robot.position = (3.5, 3.5)
    space.add(robot, pymunk.Circle(robot, RADIUS))
    begin = time.process_time()
    for step in range(steps):
        drive = SPEED if pushing or step // 20 % 2 == 0 else -SPEED
        impulse = MASS * (drive - robot.velocity[0])
        robot.apply_impulse_at_world_point((max(-2.0, min(2.0, impulse)), 0), robot.position)
        space.step(DT)
    return {"microseconds": (time.process_time() - begin) / steps * 1e6}


def pointmaze_work(steps):
    """CPU seconds per simulated second of a ball in a maze of MuJoCo, driven at random."""
    import gymnasium
    import gymnasium_robotics

    gymnasium.register_envs(gymnasium_robotics)
    maze = gymnasium.make("PointMaze_UMaze-v3")
    maze.reset(seed=1)
    maze.action_space.seed(1)
    actions = [maze.action_space.sample() for _ in range(steps)]
    simulated = steps * maze.unwrapped.point_env.dt
    begin = time.process_time()
    for action in actions:
        *_, terminated, truncated, _ = maze.step(action)
        if terminated or truncated:
            maze.reset()
    return {"load": (time.process_time() - begin) / simulated}


def compare_pointmaze(steps=10_000, moves=40_000):
    if not importlib.util.find_spec("gymnasium_robotics"):
        return
    ratios, loads = [], []
    for _ in range(ROUNDS):
        cpu, out = cpu_of([newest("drive"), "0", "1", str(moves)])
        ours = cpu / (json.loads(out)["physics_steps"] * DT)
        peer = in_own_process("pointmaze", steps)["load"]
        loads.append((ours * 1e6, peer * 1e6))
        ratios.append(peer / ours)
    ours, peer = (round(statistics.median(load), 1) for load in zip(*loads))
    print(f"free, per simulated second: xcscr {ours} us, PointMaze {peer} us, "
          f"ratio {statistics.median(ratios):.0f} [{min(ratios):.0f}-{max(ratios):.0f}]")  # fmt: skip


NATIVE = {"Box2D from C++": "box2d", "Chipmunk from C": "chipmunk", "MuJoCo from C": "mujoco"}


def native_work(program, pushing, steps):
    out = subprocess.run([BUILT / program, str(pushing), str(steps)], check=True,
                         capture_output=True, text=True).stdout  # fmt: skip
    return json.loads(out.splitlines()[-1])


def physics_round(pushing, steps):
    """Microseconds of CPU per physics step, once for each program."""
    found = {}
    for shortcut, name in ((0, "xcscr, every step in the engine"), (1, "xcscr, shortcut")):
        command = [newest("drive"), str(pushing), str(shortcut), str(steps // 25)]
        cpu, out = cpu_of(command)
        found[name] = cpu / json.loads(out)["physics_steps"] * 1e6
    for name, program in NATIVE.items():
        if (BUILT / program).exists():
            found[name] = native_work(program, pushing, 4 * steps)["microseconds"]
    for peer in ("Box2D", "pymunk"):
        if importlib.util.find_spec(peer):
            work = in_own_process(peer.lower(), pushing, steps)
            found[f"{peer} from Python"] = work["microseconds"]
    return found


def compare_physics(steps=100_000):
    for pushing in (0, 1):
        rounds = [physics_round(pushing, steps) for _ in range(ROUNDS)]
        ours = [found["xcscr, every step in the engine"] for found in rounds]
        print(f"{'pushing' if pushing else 'free'}: microseconds of CPU per physics step, and how "
              f"many of them a step of ours takes in the engine ({ROUNDS} rounds)")  # fmt: skip
        for name in rounds[0]:
            own = [found[name] for found in rounds]
            print(f"  {name}: {statistics.median(own):.2f}, {spread(ours, own)}", flush=True)


WORK = {"xcsf": xcsf_work, "box2d": box2d_work, "pymunk": pymunk_work,
        "pointmaze": pointmaze_work}  # fmt: skip


def main(arguments):
    if arguments[:1] == ["--work"]:
        print(json.dumps(WORK[arguments[1]](*map(int, arguments[2:]))))
        return
    if not arguments or "xcs" in arguments:
        compare_xcs()
    if not arguments or "physics" in arguments:
        compare_physics()
        compare_pointmaze()


if __name__ == "__main__":
    main(sys.argv[1:])
