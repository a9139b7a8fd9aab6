"""Bodies from arrays, meshio and PyVista."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from conftest import FIXTURES, write_brick

from pneuflex import Case, InputError, Model

# A plate of 4 x 1 hexahedra, 8 mm x 2 mm x 1 mm, whose nodes are numbered as a lattice's.
NODES = np.array([[2.0 * (n // 4), 2.0 * (n // 2 % 2), n % 2] for n in range(20)])
CELLS = np.array([[4 * i + n for n in (0, 4, 6, 2, 1, 5, 7, 3)] for i in range(4)])


def plate(**arguments: Any) -> Model:
    given: dict[str, Any] = {
        "material": {"law": "neo-hooke", "c10": 0.1},
        "node_sets": {"clamp": NODES[:, 0] == 0},
        "face_sets": {"bottom": NODES[:, 2] == 0},
        "supports": [{"nodes": "clamp", "axes": "xyz"}],
        "pressures": [{"faces": "bottom", "pressure_kpa": 0.5}],
        "probes": [{"name": "tip", "at": [8, 0, 0]}],
        "times": [0.5, 1.0],
    }
    return Model.from_arrays(NODES, CELLS, **given | arguments)


def test_a_body_from_arrays_is_solved_and_kept(tmp_path: Any) -> None:
    model = plate()
    result = model.solve(threads=1)
    assert result.time.tolist() == [0.5, 1.0] and result.probes["tip"].shape == (2, 3) and result.tip[-1, 2] > 0.1
    assert np.array_equal(result[0].points, NODES) and np.isnan(result.end_face_angle_deg).all()
    assert set(result.reactions) == {"clamp"}
    again = pickle.loads(pickle.dumps(model)).solve(threads=1)
    assert np.array_equal(again[-1].displacement, result[-1].displacement)
    opened = type(result).open(result.save(tmp_path / "plate"))
    assert np.array_equal(opened[-1].points, NODES) and np.array_equal(opened.tip, result.tip)
    # Its load grows up to the last time: at the time 1 there would be half of it if the last time were 2.
    for kept in (opened, result):
        with pytest.raises(InputError, match="other loads"):
            kept.resume(times=[2.0], threads=1)
    given = plate(pressures=[{"faces": "bottom", "pressure_kpa": [[0, 0], [2, 1.0]]}])
    further = given.solve(threads=1).resume(times=[2.0], threads=1)
    straight = given.solve(times=[0.5, 1.0, 2.0], threads=1)
    assert further.time.tolist() == [0.5, 1.0, 2.0] and np.allclose(further.tip, straight.tip, rtol=1e-6)
    assert repr(model) == "Model('model', 20 nodes, hex8-q1p0)"


def test_sets_of_faces_may_be_given_in_three_ways() -> None:
    wanted = plate().check().face_sets["bottom"]
    bottom = CELLS[:, [0, 1, 2, 3]]
    assert len(wanted) == 4
    for given in (wanted, bottom, bottom[:, ::-1], NODES[:, 2] == 0):
        assert np.array_equal(plate(face_sets={"bottom": given}).check().face_sets["bottom"], wanted)


def test_a_node_of_no_cell_is_named() -> None:
    nodes = np.vstack([NODES, [30.0, 0, 0]])
    with pytest.raises(InputError, match=r"node 20 at \[30.0, 0.0, 0.0\] mm belongs to no cell and to no set"):
        Model.from_arrays(nodes, CELLS, material={"law": "neo-hooke", "c10": 0.1}, times=[1.0])


def test_bad_arrays_are_refused() -> None:
    def bad(match: str, **arguments: Any) -> None:
        with pytest.raises(InputError, match=match):
            plate(**arguments).check()

    bad(r'node_sets\["clamp"\] has 20', node_sets={"clamp": [0, 20]})
    bad(r'node_sets\["clamp"\] has the shape', node_sets={"clamp": np.ones(19, bool)})
    bad("whole numbers", node_sets={"clamp": [0.5]})
    bad("cell 1 has no face 6", face_sets={"bottom": [[1, 6]]})
    bad("cell 4 has no face 0", face_sets={"bottom": [[4, 0]]})
    bad("row 0 has not the nodes of a face", face_sets={"bottom": [[0, 1, 2, 7]]})
    bad("must have the shape", face_sets={"bottom": [1, 2]})
    bad("set .* clamp|clamp", supports=[{"nodes": "clmap", "axes": "xyz"}])
    bad("did you mean `axes`", supports=[{"nodes": "clamp", "axis": "xyz"}])
    bad("hold", supports=[])
    bad("members by name", node_sets=[0, 1])
    bad("a list of tables is wanted", supports={"nodes": "clamp", "axes": "xyz"})
    bad("must be one of hex8-sri, hex8-q1p0", element="hex9")
    bad('"tet10" has 10 nodes, but cells have 8', element="tet10")
    bad("element = 5 must be a text", element=5)
    bad("supports: a list of tables", supports=3)
    bad("is no array", node_sets={"clamp": [[0], [1, 2]]})
    for scale in ("m", 0, -1, np.nan, None):
        bad("scale = .* must be a number greater than 0", scale=scale)
    for nodes, cells, match in [
        (NODES[:, :2], CELLS, r"shape \(n, 3\)"),
        (NODES, CELLS[:, :4], "nodes in the middle of the edges"),
        (NODES, CELLS + 1, "has 20"),
        (NODES, CELLS.astype(float), "whole numbers"),
        (NODES * np.nan, CELLS, "not finite"),
        (NODES, CELLS[:0], "no cells"),
        (NODES.astype(str), CELLS, "numbers"),
    ]:
        with pytest.raises(InputError, match=match):
            Model.from_arrays(nodes, cells)
    many = np.repeat(CELLS, 5, axis=0)
    with pytest.raises(InputError, match='"tet10" has 10 nodes, but cells have 8'):
        Model.from_arrays(NODES, many, element="tet10")
    # A cell that is inside out, and one without volume.
    for cells in (CELLS[:, [4, 5, 6, 7, 0, 1, 2, 3]], CELLS[:, [0, 0, 0, 0, 1, 1, 1, 1]]):
        with pytest.raises((InputError, RuntimeError)):
            model = Model.from_arrays(NODES, cells, node_sets={"clamp": [0, 1, 2, 3]}, times=[1.0])
            model.set({"support": [{"nodes": "clamp", "axes": "xyz"}]}).solve()


@pytest.mark.parametrize("element, stable", [("tet10", "tet15"), ("hex20", "hex27")])
def test_elements_whose_pressures_are_not_stable_are_given_nodes(element: str, stable: str) -> None:
    mesh = Case.actuator(1, mesh={"size": 6, "element": element}).check()
    cells = mesh.connectivity.reshape(mesh.cells, -1)
    of = lambda **more: Model.from_arrays(  # noqa: E731
        mesh.points,
        cells,
        material="dragon-skin-30",
        node_sets={"all": np.arange(mesh.nodes)},
        supports=[{"nodes": "all", "axes": "xyz"}],
        times=[1.0],
        **more,
    ).check()
    for check in (of(), of(element=stable)):
        assert check.element == stable and check.nodes > mesh.nodes
        assert np.array_equal(check.points[: mesh.nodes], mesh.points)
    assert of(element=element).element == element and of(element=element).nodes == mesh.nodes


def test_models_and_decks_are_read() -> None:
    model = Model.load(FIXTURES / "models/gripper.toml")
    assert "obstacle" in model.values
    with pytest.raises(InputError, match=r"Case.load"):
        Model.load(FIXTURES / "two_chamber.toml")
    decks = sorted((FIXTURES / "models").glob("*.inp")) or sorted(FIXTURES.rglob("*.inp"))
    deck = Model.load(decks[0])
    assert deck.values == {} and decks[0].name in repr(deck)
    with pytest.raises(InputError, match="no keys"):
        deck.set({"title": "x"})


def test_meshes_of_meshio_are_taken_as_they_are() -> None:
    meshio = pytest.importorskip("meshio")
    # A point of the geometry that no cell has comes first, as Gmsh writes it.
    points = np.vstack([[[9.0, 9.0, 9.0]], NODES])
    mesh = meshio.Mesh(
        points,
        [("quad", CELLS[:, [0, 1, 2, 3]] + 1), ("hexahedron", CELLS[:2] + 1), ("hexahedron", CELLS[2:] + 1)],
        point_sets={"clamp": np.flatnonzero(points[:, 0] == 0)},
        cell_data={"gmsh:physical": [np.full(4, 7), np.full(2, 8), np.full(2, 9)]},
        field_data={"bottom": np.array([7, 2]), "soft": np.array([9, 3])},
    )
    arguments: dict[str, Any] = {
        "supports": [{"nodes": "clamp", "axes": "xyz"}],
        "pressures": [{"faces": "bottom", "pressure_kpa": 0.5}],
        "material": {"law": "neo-hooke", "c10": 0.1},
        "times": [1.0],
    }
    model = Model.from_mesh(mesh, **arguments)
    check = model.check()
    assert check.cell_sets["soft"].tolist() == [2, 3] and len(check.face_sets["bottom"]) == 4
    result = model.solve(threads=1)
    assert np.allclose(result[-1].displacement, plate(times=[1.0]).solve(threads=1)[-1].displacement, atol=1e-14)
    with pytest.raises(InputError, match="tetra cannot be solved"):
        Model.from_mesh(meshio.Mesh(NODES, [("tetra", [[0, 1, 2, 4]])]))
    with pytest.raises(InputError, match="no solid cells"):
        Model.from_mesh(meshio.Mesh(NODES, [("quad", CELLS[:, :4])]))


def test_meshes_of_pyvista_are_taken_as_they_are() -> None:
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: CELLS}, NODES)
    grid.point_data["clamp"] = NODES[:, 0] == 0
    grid.cell_data["soft"] = np.array([False, False, True, True])
    check = Model.from_mesh(
        grid,
        face_sets={"bottom": NODES[:, 2] == 0},
        supports=[{"nodes": "clamp", "axes": "xyz"}],
        material={"law": "neo-hooke", "c10": 0.1},
        regions=[{"name": "soft", "elements": "soft", "material": "dragon-skin-30"}],
        times=[1.0],
    ).check()
    assert check.cell_sets["soft"].tolist() == [2, 3] and len(check.node_sets["clamp"]) == 4
    with pytest.raises(InputError, match="tetra cannot be solved"):
        Model.from_mesh(pyvista.UnstructuredGrid({pyvista.CellType.TETRA: np.array([[0, 1, 2, 4]])}, NODES))
    with pytest.raises(InputError, match="neither"):
        Model.from_mesh("mesh.vtu")


@pytest.mark.parametrize("element, kind", [("hex27", 29), ("hex20", 25), ("tet10", 24), ("tet15", 71), ("hex8-q1p0", 12)])
def test_meshes_are_those_of_vtk(element: str, kind: int) -> None:
    pytest.importorskip("pyvista")
    check = Case.actuator(1, mesh={"size": 6, "element": element}).check()
    mesh = check.mesh()
    assert set(mesh.celltypes) == {kind} and mesh.n_points == check.nodes
    sizes = mesh.compute_cell_sizes(length=False, area=False)["Volume"]
    assert (sizes > 0).all() and np.isclose(sizes.sum(), check.volume_mm3, rtol=1e-6)


def test_a_body_whose_files_have_changed_is_not_gone_on_with(tmp_path: Any) -> None:
    model = Model.load(write_brick(tmp_path, 2))
    result = model.solve(times=[0.5, 1.0], threads=1)
    write_brick(tmp_path, 3)
    with pytest.raises(InputError, match="the files of the body are other ones"):
        result.resume(threads=1)


def test_sets_by_number_are_those_of_the_mesh() -> None:
    """Also where nodes of no cell are left out, and cells that are not solid."""
    meshio, pyvista = pytest.importorskip("meshio"), pytest.importorskip("pyvista")
    points = np.vstack([[[9.0, 9.0, 9.0]], NODES[:7], [[0.0, 0.0, 0.0]], NODES[7:]])
    cells = CELLS + 1 + (CELLS >= 7)
    quads = cells[:, [0, 1, 2, 3]]
    grid = pyvista.UnstructuredGrid({pyvista.CellType.QUAD: quads, pyvista.CellType.HEXAHEDRON: cells}, points)
    first = int(np.flatnonzero(grid.celltypes == pyvista.CellType.HEXAHEDRON)[0])
    wanted = plate(cell_sets={"soft": [2, 3]}).check()
    rest: dict[str, Any] = {
        "supports": [{"nodes": "clamp", "axes": "xyz"}],
        "pressures": [{"faces": "bottom", "pressure_kpa": 0.5}],
        "material": {"law": "neo-hooke", "c10": 0.1},
        "times": [1.0],
    }
    clamp = np.flatnonzero(points[:, 0] == 0)
    for mesh, begin in ((meshio.Mesh(points, [("quad", quads), ("hexahedron", cells)]), 0), (grid, first)):
        by_cell = wanted.face_sets["bottom"] + [begin, 0]
        for nodes in (clamp, points[:, 0] == 0):
            for faces in (quads, points[:, 2] == 0, by_cell):
                sets = {"node_sets": {"clamp": nodes}, "face_sets": {"bottom": faces}, "cell_sets": {"soft": [begin + 2, begin + 3]}}
                found = Model.from_mesh(mesh, **sets, **rest).check()
                assert np.array_equal(found.points, NODES)
                for kind in ("node_sets", "face_sets", "cell_sets"):
                    for name, members in getattr(wanted, kind).items():
                        assert np.array_equal(getattr(found, kind)[name], members), (kind, name)
        for match, sets in [
            ("node 8 belongs to no solid cell", {"face_sets": {"bottom": [[8, 1, 2, 3]]}}),
            ("numbers run from 0 to 21", {"node_sets": {"clamp": [22]}}),
            ("but there are 22 nodes", {"node_sets": {"clamp": np.ones(20, bool)}}),
            ("is no solid cell", {"face_sets": {"bottom": [[99, 0]]}}),
        ]:
            with pytest.raises(InputError, match=match):
                Model.from_mesh(mesh, **sets, **rest)


def test_a_stress_is_drawn_by_component(solved: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    pyvista = pytest.importorskip("pyvista")
    shown: list[Any] = []
    monkeypatch.setattr(pyvista.UnstructuredGrid, "plot", lambda grid, **given: shown.append(grid[given["scalars"]]))
    for match, given in [
        ("must be one of xx, yy, zz, xy, yz, xz; field = von_mises", {"field": "cauchy_stress"}),
        ("must be one of xx", {"field": "cauchy_stress", "component": "x"}),
        ("must be one of x, y, z", {"field": "displacement", "component": "xx"}),
        ("a single number", {"component": "xx"}),
    ]:
        with pytest.raises(InputError, match=match):
            solved.plot(**given)
    solved.plot(field="cauchy_stress", component="yz")
    solved[-1].plot("displacement", "z")
    solved.plot()
    last = solved[-1]
    for found, wanted in zip(shown, (last.cauchy_stress[:, 4], last.displacement[:, 2], last.von_mises), strict=True):
        assert np.array_equal(found, wanted)


def test_states_are_meshes_of_pyvista() -> None:
    pytest.importorskip("pyvista")
    case = Case.actuator(1, pressures=[2], mesh={"size": 6, "element": "hex27"})
    state = case.solve(threads=1)[0]
    mesh, bent = state.mesh(), state.mesh(deformed=True)
    assert np.allclose(mesh.warp_by_vector("displacement").points, bent.points)
    assert mesh.n_cells == len(mesh["pressure"]) and np.array_equal(mesh["von_mises"], state.von_mises)
    # As it came, it goes back.
    again = Model.from_mesh(mesh, times=[1.0], material="dragon-skin-30", node_sets={"all": np.arange(mesh.n_points)})
    held = again.set({"support": [{"nodes": "all", "axes": "xyz"}]}).check()
    assert held.element == "hex27" and held.cells == mesh.n_cells and np.array_equal(held.points, state.points)


def test_tables_and_curves(solved: Any) -> None:
    pandas = pytest.importorskip("pandas")
    table = solved.to_dataframe()
    assert isinstance(table, pandas.DataFrame) and table["pressure_kpa"].tolist() == [1, 2, 3]
    assert np.array_equal(table["tip.z_mm"], solved.tip[:, 2])
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    assert len(solved.plot_curves().axes) == 4


def test_what_needs_another_package_says_so(solved: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    for package, use in [
        ("pyvista", solved.mesh),
        ("pandas", solved.to_dataframe),
        ("matplotlib", solved.plot_curves),
    ]:
        monkeypatch.setitem(__import__("sys").modules, package, None)
        with pytest.raises(ImportError, match=f"pip install {package}"):
            use()
