"""The Python of the guide and of the READMEs runs."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest

COARSE = 'mesh={"size": 3, "element": "hex8-q1p0"}'
"""In the place of the coarsest mesh for people, to be quick."""

ROOT = Path(__file__).parents[3]


def blocks(path: Path) -> list[tuple[int, list[str], str]]:
    """Line, words behind the fence and text of every block of Python."""
    text = path.read_text(encoding="utf-8")
    found = re.finditer(r"^```python([^\n]*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return [(text[: m.start()].count("\n") + 2, m[1].split(), m[2]) for m in found]


@pytest.mark.parametrize("name", ["docs/guide/src/python.md", "README.md", "crates/python/README.md"])
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    space: dict[str, object] = {"__name__": "guide"}
    done = 0
    for line, words, text in blocks(ROOT / name):
        if "by-hand" in words:
            continue
        needs = [package for word in words if word.startswith("needs=") for package in word[6:].split(",")]
        if any(importlib.util.find_spec(package) is None for package in needs):
            continue
        # Lines of messages are those of the page.
        text = "\n" * (line - 1) + text.replace('mesh="draft"', COARSE)
        exec(compile(text, name, "exec"), space)
        done += 1
    assert done
