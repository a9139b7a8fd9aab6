"""What the tests have in common: small cases, and one of each that is solved."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import pneuflex

FIXTURES = Path(__file__).parents[3] / "fixtures"

SMALL = {"size": 3, "element": "hex8-q1p0"}


def small_case(**keys: object) -> pneuflex.Case:
    """Two chambers on a mesh that is solved in no time."""
    arguments: dict[str, object] = {"flange": 0, "pressures": [1, 2, 3], "mesh": SMALL, **keys}
    return pneuflex.Case.actuator(2, **arguments)  # type: ignore[arg-type]


@pytest.fixture
def small() -> pneuflex.Case:
    return small_case()


@pytest.fixture(scope="session")
def solved() -> pneuflex.Result:
    return small_case().solve(threads=1)


@pytest.fixture(scope="session")
def program() -> str:
    """The command line program."""
    path = os.environ.get("PNEUFLEX_PROGRAM")
    if not path or not os.path.exists(path):
        pytest.skip("PNEUFLEX_PROGRAM names no program")
    return os.path.abspath(path)
