"""Conversion of observations to percepts, and of conditions to text."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy
from gymnasium import spaces

from . import checks

Tests = Sequence[tuple[int, float, float]]

#: A discrete variable with at most this many values gets one bit per value, or one bit for two values. A larger one is
#: binary coded.
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
        values = _table(observations, self.width)
        wrong = values[(values != 0.0) & (values != 1.0)]
        if wrong.size:
            raise ValueError(f"a binary percept has the value {wrong[0]}: only 0 and 1 are possible")
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
        flat = _flat(observations)
        # Large whole numbers are not exact as floats.
        given = _table(flat, len(self.counts), int if flat.dtype.kind in "iu" else float)
        wrong = given[given != numpy.floor(given)]
        if wrong.size:
            raise ValueError(f"a discrete percept has the value {wrong[0]}, which is not a whole number")
        starts = numpy.array(self.starts)
        outside = given[(given < starts) | (given >= starts + numpy.array(self.counts))]
        if outside.size:
            raise ValueError(f"a discrete percept has the value {outside[0]:g}, which is outside of its space")
        numbers = given.astype(int) - starts
        variables, values, is_one_hot = _layout(self.counts)
        of_bits = numbers[:, variables]
        return numpy.where(is_one_hot, of_bits == values, of_bits >> values & 1).astype(float)

    def words(self, tests: Tests) -> str:
        return " and ".join(self._word(at, _bit(lower)) for at, lower, upper in tests)

    def _word(self, at: int, value: int) -> str:
        for count, start, name in zip(self.counts, self.starts, self.names, strict=True):
            if at < _bits_of(count):
                if _is_one_hot(count):
                    return f"{name} {'=' if value else '!='} {at + start}"
                return f"{name} = {value + start}" if count <= 2 else f"bit {at} of {name} = {value}"
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
        values = _table(observations, self.width) - low
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


def _table(observations: Any, width: int, dtype: Any = float) -> Any:
    """Returns observations as rows of `width` numbers."""
    values = checks.numbers(observations)
    if values is None:
        raise ValueError(f"the percept is {checks.shown(observations)}, but must be numbers")
    values = values.astype(dtype)
    if values.size % width:
        raise ValueError(f"the percept has {values.size} values, but the learner has {width}: {checks.shown(observations)}")
    return values.reshape(-1, width)


def _bit(lower: float) -> int:
    """Returns the value that a test requires of a bit. An interval such as [0.3, 1] requires 1."""
    return int(lower > 0.0)


def _is_one_hot(count: int) -> bool:
    return 2 < count <= MOST_ONE_HOT


def _bits_of(count: int) -> int:
    return count if _is_one_hot(count) else max((count - 1).bit_length(), 1)


@functools.lru_cache
def _layout(counts: tuple[int, ...]) -> tuple[Any, Any, Any]:
    """Returns for each bit its variable, its value or its place in a binary code, and which of them it is."""
    widths = [_bits_of(count) for count in counts]
    variables = numpy.repeat(numpy.arange(len(counts)), widths)
    values = numpy.concatenate([numpy.arange(width) for width in widths])
    return variables, values, numpy.repeat([_is_one_hot(count) for count in counts], widths)


def _flat(observation: Any) -> Any:
    """Returns the numbers of an observation as an array. The parts of a Dict are sorted by key."""
    if isinstance(observation, Mapping):
        observation = tuple(observation[key] for key in sorted(observation))
    if isinstance(observation, tuple):
        return numpy.concatenate([numpy.zeros(0, int), *map(_flat, observation)])
    return numpy.ravel(observation)


def named(names: Sequence[str] | None, count: int, stem: str) -> tuple[str, ...]:
    """Returns the given names, or `stem0`, `stem1`, ..."""
    if names is None:
        return tuple(f"{stem}{at}" for at in range(count))
    if len(names) != count:
        raise ValueError(f"{len(names)} feature names for {count} features")
    return tuple(map(str, names))


def ends(low: Any, high: Any, count: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Returns the bounds of each of `count` features. One bound may stand for all."""
    bounds = []
    for name, given in (("low", low), ("high", high)):
        values = checks.numbers(given)
        if values is None or values.size not in (1, count):
            raise ValueError(f"`{name}` is {checks.shown(given)}, but must be a number, or {count} numbers")
        bounds.append(tuple(map(float, numpy.broadcast_to(values.ravel(), count))))
    return bounds[0], bounds[1]


def of_space(
    space: Any, names: Sequence[str] | None = None, low: Any = None, high: Any = None
) -> Percepts:
    """Returns the conversion for an observation space of Gymnasium."""
    if isinstance(space, spaces.MultiBinary):
        return Bits(named(names, int(numpy.prod(space.shape)), "bit"))
    if isinstance(space, spaces.Box):
        count = int(numpy.prod(space.shape))
        low, high = (space.low if low is None else low), (space.high if high is None else high)
        return Reals(*ends(low, high, count), named(names, count, "x"))
    return states_of(space, names)


def states_of(space: Any, names: Sequence[str] | None = None) -> States:
    """Returns the conversion for a discrete observation space, in which a Box of integers counts as discrete."""
    variables = _variables(space, "")
    own = [name for name, _, _ in variables]
    return States(
        tuple(count for _, count, _ in variables),
        tuple(start for _, _, start in variables),
        named(own if names is None else names, len(own), "x"),
    )


def _variables(space: Any, name: str) -> list[tuple[str, int, int]]:
    """Returns name, number of values and least value of each variable, in the order of `_flat`."""
    if isinstance(space, spaces.Discrete):
        return [(name or "state", int(space.n), int(space.start))]
    if isinstance(space, spaces.Dict):
        parts = sorted(space.spaces.items())
        return [each for key, part in parts for each in _variables(part, f"{name}.{key}" if name else str(key))]
    if isinstance(space, spaces.Tuple):
        return [each for at, part in enumerate(space.spaces) for each in _variables(part, f"{name or 'x'}{at}")]
    if isinstance(space, spaces.MultiDiscrete):
        counts, starts = space.nvec, space.start
    elif isinstance(space, spaces.MultiBinary):
        counts, starts = numpy.full(space.shape, 2), numpy.zeros(space.shape, int)
    elif isinstance(space, spaces.Box) and numpy.issubdtype(space.dtype, numpy.integer):
        starts = space.low.astype(int)
        counts = space.high.astype(int) - starts + 1
        if (counts < 1).any() or (counts > 1 << 31).any():
            raise TypeError(f"{space} is not supported: its numbers have too many values")
    else:
        raise TypeError(
            f"{space} is not supported: use Discrete, MultiDiscrete, MultiBinary, Box, or a Dict or Tuple of these "
            "with integers"
        )
    indices = list(numpy.ndindex(counts.shape))
    names = [_indexed(name or "x", index) for index in indices]
    return [
        (each, int(count), int(start))
        for each, count, start in zip(names, counts.ravel(), starts.ravel(), strict=True)
    ]


def _indexed(name: str, index: tuple[int, ...]) -> str:
    """Returns `x3`, or `image[2,0]` for several dimensions."""
    if len(index) > 1:
        return f"{name}[{','.join(map(str, index))}]"
    return name + "".join(map(str, index))
