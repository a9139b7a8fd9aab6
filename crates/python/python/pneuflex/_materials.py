"""Constants of silicones: fits to test curves, known sets."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import array_of, positive
from ._errors import InputError


@dataclass(frozen=True)
class Silicone:
    """A known set of Yeoh constants.

    Attributes
    ----------
    name : str
        What :meth:`Study.set` and others take as a material, e.g. ``"dragon-skin-30"``.
    product : str
        The product.
    constants : dict
        C₁₀, C₂₀, C₃₀, MPa.
    range, source : str
        The test and its range; where the constants are from.
    material : dict
        As keys of ``[material]``.
    """

    name: str
    product: str
    constants: dict[str, float]
    range: str
    source: str
    material: dict[str, Any] = field(repr=False)


@cache
def _library() -> tuple[Silicone, ...]:
    found = []
    for row in json.loads(_native.materials()):
        constants = dict(zip(("c10", "c20", "c30"), row["constants"], strict=True))
        found.append(Silicone(row["identifier"], row["name"], constants, row["range"], row["source"], row["material"]))
    return tuple(found)


def materials(name: str | None = None) -> dict[str, Silicone]:
    """Known silicones by name. Published sets for one product differ by a factor of two (batch, curing, strain rate, first or later loading,
    range of the fit): test your own batch and :func:`fit` it if it matters.

    Parameters
    ----------
    name
        Only those whose name has this in it.
    """
    if not isinstance(name, str | None):
        raise InputError(f"name = {name!r} must be a text, or left out")
    wanted = _bare(name or "")
    return {entry.name: entry for entry in _library() if wanted in _bare(entry.name)}


def _in_python(note: str) -> str:
    """A note of the library with arguments of :func:`fit` in the place of the program's options."""
    options = {
        "--keep-offset": "keep_offset=True",
        "--keep-break": "keep_break=True",
        "--cycles first, last or all": 'cycles="first", "last" or "all"',
    }
    for option, argument in options.items():
        note = note.replace(option, argument)
    return note


def _bare(name: str) -> str:
    return "".join(filter(str.isalnum, name.lower()))


def _rounded(value: float) -> float:
    return float(f"{value:.5e}")


def as_material(material: Any) -> Any:
    """Keys of ``[material]``: of a known silicone, of a fit, or as they are."""
    if isinstance(material, (Silicone, Fit)):
        return dict(material.material)
    if not isinstance(material, str):
        return material
    for entry in _library():
        if entry.name == material:
            return dict(entry.material)
    like = list(materials(material)) if _bare(material) else []
    help = f"did you mean {', '.join(like)}?" if like else "pneuflex.materials() lists all"
    raise InputError(f'no material "{material}" is known\n  help: {help}')


@dataclass(frozen=True)
class Fit:
    """Constants of a law, fitted to test curves.

    Attributes
    ----------
    law : str
        ``yeoh``, ``neo-hooke``, ``mooney-rivlin``, ``ogden`` or ``gent``.
    constants : dict
        Moduli, MPa; Ogden's exponents and Gent's J_m are in `material`.
    confidence_95 : dict
        Intervals of 95 %, MPa, for independent residuals (which those of a smooth curve are not: they are too narrow); None where there are
        as many constants as points, or none are known.
    r_squared : float or None
        Coefficient of determination of all tests together.
    is_stable : bool
        Whether the law is stable (Drucker) over the range of the tests.
    largest_error : float
        Largest relative error of a stress from 10 % strain on, in the range that was fitted; above 0.1 the law does not follow the curves.
    material : dict
        As keys of ``[material]``: ``case.set({"material": fit})``.
    notes : list of str
        What was left out of the curves, and how files were understood.
    details : dict
        Everything, as in the program's `fit.json`.
    """

    law: str
    constants: dict[str, float]
    confidence_95: dict[str, tuple[float, float] | None]
    r_squared: float | None
    is_stable: bool
    largest_error: float
    material: dict[str, Any]
    notes: list[str] = field(repr=False)
    details: dict[str, Any] = field(repr=False)


