"""Conversion of Python arguments to arguments of the native part."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from . import checks
from ._native import Robot

#: The settings that an environment reads, by how their names begin. The step threshold is the default of `max_steps`.
READ_BY_ENVIRONMENTS = ("arena.", "sensor.", "reward.step_threshold")


def choice(
    world: Any, arena: Any, sensor: Any, robot: Any, settings: Mapping[str, Any] | None, seed: Any
) -> dict[str, Any]:
    """Returns the arguments of the native part, with settings as `key=value` strings."""

    def written(value: Any) -> str:
        return str(value).lower() if isinstance(value, bool) else str(value)

    given = plain_settings(settings)
    if arena == "grid":
        unread = ["robot"] if robot is not None else [key for key in given if key.startswith("physics.")]
        if unread:
            raise ValueError(f'`{unread[0]}` has no effect: only the arena "physics" has a robot')
    return {
        "world": checks.text("world", world),
        "arena": checks.text("arena", arena),
        "sensor": None if sensor is None else checks.text("sensor", sensor),
        "robot": None if robot is None else checks.text("robot", robot),
        "settings": [f"{key}={written(value)}" for key, value in given.items()],
        "seed": checks.whole("seed", seed),
    }


def environment(
    world: Any,
    arena: Any,
    sensor: Any,
    robot: Any,
    noise: Any,
    slip: Any,
    settings: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """Returns the choice of an environment, whose moves are chosen by its user. Refuses settings of learners."""
    sets = plain_settings(settings)
    for key in sets:
        # A setting without a section is unknown, which the native part explains.
        if "." in key and not key.startswith((*READ_BY_ENVIRONMENTS, "physics.")):
            raise ValueError(
                f"`{key}` in `settings` has no effect: an environment has no learner, and reads only `arena.*`, "
                "`physics.*`, `sensor.*` and `reward.step_threshold`"
            )
    if noise is not None:
        if arena == "grid":
            raise ValueError('`noise` has no effect: only the arena "physics" has sensors with noise')
        sets["physics.noise"] = checks.real("noise", noise, 0.0, 5.0)
    if slip != 0:
        sets["arena.slip"] = checks.real("slip", slip, 0.0, 0.75)
    return choice(world, arena, sensor, robot, sets, seed=1)


def plain_settings(settings: Mapping[str, Any] | None) -> dict[str, Any]:
    """Returns settings by their full names, with values of Python's own types."""
    if not isinstance(settings or {}, Mapping):
        raise ValueError(f"`settings` is {checks.shown(settings)}, but must be a dict of settings by their full names")
    plain = {}
    for key, value in (settings or {}).items():
        if hasattr(value, "item") and getattr(value, "ndim", None) == 0:
            value = value.item()
        if isinstance(value, Mapping):
            raise ValueError(f'`settings` has a dict for {key!r}: write the full names, such as {{"{key}.<name>": value}}')
        if not isinstance(key, str) or not isinstance(value, bool | int | float | str):
            raise ValueError(f"`settings` has {checks.shown(value)} for {key!r}, but a setting is a number, a bool or a string")
        if isinstance(value, str):
            value = checks.text(key, value)
        elif isinstance(value, int) and not isinstance(value, bool):
            value = checks.whole(key, value, -(2**63), 2**63 - 1)
        plain[checks.text("settings", key)] = value
    return plain


def rewards(goal_reward: Any, step_reward: Any, collision_reward: Any) -> tuple[float, float, float]:
    """Returns the rewards of an environment."""
    given = {"goal_reward": goal_reward, "step_reward": step_reward, "collision_reward": collision_reward}
    goal, step, collision = (checks.real(name, value) for name, value in given.items())
    return goal, step, collision


def with_goal(given: dict[str, Any], goal: Any) -> dict[str, Any]:
    """Returns the choice with this single goal in its world. `None` keeps the goals of the world."""
    if goal is None:
        return given
    world = json.loads(Robot(given).world_json)
    rows = [row.replace("G", ".") for row in world["rows"]]
    col, row = checks.cell("goal", goal)
    if not (row < len(rows) and col < len(rows[row]) and rows[row][col] == "."):
        raise ValueError(f"the goal ({col}, {row}) is not a free cell, or it is the start")
    rows[row] = rows[row][:col] + "G" + rows[row][col + 1 :]
    return given | {"world": json.dumps(world | {"rows": rows})}
