"""Meshes of meshio and PyVista as they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Integers, members
from ._arrays import faces as faces_of
from ._errors import InputError

VTK_CELLS = {8: "hex8-q1p0", 20: "hex20", 27: "hex27", 10: "tet10"}
"""The element for a number of nodes of a cell."""

STABLE = {"hex20": "hex27", "tet10": "tet15"}
"""The element with further nodes that is solved in the place of one whose pressures are not stable."""

SOLID = {"hexahedron": 8, "hexahedron20": 20, "hexahedron27": 27, "tetra10": 10}
FACES = ("quad", "quad8", "quad9", "triangle6", "triangle")
OTHER_SOLID = ("tetra", "wedge", "wedge15", "wedge18", "pyramid", "pyramid13", "pyramid14", "hexahedron24")
VTK_SOLID = {12: "hexahedron", 25: "hexahedron20", 29: "hexahedron27", 24: "tetra10"}
VTK_OTHER_SOLID = {10: "tetra", 13: "wedge", 14: "pyramid", 26: "wedge15", 27: "pyramid13", 32: "wedge18", 11: "voxel"}


Sets = Mapping[str, ArrayLike] | None


@dataclass
class Parts:
    """What a mesh consists of."""

    nodes: Any
    cells: Any
    node_sets: dict[str, Integers] = field(default_factory=dict)
    face_sets: dict[str, Integers] = field(default_factory=dict)
    cell_sets: dict[str, Integers] = field(default_factory=dict)
    solid: Integers | None = None
    """Which cells of the mesh these are, if it numbers others, too."""

    def add(self, nodes: Sets, faces: Sets, cells: Sets) -> None:
        """Adds sets in the numbers of the mesh: of all its points, and of all its cells if it numbers these."""
        solid = np.ones(len(self.cells), dtype=bool) if self.solid is None else self.solid
        number = np.cumsum(solid) - 1
        self.node_sets |= members(nodes, len(self.nodes), "node")
        for name, chosen in members(cells, len(solid), "cell").items():
            self.cell_sets[name] = number[chosen[solid[chosen]]]
        for name, rows in faces_of(faces, len(self.nodes)).items():
            label, is_used = f'face_sets["{name}"]', np.isin(rows, self.cells)
            if rows.ndim == 2 and rows.shape[1] == 2:
                if bad := [int(cell) for cell in rows[:, 0] if cell >= len(solid) or not solid[cell]]:
                    raise InputError(f"{label}: cell {bad[0]} is no solid cell of the mesh")
                rows = np.column_stack([number[rows[:, 0]], rows[:, 1]])
            elif rows.ndim == 2 and not is_used.all():
                raise InputError(f"{label}: node {rows[~is_used][0]} belongs to no solid cell")
            self.face_sets[name] = rows

    def used(self) -> Parts:
        """Without nodes of no cell, such as the points by which Gmsh describes a geometry: they have no stiffness."""
        used = np.unique(self.cells)
        number = np.full(len(self.nodes), -1)
        number[used] = np.arange(len(used))
        faces = {}
        for name, rows in self.face_sets.items():
            if rows.ndim == 1:
                faces[name] = np.isin(used, rows)
            elif rows.shape[1] == 2:
                faces[name] = rows
            else:
                faces[name] = number[rows[np.isin(rows, used).all(axis=1)]]
        nodes = {name: number[chosen[np.isin(chosen, used)]] for name, chosen in self.node_sets.items()}
        return Parts(np.asarray(self.nodes)[used], number[self.cells], nodes, faces, self.cell_sets)


def parts_of(mesh: Any) -> Parts:
    """What a `meshio.Mesh` or a `pyvista.UnstructuredGrid` consists of; neither package is imported."""
    if hasattr(mesh, "cells_dict") and hasattr(mesh, "celltypes"):
        return _of_pyvista(mesh)
    if hasattr(mesh, "cells") and hasattr(mesh, "point_sets"):
        return _of_meshio(mesh)
    if hasattr(mesh, "cast_to_unstructured_grid"):
        return _of_pyvista(mesh.cast_to_unstructured_grid())
    raise InputError(f"a {type(mesh).__name__} is neither a meshio.Mesh nor a pyvista.UnstructuredGrid")


def _of_pyvista(mesh: Any) -> Parts:
    kinds = [int(kind) for kind in np.unique(mesh.celltypes)]
    if bad := [VTK_OTHER_SOLID[kind] for kind in kinds if kind in VTK_OTHER_SOLID]:
        raise InputError(f"cells of the kind {bad[0]} cannot be solved: {_known()}")
    solid = [kind for kind in kinds if kind in VTK_SOLID]
    if len(solid) != 1:
        raise InputError(_several([VTK_SOLID[kind] for kind in solid]))
    chosen = mesh.celltypes == solid[0]
    parts = Parts(np.asarray(mesh.points, dtype=float), np.asarray(mesh.cells_dict[solid[0]]), solid=chosen)
    for name in mesh.point_data:
        values = np.asarray(mesh.point_data[name])
        if _is_truth(values):
            parts.node_sets[str(name)] = np.flatnonzero(values)
    for name in mesh.cell_data:
        values = np.asarray(mesh.cell_data[name])
        if _is_truth(values):
            parts.cell_sets[str(name)] = np.flatnonzero(values[chosen])
    return parts


def _is_truth(values: Any) -> bool:
    # VTK has no truth values: PyVista gives them back as such where it has put them in itself.
    return bool(values.dtype == bool and values.ndim == 1)


def _of_meshio(mesh: Any) -> Parts:
    kinds = [block.type for block in mesh.cells]
    if bad := [kind for kind in kinds if kind in OTHER_SOLID]:
        raise InputError(f"cells of the kind {bad[0]} cannot be solved: {_known()}")
    solid = sorted({kind for kind in kinds if kind in SOLID})
    if len(solid) != 1:
        raise InputError(_several(solid))
    points = np.asarray(mesh.points, dtype=float)
    blocks = [np.asarray(block.data) for block in mesh.cells]
    is_solid = [kind in SOLID for kind in kinds]
    cells = np.concatenate([data for data, chosen in zip(blocks, is_solid, strict=True) if chosen])
    parts = Parts(points, cells)
    for name, nodes in mesh.point_sets.items():
        parts.node_sets[str(name)] = np.asarray(nodes).astype(np.int64).reshape(-1)
    for name, chosen_by_block in _groups(mesh).items():
        first, in_cells, in_faces = 0, [], []
        for kind, data, chosen in zip(kinds, blocks, chosen_by_block, strict=True):
            if kind in SOLID:
                in_cells.append(first + chosen)
                first += len(data)
            elif kind in FACES and len(chosen):
                in_faces.append(data[chosen])
        if any(map(len, in_cells)):
            parts.cell_sets[name] = np.concatenate(in_cells)
        if in_faces:
            parts.face_sets[name] = np.concatenate(in_faces)
    return parts


def _groups(mesh: Any) -> dict[str, list[Integers]]:
    """Named members of every block: sets of cells, and Gmsh's physical groups."""
    empty = np.zeros(0, dtype=np.int64)
    groups: dict[str, list[Integers]] = {}
    for name, blocks in mesh.cell_sets.items():
        # Gmsh's own list of entities, which are no sets.
        if not str(name).startswith("gmsh:"):
            members = [empty if block is None else np.asarray(block).astype(np.int64) for block in blocks]
            groups[str(name)] = members
    physical = mesh.cell_data.get("gmsh:physical")
    dimensions = {"line": 1, "line3": 1, "vertex": 0} | dict.fromkeys(FACES, 2) | dict.fromkeys(SOLID, 3)
    for name, (tag, dimension) in mesh.field_data.items() if physical is not None else ():
        groups[str(name)] = [
            np.flatnonzero(np.asarray(tags) == tag) if dimensions.get(block.type) == dimension else empty
            for block, tags in zip(mesh.cells, physical, strict=True)
        ]
    return groups


def _known() -> str:
    return "hexahedra of 8, 20 or 27 nodes and tetrahedra of 10 can"


def _several(found: list[str]) -> str:
    if not found:
        return f"the mesh has no solid cells: {_known()}"
    return f"the mesh has cells of several kinds ({', '.join(found)}); all must be of one"
