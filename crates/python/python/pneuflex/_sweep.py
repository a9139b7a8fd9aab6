"""Many designs, on all cores or a cluster."""

from __future__ import annotations

import hashlib
import io
import json
import math
import os
import pickle
import sys
import time
import weakref
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, Literal

from numpy.typing import ArrayLike

from . import _native
from ._arrays import whole
from ._errors import InputError, missing
from ._processes import Processes, WorkerDied, cores
from ._result import Result, positions
from ._space import Design, Grid, LatinHypercube, Sobol, designs_of
from ._study import Case, Study
from ._toml import flat
from ._worker import Row, Task, keep, replace, row_file, solve_design

__all__ = ["Grid", "LatinHypercube", "Sobol", "Sweep", "sweep"]

LARGE = 64 * 1024
"""Bytes of a study that is read from the sweep's folder instead of being sent with every design."""

MEMORY_SHARE = 0.8
"""Share of the memory that is available that workers may fill, by their estimates."""

TRIES = 3
"""How often a design is handed to an executor that loses it."""

TRANSIENT = ("worker-died", "error")
"""What became of a design for a reason that is not its own."""


class Sweep(Sequence[Row]):
    """What became of the designs of a sweep, in their order. Each is a dict with ``design`` (its number), ``inputs``, ``status``, ``reason``,
    ``message``, ``advice``, ``seconds``, ``cpu_seconds``, ``threads`` and ``states``: for every reached state its numbers.

    ``status`` is that of a :class:`Result`, or ``bad-input``: values that make no body. The next call tries again what did not end by
    the design itself: ``worker-died``: the process that solved it was killed, each time that it was tried; ``error``: the machine had no room for
    it, its results could not be written, or something unforeseen. ``open`` is a design that is not finished yet.
    """

    def __init__(self, folder: Path, rows: list[Row]) -> None:
        self.folder, self.rows = folder, rows

    @classmethod
    def open(cls, folder: str | os.PathLike[str]) -> Sweep:
        """Opens the folder of a sweep, also of one that is still running or was killed."""
        folder = Path(folder)
        path = folder / "sweep.json"
        if not path.is_file():
            raise InputError(f"{folder} holds no sweep")
        plan = json.loads(path.read_text(encoding="utf-8"))
        return cls(folder, [_row_of(folder, i, **entry) for i, entry in enumerate(plan["designs"])])

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: Any) -> Any:
        return self.rows[index]

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    @property
    def failures(self) -> list[Row]:
        """Designs that did not reach all that was asked for, with reasons."""
        return [row for row in self.rows if row["status"] not in ("converged", "past-limit", "open")]

    @property
    def unfinished(self) -> list[Row]:
        """Designs that are not finished yet."""
        return [row for row in self.rows if row["status"] == "open"]

    def table(self) -> list[dict[str, Any]]:
        """One row for every reached state of every design: its number, inputs and status, what was found, time, reason. A design without any
        state has one row."""
        found = []
        numbers = {row["identity"]: row["design"] for row in reversed(self.rows)}
        has_neighbours = any(row.get("started_from") for row in self.rows)
        for row in self.rows:
            plain = {key: json.dumps(v, separators=(",", ":"), ensure_ascii=False) if isinstance(v, (dict, list)) else v for key, v in row["inputs"].items()}
            head = {"design": row["design"], **plain, "status": row["status"]}
            if has_neighbours:
                head["started_from"] = numbers.get(row.get("started_from") or "")
            tail = {key: row.get(key) for key in ("reason", "message", "seconds", "cpu_seconds", "threads")}
            for state in row["states"] or [{}]:
                found.append({**head, **state, **tail})
        return found

    def to_dataframe(self) -> Any:
        """:meth:`table` as a `pandas.DataFrame`."""
        try:
            import pandas
        except ImportError as error:
            raise missing("pandas", "to_dataframe()") from error
        return pandas.DataFrame(self.table())

    def result(self, design: int) -> Result:
        """The result of a design whose fields were kept."""
        return Result.open(_record(self.folder, self.rows[design]["identity"]))

    def write(self) -> Path:
        """Writes the table into the folder: `table.parquet` where pyarrow is there, otherwise `table.csv`; returns its path."""
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            path = self.folder / "table.csv"
            replace(path, _native.table_of(self.folder).encode())
            # One of before would be taken for this one.
            (self.folder / "table.parquet").unlink(missing_ok=True)
            return path
        rows = self.table()
        names = list(dict.fromkeys(name for row in rows for name in row))
        # What stands behind the numbers stays there, whichever design had them first.
        last = ["reason", "message", "seconds", "cpu_seconds", "threads"]
        names = [name for name in names if name not in last] + last
        columns = {name: _alike([row.get(name) for row in rows]) for name in names}
        buffer = io.BytesIO()
        pyarrow.parquet.write_table(pyarrow.table(columns), buffer)
        path = self.folder / "table.parquet"
        replace(path, buffer.getvalue())
        (self.folder / "table.csv").unlink(missing_ok=True)
        return path

    def __repr__(self) -> str:
        done, failed = len(self) - len(self.unfinished), len(self.failures)
        lines = [f"<Sweep in {self.folder}: {done} of {len(self)} designs finished, {failed} of them failed>"]
        reasons: dict[str, int] = {}
        for row in self.failures:
            reason = row["reason"] or row["status"]
            reasons[reason] = reasons.get(reason, 0) + 1
        lines += [f"  {count} × {reason}" for reason, count in sorted(reasons.items(), key=lambda item: -item[1])]
        return "\n".join(lines)


