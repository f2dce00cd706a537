"""XCS for any environment."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Self, Unpack

import numpy
from gymnasium import spaces

from . import checks
from ._native import Agent
from .learner import Learner
from .parameters import Parameters, as_json, plain
from .percepts import Bits, Percepts, Reals, States, ends, named, of_space

#: The limits of ternary conditions. Beyond them, each bit gets an interval.
MOST_BITS, MOST_TERNARY_ACTIONS = 320, 8

#: The largest number of attributes of a percept, and of actions.
MOST_ATTRIBUTES, MOST_ACTIONS = 1_000_000, 256

#: Defaults of parameters that differ from `Parameters`, for problems of several steps.
DEFAULTS: Parameters = {"p_hash": 0.05, "theta_ga": 100, "theta_sub": 500}

#: By default, epsilon_0 is this share of the largest absolute reward so far.
ERROR_SHARE = 1e-4
#: epsilon_0 before the first reward.
LEAST_ERROR = 1e-9

#: The format of a saved learner.
_FORMAT = "xcscr.XCS 2"
_KINDS: dict[str, type[Percepts]] = {"bits": Bits, "states": States, "reals": Reals}


class XCS(Learner):
    """XCS, the accuracy-based learning classifier system (Butz and Wilson 2001).

    Binary percepts get ternary conditions. Real-valued percepts get an interval for each feature: XCSR (Wilson
    2000) with ordered bounds (Stone and Bull 2003). The same calls and seed give the same rules on every machine.

    >>> learner = XCS(2, n_bits=6, seed=1)
    >>> action = learner.act([0, 1, 0, 0, 1, 1])
    >>> learner.update(1000.0)
    """

    def __init__(
        self,
        n_actions: int,
        *,
        n_bits: int | None = None,
        n_features: int | None = None,
        low: Sequence[float] | float = 0.0,
        high: Sequence[float] | float = 1.0,
        feature_names: Sequence[str] | None = None,
        gamma: float = 0.99,
        p_explore: float = 0.1,
        seed: int = 1,
        **parameters: Unpack[Parameters],
    ) -> None:
        """Creates an untrained learner for `n_bits` bits, or for `n_features` numbers from `low` to `high`.

        `gamma` is the discount factor and `p_explore` the share of random actions while learning. The defaults are for
        problems of several steps. `Parameters` describes the other parameters. Raises ValueError if a value is out of range.
        """
        if (n_bits is None) == (n_features is None):
            raise ValueError("pass either n_bits or n_features")
        percepts: Percepts
        if n_bits is not None:
            percepts = Bits(named(feature_names, checks.whole("n_bits", n_bits, 1, MOST_ATTRIBUTES), "bit"))
        else:
            count = checks.whole("n_features", n_features, 1, MOST_ATTRIBUTES)
            percepts = Reals(*ends(low, high, count), named(feature_names, count, "x"))
        self._create(percepts, n_actions, 0, gamma, p_explore, seed, dict(parameters))

    @classmethod
    def for_env(
        cls,
        env: Any,
        *,
        low: Any = None,
        high: Any = None,
        feature_names: Sequence[str] | None = None,
        gamma: float = 0.99,
        p_explore: float = 0.1,
        seed: int = 1,
        **parameters: Unpack[Parameters],
    ) -> Self:
        """Creates a learner for a Gymnasium environment.

        The action space must be Discrete, and the observation space Discrete, MultiDiscrete, MultiBinary or Box, or a
        Dict or Tuple of discrete ones. A discrete variable gets one bit per value, or a binary code if it has more than
        64 values. An unbounded Box needs `low` and `high`.
        """
        actions = env.action_space
        if not isinstance(actions, spaces.Discrete):
            raise TypeError(f"{actions} is not supported: the action space must be Discrete")
        percepts = of_space(env.observation_space, feature_names, low, high)
        learner = cls.__new__(cls)
        learner._create(percepts, int(actions.n), int(actions.start), gamma, p_explore, seed, dict(parameters))
        return learner

    def _create(self, percepts: Percepts, *arguments: Any) -> None:
        n_actions, first_action, gamma, p_explore, seed, parameters = arguments
        n_actions = checks.whole("n_actions", n_actions, 1, MOST_ACTIONS)
        gamma, p_explore = checks.real("gamma", gamma, 0.0, 1.0), checks.real("p_explore", p_explore, 0.0, 1.0)
        seed, parameters = checks.whole("seed", seed), plain(DEFAULTS | parameters)
        self._percepts, self._seed, self.episode_returns = percepts, seed, []
        self._arguments = (n_actions, first_action, gamma, p_explore, seed, parameters)
        intervals = percepts.is_real or percepts.width > MOST_BITS or n_actions > MOST_TERNARY_ACTIONS
        error_share = None if "epsilon_0" in parameters else ERROR_SHARE
        xcs, spreads = as_json({"epsilon_0": LEAST_ERROR} | parameters)
        self._agent = Agent(intervals, percepts.width, n_actions, xcs, spreads, gamma, p_explore, error_share, seed)

    def fit_table(self, percepts: Any, actions: Any, *, trials: int, seed: int | None = None) -> Self:
        """Learns from a table of percepts and their right actions, without holding Python's lock.

        Each trial draws a row at random. Half of the trials take the right action, which gets the reward 1000. The
        others take any other action, which gets 0. `seed` selects the rows; by default it is the seed of the learner.
        """
        trials = checks.whole("trials", trials)
        chosen = self._seed if seed is None else checks.whole("seed", seed)
        given = numpy.ravel(actions)
        if not numpy.issubdtype(given.dtype, numpy.integer):
            raise ValueError(f"`actions` is {checks.shown(actions)}, but must be whole numbers")
        rows, answers = self._percepts.rows(percepts), given - self._first_action
        wrong = given[(answers < 0) | (answers >= self.n_actions)]
        if wrong.size:
            raise ValueError(f"`actions` has {wrong[0]}, which is not one of the learner's {self.n_actions} actions")
        self._agent.learn_table(rows.tobytes(), answers.astype(numpy.uint8).tobytes(), trials, chosen)
        return self

    def __getstate__(self) -> dict[str, Any]:
        kind = next(name for name, kind in _KINDS.items() if isinstance(self._percepts, kind))
        return {
            "format": _FORMAT,
            "percepts": [kind, vars(self._percepts)],
            "arguments": self._arguments,
            "episode_returns": self.episode_returns,
            "state": base64.b64encode(self._agent.state()).decode(),
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        if state.get("format") != _FORMAT:
            raise ValueError("this is not a saved xcscr.XCS")
        kind, fields = state["percepts"]
        self._create(_KINDS[kind](**{key: tuple(value) for key, value in fields.items()}), *state["arguments"])
        self._agent.restore(base64.b64decode(state["state"]))
        self.episode_returns = list(state["episode_returns"])

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the learner to a JSON file. A learner read by `load` continues bit for bit."""
        Path(path).write_text(json.dumps(self.__getstate__()), encoding="utf-8")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Reads a learner written by `save`. Raises ValueError for any other file."""
        learner = cls.__new__(cls)
        try:
            learner.__setstate__(json.loads(Path(path).read_text(encoding="utf-8")))
        except (KeyError, TypeError, AttributeError, UnicodeDecodeError, OverflowError) as error:
            raise ValueError(f"{os.fspath(path)} is not a saved xcscr.XCS, or it is damaged") from error
        return learner
