"""Conversion of Python arguments to arguments of the native part."""

from __future__ import annotations

import json
from typing import Any

from ._native import Robot


def choice(
    world: str, arena: str, sensor: str | None, robot: str | None, settings: dict[str, Any], seed: int
) -> dict[str, Any]:
    """Returns the arguments of the native part, with settings as `key=value` strings."""

    def written(value: Any) -> str:
        return str(value).lower() if isinstance(value, bool) else str(value)

    sets = [f"{key}={written(value)}" for key, value in settings.items()]
    return {"world": world, "arena": arena, "sensor": sensor, "robot": robot, "settings": sets, "seed": seed}


def with_goal(given: dict[str, Any], goal: tuple[int, int] | None) -> dict[str, Any]:
    """Returns the choice with this single goal in its world. `None` keeps the goals of the world."""
    if goal is None:
        return given
    world = json.loads(Robot(given).world_json)
    rows = [row.replace("G", ".") for row in world["rows"]]
    col, row = int(goal[0]), int(goal[1])
    if not (0 <= row < len(rows) and 0 <= col < len(rows[row]) and rows[row][col] == "."):
        raise ValueError(f"the goal ({col}, {row}) is not a free cell, or it is the start")
    rows[row] = rows[row][:col] + "G" + rows[row][col + 1 :]
    return given | {"world": json.dumps(world | {"rows": rows})}
