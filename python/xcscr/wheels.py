"""A Gymnasium environment with direct control of the robot's wheels."""

from __future__ import annotations

import json
import os
from typing import Any, SupportsFloat

import gymnasium
import numpy as np
from gymnasium import spaces

from . import checks
from ._native import Robot, Wheels
from .choice import environment, rewards, with_goal

#: The maximum number of distance readings.
MOST_BEAMS = 4096


class WheelsEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """A differential-drive robot with direct control of the wheels, 20 times a second.

    ## Description
    The robot of `xcscr/Maze-v0` in physics, without its controller: rapier2d simulates body, wheels, floor and walls. The robot has to
    reach a goal.

    ## Action Space
    `Box(-1, 1, (2,))`: the commanded speeds of the left and right wheel, as a share of the maximum speed of the robot. The motors respond
    with lag and limited acceleration.

    ## Observation Space
    `Box((beams + 3,))`: the distances to the nearest wall in `beams` evenly spaced directions, counter-clockwise from straight ahead, as a
    share of `range_m`. Then the sine and the cosine of the bearing of the nearest goal, and its straight-line distance as a
    share of the diagonal of the world. These readings have no noise.

    ## Rewards
    `goal_reward` (1) at a goal, `step_reward` (0) otherwise, and `collision_reward` (0) in addition while the robot hits a wall.

    ## Starting State
    At rest in the middle of the start cell of the world, or of a random free cell, with a random heading. `reset(options={"start":
    (column, row), "heading": radians, "goal": (column, row)})` chooses them. A goal stays in effect until another one is set. `"goal": None`
    restores the goals of the world.

    ## Episode Termination
    The episode terminates when the middle of the robot is in a goal cell. It is truncated after `max_steps` steps (1,200, or one
    minute).

    ## Arguments
    - `world`, `robot`, `noise`, `settings`: as in `xcscr/Maze-v0`
    - `beams`, `range_m`: number and range of the distance readings

    `info` has `pose` (x and y in metres, heading in radians, in the map frame), `goal_distance` (metres) and `collision_impulse`
    (newton-seconds).
    """

    metadata = {"render_modes": [], "render_fps": 20}

    def __init__(
        self,
        world: str | os.PathLike[str] = "maze4",
        robot: str | os.PathLike[str] | None = None,
        noise: float | None = None,
        settings: dict[str, Any] | None = None,
        beams: int = 16,
        range_m: float = 4.0,
        goal_reward: float = 1.0,
        step_reward: float = 0.0,
        collision_reward: float = 0.0,
        max_steps: int = 1200,
    ) -> None:
        self._beams = beams = checks.whole("beams", beams, 1, MOST_BEAMS)
        self._range_m = checks.real("range_m", range_m, 0.001, 1000.0)
        self._given = self._choice = environment(world, "physics", "neighbours", robot, noise, 0, settings)
        self._rewards = rewards(goal_reward, step_reward, collision_reward)
        self._max_steps = checks.whole("max_steps", max_steps, 1)
        self._history: tuple[int, tuple[int, int], float, list[tuple[float, float]]] | None = None
        self.render_mode = None
        self._build()
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        low = np.r_[np.zeros(beams), -1.0, -1.0, 0.0].astype(np.float32)
        self.observation_space = spaces.Box(low, np.ones(beams + 3, np.float32), dtype=np.float32)

    def _build(self) -> None:
        self._wheels = Wheels(self._choice)
        self._maze = Robot(self._choice)
        world = json.loads(self._maze.world_json)
        self._diagonal_m = float(np.hypot(*self._maze.size)) * float(world.get("cell_size_m", 1.0))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=None if seed is None else checks.whole("seed", seed))
        options = dict(options or {})
        unknown = options.keys() - {"start", "heading", "goal"}
        if unknown:
            raise ValueError(f"unknown options {sorted(unknown)}: only `start`, `heading` and `goal` are known")
        if "goal" in options:
            self._choice = with_goal(self._given, options["goal"])
            self._build()
        noise = int(self.np_random.integers(2**63))
        start, heading = options.get("start"), options.get("heading")
        if start is not None:
            start = checks.cell("start", start)
        else:
            cells = self._maze.start_cells
            start = cells[int(self.np_random.integers(len(cells)))]
        if heading is None:
            heading = self.np_random.uniform(-np.pi, np.pi)
        self._history = (noise, start, checks.real("heading", heading), [])
        self._replay()
        return self._observation(), self._info(0.0)

    def _replay(self) -> None:
        """Replays the episode up to the current step."""
        assert self._history is not None
        noise, start, heading, speeds = self._history
        self._wheels.reseed(noise)
        self._wheels.reset(start, heading)
        for left, right in speeds:
            self._wheels.step(left, right)

    def step(self, action: np.ndarray) -> tuple[np.ndarray, SupportsFloat, bool, bool, dict[str, Any]]:
        if self._history is None:
            raise gymnasium.error.ResetNeeded("call reset before step")
        given = checks.numbers(action)
        if given is None or given.shape != (2,) or not np.isfinite(given).all():
            raise ValueError(f"`action` is {checks.shown(action)}, but must be two finite numbers")
        left, right = (np.clip(given.astype(np.float64), -1.0, 1.0) * self._wheels.max_speed).tolist()
        arrived, impulse = self._wheels.step(left, right)
        self._history[3].append((left, right))
        goal, each, collision = self._rewards
        reward = (goal if arrived else each) + (collision if impulse > 0 else 0.0)
        truncated = not arrived and len(self._history[3]) >= self._max_steps
        return self._observation(), float(reward), arrived, truncated, self._info(impulse)

    def _observation(self) -> np.ndarray:
        ranges = np.array(self._wheels.ranges(self._beams, self._range_m)) / self._range_m
        distance, bearing = self._wheels.goal
        goal = [np.sin(bearing), np.cos(bearing), min(distance / self._diagonal_m, 1.0)]
        readings: np.ndarray = np.r_[ranges, goal].astype(np.float32)
        return readings

    def _info(self, impulse: float) -> dict[str, Any]:
        wheels = self._wheels
        return {"pose": np.array(wheels.pose), "goal_distance": wheels.goal[0], "collision_impulse": impulse}

    def __getstate__(self) -> dict[str, Any]:
        """Returns the state without the native parts, which are rebuilt by replaying the speeds of the episode."""
        state = self.__dict__.copy()
        del state["_wheels"], state["_maze"]
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._build()
        if self._history is not None:
            self._replay()
