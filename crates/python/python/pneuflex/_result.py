"""What a run found."""

from __future__ import annotations

import errno
import html
import json
import math
import os
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import Floats, Integers, floats, integers, listed, whole
from ._errors import InputError, Interrupted, NotConverged, missing
from ._progress import Progress
from ._toml import flat

TRIES = 10
"""How often a folder is read whose run is going on."""

FORMAT = 2
"""Number of the form of `summary.json` in which numbers are those of the whole body."""

COMPONENTS = {"displacement": ("x", "y", "z"), "cauchy_stress": ("xx", "yy", "zz", "xy", "yz", "xz")}
"""Names of the columns of fields that have several."""


class _Body:
    """The mesh at rest, from where it was solved or from a field file."""

    def __init__(self, points: Floats, connectivity: Integers, sizes: Integers, cell_types: Integers) -> None:
        self.points, self.connectivity, self.sizes, self.cell_types = points, connectivity, sizes, cell_types

    @classmethod
    def of_analysis(cls, analysis: _native.Analysis) -> _Body:
        cells, sizes = integers(analysis.cells), np.array(analysis.cell_sizes, dtype=np.int64)
        return cls(floats(analysis.nodes), cells.reshape(-1), sizes, integers(analysis.cell_types))

    @classmethod
    def of_file(cls, file: _native.FieldFile) -> _Body:
        offsets = integers(file.offsets).astype(np.int64)
        return cls(
            floats(file.points), integers(file.connectivity), np.diff(offsets, prepend=0), integers(file.cell_types)
        )

    def grid(self, points: Floats | None = None) -> Any:
        """As a `pyvista.UnstructuredGrid`."""
        try:
            import pyvista
        except ImportError as error:
            raise missing("pyvista", "mesh()") from error
        begins = np.cumsum(self.sizes) - self.sizes
        cells = np.insert(self.connectivity.astype(np.int64), begins, self.sizes)
        return pyvista.UnstructuredGrid(cells, self.cell_types, np.array(self.points if points is None else points))


