"""The model-based learner `xcscr-plus` for any discrete environment."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Self

from gymnasium import spaces

from . import checks
from ._native import Agent
from .learner import Learner
from .percepts import Percepts, States, named, states_of

#: The limits of the conditions of its rules.
MOST_BITS, MOST_ACTIONS = 320, 8


class Plus(Learner):
    """`xcscr-plus`: a plan on a learned model, distilled into a small set of best-action rules.

    The state is the percept. The learner counts what follows each action (the model), explores where a path may be
    better than all known ones, and plans on the counts by prioritised sweeping. Its rules state the best actions of the
    plan, and choose every action that does not explore. It is the program's learner with the percept as the state.
    What only holds in mazes is left out: collisions, inverse actions, rotational symmetry and slips.

    If different states share a percept, the plan is for their mean, and may be bad. The learner does not generalise
    between percepts that it has not met; only its rules do.

    Each different reward of an action is stored. Rewards with continuous noise make learning several times slower
    (2 to 13 times in Taxi and FrozenLake). Differences of returns below 0.01 % (1 % where results vary) of the range from
    the worst endless walk to the best return do not count. So one percept with an unavoidable cost of more than about 100 times the
    best return can end exploration too early. Scale such a cost down.

    >>> learner = Plus(2, n_bits=6, seed=1)
    >>> action = learner.act([0, 1, 0, 0, 1, 1])
    >>> learner.update(1.0)
    """

    def __init__(
        self,
        n_actions: int,
        *,
        n_bits: int,
        feature_names: Sequence[str] | None = None,
        gamma: float = 0.99,
        best_return: float | None = None,
        tries: int = 20,
        population_size: int = 5000,
        seed: int = 1,
    ) -> None:
        """Creates an untrained learner for percepts of `n_bits` bits.

        - `gamma`: the discount per step
        - `best_return`: the return that an unknown action may bring. Exploration ends when no unknown action can be
          better than the known ones. By default, the greatest return seen so far, at least 0. Set it if a great
          reward may follow steps that cost much, or if a small reward may hide it.
        - `tries`: an action is known after this many tries (2 to 10,000), once different percepts have followed some
          action. Before that, one try is enough; so an action whose reward alone is random may be misjudged.
        - `population_size`: the greatest number of rules

        Raises ValueError if a value is out of range.
        """
        n_bits = checks.whole("n_bits", n_bits, 1, MOST_BITS)
        names = named(feature_names, n_bits, "bit")
        percepts = States((2,) * n_bits, (0,) * n_bits, names)
        self._create(percepts, n_actions, 0, gamma, best_return, tries, population_size, seed)

    @classmethod
    def for_env(
        cls,
        env: Any,
        *,
        feature_names: Sequence[str] | None = None,
        gamma: float = 0.99,
        best_return: float | None = None,
        tries: int = 20,
        population_size: int = 5000,
        seed: int = 1,
    ) -> Self:
        """Creates a learner for a Gymnasium environment.

        The action space must be Discrete with at most 8 actions. The observation space must be Discrete, MultiDiscrete,
        MultiBinary, a Box of integers, or a Dict or Tuple of these, with at most 320 bits. A variable gets one bit per
        value, one bit for two values, or a binary code for more than 64 values. A MultiDiscrete of coordinates gives
        better rules than a Discrete number of the state.
        """
        actions = env.action_space
        if not isinstance(actions, spaces.Discrete):
            raise TypeError(f"{actions} is not supported: the action space must be Discrete")
        learner = cls.__new__(cls)
        percepts = states_of(env.observation_space, feature_names)
        given = (gamma, best_return, tries, population_size, seed)
        learner._create(percepts, int(actions.n), int(actions.start), *given)
        return learner

    def _create(self, percepts: Percepts, *arguments: Any) -> None:
        n_actions, first_action, gamma, best_return, tries, population_size, seed = arguments
        if percepts.width > MOST_BITS:
            raise ValueError(
                f"the percepts have {percepts.width} bits, but at most {MOST_BITS} are possible: "
                "wrap the environment in an ObservationWrapper that shows less"
            )
        n_actions = checks.whole("n_actions", n_actions, 1, MOST_ACTIONS)
        best_return = None if best_return is None else checks.real("best_return", best_return)
        numbers = (checks.real("gamma", gamma, 0.0, 1.0), best_return)
        counts = (checks.whole("tries", tries), checks.whole("population_size", population_size))
        self._percepts, self._seed, self.episode_returns = percepts, checks.whole("seed", seed), []
        self._arguments = (n_actions, first_action, *numbers, *counts, self._seed)
        names = ("gamma", "best_return", "tries", "population_size")
        params = json.dumps(dict(zip(names, (*numbers, *counts), strict=True)))
        self._agent = Agent.plus(percepts.width, n_actions, params, self._seed)
