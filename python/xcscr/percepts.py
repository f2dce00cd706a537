"""Conversion of observations to percepts, and of conditions to text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy
from gymnasium import spaces

Tests = Sequence[tuple[int, float, float]]

#: A discrete variable with at most this many values gets one bit per value; a larger one is binary coded.
MOST_ONE_HOT = 64


@dataclass(frozen=True)
class Bits:
    """Binary observations: an array of 0 and 1."""

    names: tuple[str, ...]
    is_real = False

    @property
    def width(self) -> int:
        return len(self.names)

    def rows(self, observations: Any) -> Any:
        values = numpy.asarray(observations, dtype=float).reshape(-1, self.width)
        if ((values != 0.0) & (values != 1.0)).any():
            raise ValueError("a binary percept has a value other than 0 and 1")
        return values

    def words(self, tests: Tests) -> str:
        return " and ".join(f"{self.names[at]} = {_bit(lower)}" for at, lower, upper in tests)


@dataclass(frozen=True)
class States:
    """Discrete observations: one number per variable, starting at `starts`."""

    counts: tuple[int, ...]
    starts: tuple[int, ...]
    names: tuple[str, ...]
    is_real = False

    @property
    def width(self) -> int:
        return sum(map(_bits_of, self.counts))

    def rows(self, observations: Any) -> Any:
        numbers = numpy.asarray(observations).reshape(-1, len(self.counts)) - numpy.array(self.starts)
        if (numbers < 0).any() or (numbers >= numpy.array(self.counts)).any():
            raise ValueError("a discrete percept is outside of its space")
        columns = []
        for count, column in zip(self.counts, numbers.T, strict=True):
            bits = numpy.arange(_bits_of(count))
            columns.append(column[:, None] == bits if count <= MOST_ONE_HOT else column[:, None] >> bits & 1)
        return numpy.concatenate(columns, axis=1).astype(float)

    def words(self, tests: Tests) -> str:
        return " and ".join(self._word(at, _bit(lower)) for at, lower, upper in tests)

    def _word(self, at: int, value: int) -> str:
        for count, start, name in zip(self.counts, self.starts, self.names, strict=True):
            if at < _bits_of(count):
                one_hot = f"{name} {'=' if value else '!='} {at + start}"
                return one_hot if count <= MOST_ONE_HOT else f"bit {at} of {name} = {value}"
            at -= _bits_of(count)
        raise IndexError(at)


@dataclass(frozen=True)
class Reals:
    """Real-valued observations. Each feature is scaled from `low`..`high` to 0..1."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    names: tuple[str, ...]
    is_real = True

    def __post_init__(self) -> None:
        bounds = numpy.array([self.low, self.high])
        if not numpy.isfinite(bounds).all() or (bounds[0] > bounds[1]).any():
            raise ValueError("each feature needs finite bounds with low <= high: pass low= and high=")

    @property
    def width(self) -> int:
        return len(self.names)

    def rows(self, observations: Any) -> Any:
        low, span = numpy.array(self.low), numpy.array(self.high) - numpy.array(self.low)
        values = numpy.asarray(observations, dtype=float).reshape(-1, self.width) - low
        return numpy.divide(values, span, out=numpy.full_like(values, 0.5), where=span > 0)

    def words(self, tests: Tests) -> str:
        return " and ".join(self._word(*test) for test in tests)

    def _word(self, at: int, lower: float, upper: float) -> str:
        low, span = self.low[at], self.high[at] - self.low[at]
        least, most = (f"{low + span * bound:.4g}" for bound in (lower, upper))
        if lower <= 0.0:
            return f"{self.names[at]} <= {most}"
        return f"{self.names[at]} >= {least}" if upper >= 1.0 else f"{least} <= {self.names[at]} <= {most}"


Percepts = Bits | States | Reals


def _bit(lower: float) -> int:
    """Returns the value that a test requires of a bit. An interval such as [0.3, 1] requires 1."""
    return int(lower > 0.0)


def _bits_of(count: int) -> int:
    return count if count <= MOST_ONE_HOT else (count - 1).bit_length()


def named(names: Sequence[str] | None, count: int, stem: str) -> tuple[str, ...]:
    """Returns the given names, or `stem0`, `stem1`, ..."""
    if names is None:
        return tuple(f"{stem}{at}" for at in range(count))
    if len(names) != count:
        raise ValueError(f"{len(names)} feature names for {count} features")
    return tuple(map(str, names))


def of_space(
    space: Any, names: Sequence[str] | None = None, low: Any = None, high: Any = None
) -> Percepts:
    """Returns the conversion for an observation space of Gymnasium."""
    if isinstance(space, spaces.MultiBinary):
        return Bits(named(names, int(numpy.prod(space.shape)), "bit"))
    if isinstance(space, spaces.Discrete):
        return States((int(space.n),), (int(space.start),), named(names or ["state"], 1, "state"))
    if isinstance(space, spaces.MultiDiscrete):
        counts, starts = space.nvec.ravel(), space.start.ravel()
        names = named(names, counts.size, "x")
        return States(tuple(map(int, counts)), tuple(map(int, starts)), names)
    if isinstance(space, spaces.Box):
        count = int(numpy.prod(space.shape))
        low, high = (space.low if low is None else low), (space.high if high is None else high)
        ends = [tuple(map(float, numpy.broadcast_to(numpy.ravel(end), count))) for end in (low, high)]
        return Reals(ends[0], ends[1], named(names, count, "x"))
    raise TypeError(f"{space} is not supported: use Discrete, MultiDiscrete, MultiBinary or Box")
