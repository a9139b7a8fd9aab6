"""Fits and known silicones."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import FIXTURES, small_case

import pneuflex
from pneuflex import InputError

CURVE = FIXTURES / "curves/dragon_skin_30.csv"


@pytest.mark.parametrize("to_stretch", [None, 4.0])
def test_a_fit_is_that_of_the_program(program: str, tmp_path: Path, to_stretch: float | None) -> None:
    fit = pneuflex.fit(CURVE, to_stretch=to_stretch)
    options = [] if to_stretch is None else ["--to", str(to_stretch)]
    subprocess.run([program, "fit", str(CURVE), *options, "--out", str(tmp_path), "--quiet"], check=True)
    theirs = json.loads((tmp_path / "fit.json").read_text())
    law = next(law for law in theirs["laws"] if law["law"] == fit.details["law"])
    assert [constant["value"] for constant in law["constants"]] == list(fit.constants.values())
    errors = [abs(band["largest_error"]) for bands in law["bands"] for band in bands]
    assert fit.largest_error == max(errors) and (to_stretch is not None or fit.largest_error <= 0.1)
    assert fit.r_squared == law["total"]["r_squared"] and fit.is_stable == law["is_stable_in_range"]
    case = small_case().set({"material": fit})
    assert case["material.c10"] == fit.constants["c10"] and case["material.bulk_modulus"] == fit.material["bulk_modulus"]


def test_points_of_a_law_give_its_constants_back() -> None:
    stretch = np.linspace(1.05, 2.5, 30)
    uniaxial = 2 * 0.1 * (stretch - stretch**-2)
    planar = 2 * 0.1 * (stretch - stretch**-3)
    fit = pneuflex.fit(("uniaxial", stretch, uniaxial), ("planar", stretch, planar), law="neo-hooke")
    assert np.isclose(fit.constants["c10"], 0.1, rtol=1e-9) and np.isclose(fit.r_squared or 0, 1)
    assert fit.law == "neo-hooke" and fit.material["law"] == "neo-hooke"


def test_weights_are_by_kinds_of_test_under_any_of_their_names() -> None:
    stretch = np.linspace(1.05, 2.5, 30)
    curves = [("uniaxial", stretch, 0.2 * (stretch - stretch**-2)), ("pure shear", stretch, 0.3 * (stretch - stretch**-3))]
    of = lambda **more: pneuflex.fit(*curves, law="neo-hooke", to_stretch=2.0, **more).constants["c10"]  # noqa: E731
    assert of(weights={"planar": 5.0}) == of(weights={"pure shear": 5.0}) > of() > of(weights={"uniaxial": 5})
    for weights, match in [
        ({"plannar": 5.0}, "no kind of test: it must be uniaxial, equibiaxial or planar"),
        ({"equibiaxial": 5.0}, "no curve is equibiaxial; there are planar, uniaxial"),
        ({"planar": 1.0, "pure shear": 2.0}, "there are two"),
        ({"planar": "x"}, "greater than 0"),
        ({"planar": 0}, "greater than 0"),
        (5, "by kind of test"),
    ]:
        with pytest.raises(InputError, match=match):
            of(weights=weights)


def test_ogdens_exponents_are_fitted() -> None:
    fit = pneuflex.fit(CURVE, law="ogden")
    assert fit.law == "ogden" and fit.largest_error < 0.1
    assert small_case().set({"material": fit}).check().unknowns


def test_bad_fits_are_refused() -> None:
    good = np.linspace(1.1, 2, 9)
    for arguments, keys, match in [
        ((), {}, "at least one"),
        ((CURVE,), {"law": "arruda-boyce"}, "yeoh, neo-hooke, mooney-rivlin, ogden or gent"),
        ((CURVE,), {"law": "gent", "terms": 2}, "terms: yeoh has 2 or 3, ogden 1 to 3"),
        ((CURVE,), {"to_stretch": 1.0}, "left to fit"),
        ((CURVE,), {"residuals": "x"}, "absolute or relative"),
        ((CURVE,), {"cycles": "x"}, "last, first or all"),
        ((CURVE,), {"area": 12.0}, "both area and length"),
        ((CURVE,), {"area": 12.0, "length": "x"}, "length = 'x'"),
        ((CURVE,), {"bulk_ratio": -1}, "bulk_ratio = -1 must be a number greater than 0"),
        ((3,), {}, "curve 0: a file or"),
        ((("uniaxial", good),), {}, "curve 0: .kind of test, stretches, stresses. is wanted"),
        ((("shear", good, good),), {}, "uniaxial, equibiaxial or planar"),
        ((("uniaxial", good, good[1:]),), {}, "shapes"),
        ((("uniaxial", good, -good),), {}, "cannot be used|stable"),
        ((("uniaxial", good - 2, good),), {}, "greater than 0"),
    ]:
        with pytest.raises(InputError, match=match):
            pneuflex.fit(*arguments, **keys)  # type: ignore[arg-type]


def test_known_silicones_are_materials() -> None:
    found = pneuflex.materials("ecoflex")
    assert found and all("ecoflex" in name for name in found)
    entry = next(iter(found.values()))
    assert entry.source and small_case().set({"material": entry})["material.c10"] == entry.constants["c10"]
