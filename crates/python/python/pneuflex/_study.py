"""What is to be solved: cases of actuators, models of other bodies."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import Floats, Integers, array_of, faces, floats, integers, listed, matrix, members, numbers, positive, whole
from ._errors import InputError, NotConverged
from ._materials import as_material
from ._mesh import STABLE, VTK_CELLS, parts_of
from ._result import Hearing, Result, State, _Body, follow, positions
from ._toml import PER_CHAMBER, flat, to_toml

Keys = Mapping[str, Any]


class Check:
    """What would be solved.

    Attributes
    ----------
    nodes, cells : int
        Numbers of nodes and of cells.
    unknowns : int
        Number of unknown displacements.
    element : str
        The element, e.g. ``"hex27"``.
    modelled : str or None
        What is modelled of the whole body: ``whole``, ``half``, ``quarter``, ``eighth``; None where nobody knows.
    volume_mm3 : float
        Volume of the solid that is modelled.
    memory_bytes : float
        Peak memory that solving will need, about.
    requested : list of float
        Pressures in kPa, or times, at which there will be results.
    notes : list of str
        What was understood in another way than it may be meant.
    warnings : list of dict
        What to be careful about: ``kind``, ``message``, ``advice``.
    """

    def __init__(self, analysis: _native.Analysis) -> None:
        self._analysis = analysis
        self.title = analysis.title
        self.nodes, self.cells, self.unknowns = analysis.sizes
        self.element, self.modelled = analysis.element, analysis.modelled
        self.volume_mm3, self.memory_bytes = analysis.volume_and_memory
        self.requested = analysis.requested
        self.notes, warnings = analysis.remarks
        self.warnings: list[dict[str, Any]] = json.loads(warnings)
        self._text, self.rows = analysis.overview

    @property
    def points(self) -> Floats:
        """Positions of the nodes at rest, mm, shape (nodes, 3)."""
        return floats(self._analysis.nodes)

    @property
    def connectivity(self) -> Integers:
        """Nodes of every cell in VTK's order, shape (cells, nodes of a cell); one list where there are cells of several kinds."""
        return integers(self._analysis.cells)

    @property
    def node_sets(self) -> dict[str, Integers]:
        """Named nodes, each of shape (m,)."""
        return {name: np.array(nodes, dtype=np.int64) for name, nodes in self._analysis.sets[0].items()}

    @property
    def cell_sets(self) -> dict[str, Integers]:
        """Named cells, each of shape (m,)."""
        return {name: np.array(cells, dtype=np.int64) for name, cells in self._analysis.sets[1].items()}

    @property
    def face_sets(self) -> dict[str, Integers]:
        """Named faces: cell and number of the face in it, each of shape (m, 2)."""
        found = self._analysis.face_sets.items()
        return {name: np.array(faces, dtype=np.int64).reshape(-1, 2) for name, faces in found}

    def mesh(self) -> Any:
        """The body at rest as a `pyvista.UnstructuredGrid`."""
        return _Body.of_analysis(self._analysis).grid()

    def __str__(self) -> str:
        notes = [*self.notes, *(f"warning: {w['message']}\n  what to do: {w['advice']}" for w in self.warnings)]
        return "\n".join([self._text.rstrip(), *notes])

    def __repr__(self) -> str:
        return f"<Check: {self.nodes} nodes, {self.cells} cells {self.element}, {self.unknowns} unknowns>"


