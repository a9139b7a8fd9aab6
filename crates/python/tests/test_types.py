"""Types and documentation of the package are whole."""

from __future__ import annotations

import importlib.util
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import pneuflex


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_types_are_strict(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path), "--config-file", "pyproject.toml"]
    environment = {"PATH": "", "MYPYPATH": str(Path(pneuflex.__file__).parents[1])}
    checked = subprocess.run(command, cwd=Path(__file__).parents[1], capture_output=True, text=True, env=environment)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_everything_public_is_documented() -> None:
    missing = []
    for name in pneuflex.__all__:
        thing = getattr(pneuflex, name)
        if not (inspect.isclass(thing) or inspect.isfunction(thing)):
            continue
        names = {name: thing}
        if inspect.isclass(thing):
            names |= {f"{name}.{key}": value for key, value in vars(thing).items() if not key.startswith("_")}
        for path, member in names.items():
            inner = getattr(member, "__func__", member)
            if (callable(inner) or isinstance(inner, property)) and not inspect.getdoc(inner):
                # Plain numbers of a state are documented together, in the class.
                if path.rsplit(".", 1)[-1] not in (inspect.getdoc(thing) or ""):
                    missing.append(path)
    assert not missing
    assert (Path(pneuflex.__file__).parent / "py.typed").exists()


def test_the_reference_is_that_of_the_docstrings() -> None:
    import reference

    assert reference.PAGE.read_text(encoding="utf-8") == reference.page(), "python tests/reference.py writes it anew"
