"""Recordings of episodes that an agent of Python drives."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, SupportsFloat

import gymnasium
import gymnasium.vector
import numpy as np

from . import checks
from ._native import Recording
from .envs import MazeEnv
from .vector import History, MazeVectorEnv
from .wheels import WheelsEnv


class Record(gymnasium.Wrapper[np.ndarray, Any, np.ndarray, Any]):
    """Writes an MCAP file for each episode of an environment, and `run.mcap` for all of them.

    - `env`: one of the environments `xcscr/<Maze>-v0`, or `xcscr/Wheels-v0`
    - `folder`: missing or empty
    - `record`: which episodes get a file: `"all"`, `"beams"` (all, with each lidar beam), or `"every:50"`

    An episode is written when it ends, or when the environment is reset or closed. Call `close` at the end: it writes the
    seeds, the actions and the rewards to `run.mcap`. `xcscr recording verify` repeats them and compares every byte.
    """

    def __init__(self, env: gymnasium.Env[np.ndarray, Any], folder: str | os.PathLike[str], record: str = "all") -> None:
        super().__init__(env)
        robot = env.unwrapped
        if not isinstance(robot, MazeEnv | WheelsEnv):
            raise ValueError(f"cannot record {robot}: only the environments of xcscr are recorded")
        self._robot = robot
        self._rewards: list[float] | None = None
        self._recording = Recording(robot._choice, checks.text("folder", folder), record)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        if "goal" in (options or {}):
            raise ValueError("a recording has one world: wrap another environment for another goal")
        self._write()
        answer = self.env.reset(seed=seed, options=options)
        self._rewards = []
        return answer

    def step(self, action: Any) -> tuple[np.ndarray, SupportsFloat, bool, bool, dict[str, Any]]:
        if self._rewards is None:
            raise gymnasium.error.ResetNeeded("call reset before step: the episode is over")
        answer = self.env.step(action)
        _, reward, terminated, truncated, _ = answer
        self._rewards.append(float(reward))
        if terminated or truncated:
            self._write()
        return answer

    def close(self) -> None:
        """Writes the last episode, and finishes the recording."""
        try:
            self._write()
            self._recording.close()
        finally:
            super().close()

    def _write(self) -> None:
        rewards, self._rewards = self._rewards, None
        robot = self._robot
        if not rewards or robot._history is None:
            return
        if isinstance(robot, WheelsEnv):
            _check(self._recording.drive(*robot._history, rewards), robot._wheels.pose)
        else:
            _check(self._recording.episode(*robot._history, rewards), robot._robot.pose)


class RecordVector(gymnasium.vector.VectorWrapper):
    """Records each environment of a vector environment of mazes in a folder of its own, as `Record` does.

    - `env`: one of the environments `xcscr/<Maze>-v0`, made by `gymnasium.make_vec`
    - `folder`: missing or empty; environment 3 is recorded in its folder `env-3`
    - `record`: as in `Record`

    An episode is written when the environment is reset after it, or closed. Call `close` at the end.
    """

    def __init__(self, env: gymnasium.vector.VectorEnv[Any, Any, Any], folder: str | os.PathLike[str], record: str = "all") -> None:
        super().__init__(env)
        mazes = env.unwrapped
        if not isinstance(mazes, MazeVectorEnv):
            raise ValueError(f"cannot record {mazes}: only vector environments of xcscr/<Maze>-v0 are recorded")
        if mazes._begun.any():
            raise ValueError("the environment has been reset already: record it from its first episode")
        self._mazes = mazes
        folders = [str(Path(checks.text("folder", folder)) / f"env-{lane}") for lane in range(mazes.num_envs)]
        self._recordings = [Recording(mazes._given, each, record) for each in folders]
        mazes._recorder = self._write

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        if "goal" in (options or {}):
            raise ValueError("a recording has one world: wrap another environment for another goal")
        return self.env.reset(seed=seed, options=options)

    def close(self, **kwargs: Any) -> None:
        """Writes the last episodes, and finishes the recordings."""
        try:
            self._mazes._finish()
            for recording in self._recordings:
                recording.close()
        finally:
            self._mazes._recorder = None
            super().close(**kwargs)

    def _write(self, lane: int, history: History, pose: tuple[float, ...]) -> None:
        _check(self._recordings[lane].episode(*history), pose)


def _check(end: tuple[float, ...], pose: tuple[float, ...]) -> None:
    """Checks that a repeated episode ends where the robot is."""
    if end != pose:
        raise RuntimeError(f"the recorded episode ends at {end}, not at {pose}; please report this")
