"""Arrays in and out of the native part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import InputError
from ._native import Array

Floats = NDArray[np.float64]
Integers = NDArray[Any]


def floats(array: Array) -> Floats:
    """The numbers of the native part, without a copy and for reading only."""
    seen: Floats = np.asarray(array)
    return seen


def integers(array: Array) -> Integers:
    """The same for whole numbers."""
    return np.asarray(array)


def whole(value: Any, name: str, most: int | None = None) -> int:
    """A whole number from 1 on."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not 1 <= value <= (most or value):
        raise InputError(f"{name} = {value!r} must be a whole number from 1 {f'to {most}' if most else 'on'}")
    return int(value)


def positive(value: Any, name: str, unit: str = "") -> float:
    """A number greater than 0."""
    is_number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    if not is_number or not 0.0 < value < np.inf:
        raise InputError(f"{name} = {value!r} must be a number greater than 0{unit}")
    return float(value)


def array_of(values: ArrayLike, name: str) -> Integers:
    """Anything as an array."""
    try:
        return np.asarray(values)
    except (ValueError, TypeError) as error:
        raise InputError(f"{name} is no array: {error}") from error


def listed(values: ArrayLike, name: str) -> list[float]:
    """A number, or a list of numbers."""
    array = np.atleast_1d(array_of(values, name))
    if array.ndim != 1 or (array.dtype.kind not in "fiu" and array.size):
        raise InputError(f"{name} must be a list of numbers, not {array.dtype} of shape {array.shape}")
    return [float(x) for x in array]


def matrix(values: ArrayLike, columns: int, name: str) -> Floats:
    """Real numbers in rows of `columns`."""
    array = array_of(values, name)
    if array.dtype.kind not in "fiu" or array.ndim != 2 or array.shape[1] != columns:
        raise InputError(f"{name} must be numbers of shape (n, {columns}), not {array.dtype} of shape {array.shape}")
    return np.ascontiguousarray(array, dtype="<f8")


def numbers(values: ArrayLike, name: str, end: int | None = None) -> Integers:
    """Numbers of nodes or cells, from 0."""
    array = array_of(values, name)
    if array.size == 0:
        return array.astype("<u4")
    if array.dtype.kind not in "iu":
        raise InputError(f"{name} must be whole numbers, not {array.dtype}")
    least, most = int(array.min()), int(array.max())
    if least < 0 or most >= 2**32 or (end is not None and most >= end):
        bad = least if least < 0 else most
        raise InputError(f"{name} has {bad}, but numbers run from 0 to {end - 1 if end is not None else 2**32 - 1}")
    return np.ascontiguousarray(array, dtype="<u4")


def _named(sets: Mapping[str, ArrayLike] | None, name: str) -> Mapping[str, ArrayLike]:
    if sets is not None and not (isinstance(sets, Mapping) and all(isinstance(key, str) for key in sets)):
        raise InputError(f"{name} must be members by name, e.g. {{'clamp': [0, 1]}}, not {sets!r:.100}")
    return sets or {}


def members(sets: Mapping[str, ArrayLike] | None, count: int, kind: str) -> dict[str, Integers]:
    """Sets given by the numbers of their members, or by one truth value for each of `count` things."""
    found = {}
    for name, values in _named(sets, f"{kind}_sets").items():
        label = f'{kind}_sets["{name}"]'
        array = array_of(values, label)
        if array.dtype == bool:
            if array.shape != (count,):
                raise InputError(f"{label} has the shape {array.shape}, but there are {count} {kind}s")
            array = np.flatnonzero(array)
        if array.ndim != 1:
            raise InputError(f"{label} must be a list of numbers or of truth values, not of shape {array.shape}")
        found[name] = numbers(array, label, count)
    return found


def faces(sets: Mapping[str, ArrayLike] | None, nodes: int) -> dict[str, Integers]:
    """Sets of faces: rows of a cell and the number of the face in it, or of the nodes of a face; or, without rows, nodes of which all of a face
    must be there."""
    found = {}
    for name, values in _named(sets, "face_sets").items():
        label = f'face_sets["{name}"]'
        array = array_of(values, label)
        if array.dtype == bool and array.shape == (nodes,):
            array = np.flatnonzero(array)
        elif array.ndim != 2 or array.shape[1] < 2:
            raise InputError(
                f"{label} must have the shape (n, 2), cell and number of the face in it, or (n, nodes of a face), "
                f"or be a truth value for each of the {nodes} nodes, not {array.dtype} of shape {array.shape}"
            )
        found[name] = numbers(array, label)
    return found