class State:
    """An equilibrium that was reached. Numbers are those of the whole body, also where a part of it is modelled; fields are of the part
    that is modelled.

    Attributes
    ----------
    pressure_kpa : float
        Air pressure, kPa; that of the first cavity of a model, 0 if it has none.
    time : float or None
        Time of a model's schedule; None for an actuator.
    end_face_angle_deg : float
        Angle by which the end face has turned, degrees, positive downwards; NaN for a body without one.
    chord_angle_deg : float
        Angle of the chord from the clamp to the tip, degrees, positive downwards: half of the end face's for a circular arc. NaN for a
        body without a centreline.
    cavity_volume_mm3, strain_energy_mj, max_von_mises_mpa, von_mises_p99_mpa : float
        Volume of the air; strain energy; largest von Mises stress, and the one that 99 % of the volume stays below.
    summary : dict
        Everything, as in the file `summary.json`.
    """

    def __init__(
        self,
        summary: dict[str, Any],
        length: float | None,
        body: Callable[[], _Body],
        fields: _native.State | Callable[[], _native.FieldFile | None],
        tip_at: Sequence[float] | None = None,
    ) -> None:
        self.summary = summary
        self._length = length
        self._body = body
        self._fields = fields
        self._tip_at = tip_at
        self._file: _native.FieldFile | None = None

    @property
    def time(self) -> float | None:
        time: float | None = self.summary.get("time")
        return time

    @property
    def pressure_kpa(self) -> float:
        return float(self.summary["pressure_kpa"])

    @property
    def _when(self) -> float:
        return self.pressure_kpa if self.time is None else self.time

    @property
    def end_face_angle_deg(self) -> float:
        return float(self.summary.get("end_face_angle_deg", math.nan))

    @property
    def chord_angle_deg(self) -> float:
        if "chord_angle_deg" in self.summary:
            return float(self.summary["chord_angle_deg"])
        line = self.centreline
        if len(line) < 2:
            return math.nan
        dx, dz = line[-1] - line[0]
        return math.degrees(math.atan2(-dz, dx))

    @property
    def cavity_volume_mm3(self) -> float:
        return float(self.summary["cavity_volume_mm3"])

    @property
    def strain_energy_mj(self) -> float:
        return float(self.summary["strain_energy_mj"])

    @property
    def max_von_mises_mpa(self) -> float:
        return float(self.summary["max_von_mises_mpa"])

    @property
    def von_mises_p99_mpa(self) -> float:
        return float(self.summary["von_mises_p99_mpa"])

    @property
    def reaction(self) -> Floats:
        """Sum of the reactions of all supports, N, shape (3,)."""
        return np.array(self.summary["reaction_n"])

    @property
    def centreline(self) -> Floats:
        """Deformed bottom centreline from the clamp to the tip, x and z in mm, shape (m, 2); empty for a body without one."""
        return np.array(self.summary.get("centreline", []), dtype=float).reshape(-1, 2)

    @property
    def probes(self) -> dict[str, Floats]:
        """Displacement of every probe, mm, shape (3,)."""
        return {name: np.array(u) for name, u in self.summary.get("probes", {}).items()}

    @property
    def tip(self) -> Floats:
        """Displacement of the tip, mm, shape (3,): of an actuator the end of its bottom centreline, of another body the probe `tip`."""
        probe, line = self.summary.get("probes", {}).get("tip"), self.centreline
        if self._length is None or not len(line):
            if probe is None:
                raise AttributeError("the body has no end face, and there is no probe called tip")
            return np.array(probe)
        at = self._tip_at
        if probe is not None and at is not None and math.dist(at, (self._length, 0.0, 0.0)) < 1e-9:
            return np.array(probe)
        # In the plane y = 0, in which the centreline lies.
        return np.array([line[-1, 0] - self._length, 0.0, line[-1, 1]])

    def _field(self, name: str, columns: int) -> Floats:
        if isinstance(self._fields, _native.State):
            if not self._fields.has_fields:
                raise AttributeError("no fields were kept: solve with fields=True")
            if name == "displacement":
                return floats(self._fields.displacement)
            found = self._fields.field(name, columns)
        else:
            file = self._field_file()
            if file is None:
                raise AttributeError("no fields were recorded (output.fields = false)")
            found = file.field(name, columns)
        if found is None:
            raise AttributeError(f"there is no field {name}")
        return floats(found)

    def _field_file(self) -> _native.FieldFile | None:
        if not isinstance(self._fields, _native.State):
            self._file = self._file or self._fields()
        return self._file

    @property
    def points(self) -> Floats:
        """Positions of the nodes at rest, mm, shape (n, 3), for reading."""
        return self._body().points

    @property
    def displacement(self) -> Floats:
        """Displacements of the nodes, mm, shape (n, 3), without a copy and for reading."""
        return self._field("displacement", 3)

    @property
    def von_mises(self) -> Floats:
        """Von Mises stress at the nodes, MPa, shape (n,): of the Cauchy stress there, for pictures. Without a copy."""
        return self._field("von_mises", 1)

    @property
    def cauchy_stress(self) -> Floats:
        """Cauchy stress at the nodes, MPa, shape (n, 6): xx, yy, zz, xy, yz, xz; at smooth free or pressurised surfaces that of the surface itself, elsewhere averaged over the elements at a node. Without a copy."""
        return self._field("cauchy_stress", 6)

    @property
    def hydrostatic_pressure(self) -> Floats:
        """Hydrostatic pressure −tr σ/3 of the elements, MPa, shape (elements,); compression is positive. Without a copy."""
        return self._field("pressure", 1)

    @property
    def nodal_reaction(self) -> Floats:
        """Forces of the supports on the nodes, N, shape (n, 3), zero where nothing is held; of the part that is modelled. Not recorded in
        folders."""
        if not isinstance(self._fields, _native.State):
            raise AttributeError("result folders do not hold the reactions of single nodes")
        if not self._fields.has_fields:
            raise AttributeError("no fields were kept: solve with fields=True")
        return floats(self._fields.reaction)

    def mesh(self, deformed: bool = False) -> Any:
        """The body as a `pyvista.UnstructuredGrid` with `displacement`, `von_mises`, `cauchy_stress` at its points and `pressure` in its
        cells. Its points are those at rest (`warp_by_vector("displacement")` moves them), or the deformed ones. Cells are VTK's own, also
        the triquadratic hexahedra."""
        body = self._body()
        grid = body.grid(body.points + self.displacement if deformed else None)
        grid.point_data["displacement"] = self.displacement
        grid.point_data["von_mises"] = self.von_mises
        grid.point_data["cauchy_stress"] = self.cauchy_stress
        grid.cell_data["pressure"] = self.hydrostatic_pressure
        return grid

    def plot(self, field: str = "von_mises", component: str | None = None, **arguments: Any) -> Any:
        """Shows the deformed body coloured by a field with PyVista; further arguments are those of `pyvista.plot`.

        Parameters
        ----------
        field
            ``von_mises``, ``displacement``, ``cauchy_stress`` or ``pressure`` (the hydrostatic one).
        component
            Of the displacement ``x``, ``y`` or ``z``, its length unless told otherwise; of the Cauchy stress ``xx``, ``yy``, ``zz``, ``xy``,
            ``yz`` or ``xz``, one of which must be told.
        """
        if field not in ("von_mises", "displacement", "cauchy_stress", "pressure"):
            raise InputError(f'field = "{field}" must be von_mises, displacement, cauchy_stress or pressure')
        names = COMPONENTS.get(field, ())
        if component not in names and (component is not None or field == "cauchy_stress"):
            words = f"must be one of {', '.join(names)}" if names else "must be left out: the field is a single number"
            also = "; field = von_mises shows the equivalent stress" if field == "cauchy_stress" else ""
            raise InputError(f"component = {component!r} of {field} {words}{also}")
        mesh = self.mesh(deformed=True)
        if component is not None:
            field, column = f"{field} {component}", mesh.point_data[field][:, names.index(component)]
            mesh.point_data[field] = column
        return mesh.plot(**{"scalars": field, **arguments})

    def numbers(self) -> dict[str, float]:
        """The state as a flat table of numbers, named as the columns of :meth:`Result.to_dataframe`."""
        at = None if self._tip_at is None else [float(x) for x in self._tip_at]
        found: dict[str, float] = json.loads(_native.numbers(json.dumps(self.summary), self._length, at))
        return found

    def __repr__(self) -> str:
        at = f"{self.pressure_kpa:.6g} kPa" if self.time is None else f"time {self.time:.6g}"
        said = []
        if not math.isnan(self.end_face_angle_deg):
            said.append(f"end face {self.end_face_angle_deg:.4g}°")
        if not math.isnan(self.chord_angle_deg):
            said.append(f"chord {self.chord_angle_deg:.4g}°")
        said.append(f"largest von Mises stress {self.max_von_mises_mpa:.3g} MPa")
        return f"<State at {at}: {', '.join(said)}>"


