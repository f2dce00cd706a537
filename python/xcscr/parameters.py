"""The parameters of XCS, under the names used in the literature."""

from __future__ import annotations

import json
from typing import Any, Literal, TypedDict, get_args, get_type_hints

from . import checks

#: The greatest whole number that a parameter can have.
MOST_COUNT = 2**32 - 1
#: Parameters of interval conditions.
SPREADS = ("s0", "m")


class Parameters(TypedDict, total=False):
    """Parameters of XCS (Butz and Wilson 2001) and XCSR (Wilson 2000).

    The defaults are in brackets. `XCS` has those for problems of several steps: p_hash 0.05, theta_ga 100, theta_sub 500, and
    epsilon_0 as 0.0001 of the largest absolute reward so far.

    population_size: N, the maximum number of micro-classifiers (1600).
    p_hash: P#, the probability of a don't-care in covering, for binary percepts (0.3).
    beta: the learning rate (0.2).
    alpha, epsilon_0, nu: accuracy is 1 up to the error epsilon_0, and alpha (error / epsilon_0)^-nu above it
        (0.1, 10, 5). epsilon_0 is in units of reward. Rules do not distinguish values that differ by less.
    theta_ga: the mean number of steps between two runs of the genetic algorithm in a niche (25).
    chi, mu: the probabilities of crossover and of mutating an attribute (0.8, 0.04).
    theta_del, delta: above this experience, a fitness below delta times the mean raises the deletion vote (20, 0.1).
    theta_sub: the experience above which a rule can subsume others (20).
    s0: the largest distance of a bound from the percept in covering, as a share of the feature's range (1;
        `XCSClassifier` derives it from the data). A larger value gives more general conditions.
    m: the largest change of a bound in mutation, as a share of the feature's range (0.1).
    initial_prediction, initial_error, initial_fitness: the initial values of a covering rule (0, 0, 0.01).
    ga, ga_subsumption, action_set_subsumption: switches (True).
    update_order, subsumer_ties, ga_clock: variants of the algorithm.
    """

    population_size: int
    p_hash: float
    beta: float
    alpha: float
    epsilon_0: float
    nu: int
    theta_ga: int
    chi: float
    mu: float
    theta_del: int
    delta: float
    theta_sub: int
    s0: float
    m: float
    initial_prediction: float
    initial_error: float
    initial_fitness: float
    ga: bool
    ga_subsumption: bool
    action_set_subsumption: bool
    update_order: Literal["error-first", "prediction-first"]
    subsumer_ties: Literal["first", "random"]
    ga_clock: Literal["all-steps", "evolving-steps"]


def plain(parameters: dict[str, Any]) -> dict[str, Any]:
    """Returns the parameters as Python's own numbers. Raises TypeError for unknown names, and ValueError for other types."""
    kinds = get_type_hints(Parameters)
    unknown = sorted(parameters.keys() - kinds.keys())
    if unknown:
        known = ", ".join(kinds)
        raise TypeError(f"unknown parameter {unknown[0]!r}: choose from {known}")
    return {key: _plain(key, value, kinds[key]) for key, value in parameters.items()}


def _plain(name: str, value: Any, kind: Any) -> Any:
    """Returns the value of a parameter of this type. The native part checks its range."""
    if kind is int:
        return checks.whole(name, value, 0, MOST_COUNT)
    if kind is float:
        return checks.real(name, value)
    if kind is bool:
        return checks.switch(name, value)
    if value not in get_args(kind):
        raise ValueError(f"`{name}` is {checks.shown(value)}, but must be one of {', '.join(get_args(kind))}")
    return value


def as_json(parameters: dict[str, Any]) -> tuple[str, str]:
    """Returns the parameters of XCS and of interval conditions as JSON for the native part."""
    native = {"dont_care" if key == "p_hash" else key: value for key, value in parameters.items()}
    spreads = {key: native.pop(key) for key in SPREADS if key in native}
    return json.dumps(native), json.dumps(spreads)
