"""Recordings of episodes that an agent of Python drives."""

from __future__ import annotations

from pathlib import Path
from typing import Any, SupportsFloat

import gymnasium
import numpy as np

from ._native import Recording
from .envs import MazeEnv


class Record(gymnasium.Wrapper[np.ndarray, np.int64, np.ndarray, np.int64]):
    """Writes an MCAP file for each episode of a maze environment, and `run.mcap` for all of them.

    - `env`: one of the environments `xcscr/<Maze>-v0`
    - `folder`: missing or empty
    - `record`: which episodes get a file: `"all"`, `"beams"` (all, with each lidar beam), `"every:50"`, `"best"` or `"last"`

    An episode is written when it ends, or when the environment is reset or closed. Call `close` at the end: it writes the
    seeds, the actions and the rewards to `run.mcap`. `xcscr recording verify` repeats them and compares every byte.
    """

    def __init__(self, env: gymnasium.Env[np.ndarray, np.int64], folder: str | Path, record: str = "all") -> None:
        super().__init__(env)
        maze = env.unwrapped
        if not isinstance(maze, MazeEnv):
            raise ValueError(f"cannot record {maze}: only the environments xcscr/<Maze>-v0 are recorded")
        self._maze = maze
        self._rewards: list[float] | None = None
        self._recording = Recording(maze._choice, str(folder), record)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        if "goal" in (options or {}):
            raise ValueError("a recording has one world: wrap another environment for another goal")
        self._write()
        answer = self.env.reset(seed=seed, options=options)
        self._rewards = []
        return answer

    def step(self, action: np.int64) -> tuple[np.ndarray, SupportsFloat, bool, bool, dict[str, Any]]:
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
        if rewards and self._maze._history is not None:
            noise, start, actions = self._maze._history
            end = self._recording.episode(noise, start, actions, rewards)
            if end != self._maze._robot.pose:
                raise RuntimeError(f"the recorded episode ends at {end}, not at {self._maze._robot.pose}; please report this")