class Result(Sequence[State]):
    """What a run found: arrays over the states that were reached, in their order, and the states themselves, ``result[k]``.

    Attributes
    ----------
    status : str
        ``converged``; ``past-limit``: followed past a limit point of the load; ``not-converged``; ``interrupted``; ``setup``: the equations
        could not be set up; ``running``: of a folder whose run has not ended, or was killed.
    states, on_the_way : list of State
        Those that were asked for; of a run that ended early, equilibria beyond the last of these.
    failure : str
        How it ended early; empty if it did not.
    reason : dict or None
        Why: ``kind``, ``is_physical``, ``message``, ``advice``.
    warnings : list of dict
        What to be careful about: ``kind``, ``message``, ``advice``.
    error_estimate : dict or None
        Estimated errors of the last state, if ``output.error_estimate`` asks for them: ``errors``, by quantity its ``value``, signed ``error`` and
        ``percent``; or ``why_not``.
    iterations : int
        Newton iterations, those of rejected attempts included.
    timing : dict
        Seconds by kind of work.
    folder : pathlib.Path or None
        Where it is recorded.
    """

    def __init__(self) -> None:
        self.title = ""
        self.status = "running"
        self.states: list[State] = []
        self.on_the_way: list[State] = []
        self.failure = ""
        self.reason: dict[str, Any] | None = None
        self.warnings: list[dict[str, Any]] = []
        self.error_estimate: dict[str, Any] | None = None
        self.iterations = 0
        self.timing: dict[str, float] = {}
        self.folder: Path | None = None
        self._study: _native.Study | None = None
        self._outcome: _native.Outcome | None = None
        self._page: str | None = None

    # --- where results come from

    @classmethod
    def open(cls, folder: str | os.PathLike[str]) -> Result:
        """Opens the result folder of an earlier run, of this package or of the program. Fields are read when they are asked for.

        Raises
        ------
        InputError
            For a folder that holds no results, or damaged ones.
        FileNotFoundError
            If there is no such folder.
        """
        folder = Path(folder)
        result = cls()
        result.folder = folder
        for _ in range(TRIES):
            summary = _summary_of(folder)
            try:
                result._study = _native.Study.load(folder / "case.toml", [])
            except InputError:
                # The numbers are there all the same.
                result._study = None
            if _summary_of(folder) == summary:
                break
        else:
            raise InputError(f"{folder}: a run is writing to it at this moment; try again")
        length = result._study.length if result._study else None
        at = summary.get("probes", {}).get("tip", {}).get("at")
        lock = threading.Lock()

        @cache
        def body() -> _Body:
            with lock:
                files = (state._field_file() for state in (*result.states, *result.on_the_way))
                file = next((file for file in files if file is not None), None)
            if file is None:
                raise AttributeError("no fields were recorded (output.fields = false)")
            return _Body.of_file(file)

        def states(kind: str, name: str) -> list[State]:
            found = []
            for i, step in enumerate(_reached(summary, kind)):
                path = folder / "fields" / f"step_{name}{i + 1:02}.vtu"
                found.append(State(step, length, body, partial(_field_file, path, kind, i, step), at))
            return found

        result.states, result.on_the_way = states("steps", ""), states("on_the_way", "on_the_way_")
        result.title, result.status = summary.get("title", ""), summary["status"]
        result.failure, result.reason = summary.get("failure") or "", summary.get("failure_reason")
        result.warnings = summary.get("warnings") or []
        result.error_estimate = summary.get("error_estimate")
        result.iterations, result.timing = summary.get("iterations_total", 0), summary.get("timing", {})
        return result

    @classmethod
    def _of(
        cls,
        study: _native.Study,
        analysis: _native.Analysis,
        outcome: _native.Outcome,
        folder: Path | None,
    ) -> Result:
        result = cls()
        result.title, result.status, result.folder = analysis.title, outcome.status, folder
        result.failure = outcome.failure
        result.reason = json.loads(outcome.reason) if outcome.reason else None
        result.warnings = json.loads(outcome.warnings)
        result.error_estimate = json.loads(outcome.error_estimate)
        result.iterations, result.timing = outcome.iterations, json.loads(outcome.timing)
        result._study, result._outcome = study, outcome
        body = _Body.of_analysis(analysis)
        make = _maker(study, lambda: body)
        result.states = [make(state) for state in outcome.states]
        result.on_the_way = [make(outcome.last)] if outcome.last else []
        return result

    # --- as a sequence

    def __len__(self) -> int:
        return len(self.states)

    @overload
    def __getitem__(self, index: int) -> State: ...
    @overload
    def __getitem__(self, index: slice) -> list[State]: ...
    def __getitem__(self, index: int | slice) -> State | list[State]:
        return self.states[index]

    def __iter__(self) -> Iterator[State]:
        return iter(self.states)

    def at(self, pressure_kpa: float | None = None, *, time: float | None = None) -> State:
        """The state at a pressure, kPa, or at a model's time, that was asked for."""
        if (pressure_kpa is None) == (time is None):
            raise InputError("give either a pressure or a time")
        for state in self.states:
            when, wanted = (state.pressure_kpa, pressure_kpa) if time is None else (state.time, time)
            if when is not None and wanted is not None and abs(when - wanted) <= 1e-9 * max(1.0, abs(wanted)):
                return state
        raise KeyError(f"no state at {pressure_kpa} kPa" if time is None else f"no state at the time {time}")

    # --- arrays over the states

    def _column(self, name: str) -> Floats:
        return np.array([getattr(state, name) for state in self.states], dtype=float)

    @property
    def pressure_kpa(self) -> Floats:
        """Air pressure, kPa, shape (states,); that of the first cavity of a model."""
        return self._column("pressure_kpa")

    @property
    def time(self) -> Floats:
        """Times of a model's schedule, shape (states,); of an actuator its pressures."""
        return self._column("_when")

    @property
    def end_face_angle_deg(self) -> Floats:
        """Angle by which the end face has turned, degrees, positive downwards, shape (states,); NaN for a body without one."""
        return self._column("end_face_angle_deg")

    @property
    def chord_angle_deg(self) -> Floats:
        """Angle of the chord from the clamp to the tip, degrees, positive downwards, shape (states,). Of a circular arc it is half of the end
        face's; published "bending angles" are often this one."""
        return self._column("chord_angle_deg")

    @property
    def tip(self) -> Floats:
        """Displacement of the tip, mm, shape (states, 3), see :attr:`State.tip`."""
        return np.array([state.tip for state in self.states], dtype=float).reshape(-1, 3)

    @property
    def cavity_volume_mm3(self) -> Floats:
        """Volume of the air in all cavities, mm³, shape (states,)."""
        return self._column("cavity_volume_mm3")

    @property
    def reaction(self) -> Floats:
        """Sum of the reactions of all supports, N, shape (states, 3); planes of symmetry are none."""
        return np.array([state.reaction for state in self.states], dtype=float).reshape(-1, 3)

    @property
    def max_von_mises_mpa(self) -> Floats:
        """Largest von Mises stress at an integration point, MPa, shape (states,). It grows without limit at sharp edges as meshes become
        finer."""
        return self._column("max_von_mises_mpa")

    @property
    def von_mises_p99_mpa(self) -> Floats:
        """Von Mises stress that 99 % of the volume stays below, MPa, shape (states,)."""
        return self._column("von_mises_p99_mpa")

    @property
    def strain_energy_mj(self) -> Floats:
        """Strain energy, mJ, shape (states,)."""
        return self._column("strain_energy_mj")

    @property
    def contact(self) -> dict[str, Floats]:
        """What the contact carries, each of shape (states,): ``points_active``, ``area_mm2``, ``max_penetration_mm``, ``gaps_in_contact`` …"""
        names = list(dict.fromkeys(name for state in self.states for name in state.summary["contact"]))
        value = [[state.summary["contact"].get(name, math.nan) for state in self.states] for name in names]
        return {name: np.array(column, dtype=float) for name, column in zip(names, value, strict=True)}

    @property
    def probes(self) -> dict[str, Floats]:
        """Displacement of every probe, mm, shape (states, 3)."""
        names = self.states[0].probes if self.states else {}
        return {name: np.array([state.probes[name] for state in self.states]) for name in names}

    @property
    def cavities(self) -> dict[str, dict[str, Floats]]:
        """Of every cavity of a model ``pressure_kpa`` and ``volume_mm3``, each of shape (states,); NaN where an open cavity has no volume."""
        return self._tables("cavities")

    @property
    def obstacles(self) -> dict[str, dict[str, Floats]]:
        """Of every obstacle ``force_n`` (states, 3), ``moment_nmm``, ``area_mm2``, ``max_penetration_mm`` …"""
        return self._tables("obstacles")

    @property
    def reactions(self) -> dict[str, Floats]:
        """Sum of the reactions of every support of a model, N, shape (states, 3)."""
        names = self.states[0].summary.get("reactions", {}) if self.states else {}
        return {name: np.array([state.summary["reactions"][name] for state in self.states]) for name in names}

    def _tables(self, kind: str) -> dict[str, dict[str, Floats]]:
        tables = self.states[0].summary.get(kind, {}) if self.states else {}
        found: dict[str, dict[str, Floats]] = {}
        for name, table in tables.items():
            rows = [state.summary[kind][name] for state in self.states]
            keys = list(dict.fromkeys(key for row in rows for key in row)) or list(table)
            found[name] = {key: np.array([row.get(key, math.nan) for row in rows], dtype=float) for key in keys}
        return found

    # --- going on, and keeping

    def resume(
        self,
        pressures: ArrayLike | None = None,
        *,
        times: ArrayLike | None = None,
        threads: int | None = None,
        progress: bool = False,
        on_state: Callable[[State], object] | None = None,
    ) -> Result:
        """Goes on from the last load step, through what is left of the pressures (kPa) or of a model's times, or through others beyond that
        step, as if the run had never ended. What is recorded goes on in its folder.

        Raises
        ------
        NotConverged, Interrupted
            As :meth:`Study.solve`.
        InputError
            For positions before the last load step; for later times of a model whose loads grow up to the last time; for a folder in which
            another run has been recorded since.
        """
        if self._study is None:
            raise InputError(f"{self.folder}: case.toml is missing or cannot be read: there is nothing to go on with")
        reached = [state for state in self.states if state.summary.get("kind", "requested") == "requested"]
        done = [state._when for state in reached]
        hearing = Hearing(threads, progress, on_state)
        study = self._study
        for key, values in (positions(study, pressures, times) or {}).items():
            if lost := [x for x in values if done and x <= done[-1] and x not in done]:
                raise InputError(f"{key}: {lost} lie before {done[-1]:g}, which was reached already")
            study = study.with_changes(flat({key: done + [x for x in values if not done or not x <= done[-1]]}))
        analysis = study.build(False, hearing.threads)
        if self.folder is not None:
            self._check_folder()
            return follow(study, analysis, hearing, out=self.folder, resumes=True, fields=True)
        start = self._outcome.start(analysis) if self._outcome else None
        if start is None:
            return self
        return follow(study, analysis, hearing, out=None, resumes=False, fields=True, start=start)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Records a result that was not recorded while it was solved, as the program does: `summary.json`, `case.toml`, fields for ParaView,
        a checkpoint, `report.html`. Returns the folder."""
        folder = Path(folder)
        self._save(folder)
        (folder / "report.html").write_text(_native.report_page(folder), encoding="utf-8")
        return folder

    def _save(self, folder: Path) -> None:
        if self._outcome is None or self._study is None:
            raise InputError(f"the result is recorded already, in {self.folder}: copy that folder")
        if any(isinstance(s._fields, _native.State) and not s._fields.has_fields for s in self.states):
            raise InputError("no fields were kept: solve with fields=True")
        self._outcome.record(folder)

    # --- for others

    def export(
        self,
        to: str,
        out: str | os.PathLike[str],
        *,
        at: float | None = None,
        colour: str | None = None,
        range: tuple[float, float] | None = None,
        view: str | None = None,
        width: float | None = None,
        pictures: int | None = None,
        wall: float | None = None,
    ) -> list[Path]:
        """Writes the result in the format of another program, as ``pneuflex export`` does, and returns the files.

        Parameters
        ----------
        to : str
            ``stl``, ``obj``: the surface; ``glb``: the body in motion; ``csv``, ``npz``: fields; ``vtk``, ``msh``: the mesh at rest, for SOFA and
            MuJoCo; ``gif``, ``mp4``: a film; ``png``: a folder of its pictures; ``mould``: a folder with a mould's parts.
        out : path
            The file, or the folder.
        at : float, optional
            Pressure, kPa, or time of the state, where the format is one of a state; the last one unless told otherwise.
        colour, range
            ``von-mises``, ``displacement``, ``contact`` or ``none``, and the ends of the colours.
        view, width, pictures
            Of a film: ``iso``, ``section`` or ``side``, pixels, and how many pictures.
        wall : float, optional
            Thickness of a mould's walls, mm.

        Raises
        ------
        InputError
            For what the format has no use for, and for results without fields.
        """
        asked = {"at": at, "colour": colour, "range": range, "view": view, "width": width, "pictures": pictures, "wall": wall}
        with self._recorded() as folder:
            return _native.export(folder, to, Path(out), json.dumps(asked))

    def compare(
        self,
        measured: str | os.PathLike[str],
        *,
        line: str | None = None,
        fit: Iterable[str] = (),
    ) -> dict[str, Any]:
        """Compares the result with a table of measurements (CSV), as ``pneuflex compare`` does, and returns what `comparison.json` says: in ``kinds`` the
        ``rms`` and the ``largest`` difference of every kind, ``alignment`` if something was fitted; and ``picture``, an SVG file's text.

        Parameters
        ----------
        measured : path
            Columns ``pressure_kpa`` or ``time``; points ``x_mm``, ``z_mm``, and columns of :meth:`State.numbers`.
        line : str, optional
            What points are compared with: ``bottom``, or ``outline``.
        fit : iterable of str
            What is fitted before: ``scale``, ``rotation``, ``offset``.
        """
        with self._recorded() as folder:
            text, picture = _native.compare(folder, Path(measured), line, list(fit))
        found: dict[str, Any] = json.loads(text)
        return {**found, "picture": picture}

    def to_dataframe(self) -> Any:
        """The states as a `pandas.DataFrame`, one row for each, units in the names of the columns."""
        try:
            import pandas
        except ImportError as error:
            raise missing("pandas", "to_dataframe()") from error
        return pandas.DataFrame([state.numbers() for state in self.states])

    def mesh(self, index: int = -1, deformed: bool = False) -> Any:
        """The mesh of a state, see :meth:`State.mesh`."""
        return self[index].mesh(deformed)

    def plot(self, index: int = -1, field: str = "von_mises", **arguments: Any) -> Any:
        """Shows a state, the last one unless told otherwise, see :meth:`State.plot`."""
        return self[index].plot(field, **arguments)

    def plot_curves(self) -> Any:
        """Draws angle, tip, volume and stress over the pressure with matplotlib, a model's over its time; returns the figure."""
        try:
            from matplotlib import pyplot
        except ImportError as error:
            raise missing("matplotlib", "plot_curves()") from error
        is_model = any(state.time is not None for state in self.states)
        curves: list[tuple[str, dict[str, Floats]]] = []
        if not np.isnan(self.end_face_angle_deg).all():
            curves.append(("angle, °", {"end face": self.end_face_angle_deg, "chord": self.chord_angle_deg}))
        try:
            tip = self.tip
            curves.append(("tip, mm", {"u_x": tip[:, 0], "u_z": tip[:, 2]}))
        except AttributeError:
            curves += [(f"{name}, mm", dict(zip("xyz", u.T, strict=True))) for name, u in self.probes.items()]
        curves.append(("volume of the air, mm³", {"": self.cavity_volume_mm3}))
        curves.append(("von Mises stress, MPa", {"largest": self.max_von_mises_mpa, "99 %": self.von_mises_p99_mpa}))
        figure, axes = pyplot.subplots(1, len(curves), figsize=(3.4 * len(curves), 3.2), layout="constrained")
        for axis, (label, lines) in zip(np.atleast_1d(axes), curves, strict=True):
            for name, values in lines.items():
                axis.plot(self.time, values, marker="o", label=name or None)
            axis.set_xlabel("time" if is_model else "air pressure, kPa")
            axis.set_ylabel(label)
            if len(lines) > 1:
                axis.legend()
        return figure

    def __repr__(self) -> str:
        name = f" of {self.title!r}" if self.title else ""
        lines = [f"<Result{name}: {self.status}, {len(self)} {'state' if len(self) == 1 else 'states'}>"]
        lines += [f"  {repr(state)[1:-1]}" for state in self.states[:12]]
        if len(self) > 12:
            lines.append(f"  … and {len(self) - 12} more")
        if self.failure:
            lines.append(f"  {self.failure}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """The report page of the run, as notebooks show it."""
        page = self._page
        if page is None:
            try:
                page = self._make_page()
            except (InputError, OSError):
                return f"<pre>{html.escape(repr(self))}</pre>"
            self._page = page
        source = html.escape(page, quote=True)
        return f'<iframe srcdoc="{source}" style="width: 100%; height: 640px; border: 0" title="pneuflex"></iframe>'

    def _check_folder(self) -> None:
        """Whether the folder holds this run still, which may have gone on."""
        assert self.folder is not None
        _check_states(self.folder, "steps", 0, [state.summary for state in self.states])

    @contextmanager
    def _recorded(self) -> Iterator[Path]:
        """A folder that holds this run: its own, or one that goes afterwards."""
        if self.folder is not None:
            yield self.folder
            self._check_folder()
            return
        with tempfile.TemporaryDirectory(prefix="pneuflex-") as folder:
            self._save(Path(folder))
            yield Path(folder)

    def _make_page(self) -> str:
        with self._recorded() as folder:
            return _native.report_page(folder)


def _summary_of(folder: Path) -> dict[str, Any]:
    """What `summary.json` of a folder says."""
    path = folder / "summary.json"
    try:
        summary: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        form = summary.get("format", 1)
    except OSError as error:
        if not folder.exists():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), os.fspath(folder)) from error
        what = "holds no summary.json" if folder.is_dir() else "is no folder"
        raise InputError(f"{folder}: not a result folder: it {what}") from error
    except (ValueError, AttributeError) as error:
        raise InputError(f"{path}: damaged: {error}") from error
    if form != FORMAT:
        raise InputError(f"{path}: it has the format {form} instead of {FORMAT}: another version of pneuflex wrote it")
    return summary


def _reached(summary: dict[str, Any], kind: str) -> list[dict[str, Any]]:
    """States that were reached: `steps`, or those `on_the_way`."""
    return [step for step in summary.get(kind, []) if kind != "steps" or step.get("converged")]


def _check_states(folder: Path, kind: str, first: int, states: list[dict[str, Any]]) -> None:
    """Refuses a folder that does not hold states any more, from the first on of a kind."""
    try:
        is_there = _reached(_summary_of(folder), kind)[first : first + len(states)] == states
    except InputError:
        is_there = False
    if not is_there:
        raise InputError(f"{folder}: another run has been recorded there since: Result.open opens what is there now")


def _field_file(path: Path, kind: str, number: int, step: dict[str, Any]) -> _native.FieldFile | None:
    """The fields of a state in a result folder, as long as that holds the run of which the state is."""
    try:
        return _native.read_field_file(path) if path.is_file() else None
    finally:
        # Afterwards: a run that replaces another one removes its summary before it writes any fields.
        _check_states(path.parents[1], kind, number, [step])


class Hearing:
    """How a run is solved, and who hears of it."""

    def __init__(self, threads: int | None, progress: bool, on_state: Callable[[State], object] | None) -> None:
        if on_state is not None and not callable(on_state):
            raise InputError(f"on_state = {on_state!r} cannot be called with a state")
        self.threads = None if threads is None else whole(threads, "threads")
        self.progress, self.on_state = progress, on_state


def _maker(study: _native.Study, body: Callable[[], _Body]) -> Callable[[_native.State], State]:
    length = study.length
    probes = json.loads(study.values).get("probe", [])
    at = next((probe["at"] for probe in probes if probe["name"] == "tip"), None)
    return lambda state: State(json.loads(state.summary), length, body, state, at)


def positions(
    study: _native.Study, pressures: ArrayLike | None, times: ArrayLike | None
) -> dict[str, list[float]] | None:
    """The positions on the load path that were given by their key, unless none were."""
    if pressures is not None and times is not None:
        raise InputError("give either pressures, of an actuator, or times, of a model")
    if pressures is not None and study.kind != "case":
        raise InputError("a model has times, not pressures: its pressures are in its cavities")
    if times is not None and study.kind == "case":
        raise InputError("an actuator has pressures, not times")
    if pressures is not None:
        return {"load.pressure_kpa": listed(pressures, "pressures")}
    return None if times is None else {"load.times": listed(times, "times")}


def follow(
    study: _native.Study,
    analysis: _native.Analysis,
    hearing: Hearing,
    *,
    out: Path | None,
    resumes: bool,
    fields: bool,
    start: _native.Start | None = None,
    neighbour: tuple[str, str] | None = None,
    keeps_equilibria: bool = False,
) -> Result:
    """Solves an analysis of a study, with the guesses of a neighbour: the folder of a sweep and the name of a design in it.

    Raises
    ------
    NotConverged, Interrupted
        With what was reached.
    """
    requested = analysis.requested
    progress = None
    if hearing.progress:
        unit = " kPa" if study.kind == "case" else ""
        progress = Progress(requested[-1] if requested else 0.0, unit)
    tell: Callable[[_native.State], object] | None = None
    if hearing.on_state is not None:
        hear, body = hearing.on_state, _Body.of_analysis(analysis)
        make = _maker(study, lambda: body)

        def tell(state: _native.State) -> object:
            return hear(make(state))

    iteration = progress.iteration if progress else None
    outcome = _native.solve(analysis, hearing.threads, out, resumes, start, fields, neighbour, keeps_equilibria, tell, iteration)
    if progress:
        progress.finish(outcome.status)
    if out is not None and outcome.status != "setup":
        try:
            (out / "report.html").write_text(_native.report_page(out), encoding="utf-8")
        except (InputError, OSError) as error:
            # What was solved is there all the same.
            warnings.warn(f"report.html could not be written: {error}", RuntimeWarning, stacklevel=3)
    if out is not None and resumes:
        result = Result.open(out)
    else:
        result = Result._of(study, analysis, outcome, out)
    match outcome.status:
        case "not-converged" | "setup":
            raise NotConverged(outcome.failure, result)
        case "interrupted":
            raise Interrupted(outcome.failure or "interrupted", result)
    return result
