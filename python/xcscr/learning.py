"""Learner trials."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

from . import _native, checks
from .choice import choice

#: The maximum number of episodes of a trial.
MOST_EPISODES = 1_000_000
COLUMNS = ["episode", "steps", "collisions", "explored", "reward", "reached", "rules", "optimal"]


class Rule(NamedTuple):
    """A readable rule."""

    condition: str
    action: str
    prediction: float
    error: float
    experience: int


class Result:
    """The result of a trial."""

    def __init__(self, native: _native.Trained) -> None:
        self._native = native

    @property
    def world(self) -> str:
        """The name of the world."""
        return self._native.world

    @property
    def method(self) -> str:
        """The name of the method."""
        return self._native.method

    @property
    def first_optimal_episode(self) -> int | None:
        """The first episode after which the greedy policy was globally optimal."""
        return self._native.first_optimal_episode

    @property
    def retained(self) -> bool:
        """Whether the greedy policy is globally optimal at the end."""
        return self._native.retained

    @property
    def greedy_path(self) -> list[tuple[int, int]] | None:
        """The cells of the greedy path from the start; None if episodes start anywhere."""
        return self._native.greedy_path

    def rules(self) -> list[Rule]:
        """Returns the rules, the most experienced first. Empty for tables and plans."""
        return [Rule(*rule) for rule in self._native.rules()]

    def episodes(self) -> Any:
        """Returns a pandas frame with a row for each episode."""
        import pandas  # type: ignore[import-untyped]

        return pandas.DataFrame(self._native.rows(), columns=COLUMNS).set_index("episode")

    def __repr__(self) -> str:
        return f"<{self.method} in {self.world}: first optimal {self.first_optimal_episode}, retained {self.retained}>"


def train(
    world: str | os.PathLike[str] = "maze4",
    method: str = "xcscr",
    *,
    arena: str = "physics",
    sensor: str | None = None,
    robot: str | os.PathLike[str] | None = None,
    settings: dict[str, Any] | None = None,
    episodes: int = 180,
    seed: int = 1,
) -> Result:
    """Runs one trial. The same arguments give the same result on every machine."""
    chosen = choice(world, arena, sensor, robot, settings, seed)
    limit = checks.whole("episodes", episodes, 1, MOST_EPISODES)
    return Result(_native.train(chosen, checks.text("method", method), limit))