def _alike(values: list[Any]) -> list[Any]:
    """Values of one type, as a column of Parquet has them."""
    kinds = {type(value) for value in values if value is not None}
    if kinds <= {int, float} or len(kinds) <= 1:
        return [float(v) if v is not None and kinds == {int, float} else v for v in values]
    return [None if value is None else str(value) for value in values]


def sweep(
    study: Study,
    space: Any,
    executor: Executor | None = None,
    *,
    out: str | os.PathLike[str],
    pressures: ArrayLike | None = None,
    times: ArrayLike | None = None,
    fields: bool = False,
    workers: int | None = None,
    threads: int | None = None,
    start: Literal["rest", "neighbours"] = "rest",
    progress: bool = True,
    on_row: Callable[[Row], object] | None = None,
) -> Sweep:
    """Solves many designs. What is finished is kept whatever dies, and not solved again: the same call goes on, also with more designs.

    Parameters
    ----------
    study
        The case or model whose keys are set.
    space
        Values by keys, every combination of which is a design (a :class:`Grid`); a :class:`LatinHypercube` or :class:`Sobol` sequence; a list of
        designs, each with values by keys; or a table of pandas, one design in each row.
    executor
        Where designs are solved: any `concurrent.futures.Executor`, e.g. Dask's ``client.get_executor()`` for a cluster, whose workers should
        reach `out`. Without one, processes of this machine.
    out
        Folder of the sweep: `table.parquet` (`table.csv` without pyarrow), a file per design in `rows`, and with `fields` a result folder per
        design in `designs`.
    pressures, times
        As for :meth:`Study.solve`, for all designs.
    fields
        Whether every design's fields and report are kept: :meth:`Sweep.result`.
    workers, threads
        Number of processes of this machine, and of threads that each design is solved with. Unless told otherwise as many processes as there
        are cores, or as have room in the memory by the largest design's estimate (:meth:`Study.check`); cores that are left over are
        shared out as threads. With an executor one thread.
    start
        ``"neighbours"``: guesses for the load steps come from a design before it whose numbers all differ by at most 10 %, where there is one
        on a mesh of the same topology; the table has its number in ``started_from``. Results are the same to the solver's tolerances.
    progress
        Whether a line on standard error says how far the sweep is, how many designs have failed, and the time left.
    on_row
        Called with the row of every design as it is finished.

    Returns
    -------
    Sweep
        Designs that could not be solved are rows, too, with their reason.

    Raises
    ------
    InputError
        A key that no design can have, values that are out of range in every design, a folder that holds something else.
    KeyboardInterrupt
        Ctrl-C; what is finished is kept.
    """
    if not isinstance(study, Study):
        raise InputError(f"study = {study!r:.100} must be a Case or a Model")
    if executor is not None and workers is not None:
        raise InputError("workers are those of this machine: give either these or an executor")
    if start not in ("rest", "neighbours"):
        raise InputError(f"start = {start!r:.100} must be 'rest' or 'neighbours'")
    if executor is not None and not hasattr(executor, "submit"):
        raise InputError(f"executor = {executor!r:.100} must be a concurrent.futures.Executor")
    workers, threads = (
        None if number is None else whole(number, name) for name, number in (("workers", workers), ("threads", threads))
    )
    base = study.copy()
    base.set(positions(base._study, pressures, times) or {})
    designs = designs_of(space)
    memory = _checked(base, designs)
    folder = Path(out).absolute()
    with _held(folder):
        base, contents = _in_memory(base, designs)
        origin = _native.identity_of(base._study, contents.pop(), False)
        entries = [
            {"identity": _identity(base, origin, fields, design, content), "inputs": _plain(design)}
            for design, content in zip(designs, contents, strict=True)
        ]
        _begin(folder, origin, entries, base)
        rows = {entry["identity"]: _row_of(folder, i, **entry) for i, entry in reversed(list(enumerate(entries)))}
        left = [entry for entry in entries if rows[entry["identity"]]["status"] in ("open", *TRANSIENT)]
        # A design that is there twice is solved once.
        left = list({entry["identity"]: entry for entry in left}.values())
        for entry in left:
            row_file(folder, entry["identity"]).unlink(missing_ok=True)
            del rows[entry["identity"]]
        by_identity = {entry["identity"]: design for entry, design in zip(entries, designs, strict=True)}
        share = _share(len(left), memory, workers, threads) if executor is None else (0, threads or 1)
        data = _sent(folder, base)
        record = (lambda identity: str(_record(folder, identity))) if fields else (lambda identity: None)
        neighbours = _neighbours(entries, designs) if start == "neighbours" else {}
        has_followers = set(neighbours.values())
        tasks = [
            Task(
                name := e["identity"], by_identity[name], data, str(folder), record(name), share[1],
                starts_from=neighbours.get(name), is_neighbour=name in has_followers,
            )
            for e in left
        ]
        teller = _Teller(len(entries), len(entries) - len(left), progress)
        teller.failed = sum(row["status"] not in ("converged", "past-limit") for row in rows.values())
        pool = executor if executor is not None else Processes(share[0]) if tasks else None
        is_done = False
        try:
            if pool is not None:
                # First those that others start from.
                for has_neighbour in (False, True):
                    for row in _solved(pool, [task for task in tasks if (task.starts_from is not None) == has_neighbour]):
                        if not row_file(folder, row["identity"]).exists():
                            keep(folder, row)
                        teller.row(row)
                        if on_row is not None:
                            on_row(row)
            is_done = True
        finally:
            if isinstance(pool, Processes):
                pool.shutdown(cancel_futures=not is_done)
            teller.finish()
            found = Sweep(folder, [_row_of(folder, i, **entry) for i, entry in enumerate(entries)])
            found.write()
            if not found.unfinished:
                _native.forget_neighbours(folder)
    return found


