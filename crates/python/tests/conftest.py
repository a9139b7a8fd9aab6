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


DECK = """*INCLUDE, INPUT=nodes.inc
*ELEMENT, TYPE=C3D8, ELSET=BAR
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=FOOT
1, 2, 3, 4
*NSET, NSET=TOP
5, 6, 7, 8
*MATERIAL, NAME=SILICONE
*HYPERELASTIC, NEO HOOKE
0.1, 0.1
*SOLID SECTION, ELSET=BAR, MATERIAL=SILICONE
*BOUNDARY
FOOT, 1, 3
*STEP, NLGEOM
*STATIC
1., 1.
*BOUNDARY
TOP, 3, 3, 0.1
*END STEP
"""


def write_brick(folder: Path, height: float) -> Path:
    """A model file whose deck, a brick that is drawn, includes its nodes."""
    folder.mkdir(exist_ok=True)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    lines = [f"{4 * i + n + 1}, {x}, {y}, {i * height}" for i in (0, 1) for n, (x, y) in enumerate(corners)]
    (folder / "nodes.inc").write_text("*NODE\n" + "\n".join(lines) + "\n")
    (folder / "brick.inp").write_text(DECK)
    (folder / "brick.toml").write_text('[model]\nfile = "brick.inp"\n[load]\ntimes = [1.0]\n')
    return folder / "brick.toml"


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
