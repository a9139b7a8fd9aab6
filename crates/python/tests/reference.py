"""Writes the reference of the package, docs/guide/src/python-reference.md, from its docstrings: `python tests/reference.py`."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

import pneuflex

PAGE = Path(__file__).parents[3] / "docs/guide/src/python-reference.md"

SECTIONS = ("Parameters", "Attributes", "Returns", "Raises")

HEAD = """# Reference of the Python package

Written from the package's docstrings by `crates/python/tests/reference.py`. Lengths are in mm, forces in N, stresses in MPa, air pressures in
kPa, angles in degrees; arrays are numpy's.
"""


def markdown(text: str) -> str:
    """A docstring in numpy's form as Markdown."""
    text = re.sub(r":(?:class|meth|func|attr):`~?([^`]*)`", r"`\1`", text).replace("``", "`")
    lines: list[str] = []
    section = ""
    rows = text.splitlines()
    for i, line in enumerate(rows):
        below = rows[i + 1] if i + 1 < len(rows) else ""
        if line in SECTIONS and set(below) == {"-"}:
            section = line
            lines += [f"*{line}*", ""]
        elif section and set(line) == {"-"}:
            continue
        elif section and line and not line.startswith(" "):
            names = ", ".join(f"`{name}`" for name in line.split(" : ")[0].split(", "))
            kind = line.split(" : ")[1:]
            lines.append(f"* {names}{f' ({kind[0]})' if kind else ''}:")
        elif section and line:
            lines.append(f"  {line.strip()}")
        else:
            lines.append(line)
    return "\n".join(lines).strip()


def examples(text: str) -> str:
    """Examples of a docstring as blocks of code."""
    found, code = [], False
    for line in text.splitlines():
        is_code = line.strip().startswith((">>>", "...")) or (code and bool(line.strip()))
        if is_code != code:
            found.append("```text" if is_code else "```")
            code = is_code
        found.append(line)
    return "\n".join([*found, "```"] if code else found)


def signature(name: str, thing: Any) -> str:
    """A call as it is written, one line for each argument if there are many."""
    parameters = [p for p in inspect.signature(thing).parameters.values() if p.name not in ("self", "cls")]
    words: list[str] = []
    for i, parameter in enumerate(parameters):
        is_first = parameter.kind is parameter.KEYWORD_ONLY and all(p.kind is not p.KEYWORD_ONLY for p in parameters[:i])
        if is_first and not any(p.kind is p.VAR_POSITIONAL for p in parameters[:i]):
            words.append("*")
        words.append(re.sub(r": '([^']*)'", r": \1", str(parameter)))
    line = f"{name}({', '.join(words)})"
    return line if len(line) <= 110 else f"{name}(\n    " + ",\n    ".join(words) + ",\n)"


def entry(level: int, name: str, thing: Any, *, is_property: bool = False) -> list[str]:
    """What is said of a thing."""
    doc = inspect.getdoc(thing)
    assert doc, name
    call = [] if is_property else ["```text", signature(name, thing), "```", ""]
    return [f"{'#' * level} `{name}`", "", *call, examples(markdown(doc)), ""]


def page() -> str:
    """The whole reference."""
    lines = [HEAD]
    for name in sorted(pneuflex.__all__, key=str.lower):
        thing = getattr(pneuflex, name)
        if inspect.isfunction(thing):
            lines += entry(2, name, thing)
        elif inspect.isclass(thing):
            base = thing.__mro__[1].__name__
            words = f"A `{base}`.\n\n" if issubclass(thing, BaseException) or base == "Study" else ""
            lines += [f"## `{name}`", "", words + examples(markdown(inspect.getdoc(thing) or "")), ""]
            for key, member in vars(thing).items():
                inner = getattr(member, "__func__", member)
                if key.startswith("_") or not inspect.getdoc(inner):
                    continue
                if isinstance(inner, property):
                    lines += entry(3, f"{name}.{key}", inner, is_property=True)
                elif inspect.isfunction(inner):
                    lines += entry(3, f"{name}.{key}", inner)
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
