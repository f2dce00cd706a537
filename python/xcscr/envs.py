"""Gymnasium environments."""

from __future__ import annotations

import os
from typing import Any, SupportsFloat

import gymnasium
import numpy as np
from gymnasium import spaces

from . import checks
from ._native import Robot
from .choice import environment, rewards, with_goal

CELL_PX = 32
COLOURS = {
    "wall": (60, 60, 60),
    "free": (245, 245, 245),
    "goal": (90, 180, 90),
    "robot": (230, 120, 20),
}


class MazeEnv(gymnasium.Env[np.ndarray, np.int64]):
    """A differential-drive robot in a maze.

    ## Description
    The robot moves from cell to cell until it reaches a goal. In physics (`arena="physics"`), rapier2d simulates its body,
    wheels and sensors, and an action drives one cell. On the grid (`arena="grid"`) the same moves take no time.

    ## Action Space
    `Discrete(4)` or `Discrete(8)`: the directions, clockwise from north. A move against a wall leaves the robot where it was.

    ## Observation Space
    `MultiBinary(n)`: the percept of `sensor`. `neighbours` has two bits for each of the eight cells around the robot. `lidar` is the same as
    measured by a lidar, without goals. `position`, `neighbours-position` and `lidar-position` add column and row.

    ## Rewards
    `goal_reward` (1) at a goal, `step_reward` (0) otherwise, and `collision_reward` (0) in addition where the robot hits a wall.

    ## Starting State
    The start cell of the world, or a random free cell. `reset(options={"start": (column, row), "goal": (column, row)})` chooses them. A
    goal stays in effect until another one is set. `"goal": None` restores the goals of the world.

    ## Episode Termination
    The episode terminates at a goal. It is truncated after `max_steps` steps (default: the step threshold of the world).

    ## Arguments
    - `world`: a bundled world, a generated one (`"rooms-12-3"`), a world file, or the JSON text of one
    - `arena`: `"grid"` or `"physics"`
    - `sensor`: default `lidar` in physics and `neighbours` on the grid, with the position in mazes of more than 1,024 cells
    - `robot`: a bundled profile or a TOML file; physics only
    - `noise`: factor for all sensor noise; physics only
    - `slip`: the probability that another action is executed
    - `settings`: program settings by their full names

    `info` has `cell`, `pose` (x and y in metres, heading in radians, in the map frame), `collision_impulse` (newton-seconds),
    `shortest_distance` (moves to the goal) and, after a step, `outcome`.
    """

    metadata = {"render_modes": ["rgb_array", "ansi"], "render_fps": 4}

    def __init__(
        self,
        world: str | os.PathLike[str] = "maze4",
        arena: str = "physics",
        sensor: str | None = None,
        robot: str | os.PathLike[str] | None = None,
        noise: float | None = None,
        slip: float = 0.0,
        settings: dict[str, Any] | None = None,
        goal_reward: float = 1.0,
        step_reward: float = 0.0,
        collision_reward: float = 0.0,
        max_steps: int | None = None,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"unknown render_mode {render_mode!r}: choose one of {self.metadata['render_modes']}")
        self._given = self._choice = environment(world, arena, sensor, robot, noise, slip, settings)
        self._rewards = rewards(goal_reward, step_reward, collision_reward)
        limit = None if max_steps is None else checks.whole("max_steps", max_steps, 1)
        self._robot = Robot(self._choice)
        self._max_steps = limit or self._robot.step_threshold
        self._steps = 0
        self._history: tuple[int, tuple[int, int], list[int]] | None = None
        self.render_mode = render_mode
        self.action_space = spaces.Discrete(self._robot.actions)
        self.observation_space = spaces.MultiBinary(self._robot.percept_bits)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=None if seed is None else checks.whole("seed", seed))
        options = dict(options or {})
        unknown = options.keys() - {"start", "goal"}
        if unknown:
            raise ValueError(f"unknown options {sorted(unknown)}: only `start` and `goal` are known")
        if "goal" in options:
            self._choice = with_goal(self._given, options["goal"])
            self._robot = Robot(self._choice)
        start = None if options.get("start") is None else checks.cell("start", options["start"])
        # Each episode has its own noise seed, so that it can be replayed on its own.
        noise = int(self.np_random.integers(2**63))
        if start is None:
            cells = self._robot.start_cells
            start = cells[int(self.np_random.integers(len(cells)))]
        self._begin(noise, start)
        return self._observation(), self._info()

    def _begin(self, noise: int, start: tuple[int, int]) -> None:
        self._robot.reseed(noise)
        self._robot.reset(start)
        self._history = (noise, start, [])
        self._steps = 0

    def step(self, action: np.int64) -> tuple[np.ndarray, SupportsFloat, bool, bool, dict[str, Any]]:
        if self._history is None:
            raise gymnasium.error.ResetNeeded("call reset before step")
        move = checks.whole("action", action, 0, self._robot.actions - 1)
        outcome = self._robot.step(move)
        self._history[2].append(move)
        self._steps += 1
        goal, each, collision = self._rewards
        reward = goal if outcome == "reached-goal" else each
        if outcome == "collided":
            reward += collision
        terminated = outcome == "reached-goal"
        truncated = not terminated and self._steps >= self._max_steps
        info = self._info() | {"outcome": outcome}
        return self._observation(), float(reward), terminated, truncated, info

    def _observation(self) -> np.ndarray:
        return np.frombuffer(self._robot.percept(), dtype=np.int8).copy()

    def _info(self) -> dict[str, Any]:
        robot, cell = self._robot, self._robot.cell
        return {
            "cell": cell,
            "pose": np.array(robot.pose),
            "collision_impulse": robot.collision_impulse,
            "shortest_distance": robot.shortest_distance(cell),
        }

    def render(self) -> Any:
        if self.render_mode == "ansi":
            return self._ansi()
        if self.render_mode == "rgb_array":
            return self._rgb()
        gymnasium.logger.warn("call render with `render_mode` set to one of the modes of `metadata`")
        return None

    def _ansi(self) -> str:
        goals, cell = set(self._robot.goals), self._robot.cell

        def glyph(cell_at: tuple[int, int], wall: bool) -> str:
            return "R" if cell_at == cell else "G" if cell_at in goals else "#" if wall else "."

        rows = enumerate(self._robot.walls)
        return "\n".join("".join(glyph((c, r), wall) for c, wall in enumerate(row)) for r, row in rows)

    def _rgb(self) -> np.ndarray:
        walls = np.array(self._robot.walls)
        image = np.where(walls[..., None], COLOURS["wall"], COLOURS["free"]).astype(np.uint8)
        for col, row in self._robot.goals:
            image[row, col] = COLOURS["goal"]
        image = image.repeat(CELL_PX, axis=0).repeat(CELL_PX, axis=1)
        col, row = self._robot.cell
        y, x = np.ogrid[: image.shape[0], : image.shape[1]]
        middle = ((col + 0.5) * CELL_PX, (row + 0.5) * CELL_PX)
        disc = (x - middle[0]) ** 2 + (y - middle[1]) ** 2 <= (0.3 * CELL_PX) ** 2
        image[disc] = COLOURS["robot"]
        return image

    def __getstate__(self) -> dict[str, Any]:
        """Returns the state without the native robot, which is rebuilt by replaying the actions of the episode."""
        state = self.__dict__.copy()
        del state["_robot"]
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._robot = Robot(self._choice)
        if self._history is not None:
            noise, start, actions = self._history
            self._robot.reseed(noise)
            self._robot.reset(start)
            for action in actions:
                self._robot.step(action)
