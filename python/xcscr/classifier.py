"""XCS for tables, with the interface of scikit-learn."""

from __future__ import annotations

import copy
import warnings
from typing import Any

import numpy

from . import checks
from ._native import Agent
from .parameters import as_json, plain
from .percepts import Reals, named
from .rules import XCSRule, frame_of, rules_of

try:
    from sklearn.base import BaseEstimator, ClassifierMixin  # type: ignore[import-untyped]
    from sklearn.exceptions import ConvergenceWarning  # type: ignore[import-untyped]
    from sklearn.utils import check_random_state  # type: ignore[import-untyped]
    from sklearn.utils.multiclass import check_classification_targets  # type: ignore[import-untyped]
    from sklearn.utils.validation import check_is_fitted, validate_data  # type: ignore[import-untyped]
except ImportError as error:
    raise ImportError("XCSClassifier needs scikit-learn: pip install xcscr[sklearn]") from error

#: A learner has at most this many actions.
MOST_CLASSES = 256
#: The reward of a right answer.
RIGHT = 1000.0
#: The share of the training rows that a covering condition matches on average, and the number of rows to measure it.
MATCHED, MOST_PAIRED = 0.2, 100
#: After `fit`, about this many rows are classified to see whether anything was learned.
MOST_CHECKED = 2000