class Study:
    """What is common to :class:`Case` and :class:`Model`: keys that can be set, checking, solving."""

    _kinds: tuple[str, ...] = ("case", "model", "deck")

    def __init__(self, source: tuple[Any, ...], changes: Sequence[tuple[str, str]] = ()) -> None:
        self._source = source
        make = getattr(_native.Study, source[0])
        self._study: _native.Study = make(*source[1:], list(changes))
        if self._study.kind not in self._kinds:
            other = "Case" if self._study.kind == "case" else "Model"
            raise InputError(f"{self._study.path} describes a {self._study.kind}: use pneuflex.{other}.load")

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), self._source, self._study.changes)

    def copy(self) -> Self:
        """A copy, whose keys can be set without changing this one's."""
        other = type(self).__new__(type(self))
        other._source, other._study = self._source, self._study
        return other

    __copy__ = copy

    def _files(self) -> dict[str, bytes]:
        """Everything that it is read from."""
        return {os.fspath(path): data for path, data in self._study.files.items()}

    def _reading(self, files: dict[str, bytes]) -> Self:
        """The same, read from these files."""
        return _again(type(self), ("from_files", os.fspath(self._study.path), files), self._study.changes)

    def set(self, keys: Keys) -> Self:
        """Sets keys, all at once: what one of them alone would break may be mended by another. Returns the same object.

        Parameters
        ----------
        keys
            Values by keys such as ``"actuator.gap"``, ``"mesh.resolution"`` or ``"load.pressure_kpa"``, or by tables, ``{"mesh": {"size":
            2}}``; numbers, texts, lists, tables and numpy's. A material may be the name of a known one. All keys are in the guide.

        Raises
        ------
        InputError
            If there is no such key (the nearest name is said) or a value is out of range (the range is said); nothing has changed then.

        >>> case = Case.actuator(chambers=2).set({"actuator.gap": 1.5, "mesh.resolution": "draft"})
        >>> case["actuator.gap"]
        1.5
        """
        if not isinstance(keys, Mapping):
            raise InputError(f"values by keys are wanted, e.g. {{'actuator.gap': 1.5}}, not {keys!r:.100}")
        named = {key: as_material(value) if key == "material" else value for key, value in keys.items()}
        self._study = self._study.with_changes(flat(named))
        return self

    def __getitem__(self, key: str) -> Any:
        """The value of a key, with defaults filled in, e.g. ``case["actuator.gap"]``, or of one chamber, ``case["actuator.gap[3]"]``."""
        value: Any = self.values
        name_of_list, _, number = str(key).removesuffix("]").partition("[")
        for name in name_of_list.split("."):
            if not isinstance(value, dict) or name not in value:
                raise KeyError(key)
            value = value[name]
        if not number:
            return value
        # One of what may be given for every chamber, from 1; a number is that of all of them.
        if name_of_list not in PER_CHAMBER or not number.isdecimal():
            raise KeyError(key)
        chambers = int(self.values["actuator"]["chambers"])
        each = value if isinstance(value, list) else [value] * (chambers - (name_of_list == "actuator.gap"))
        if not 1 <= int(number) <= len(each):
            raise KeyError(key)
        return each[int(number) - 1]

    @property
    def values(self) -> dict[str, Any]:
        """All keys with their values, as tables."""
        values: dict[str, Any] = json.loads(self._study.values)
        return values

    def check(self, *, force: bool = False) -> Check:
        """Meshes the body and says what would be solved; nothing is solved.

        Parameters
        ----------
        force
            Also for a body that needs more memory than there is.

        Raises
        ------
        InputError
            Lengths that make no body, sets that do not exist, a part that nothing holds, a body that is too large …
        """
        return Check(self._study.build(force, None))

    def solve(
        self,
        pressures: ArrayLike | None = None,
        *,
        times: ArrayLike | None = None,
        threads: int | None = None,
        progress: bool = False,
        on_state: Callable[[State], object] | None = None,
        out: str | os.PathLike[str] | None = None,
        fields: bool = True,
        force: bool = False,
    ) -> Result:
        """Follows the equilibria from rest through all pressures, or times of a model. Other Python threads go on meanwhile.

        Parameters
        ----------
        pressures
            Air pressures, kPa, increasing, in place of the case's own.
        times
            The same for a model: times of its schedule.
        threads
            Number of threads; all cores unless told otherwise. Results do not depend on it beyond 1e-10.
        progress
            Whether a line on standard error says how far the run is.
        on_state
            Called with every :class:`State` as it is reached, on this thread; the run waits for it. What it raises ends the run.
        out
            Folder to record in, as the program does, with `report.html`. Results in it are replaced; a folder with anything else is refused.
        fields
            Whether fields are kept; without them a result takes little memory.
        force
            Whether a body is tried that needs more memory than there is.

        Raises
        ------
        NotConverged
            The path ended early; ``error.result`` has what was reached, and the reason.
        Interrupted
            Ctrl-C (a `KeyboardInterrupt`); ``error.result`` has what was reached, ``error.result.resume()`` goes on.
        InputError
            As :meth:`check`, or a folder that cannot be used.
        OSError
            Results cannot be written.
        """
        hearing = Hearing(threads, progress, on_state)
        study, given = self._study, positions(self._study, pressures, times)
        if given is not None:
            study = study.with_changes(flat(given))
        analysis = study.build(force, hearing.threads)
        folder = Path(out) if out is not None else None
        return follow(study, analysis, hearing, out=folder, resumes=False, fields=fields)

    def value_and_grad(
        self, results: Sequence[str], keys: Sequence[str], *, threads: int | None = None, force: bool = False
    ) -> tuple[Floats, Floats]:
        """Solves it, and gives results with their exact derivatives: what an optimiser asks for.

        Parameters
        ----------
        results
            Names of results, as for `pneuflex run --gradient`: `"end_face_angle"` at the last pressure, `"tip.z@25"` at 25 kPa or that time,
            `"centreline[50%].z"`.
        keys
            Keys of numbers by which they are differentiated: `"actuator.top_wall"`, `"actuator.gap[2]"`, `"material.c10"`.
        threads, force
            As of :meth:`solve`.

        Returns
        -------
        values, derivatives
            Numbers of shape (results,), and (results, keys), in the results' units per unit of the keys.

        Raises
        ------
        InputError
            A result or a key without derivatives, or as :meth:`check`.
        NotConverged, Interrupted
            As of :meth:`solve`.
        """
        if isinstance(results, str) or isinstance(keys, str):
            raise InputError("value_and_grad: lists of names are wanted, not a text")
        hearing = Hearing(threads, False, None)
        analysis = self._study.build(force, hearing.threads)
        analysis.check_gradients(list(results), list(keys))
        outcome = follow(self._study, analysis, hearing, out=None, resumes=False, fields=True)._outcome
        assert outcome is not None
        values, rows = outcome.gradients(list(results), list(keys))
        return np.array(values), np.array(rows).reshape(len(values), len(keys))

    def value_and_shape_grad(
        self, results: Sequence[str], *, threads: int | None = None, force: bool = False
    ) -> tuple[Floats, Floats]:
        """Solves it, and gives results with their exact derivatives by the position of every node at rest.

        Parameters
        ----------
        results
            As of :meth:`value_and_grad`.
        threads, force
            As of :meth:`solve`.

        Returns
        -------
        values, derivatives
            Numbers of shape (results,), and (results, nodes, 3), in the results' units per mm; nodes are those of :meth:`mesh`, and of a half model those of the
            other half move as their mirror images do.

        Raises
        ------
        InputError
            A result without such derivatives, as of loads that are spread by areas at rest, or as :meth:`check`.
        NotConverged, Interrupted
            As of :meth:`solve`.
        """
        if isinstance(results, str):
            raise InputError("value_and_shape_grad: a list of names is wanted, not a text")
        hearing = Hearing(threads, False, None)
        analysis = self._study.build(force, hearing.threads)
        analysis.check_shape_gradients(list(results))
        outcome = follow(self._study, analysis, hearing, out=None, resumes=False, fields=True)._outcome
        assert outcome is not None
        values, rows = outcome.shape_gradients(list(results))
        return np.array(values), np.array(rows).reshape(len(values), -1, 3)

    def _solve_in_sweep(
        self, threads: int, out: str | None, neighbour: tuple[str, str] | None, keeps_equilibria: bool
    ) -> Result:
        hearing = Hearing(threads, False, None)
        analysis = self._study.build(False, hearing.threads)
        folder = Path(out) if out is not None else None
        options: dict[str, Any] = {"out": folder, "resumes": False, "fields": False, "keeps_equilibria": keeps_equilibria}
        try:
            return follow(self._study, analysis, hearing, neighbour=neighbour, **options)
        except NotConverged as ended:
            outcome = ended.result._outcome
            if outcome is None or not outcome.has_left_neighbour:
                raise
        # The two designs differ: once more, at rest.
        return follow(self._study, analysis, hearing, **options)


