"""The rules of a learner in Python."""

from __future__ import annotations

from typing import Any, NamedTuple

from ._native import Agent
from .percepts import Percepts


class XCSRule(NamedTuple):
    """A macro-classifier: if `condition` holds, the predicted value of `action` is `prediction`."""

    condition: str
    action: int
    prediction: float
    error: float
    fitness: float
    numerosity: int
    experience: int
    set_size: float
    time_stamp: int


def rules_of(agent: Agent, percepts: Percepts, first_action: int) -> list[XCSRule]:
    """Returns the rules with conditions as text, the highest numerosity first."""
    rules = [
        XCSRule(percepts.words(rule[0]), rule[1] + first_action, *rule[2:]) for rule in agent.rules()
    ]
    return sorted(rules, key=lambda rule: (-rule.numerosity, rule.action, rule.condition))


def frame_of(rules: list[XCSRule]) -> Any:
    """Returns a pandas frame with a row for each rule."""
    try:
        import pandas  # type: ignore[import-untyped]
    except ImportError as error:
        raise ImportError("rules_frame needs pandas: pip install xcscr[pandas]") from error
    return pandas.DataFrame(rules, columns=list(XCSRule._fields))
