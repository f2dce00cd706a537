"""Checks of arguments, which raise ValueError with the value."""

from __future__ import annotations

import math
import operator
import os
import reprlib
from typing import Any

import numpy

#: The largest seed, size or count.
MOST = 2**64 - 1
#: The largest reward.
MOST_REWARD = 1e12


def shown(value: Any) -> str:
    """Returns a value as it appears in messages, cut where it is long."""
    text = reprlib.repr(value)
    return text if len(text) <= 200 else text[:197] + "..."


def whole(name: str, value: Any, least: int = 0, most: int = MOST) -> int:
    """Returns a whole number of any type as an `int`."""
    try:
        number = operator.index(value)
    except TypeError:
        raise ValueError(f"`{name}` is {shown(value)}, but must be a whole number from {least} to {most}") from None
    if not least <= number <= most:
        raise ValueError(f"`{name}` is {shown(number)}, but must be from {least} to {most}")
    return number


def real(name: str, value: Any, least: float = -MOST_REWARD, most: float = MOST_REWARD) -> float:
    """Returns a finite number of any type as a `float`."""
    try:
        number = math.nan if isinstance(value, str | bytes) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not least <= number <= most:
        raise ValueError(f"`{name}` is {shown(value)}, but must be a number from {least:g} to {most:g}")
    return number


def numbers(value: Any) -> Any:
    """Returns an array of numbers, or `None` for anything else, such as texts and ragged lists."""
    try:
        array = numpy.asarray(value)
    except ValueError:
        return None
    return array if array.dtype.kind in "biuf" else None


def cell(name: str, value: Any) -> tuple[int, int]:
    """Returns a cell as a column and a row."""
    try:
        column, row = map(operator.index, value)
    except (TypeError, ValueError):
        raise ValueError(f"`{name}` is {shown(value)}, but must be a cell: (column, row)") from None
    if not (0 <= column < 1 << 16 and 0 <= row < 1 << 16):
        raise ValueError(f"`{name}` is {(column, row)}, which is not a free cell of the world")
    return column, row


def text(name: str, value: Any) -> str:
    """Returns a string or a path as a `str`."""
    try:
        given = os.fspath(value)
    except TypeError:
        given = None
    if not isinstance(given, str):
        raise ValueError(f"`{name}` is {shown(value)}, but must be a string or a path")
    if any("\ud800" <= letter <= "\udfff" for letter in given):
        raise ValueError(f"`{name}` is {shown(value)}, which is not valid Unicode")
    return given


def switch(name: str, value: Any) -> bool:
    """Returns a truth value of any type as a `bool`."""
    if isinstance(value, bool) or type(value).__name__ in ("bool", "bool_"):
        return bool(value)
    raise ValueError(f"`{name}` is {shown(value)}, but must be True or False")