def _tables(rows: Any, name: str) -> list[Keys]:
    if not isinstance(rows, Sequence) or isinstance(rows, str) or not all(isinstance(row, Mapping) for row in rows):
        raise InputError(f"{name}: a list of tables is wanted, each with values by keys, not {rows!r:.100}")
    return list(rows)


def _existing(path: str | os.PathLike[str]) -> str:
    if not os.path.exists(path):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), os.fspath(path))
    return os.path.abspath(path)


S = TypeVar("S", bound=Study)


def _again(kind: type[S], source: tuple[Any, ...], changes: list[tuple[str, str]]) -> S:
    made = kind.__new__(kind)
    Study.__init__(made, source, changes)
    return made


class Case(Study):
    """An actuator that its lengths describe: a row of chambers on a base, clamped at x = 0; x runs along it, z is up.

    >>> case = Case.actuator(chambers=2, pressures=[5, 10])
    >>> case.set({"actuator.gap": 1.5})
    Case('actuator', 2 chambers, 17.5 mm long, at 5, 10 kPa)
    """

    _kinds = ("case",)

    @classmethod
    def load(cls, path: str | os.PathLike[str], keys: Keys | None = None) -> Case:
        """Reads a case file (TOML).

        Parameters
        ----------
        path
            The file.
        keys
            Keys to set, as :meth:`Study.set`; they may mend what is missing in the file.

        Raises
        ------
        InputError
            With everything that is wrong: file, line, key, allowed range, nearest name.
        FileNotFoundError
            If there is no such file.
        """
        case = cls(("load", _existing(path)), flat(keys or {}))
        # A copy that is sent to another process is the case that was read.
        case._source = ("from_files", os.fspath(case._study.path), case._files())
        return case

    @classmethod
    def from_text(cls, text: str, name: str = "case.toml") -> Case:
        """A case from the text of a case file, which messages call `name`."""
        if not isinstance(text, str):
            raise InputError(f"text = {text!r:.100} must be the text of a case file")
        return cls(("from_files", name, {name: text.encode()}))

    @classmethod
    def actuator(
        cls,
        chambers: int,
        *,
        pressures: ArrayLike | None = None,
        chamber_factor: ArrayLike | None = None,
        chamber_length: ArrayLike | None = None,
        cavity_length: ArrayLike | None = None,
        gap: ArrayLike | None = None,
        flange: float | None = None,
        width: float | None = None,
        height: float | None = None,
        base: float | None = None,
        cavity_floor: float | None = None,
        side_wall: ArrayLike | None = None,
        top_wall: ArrayLike | None = None,
        channel: Keys | None = None,
        part: str | None = None,
        material: str | Keys | None = None,
        mesh: str | Keys | None = None,
        contact: Keys | None = None,
        obstacles: Sequence[Keys] = (),
        probes: Sequence[Keys] = (),
        solver: Keys | None = None,
        title: str = "",
    ) -> Case:
        """An actuator from keywords. What is left out is that of Xu & Liu's actuator (2020): chambers of 8 mm with gaps of 2 mm, 20 mm wide
        and 13 mm high, walls of 1 mm, a base of 4 mm, flanges of 2 mm.

        Parameters
        ----------
        chambers
            Number of chambers.
        pressures
            Air pressures at which results are wanted, kPa, increasing; 5, 15, 25, 35 and 50 unless told otherwise.
        chamber_factor
            Pressures in the chambers over these, one number for each chamber, for chambers that no channel joins (``channel``); negative for
            a vacuum.
        chamber_length, cavity_length
            Outer length of a chamber and length of its cavity, mm; the end walls share the rest. One number for all chambers, or one for
            each.
        gap
            Between neighbouring chambers, mm; one number for all gaps, or one for each.
        flange
            Base beyond the first and the last chamber, mm; 0 for none.
        width, height, base, cavity_floor, side_wall, top_wall
            Whole width and height; thickness of the base, height of the cavities' floor (the top of the base unless told otherwise),
            thickness of side and top walls (one number for all chambers, or one for each), mm.
        channel
            Air channel in the base: ``half_width``, ``bottom``, ``top``, mm; ``{"half_width": 0, ...}`` for none.
        part
            ``"half"`` (y ≥ 0; the default) or ``"whole"``.
        material
            Name of a known silicone (:func:`materials`), or ``law`` with its constants in MPa.
        mesh
            ``"draft"``, ``"standard"`` (the default) or ``"fine"``; or keys of ``[mesh]``: ``size``, ``element`` …
        contact, obstacles, probes, solver
            Tables of the case file.
        title
            Repeated in results.
        """
        lengths = {
            "chamber_length": chamber_length,
            "cavity_length": cavity_length,
            "gap": gap,
            "flange": flange,
            "width": width,
            "height": height,
            "base": base,
            "cavity_floor": cavity_floor,
            "side_wall": side_wall,
            "top_wall": top_wall,
            "channel": channel,
            "part": part,
        }
        keys: dict[str, Any] = {f"actuator.{key}": value for key, value in lengths.items() if value is not None}
        keys |= {"title": title, "probe": _tables(probes, "probes")}
        if pressures is not None:
            keys["load.pressure_kpa"] = listed(pressures, "pressures")
        if chamber_factor is not None:
            keys["load.chamber_factor"] = chamber_factor
        if material is not None:
            keys["material"] = as_material(material)
        if mesh is not None:
            keys["mesh"] = {"resolution": mesh} if isinstance(mesh, str) else mesh
        if contact is not None:
            keys["contact"] = contact
        if obstacles:
            keys["obstacle"] = _tables(obstacles, "obstacles")
        if solver is not None:
            keys["solver"] = solver
        text = _native.template(whole(chambers, "chambers", 10**6))
        return cls(("from_files", "actuator", {"actuator": text.encode()}), flat(keys))

    @property
    def length(self) -> float:
        """Length of the actuator at rest, mm: the tip is at (length, 0, 0)."""
        length = self._study.length
        assert length is not None
        return length

    def __repr__(self) -> str:
        values = self.values
        chambers = values["actuator"]["chambers"]
        pressures = ", ".join(f"{p:g}" for p in values["load"]["pressure_kpa"])
        name = values["title"] or os.fspath(self._study.path)
        words = "chamber" if chambers == 1 else "chambers"
        return f"Case({name!r}, {chambers} {words}, {self.length:g} mm long, at {pressures} kPa)"