def _spread(rows: Any) -> float:
    """Returns the s0 with which a covering condition of one row matches another with the probability `MATCHED`."""
    some = rows[:: len(rows) // MOST_PAIRED + 1]
    one, other = numpy.triu_indices(len(some), 1)
    distances = numpy.abs(some[one] - some[other])
    low, high = 1e-3, 1e3
    for _ in range(40):
        middle = (low * high) ** 0.5
        # A bound is at a uniform distance of at most s0.
        matched = (1 - distances / middle).clip(min=0.0).prod(axis=1).sum()
        low, high = (middle, high) if matched < MATCHED * len(distances) else (low, middle)
    return float(high)


class XCSClassifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """XCSR as a scikit-learn classifier: readable interval rules for tables of numbers.

    Each of `iterations` trials draws a row and learns from one answer. Half of the trials answer with the right
    class and get the reward 1000. The others answer with any other class and get the reward 0. `fit` scales each
    feature from its minimum and maximum to 0 and 1. The same data and `random_state` give the same rules on every machine.

    Parameters
    ----------
    iterations : int, default 50000
        The number of learning trials.
    s0 : float or None, default None
        The largest distance of a bound from the row in covering, as a share of the feature's range. By default, a
        covering condition matches a fifth of the training rows on average.
    population_size, beta, alpha, epsilon_0, nu, theta_ga, chi, mu, theta_del, delta, theta_sub, m, \
initial_prediction, initial_error, initial_fitness, ga_subsumption, action_set_subsumption
        See `xcscr.Parameters`.
    random_state : int, RandomState or None, default 1
        The seed.

    Attributes
    ----------
    classes_ : array of the classes
    n_features_in_ : number of features
    feature_names_in_ : names of the features, if `X` is a data frame
    n_iter_ : number of trials run
    s0_ : the value of `s0` that was used
    """

    def __init__(
        self,
        iterations: int = 50_000,
        *,
        population_size: int = 1600,
        beta: float = 0.2,
        alpha: float = 0.1,
        epsilon_0: float = 10.0,
        nu: int = 5,
        theta_ga: int = 25,
        chi: float = 0.8,
        mu: float = 0.04,
        theta_del: int = 20,
        delta: float = 0.1,
        theta_sub: int = 20,
        s0: float | None = None,
        m: float = 0.1,
        initial_prediction: float = 0.0,
        initial_error: float = 0.0,
        initial_fitness: float = 0.01,
        ga_subsumption: bool = True,
        action_set_subsumption: bool = True,
        random_state: Any = 1,
    ) -> None:
        self.iterations = iterations
        self.population_size = population_size
        self.beta = beta
        self.alpha = alpha
        self.epsilon_0 = epsilon_0
        self.nu = nu
        self.theta_ga = theta_ga
        self.chi = chi
        self.mu = mu
        self.theta_del = theta_del
        self.delta = delta
        self.theta_sub = theta_sub
        self.s0 = s0
        self.m = m
        self.initial_prediction = initial_prediction
        self.initial_error = initial_error
        self.initial_fitness = initial_fitness
        self.ga_subsumption = ga_subsumption
        self.action_set_subsumption = action_set_subsumption
        self.random_state = random_state

    def _seed(self) -> int:
        if isinstance(self.random_state, (int, numpy.integer)):
            return checks.whole("random_state", self.random_state)
        return int(check_random_state(self.random_state).randint(2**31))

    def _untrained(self, width: int, classes: int, seed: int) -> Agent:
        return Agent(True, width, classes, *self._settings, 0.0, 1.0, None, seed)

    def fit(self, X: Any, y: Any) -> XCSClassifier:
        """Learns rules from the rows of `X` and their classes `y`."""
        X, y = validate_data(self, X, y, dtype=float)
        check_classification_targets(y)
        self.classes_, answers = numpy.unique(y, return_inverse=True)
        if len(self.classes_) > MOST_CLASSES:
            raise ValueError(f"{len(self.classes_)} classes are too many: the limit is {MOST_CLASSES}")
        iterations = checks.whole("iterations", self.iterations, 1)
        names = named(getattr(self, "feature_names_in_", None), X.shape[1], "x")
        self._percepts = Reals(tuple(X.min(axis=0).tolist()), tuple(X.max(axis=0).tolist()), names)
        seed, rows = self._seed(), self._percepts.rows(X)
        self.s0_ = _spread(rows) if self.s0 is None else self.s0
        chosen = {key: value for key, value in self.get_params().items() if key not in ("iterations", "random_state")}
        # `set_params` may change the parameters after `fit`.
        self._settings = as_json(plain(chosen | {"s0": self.s0_}))
        self._agent = self._untrained(X.shape[1], len(self.classes_), seed)
        self._agent.learn_table(rows.tobytes(), answers.astype(numpy.uint8).tobytes(), iterations, seed)
        self._prior = numpy.bincount(answers) / len(answers)
        self.n_iter_ = iterations
        every = len(X) // MOST_CHECKED + 1
        self._warn_if_untaught(rows[::every], answers[::every])
        return self

    def _warn_if_untaught(self, rows: Any, answers: Any) -> None:
        right = float(numpy.mean(self._shares(rows).argmax(axis=1) == answers))
        largest = float(numpy.bincount(answers).max() / len(answers))
        if right <= largest < 1.0:
            warnings.warn(
                f"the rules classify {right:.0%} of the training rows correctly, and the largest class is {largest:.0%} of them: "
                "try other values of `s0` and `population_size`, and more `iterations`",
                ConvergenceWarning,
                stacklevel=3,
            )

    def compact(self, X: Any, y: Any) -> XCSClassifier:
        """Returns a classifier with the fewest rules of this one that decide as it does in the rows that it classifies correctly.

        The rules keep their statistics. The search is greedy, as that of the fewest rules of a policy.
        """
        check_is_fitted(self)
        X, y = validate_data(self, X, y, dtype=float, reset=False)
        answers = numpy.searchsorted(self.classes_, y).clip(max=len(self.classes_) - 1)
        unknown = y[self.classes_[answers] != y]
        if unknown.size:
            raise ValueError(f"`y` has the class {unknown[0]}, which the classifier has not met")
        few, rows = copy.deepcopy(self), self._percepts.rows(X)
        right = self._shares(rows).argmax(axis=1) == answers
        few._agent.compact(rows[right].tobytes(), answers[right].astype(numpy.uint8).tobytes())
        return few

    def predict_proba(self, X: Any) -> Any:
        """Returns each class's share of the predicted rewards, or its share of the training rows if no rule matches."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=float, reset=False)
        return self._shares(self._percepts.rows(X))

    def _shares(self, rows: Any) -> Any:
        values = numpy.frombuffer(self._agent.values(rows.tobytes()))
        values = numpy.nan_to_num(values.reshape(len(rows), -1)).clip(min=0.0)
        values = numpy.where(values.sum(axis=1, keepdims=True) > 1e-9, values, self._prior)
        return values / values.sum(axis=1, keepdims=True)

    def predict(self, X: Any) -> Any:
        """Returns the class with the greatest predicted reward."""
        shares = self.predict_proba(X)
        return self.classes_[numpy.argmax(shares, axis=1)]

    def rules(self) -> list[XCSRule]:
        """Returns the rules, with conditions in feature units, the highest numerosity first. `action` indexes `classes_`."""
        check_is_fitted(self)
        return rules_of(self._agent, self._percepts, 0)

    def rules_frame(self) -> Any:
        """Returns a pandas frame with a row for each rule. The column `class` has what the rule says: a class, or "not" and a
        class if the rule predicts less than half of the reward.
        """
        frame = frame_of(self.rules())
        advises = frame["prediction"] >= RIGHT / 2
        words = [str(name) if is_class else f"not {name}" for name, is_class in zip(self.classes_[frame["action"]], advises)]
        frame.insert(1, "class", words)
        return frame

    def __getstate__(self) -> dict[str, Any]:
        state: dict[str, Any] = super().__getstate__()
        if "_agent" in state:
            state = state | {"_agent": self._agent.state()}
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        saved = state.get("_agent")
        super().__setstate__({key: value for key, value in state.items() if key != "_agent"})
        if saved is not None:
            self._agent = self._untrained(self.n_features_in_, len(self.classes_), 0)
            self._agent.restore(saved)
