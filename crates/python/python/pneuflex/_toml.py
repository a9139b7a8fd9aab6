"""Values of keys as TOML."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np


def to_toml(value: Any, key: str = "") -> str:
    """A value as TOML: numbers, texts, booleans, lists and tables of these, numpy's among them."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, np.ndarray):
        value = value.tolist()
    match value:
        case bool():
            return "true" if value else "false"
        case int():
            return str(value)
        case float():
            if math.isnan(value):
                return "nan"
            return repr(value) if math.isfinite(value) else ("inf" if value > 0 else "-inf")
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case os.PathLike():
            return to_toml(os.fspath(value), key)
        case Mapping():
            pairs = (f"{_name(name)} = {to_toml(entry, f'{key}.{name}')}" for name, entry in value.items() if entry is not None)
            return "{" + ", ".join(pairs) + "}"
        case list() | tuple() | range():
            return "[" + ", ".join(to_toml(entry, f"{key}[{i}]") for i, entry in enumerate(value)) + "]"
    raise TypeError(f"{key}: a {type(value).__name__} is no value of a key")


def _name(name: object) -> str:
    if not isinstance(name, str):
        raise TypeError(f"names of keys are texts, not {name!r}")
    bare = name.isascii() and name.replace("-", "").replace("_", "").isalnum()
    return name if bare else to_toml(name)


def flat(keys: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Keys such as ``actuator.gap`` with their values as TOML; a table stands for its keys."""
    found: list[tuple[str, str]] = []
    for key, value in keys.items():
        if not isinstance(key, str):
            raise TypeError(f"names of keys are texts, not {key!r}")
        if isinstance(value, Mapping) and key.count(".") == 0 and key in TABLES:
            found += flat({f"{key}.{name}": entry for name, entry in value.items() if entry is not None})
        else:
            found.append((key, to_toml(value, key)))
    return found


TABLES = ("actuator", "mesh", "contact", "load", "solver", "output", "model")
"""Tables of which the keys that are given are set, and the others keep their values; a material is replaced as a whole."""

PER_CHAMBER = (
    "actuator.chamber_length",
    "actuator.cavity_length",
    "actuator.gap",
    "actuator.side_wall",
    "actuator.top_wall",
    "load.chamber_factor",
)
"""Keys that may have an entry for every chamber, such as ``actuator.gap[3]``."""