def _neighbours(entries: list[dict[str, Any]], designs: list[Design]) -> dict[str, str]:
    """Names of designs that start from another one, and of that."""
    texts = [flat({key: _plain(value) for key, value in design.items()}) for design in designs]
    return _native.neighbours_of([entry["identity"] for entry in entries], texts)


def _solved(pool: Executor, tasks: list[Task]) -> Iterator[Row]:
    """Rows as they come. What the executor loses is handed to it again."""
    tries = {task.identity: 1 for task in tasks}
    pending: dict[Future[Row], Task] = {pool.submit(solve_design, task): task for task in tasks}
    try:
        while pending:
            done, _ = wait(pending, timeout=1.0, return_when=FIRST_COMPLETED)
            for future in done:
                task = pending.pop(future)
                try:
                    row = future.result()
                except WorkerDied as error:
                    row = _lost(task, str(error))
                except Exception as error:
                    if tries[task.identity] >= TRIES:
                        raise RuntimeError(
                            f"the executor has lost a design {TRIES} times ({error!r}); what is finished is kept in {task.folder}, and the "
                            "same call goes on"
                        ) from error
                    tries[task.identity] += 1
                    # A pool that is broken refuses at once, by an error of its own.
                    pending[pool.submit(solve_design, task)] = task
                    continue
                yield row
    finally:
        for future in pending:
            future.cancel()


