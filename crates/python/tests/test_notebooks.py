"""The notebooks of the guide run, and say what is printed in them."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from typing import Any

import pytest

import pneuflex

FOLDER = Path(__file__).parents[3] / "docs/guide/src/notebooks"

NEEDS = {
    "first-actuator": ["matplotlib"],
    "gmsh-mesh": ["gmsh", "meshio"],
    "sweep-dask": ["distributed", "pandas"],
    "optuna-walls": ["optuna"],
    "force-angle": ["matplotlib"],
    "calibration": [],
}

DEPENDS_ON_OTHERS = ("gmsh-mesh", "optuna-walls")
"""Those whose numbers are also those of a mesh generator, or of who was first."""

MOST_BYTES = 60_000


def printed(notebook: Any) -> list[str]:
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    return ["".join(o.text for o in cell.outputs if o.output_type == "stream" and o.name == "stdout") for cell in cells]


def test_there_is_a_test_of_every_notebook_and_a_link_to_it() -> None:
    names = {path.stem for path in FOLDER.glob("*.ipynb")}
    assert names == set(NEEDS)
    chapter = (FOLDER / "../python.md").read_text(encoding="utf-8")
    for name in names:
        assert f"(notebooks/{name}.ipynb)" in chapter
        assert (FOLDER / f"{name}.ipynb").stat().st_size < MOST_BYTES


@pytest.mark.parametrize("name", NEEDS)
def test_notebooks_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    for package in ["ipykernel", *NEEDS[name]]:
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"there is no {package}")
    monkeypatch.setenv("PYTHONPATH", str(Path(pneuflex.__file__).parents[1]))
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    committed = printed(notebook)
    assert any(committed), "it was not executed"
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    if name not in DEPENDS_ON_OTHERS:
        assert printed(notebook) == committed
    elif name == "optuna-walls":
        found = re.search(r"20 trials, in (\d+) of which walls touch", printed(notebook)[-1])
        assert found and int(found[1]) < 20