def _weights(weights: Mapping[str, float], kinds: set[str]) -> dict[str, float]:
    """Weights by the kinds of test that there are."""
    found: dict[str, float] = {}
    for name, weight in weights.items():
        kind = _native.test_kind(str(name))
        if kind not in kinds or kind in found:
            why = "there are two" if kind in found else f"no curve is {kind}; there are {', '.join(sorted(kinds))}"
            raise InputError(f'weights["{name}"]: {why}')
        found[kind] = positive(weight, f'weights["{name}"]')
    return found


def fit(
    *curves: str | os.PathLike[str] | tuple[str, ArrayLike, ArrayLike],
    law: str = "yeoh",
    terms: int | None = None,
    from_stretch: float = 0.0,
    to_stretch: float | None = None,
    stable: bool | float = False,
    residuals: str = "relative",
    cycles: str = "last",
    keep_break: bool = False,
    keep_offset: bool = False,
    weights: Mapping[str, float] | None = None,
    bulk_ratio: float | None = None,
    test: str | None = None,
    columns: str | None = None,
    unit: str | None = None,
    strain: str | None = None,
    stress: str | None = None,
    decimal: str | None = None,
    area: float | None = None,
    length: float | None = None,
) -> Fit:
    """Fits a hyperelastic law to curves of material tests.

    Parameters
    ----------
    curves
        Files (CSV), or tuples of the kind of test (``"uniaxial"``, ``"equibiaxial"``, ``"planar"`` or ``"pure shear"``), stretches, shape
        (n,), and nominal stresses (force per area at rest), MPa, shape (n,).
    law
        ``yeoh``, ``neo-hooke``, ``mooney-rivlin``, ``ogden``, whose exponents are fitted, too, or ``gent``.
    terms
        Of a Yeoh law 2 or 3 (the default), of an Ogden law 1 to 3 (as many as are worth it, if left out).
    from_stretch, to_stretch
        Range that is fitted. Without `to_stretch` it ends where the law cannot follow the curves any more within 10 % of the stress at every
        strain from 10 % on: a fit up to the break is ruled by stresses that no actuator sees. `math.inf` fits all.
    stable
        True: only constants that are stable (Drucker) in every deformation up to the largest I₁ − 3 of the points; a number: up to that one.
    residuals
        ``relative`` to the stress, each part of the logarithm of the strain counting alike, or ``absolute``, which the largest stresses rule.
    cycles
        Which loading of a cyclic test: ``last``, ``first`` or ``all``.
    keep_break
        Whether rows after the largest stress of a broken specimen are kept.
    keep_offset
        Whether a stress at stretch 1 is kept in all others, from which it is taken otherwise, and strains without stress in theirs.
    weights
        By kind of test, e.g. ``{"planar": 2}``; each counts once otherwise, however many points it has.
    bulk_ratio
        Bulk modulus over initial shear modulus, which is no result of such tests; if left out 1000, or what keeps the volume to 0.5 % at
        their largest stress.
    test, columns, unit, strain, stress, decimal
        What files do not say, as the options of `pneuflex fit`: kind of test; columns such as ``"strain=2,stress=5"``; unit of stresses;
        measure of strain (``stretch``, ``engineering``, ``percent``, ``true``) and of stress (``nominal``, ``true``); ``point`` or ``comma``.
    area, length
        Undeformed area, mm², and length, mm, of the specimen, for files of force and change of length.

    Raises
    ------
    InputError
        Files that are not understood, too few points, constants that no case could use.
    """
    if not curves:
        raise InputError("give at least one curve: a file, or (test, stretches, stresses)")
    if residuals not in ("absolute", "relative"):
        raise InputError(f'residuals = "{residuals}" must be absolute or relative')
    bulk_ratio = None if bulk_ratio is None else positive(bulk_ratio, "bulk_ratio")
    if not isinstance(law, str):
        raise InputError(f"law = {law!r} must be yeoh, neo-hooke, mooney-rivlin, ogden or gent")
    if terms is not None and (isinstance(terms, bool) or not isinstance(terms, int) or not 1 <= terms <= 3):
        raise InputError(f"terms = {terms!r} must be 1, 2 or 3, or left out")
    for name, stretch in (("from_stretch", from_stretch), ("to_stretch", to_stretch)):
        if stretch is not None and not isinstance(stretch, (int, float)):
            raise InputError(f"{name} = {stretch!r} must be a stretch, the length over the length at rest")
    if to_stretch is not None and not from_stretch < to_stretch:
        raise InputError(f"from_stretch = {from_stretch} must be less than to_stretch = {to_stretch}")
    if weights is not None and not isinstance(weights, Mapping):
        raise InputError(f"weights must be numbers by kind of test, e.g. {{'planar': 2}}, not {weights!r:.100}")
    if (area is None) != (length is None):
        raise InputError("give both area and length of the specimen, or neither")
    specimen = (positive(area, "area", " mm2"), positive(length, "length", " mm")) if area is not None and length is not None else None
    if specimen is not None and not all(1e-6 <= size <= 1e9 for size in specimen):
        raise InputError(f"area = {area} mm2 and length = {length} mm must be from 1e-6 to 1e9")
    read: list[tuple[str, str, list[float], list[float]]] = []
    notes: list[str] = []
    for number, curve in enumerate(curves):
        if isinstance(curve, tuple):
            if len(curve) != 3 or not isinstance(curve[0], str):
                raise InputError(f"curve {number}: (kind of test, stretches, stresses) is wanted, not {curve!r:.100}")
            kind = _native.test_kind(curve[0])
            x, y = (array_of(values, f"curve {number}") for values in curve[1:])
            if x.dtype.kind not in "fiu" or y.dtype.kind not in "fiu":
                raise InputError(f"curve {number}: stretches and stresses are numbers, not {x.dtype} and {y.dtype}")
            if x.shape != y.shape or x.ndim != 1:
                raise InputError(f"curve {number}: stretches and stresses have the shapes {x.shape} and {y.shape}")
            if not (np.isfinite(x).all() and np.isfinite(y).all()):
                raise InputError(f"curve {number}: not all stretches and stresses are finite")
            if (x <= 0).any():
                raise InputError(f"curve {number}: a stretch is the length over the length at rest, greater than 0")
            read.append((f"curve {number} {kind}", kind, x.tolist(), y.tolist()))
        elif not isinstance(curve, (str, os.PathLike)):
            raise InputError(f"curve {number}: a file or (kind of test, stretches, stresses) is wanted, not {curve!r:.100}")
        else:
            found, understood = _native.read_curves(curve, test, columns, unit, strain, stress, decimal, specimen)
            notes += understood
            read += [(f"{os.fspath(curve)} {kind}", kind, x_, y_) for kind, x_, y_ in found]
    by_kind = _weights(weights or {}, {row[1] for row in read})
    weighted = [(*row, by_kind.get(row[1], 1.0)) for row in read]
    bound = None if isinstance(stable, bool) else positive(stable, "stable")
    range = (from_stretch, to_stretch)
    is_relative = residuals == "relative"
    text = _native.fit(
        weighted, law, terms, range, cycles, keep_break, keep_offset, is_relative, bound, stable is not False
    )
    found_fit: dict[str, Any] = json.loads(text)
    details = found_fit["fit"]
    constants = {constant["name"].lower(): float(constant["value"]) for constant in details["constants"]}
    intervals = {
        constant["name"].lower(): tuple(constant["confidence_95"]) if constant.get("confidence_95") else None
        for constant in details["constants"]
    }
    material = dict(found_fit["material"])
    bulk = material["bulk_modulus"] if bulk_ratio is None else bulk_ratio * details["shear_modulus_mpa"]
    material["bulk_modulus"] = _rounded(bulk)
    material["invariant"] = "isochoric"
    return Fit(
        material["law"],
        constants,
        intervals,
        details["total"].get("r_squared"),
        details["is_stable_in_range"],
        max((abs(band["largest_error"]) for bands in details["bands"] for band in bands), default=0.0),
        material,
        notes + [_in_python(note) for note in found_fit["notes"]],
        details,
    )
