"""Spaces of designs: which values of which keys are solved."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from . import _native
from ._arrays import whole
from ._errors import InputError, missing

Design = dict[str, Any]
"""Values by keys, as :meth:`pneuflex.Study.set` takes them."""

Range = tuple[float, float] | list[Any]
"""(least, greatest), both included, or a list to choose from. Of what is counted, as ``actuator.chambers``, there are whole numbers between them."""


def _by_key(space: Any) -> dict[str, Any]:
    if not isinstance(space, Mapping):
        raise InputError(f"values by keys are wanted, e.g. {{'actuator.gap': [1, 1.5]}}, not {space!r:.100}")
    return dict(space)


def _is_range(least: Any, greatest: Any) -> bool:
    are_numbers = all(isinstance(x, (int, float, np.integer, np.floating)) for x in (least, greatest))
    return are_numbers and bool(-np.inf < least <= greatest < np.inf)


class Grid:
    """Every combination of values.

    >>> len(Grid({"actuator.gap": [1, 1.5, 2], "actuator.chambers": [2, 4]}).designs())
    6
    """

    def __init__(self, values: Mapping[str, Iterable[Any]]) -> None:
        self.values = {}
        for key, entries in _by_key(values).items():
            if isinstance(entries, (str, Mapping)) or not isinstance(entries, Iterable):
                raise InputError(f"{key} = {entries!r} must be a list of values")
            self.values[key] = list(entries)

    def designs(self) -> list[Design]:
        """The designs, the last key changing fastest."""
        if empty := [key for key, entries in self.values.items() if not entries]:
            raise InputError(f"the grid has no values for {', '.join(empty)}")
        return [dict(zip(self.values, row, strict=True)) for row in itertools.product(*self.values.values())]

    def __repr__(self) -> str:
        return f"Grid({self.values!r})"


class _Sampled:
    """Points of the unit cube, brought to ranges."""

    def __init__(self, ranges: Mapping[str, Range], count: int, seed: int = 0) -> None:
        self.ranges, self.count, self.seed = _by_key(ranges), whole(count, "count"), seed
        for key, entry in self.ranges.items():
            if isinstance(entry, list):
                if not entry:
                    raise InputError(f"{key}: there is nothing to choose from")
            elif not (isinstance(entry, tuple) and len(entry) == 2 and _is_range(*entry)):
                raise InputError(f"{key} = {entry!r} must be (least, greatest), or a list to choose from")
            elif _native.is_count(key) and not all(isinstance(x, (int, np.integer)) for x in entry):
                raise InputError(f"{key} = {entry!r} must be (least, greatest) of whole numbers, or a list to choose from")

    def _points(self, dimensions: int) -> Any:
        raise NotImplementedError

    def designs(self) -> list[Design]:
        """The designs, the same for the same seed."""
        points = self._points(len(self.ranges))
        columns = [_scaled(key, *pair) for key, *pair in zip(self.ranges, self.ranges.values(), points.T, strict=True)]
        return [dict(zip(self.ranges, row, strict=True)) for row in zip(*columns, strict=True)]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.ranges!r}, count={self.count}, seed={self.seed})"


def _scaled(key: str, entry: Range, column: Any) -> list[Any]:
    if isinstance(entry, list):
        return [entry[min(int(x * len(entry)), len(entry) - 1)] for x in column]
    least, greatest = entry
    if _native.is_count(key):
        return [min(int(least + x * (greatest - least + 1)), int(greatest)) for x in column]
    return [float(least + x * (greatest - least)) for x in column]


class LatinHypercube(_Sampled):
    """`count` designs of which every key has one value in each of `count` equal parts of its range (SciPy's `qmc.LatinHypercube`).

    Parameters
    ----------
    ranges
        By key ``(least, greatest)``, or a list to choose from; whole numbers of what is counted, as ``actuator.chambers``.
    count
        Number of designs.
    seed
        The same seed gives the same designs.
    """

    def _points(self, dimensions: int) -> Any:
        return _qmc("LatinHypercube").LatinHypercube(dimensions, rng=np.random.default_rng(self.seed)).random(self.count)


class Sobol(_Sampled):
    """The first `count` points of a scrambled Sobol sequence (SciPy's `qmc.Sobol`); powers of 2 are balanced best. Parameters as for
    :class:`LatinHypercube`; a larger count has the designs of a smaller one first."""

    def _points(self, dimensions: int) -> Any:
        sequence = _qmc("Sobol").Sobol(dimensions, rng=np.random.default_rng(self.seed))
        return sequence.random_base2(max(self.count - 1, 0).bit_length())[: self.count]


def _qmc(what: str) -> Any:
    try:
        from scipy.stats import qmc
    except ImportError as error:
        raise missing("scipy", what) from error
    return qmc


def designs_of(space: Any) -> list[Design]:
    """The designs of a space."""
    if isinstance(space, Mapping):
        space = Grid(space)
    if hasattr(space, "designs"):
        found: list[Design] = space.designs()
    elif hasattr(space, "to_dict") and hasattr(space, "columns"):
        found = space.to_dict("records")
    elif isinstance(space, Sequence) and not isinstance(space, str) and all(isinstance(row, Mapping) for row in space):
        found = [dict(row) for row in space]
    else:
        raise InputError(
            f"a {type(space).__name__} is no space of designs: give a Grid, a LatinHypercube, a Sobol, a table of pandas, values by "
            "keys, or a list of designs, each with values by keys"
        )
    if not found:
        raise InputError("the space has no designs")
    return found
