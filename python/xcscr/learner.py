"""What all learners for environments have in common."""

from __future__ import annotations

from typing import Any, Self

import numpy

from . import checks
from ._native import Agent
from .percepts import Percepts
from .rules import XCSRule, frame_of, rules_of


class Learner:
    """A learner of rules for environments with numbered actions."""

    _percepts: Percepts
    #: The arguments of `_create` after the percepts. The first two are the number of actions and the first action.
    _arguments: tuple[Any, ...]
    _seed: int
    _agent: Agent
    episode_returns: list[float]
    """The sum of the rewards of each episode of `fit`."""

    def _create(self, percepts: Percepts, *arguments: Any) -> None:
        """Creates an untrained learner."""
        raise NotImplementedError

    @property
    def n_actions(self) -> int:
        """The number of actions."""
        return int(self._arguments[0])

    @property
    def _first_action(self) -> int:
        return int(self._arguments[1])

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
        """Chooses an action for learning, which may explore.

        With `explore=False`, always chooses one of the best. Call `update` with the reward of the action.
        """
        return self._agent.act(self._bytes(percept), bool(explore)) + self._first_action

    def update(self, reward: float, next_percept: Any = None, terminated: bool = True) -> None:
        """Learns from the reward of the last action.

        In a multistep problem, pass the next percept and `terminated=False`. After a truncated episode, call `end_episode`.
        """
        if not terminated and next_percept is None:
            raise ValueError("pass next_percept unless the episode has terminated")
        self._agent.update(checks.real("reward", reward), None if terminated else self._bytes(next_percept))

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

    def fit(self, env: Any, *, steps: int | None = None, episodes: int | None = None, seed: int | None = None) -> Self:
        """Learns in a Gymnasium environment for a number of steps or episodes, whichever ends first.

        `seed` is passed to the first reset; by default it is the seed of the learner. An episode cut off by `steps`
        has no entry in `episode_returns`.
        """
        if steps is None and episodes is None:
            raise ValueError("pass steps or episodes")
        steps_left = numpy.inf if steps is None else checks.whole("steps", steps)
        episodes_left = numpy.inf if episodes is None else checks.whole("episodes", episodes)
        reset_seed: int | None = self._seed if seed is None else checks.whole("seed", seed)
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

    def rules(self) -> list[XCSRule]:
        """Returns the rules with readable conditions, the highest numerosity first. An empty condition matches everything."""
        return rules_of(self._agent, self._percepts, self._first_action)

    def rules_frame(self) -> Any:
        """Returns a pandas frame with a row for each rule. Raises ImportError without pandas."""
        return frame_of(self.rules())

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.n_rules} rules for {self._percepts.width} attributes and {self.n_actions} actions>"
