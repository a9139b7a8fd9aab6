"""Results for other programs, and beside measurements."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

import pneuflex


@pytest.fixture(scope="module")
def solved() -> pneuflex.Result:
    """Two chambers, not recorded anywhere."""
    arguments = {"pressures": [1, 2], "mesh": {"size": 3, "element": "hex8-q1p0"}}
    return pneuflex.Case.actuator(2, **arguments).solve()  # type: ignore[arg-type]


def test_results_leave_in_formats_of_others(solved: pneuflex.Result, tmp_path: Path) -> None:
    [file] = solved.export("npz", tmp_path / "a.npz")
    with np.load(file) as arrays:
        assert np.allclose(arrays["displacement"][-1], solved[-1].displacement)
    assert len(solved.export("mould", tmp_path / "mould", wall=3.0)) == 3
    with pytest.raises(pneuflex.InputError, match="`at` means nothing to the format `npz`"):
        solved.export("npz", tmp_path / "b.npz", at=1.0)
    with pytest.raises(pneuflex.InputError, match="allowed: von-mises"):
        solved.export("glb", tmp_path / "b.glb", colour="blue")
    with pytest.raises(pneuflex.InputError, match="allowed: stl"):
        solved.export("step", tmp_path / "b.step")


def test_a_film_by_ffmpeg(solved: pneuflex.Result, tmp_path: Path) -> None:
    if shutil.which("ffmpeg") is None:
        pytest.skip("the program ffmpeg is not installed")
    [file] = solved.export("mp4", tmp_path / "a.mp4", pictures=3, width=200)
    assert file.read_bytes()[4:8] == b"ftyp"


def test_mujoco_loads_the_mesh(solved: pneuflex.Result, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco", reason="the package mujoco is not installed")
    solved.export("msh", tmp_path / "body.msh")
    flex = '<flexcomp name="body" type="gmsh" file="body.msh" dim="3" scale="0.001 0.001 0.001" mass="0.03"/>'
    (tmp_path / "scene.xml").write_text(f"<mujoco><worldbody>{flex}</worldbody></mujoco>")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "scene.xml"))
    assert model.nflex == 1 and model.flex_dim[0] == 3
    # The corners of the elements of the whole body: both halves, the nodes between them once.
    points = solved[-1].points
    between = int((np.abs(points[:, 1]) < 1e-9).sum())
    assert model.flex_vertnum[0] == 2 * len(points) - between


def test_measurements_that_are_the_result_are_no_distance_from_it(solved: pneuflex.Result, tmp_path: Path) -> None:
    noise = 0.1 * np.array([1.0, -1.0])
    rows = [f"{p},{angle + e}" for p, angle, e in zip(solved.pressure_kpa, solved.end_face_angle_deg, noise, strict=True)]
    table = tmp_path / "measured.csv"
    table.write_text("pressure_kpa,end_face_angle_deg\n" + "\n".join(rows) + "\n")
    found = solved.compare(table)
    [angles] = found["kinds"]
    assert angles["of"] == "end_face_angle_deg" and angles["rms"] == pytest.approx(0.1, rel=1e-6)
    assert found["picture"].startswith("<svg")
    with pytest.raises(pneuflex.InputError, match="allowed: bottom, outline"):
        solved.compare(table, line="top")