class Model(Study):
    """A body of any shape with materials, supports and loads on named sets of its nodes, faces and cells."""

    _kinds = ("model", "deck")

    @classmethod
    def load(cls, path: str | os.PathLike[str], keys: Keys | None = None) -> Model:
        """Reads a model file (TOML), or an input deck of Abaqus or CalculiX (``.inp``) or FEBio (``.feb``).

        Raises
        ------
        InputError
            With everything that is wrong with a model file. Decks and meshes are read when they are checked or solved.
        FileNotFoundError
            If there is no such file.
        """
        return cls(("load", _existing(path)), flat(keys or {}))

    @classmethod
    def from_arrays(
        cls,
        nodes: ArrayLike,
        cells: ArrayLike,
        *,
        material: str | Keys | None = None,
        node_sets: Mapping[str, ArrayLike] | None = None,
        face_sets: Mapping[str, ArrayLike] | None = None,
        cell_sets: Mapping[str, ArrayLike] | None = None,
        element: str | None = None,
        scale: float = 1.0,
        regions: Sequence[Keys] = (),
        supports: Sequence[Keys] = (),
        equations: Sequence[Keys] = (),
        cavities: Sequence[Keys] = (),
        forces: Sequence[Keys] = (),
        tractions: Sequence[Keys] = (),
        pressures: Sequence[Keys] = (),
        gravity: Keys | None = None,
        contacts: Sequence[Keys] = (),
        obstacles: Sequence[Keys] = (),
        probes: Sequence[Keys] = (),
        times: ArrayLike | None = None,
        solver: Keys | None = None,
        title: str = "",
    ) -> Model:
        """A model from numpy arrays.

        Parameters
        ----------
        nodes
            Positions of the nodes, mm, shape (n, 3).
        cells
            Nodes of every cell in VTK's order, from 0, shape (m, nodes of a cell): 8, 20 or 27 for hexahedra, 10 for tetrahedra.
        material
            Name of a known silicone (:func:`materials`), or ``law`` with its constants in MPa, e.g. ``{"law": "neo-hooke", "c10": 0.1}``.
        node_sets, cell_sets
            Named nodes or cells: numbers, or a truth value for each, e.g. ``{"clamp": nodes[:, 0] == 0}``.
        face_sets
            Named faces: cell and number of the face in it, shape (k, 2); or the nodes of every face, shape (k, nodes of a face), as
            surface meshes have them; or a truth value for each node, for the faces of the surface all of whose nodes are meant.
        element
            By default ``hex8-q1p0`` for 8 nodes, ``hex27`` for 20 and 27, and ``tet15`` for 10: nodes are added in faces and inside, behind
            those that are given, without which the pressures would not be stable. ``hex8-sri``, ``hex20`` and ``tet10`` are solved as they are.
        scale
            Millimetres per unit of length of the nodes.
        regions, supports, equations, cavities, forces, tractions, pressures, gravity, contacts, obstacles, probes, solver
            Tables of a model file, whose keys the guide lists, e.g. ``supports=[{"nodes": "clamp", "axes": "xyz"}]``,
            ``cavities=[{"name": "air", "faces": "inside", "pressure_kpa": 20}]``. Values by time are a number, reached along a straight line,
            or points ``[[time, value], ...]``.
        times
            Times at which results are wanted, increasing.
        title
            Repeated in results.

        Raises
        ------
        InputError
            Arrays of another shape, nodes that are not there, keys that do not exist or are out of range.
        """
        places = matrix(nodes, 3, "nodes") * positive(scale, "scale", ": millimetres per unit of length of the nodes")
        connectivity = array_of(cells, "cells")
        for name, text in (("element", element), ("title", title)):
            if not isinstance(text, str | None):
                raise InputError(f"{name} = {text!r} must be a text")
        if connectivity.ndim != 2:
            raise InputError(f"cells must have the shape (m, nodes of a cell), not {connectivity.shape}")
        size = connectivity.shape[1]
        if element is None:
            if size not in VTK_CELLS:
                help = "; add the nodes in the middle of the edges first" if size == 4 else ""
                raise InputError(f"cells of {size} nodes cannot be solved: 8, 20 and 27 are hexahedra, 10 tetrahedra{help}")
            given, element = VTK_CELLS[size], STABLE.get(VTK_CELLS[size])
        elif size in VTK_CELLS and STABLE.get(VTK_CELLS[size]) == element:
            given = VTK_CELLS[size]
        else:
            given, element = element, None
        several = {
            "region": regions,
            "support": supports,
            "equation": equations,
            "cavity": cavities,
            "force": forces,
            "traction": tractions,
            "pressure": pressures,
            "contact": contacts,
            "obstacle": obstacles,
            "probe": probes,
        }
        several = {key: _tables(rows, f"{key[:-1]}ies" if key[-1] == "y" else f"{key}s") for key, rows in several.items()}
        several["region"] = [{**region, "material": as_material(region.get("material"))} for region in regions]
        tables: dict[str, Any] = {
            "title": title or None,
            "material": as_material(material),
            "gravity": gravity,
            "solver": solver,
            "load": {"times": listed(times, "times")} if times is not None else None,
            "mesh": {"element": element} if element is not None else None,
        }
        lines = [f"{key} = {to_toml(value, key)}" for key, value in tables.items() if value is not None]
        for key, rows in several.items():
            if rows:
                inner = "".join(f"  {to_toml(row, key)},\n" for row in rows)
                lines.append(f"{key} = [\n{inner}]")
        count = len(places)
        by_rows = faces(face_sets, count).items()
        source = (
            "from_mesh",
            title or "model",
            "\n".join(lines) + "\n",
            given,
            places.astype("<f8").tobytes(),
            (numbers(connectivity, "cells", count).tobytes(), size),
            {name: chosen.tobytes() for name, chosen in members(node_sets, count, "node").items()},
            {name: (rows.tobytes(), rows.shape[1] if rows.ndim == 2 else 0) for name, rows in by_rows},
            {name: chosen.tobytes() for name, chosen in members(cell_sets, len(connectivity), "cell").items()},
        )
        return cls(source)

    @classmethod
    def from_mesh(cls, mesh: Any, **arguments: Any) -> Model:
        """A model from a `meshio.Mesh` or a `pyvista.UnstructuredGrid` as it is; further arguments are those of :meth:`from_arrays`, whose
        sets are added to the mesh's own. Numbers and truth values in them are those of the mesh: of all its points, and of all cells of a grid
        of PyVista, of the solid cells of a mesh of meshio. Points of no solid cell are left out: results number the others.

        Of meshio, `point_sets` and `cell_sets` become sets: of the solid cells sets of cells, of the faces sets of faces; physical groups of
        Gmsh are among these. Of PyVista, arrays of truth values at points and cells become sets of that name.

        Raises
        ------
        InputError
            For a mesh without solid cells, of cells of several kinds, or of a kind that cannot be solved.
        """
        parts = parts_of(mesh)
        parts.add(*(arguments.pop(name, None) for name in ("node_sets", "face_sets", "cell_sets")))
        parts = parts.used()
        arguments |= {"node_sets": parts.node_sets, "face_sets": parts.face_sets, "cell_sets": parts.cell_sets}
        return cls.from_arrays(parts.nodes, parts.cells, **arguments)

    def __repr__(self) -> str:
        if self._study.kind == "deck":
            return f"Model({os.fspath(self._study.path)!r})"
        values = self.values
        name = values.get("title") or os.fspath(self._study.path)
        if self._source[0] == "from_mesh":
            count = len(self._source[4]) // 24
            return f"Model({name!r}, {count} nodes, {self._source[3]})"
        return f"Model({name!r})"
