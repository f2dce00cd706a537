"""XCS for any environment."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, Unpack

import numpy
from gymnasium import spaces

from ._native import Agent
from .parameters import Parameters, as_json, plain
from .percepts import Bits, Percepts, Reals, States, named, of_space

#: The limits of ternary conditions. Beyond them, each bit gets an interval.
MOST_BITS, MOST_TERNARY_ACTIONS = 320, 8
_KINDS: dict[str, type[Percepts]] = {"bits": Bits, "states": States, "reals": Reals}


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


class XCS:
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
        gamma: float = 0.71,
        p_explore: float = 0.5,
        seed: int = 1,
        **parameters: Unpack[Parameters],
    ) -> None:
        """Creates an untrained learner for `n_bits` bits, or for `n_features` numbers from `low` to `high`.

        `gamma` is the discount factor and `p_explore` the share of random actions while learning.
        `Parameters` describes the other parameters. Raises ValueError if a value is out of range.
        """
        if (n_bits is None) == (n_features is None):
            raise ValueError("pass either n_bits or n_features")
        percepts: Percepts
        if n_bits is not None:
            percepts = Bits(named(feature_names, n_bits, "bit"))
        else:
            count = n_features or 0
            ends = [tuple(map(float, numpy.broadcast_to(numpy.ravel(end), count))) for end in (low, high)]
            percepts = Reals(ends[0], ends[1], named(feature_names, count, "x"))
        self._create(percepts, n_actions, 0, gamma, p_explore, seed, dict(parameters))

    @classmethod
    def for_env(
        cls,
        env: Any,
        *,
        low: Any = None,
        high: Any = None,
        feature_names: Sequence[str] | None = None,
        gamma: float = 0.71,
        p_explore: float = 0.5,
        seed: int = 1,
        **parameters: Unpack[Parameters],
    ) -> XCS:
        """Creates a learner for a Gymnasium environment.

        The action space must be Discrete, and the observation space Discrete, MultiDiscrete, MultiBinary or Box.
        A discrete variable gets one bit per value, or a binary code if it has more than 64 values. An unbounded Box
        needs `low` and `high`.
        """
        actions = env.action_space
        if not isinstance(actions, spaces.Discrete):
            raise TypeError(f"{actions} is not supported: the action space must be Discrete")
        percepts = of_space(env.observation_space, feature_names, low, high)
        learner = cls.__new__(cls)
        learner._create(percepts, int(actions.n), int(actions.start), gamma, p_explore, seed, dict(parameters))
        return learner

    def _create(
        self,
        percepts: Percepts,
        n_actions: int,
        first_action: int,
        gamma: float,
        p_explore: float,
        seed: int,
        parameters: dict[str, Any],
    ) -> None:
        n_actions, seed, parameters = int(n_actions), int(seed), plain(parameters)
        self._percepts = percepts
        self._arguments = (n_actions, first_action, gamma, p_explore, seed, parameters)
        intervals = percepts.is_real or percepts.width > MOST_BITS or n_actions > MOST_TERNARY_ACTIONS
        xcs, spreads = as_json(parameters)
        self._agent = Agent(intervals, percepts.width, n_actions, xcs, spreads, gamma, p_explore, seed)
        self._first_action = first_action
        self.episode_returns: list[float] = []
        """The sum of the rewards of each episode of `fit`."""

    @property
    def n_actions(self) -> int:
        """The number of actions."""
        return int(self._arguments[0])

    @property
    def n_rules(self) -> int:
        """The number of macro-classifiers."""
        return len(self._agent.rules())

    @property
    def numerosity(self) -> int:
        """The number of micro-classifiers."""
        return self._agent.numerosity

    def _bytes(self, percept: Any) -> bytes:
        return bytes(self._percepts.rows(percept).astype(float).tobytes())

    def act(self, percept: Any, explore: bool = True) -> int:
        """Chooses an action for learning: a random one with probability `p_explore`, and one of the best otherwise.

        With `explore=False`, always chooses one of the best. Call `update` with the reward of the action.
        """
        return self._agent.act(self._bytes(percept), explore) + self._first_action

    def update(self, reward: float, next_percept: Any = None, terminated: bool = True) -> None:
        """Learns from the reward of the last action.

        In a multistep problem, pass the next percept and `terminated=False`. The greatest action value of the next
        percept, discounted by `gamma`, is added to the reward. After a truncated episode, call `end_episode`.
        """
        if not terminated and next_percept is None:
            raise ValueError("pass next_percept unless the episode has terminated")
        self._agent.update(float(reward), None if terminated else self._bytes(next_percept))

    def end_episode(self) -> None:
        """Discards the last action, so that the next percept starts a new episode."""
        self._agent.end_episode()

    def values(self, percept: Any) -> list[float | None]:
        """Returns the value of each action, or None if no rule advocates it. Changes nothing."""
        row = numpy.frombuffer(self._agent.values(self._bytes(percept)))
        return [None if numpy.isnan(value) else float(value) for value in row]

    def policy(self, percept: Any) -> int:
        """Returns the first of the best actions, or the first action if no rule matches. Changes nothing."""
        values = [-numpy.inf if value is None else value for value in self.values(percept)]
        return int(numpy.argmax(values)) + self._first_action

    def fit(self, env: Any, *, steps: int | None = None, episodes: int | None = None, seed: int | None = None) -> XCS:
        """Learns in a Gymnasium environment for a number of steps or episodes, whichever ends first.

        `seed` is passed to the first reset; by default it is the seed of the learner. An episode cut off by `steps`
        has no entry in `episode_returns`.
        """
        if steps is None and episodes is None:
            raise ValueError("pass steps or episodes")
        steps_left = numpy.inf if steps is None else steps
        episodes_left = numpy.inf if episodes is None else episodes
        reset_seed: int | None = self._arguments[4] if seed is None else seed
        while steps_left > 0 and episodes_left > 0:
            observation, _ = env.reset(seed=reset_seed)
            reset_seed, done, total = None, False, 0.0
            while not done and steps_left > 0:
                action = self.act(observation)
                observation, reward, terminated, truncated, _ = env.step(action)
                self.update(reward, observation, terminated)
                done, total, steps_left = terminated or truncated, total + float(reward), steps_left - 1
            self.end_episode()
            episodes_left -= 1
            if done:
                self.episode_returns.append(total)
        return self

    def fit_table(self, percepts: Any, actions: Any, *, trials: int, seed: int | None = None) -> XCS:
        """Learns from a table of percepts and their right actions, without holding Python's lock.

        Each trial draws a row at random. Half of the trials take the right action, which gets the reward 1000. The
        others take any other action, which gets 0. `seed` selects the rows; by default it is the seed of the learner.
        """
        rows, answers = self._percepts.rows(percepts), numpy.asarray(actions).ravel() - self._first_action
        if ((answers < 0) | (answers >= self.n_actions)).any():
            raise ValueError(f"an action is not one of the learner's {self.n_actions} actions")
        chosen = self._arguments[4] if seed is None else seed
        self._agent.learn_table(rows.tobytes(), answers.astype(numpy.uint8).tobytes(), trials, chosen)
        return self

    def rules(self) -> list[XCSRule]:
        """Returns the rules with readable conditions, the highest numerosity first. An empty condition matches everything."""
        return rules_of(self._agent, self._percepts, self._first_action)

    def rules_frame(self) -> Any:
        """Returns a pandas frame with a row for each rule. Raises ImportError without pandas."""
        return frame_of(self.rules())

    def __getstate__(self) -> dict[str, Any]:
        kind = next(name for name, kind in _KINDS.items() if isinstance(self._percepts, kind))
        return {
            "format": "xcscr.XCS 1",
            "percepts": [kind, vars(self._percepts)],
            "arguments": self._arguments,
            "episode_returns": self.episode_returns,
            "state": base64.b64encode(self._agent.state()).decode(),
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        if state.get("format") != "xcscr.XCS 1":
            raise ValueError("this is not a saved xcscr.XCS")
        kind, fields = state["percepts"]
        self._create(_KINDS[kind](**{key: tuple(value) for key, value in fields.items()}), *state["arguments"])
        self._agent.restore(base64.b64decode(state["state"]))
        self.episode_returns = list(state["episode_returns"])

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the learner to a JSON file. A learner read by `load` continues bit for bit."""
        Path(path).write_text(json.dumps(self.__getstate__()), encoding="utf-8")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> XCS:
        """Reads a learner written by `save`. Raises ValueError for any other file."""
        learner = cls.__new__(cls)
        try:
            learner.__setstate__(json.loads(Path(path).read_text(encoding="utf-8")))
        except (KeyError, TypeError, AttributeError, UnicodeDecodeError) as error:
            raise ValueError(f"{os.fspath(path)} is not a saved xcscr.XCS, or it is damaged") from error
        return learner

    def __repr__(self) -> str:
        return f"<XCS: {self.n_rules} rules for {self._percepts.width} attributes and {self.n_actions} actions>"