def _lost(task: Task, words: str) -> Row:
    row: Row = {"identity": task.identity, "status": "worker-died", "reason": "worker-died", "message": words}
    return row | {"advice": "", "states": [], "warnings": [], "seconds": None, "cpu_seconds": None, "threads": task.threads}


def _checked(base: Study, designs: list[Design]) -> float | None:
    """The largest estimate of memory, bytes. Fails if no design can be read: a key is misspelt, or everything is out of range."""
    first, largest, any_one = None, None, None
    for design in designs:
        try:
            one = base.copy().set(design)
            estimate = one._study.estimate
            any_one = any_one or one
        except InputError as error:
            # A name that is unknown is a slip.
            if any("unknown key" in problem.message or "no material" in problem.message for problem in error.problems):
                raise
            first = first or error
            continue
        if estimate is not None:
            largest = max(largest or 0.0, estimate[1])
    if any_one is None and first is not None:
        raise first
    if largest is None and any_one is not None and not isinstance(base, Case):
        try:
            # A mesh hardly changes with the design; the base itself is only a template.
            largest = any_one.check(force=True).memory_bytes
        except InputError:
            pass
    return largest


def _share(designs: int, memory: float | None, workers: int | None, threads: int | None) -> tuple[int, int]:
    """Numbers of workers and of threads of each."""
    all_cores = cores()
    if workers is None:
        workers = max(1, min(designs, all_cores // (threads or 1)))
        available = _native.available_memory()
        if memory and available:
            workers = max(1, min(workers, int(MEMORY_SHARE * available / memory)))
    return workers, threads or max(1, all_cores // workers)


def _plain(value: Any) -> Any:
    """A value as JSON has it."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "material"):
        return value.material
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple, range)):
        return [_plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        # It has no other form in JSON.
        return str(value)
    return os.fspath(value) if isinstance(value, os.PathLike) else value


def _in_memory(base: Study, designs: list[Design]) -> tuple[Study, list[str]]:
    """A study that reads nothing from the disk, wherever and whenever designs of it are solved, and digests of what is read for each design,
    and for the study itself, beside the values of its keys."""
    if base._study.kind == "case":
        return base, [""] * (len(designs) + 1)
    main = os.fspath(base._study.path)
    # By itself it may be a template that names no body.
    files = {main: base._study.text.encode()} if base._study.kind == "model" else {}
    first: dict[str, Design] = {}
    names = []
    for design in [*designs, {}]:
        try:
            one = base.copy().set(design)
        except InputError:
            # It reads nothing.
            names.append("")
            continue
        source = one.values.get("model") or {}
        names.append(json.dumps(source, sort_keys=True))
        if names[-1] in first:
            continue
        first[names[-1]] = design
        try:
            files |= one._files()
        except InputError:
            # Bad input, as long as it is what it is.
            path = Path(main).parent / source.get("file", "")
            files |= {os.fspath(path): path.read_bytes()} if path.is_file() else {}
    base = base._reading(files)
    contents = {name: _native.content_of(base.copy().set(design)._study) for name, design in first.items()}
    return base, [contents.get(name, "") for name in names]


def _sent(folder: Path, base: Study) -> bytes | str:
    """A study as it is sent to workers: pickled, or the file that holds it."""
    data = pickle.dumps(base)
    if len(data) <= LARGE:
        return data
    path = folder / f"base-{hashlib.blake2b(data, digest_size=16).hexdigest()}.pickle"
    for other in folder.glob("base-*.pickle"):
        if other != path:
            other.unlink()
    if not path.exists():
        replace(path, data)
    return str(path)


def _identity(base: Study, origin: str, fields: bool, design: Design, content: str) -> str:
    """The name of a design: what its results are a function of, so that the program finds it, too."""
    try:
        return _native.identity_of(base.copy().set(design)._study, content, fields)
    except InputError:
        return _native.identity_of_bad_input(origin, flat({key: _plain(value) for key, value in design.items()}), fields)


def _record(folder: Path, identity: str) -> Path:
    return folder / "designs" / identity


def _row_of(folder: Path, number: int, identity: str, inputs: dict[str, Any]) -> Row:
    path = row_file(folder, identity)
    row: Row = {"identity": identity, "status": "open", "reason": None, "message": "", "advice": "", "states": []}
    row |= {"warnings": [], "seconds": None, "cpu_seconds": None, "threads": None}
    try:
        row = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        pass
    return {"design": number, "inputs": inputs, **row}


def _begin(folder: Path, origin: str, entries: list[dict[str, Any]], base: Study) -> None:
    path = folder / "sweep.json"
    if path.is_file():
        try:
            old = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(f"{path}: damaged: {error}") from error
        if old.get("version") != _native.VERSION:
            raise InputError(f"{folder} holds a sweep of pneuflex {old.get('version')}: choose another folder")
        if old.get("origin") != origin:
            changed = [k for k in base.values if base.values[k] != old.get("values", {}).get(k)]
            words = f" ({', '.join(changed)} differ)" if changed else " (its mesh, its deck or what that includes differs)"
            raise InputError(f"{folder} holds a sweep of another case{words}: choose another folder")
    elif any(entry.name != ".lock" for entry in folder.iterdir()):
        raise InputError(f"{folder} holds files that are no sweep: choose another folder; nothing was touched")
    (folder / "rows").mkdir(exist_ok=True)
    for part in (folder / "rows").glob(".*.part"):
        part.unlink(missing_ok=True)
    plan = {"program": "pneuflex", "version": _native.VERSION, "origin": origin, "values": base.values, "designs": entries}
    replace(path, json.dumps(plan, indent=1).encode())


_locks: weakref.WeakSet[IO[bytes]] = weakref.WeakSet()
"""Locks that this process holds."""


def _let_go() -> None:
    for lock in _locks:
        lock.close()


if sys.platform != "win32":
    # A worker that was forked would hold the lock with its driver, and without it when that has died.
    os.register_at_fork(after_in_child=_let_go)


@contextmanager
def _held(folder: Path) -> Iterator[None]:
    """Keeps other sweeps out of a folder; the system forgets it when this process ends, however it ends."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = open(folder / ".lock", "ab")
    except OSError as error:
        raise InputError(f"{folder}: cannot be written to: {error}") from error
    with lock:
        _locks.add(lock)
        try:
            import fcntl

            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except ImportError:
            pass
        except BlockingIOError as error:
            raise InputError(f"{folder}: another sweep is writing to this folder") from error
        except OSError:
            # A file system without locks: nothing can be promised, but nothing is wrong either.
            pass
        yield


class _Teller:
    """One line that is written over and over."""

    def __init__(self, count: int, done: int, is_on: bool) -> None:
        self.count, self.done, self.begun_with, self.is_on = count, done, done, is_on
        self.failed, self.began, self.width, self.last = 0, time.monotonic(), 0, 0.0

    def row(self, row: Row) -> None:
        self.done += 1
        self.failed += row["status"] not in ("converged", "past-limit")
        if time.monotonic() - self.last > 0.2:
            self.last = time.monotonic()
            self.say("\r")

    def say(self, begin: str) -> None:
        if not self.is_on:
            return
        spent, solved = time.monotonic() - self.began, self.done - self.begun_with
        line = f"{self.done} of {self.count} designs, {self.failed} failed"
        if solved and self.done < self.count:
            line += f", about {_duration(spent / solved * (self.count - self.done))} left"
        elif solved:
            line += f", {_duration(spent)}"
        sys.stderr.write(begin + line.ljust(self.width))
        sys.stderr.flush()
        self.width = len(line)

    def finish(self) -> None:
        self.say("\r")
        if self.is_on:
            sys.stderr.write("\n")


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
