"""Solving one design of a sweep, in this process or in another one."""

from __future__ import annotations

import json
import os
import pickle
import struct
import sys
import threading
import time
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import IO, Any

from ._errors import InputError, NotConverged
from ._study import Study

Row = dict[str, Any]
"""What became of a design."""


@dataclass(frozen=True)
class Task:
    """One design of a sweep.

    Attributes
    ----------
    identity
        Name of its row's file: what it is a function of.
    design
        Values by keys.
    base
        The pickled study whose keys are set, or the file that holds it, whose name changes with what it holds.
    folder
        The sweep's folder; rows are written there if it can be reached.
    record
        Folder for the design's own results, if these are kept.
    threads
        Of the solver.
    starts_from
        Name of the design that it starts from.
    is_neighbour
        Whether others start from it.
    """

    identity: str
    design: dict[str, Any]
    base: bytes | str
    folder: str
    record: str | None
    threads: int
    starts_from: str | None = None
    is_neighbour: bool = False


def row_file(folder: str | os.PathLike[str], identity: str) -> Path:
    """The file of a design's row."""
    return Path(folder) / "rows" / f"{identity}.json"


@lru_cache(maxsize=4)
def _base(base: bytes | str) -> Study:
    data = base if isinstance(base, bytes) else Path(base).read_bytes()
    study: Study = pickle.loads(data)
    return study


def solve_design(task: Task) -> Row:
    """Solves a design and writes its row before anybody hears of it: what is finished is never lost. Designs that cannot be solved have
    rows, too, which say why."""
    try:
        # Of a worker that died, or was lost, after it had finished.
        finished: Row = json.loads(row_file(task.folder, task.identity).read_text(encoding="utf-8"))
        return finished
    except (OSError, ValueError):
        pass
    began, cpu = time.perf_counter(), time.process_time()
    row: Row = {"identity": task.identity, "status": "error", "reason": None, "message": "", "advice": "", "states": []}
    row["warnings"] = []
    result = None
    try:
        study = _base(task.base).copy().set(task.design)
        neighbour = (task.folder, task.starts_from) if task.starts_from else None
        result = study._solve_in_sweep(task.threads, task.record, neighbour, task.is_neighbour)
    except NotConverged as ended:
        result = ended.result
        row |= {"message": str(ended), "advice": ended.advice}
    except InputError as error:
        # Another machine, or this one at another time, may have room for it.
        is_of_machine = any(problem.of_machine for problem in error.problems)
        status, reason = ("error", "machine") if is_of_machine else ("bad-input", "bad-input")
        row |= {"status": status, "reason": reason, "message": str(error)}
    except Exception as error:  # noqa: BLE001 — the process must go on, and whoever waits must hear of it
        row |= {"reason": type(error).__name__, "message": str(error)}
    if result is not None:
        row["status"] = result.status
        row["reason"] = result.reason["kind"] if result.reason else (None if not result.failure else result.status)
        row["states"] = [state.numbers() for state in result]
        errors = (result.error_estimate or {}).get("errors", {})
        if row["states"]:
            row["states"][-1] |= {f"error.{key}": error["error"] for key, error in errors.items()}
        row["warnings"] = [warning["kind"] for warning in result.warnings]
        if (outcome := result._outcome) is not None:
            outcome.leave_equilibria(task.folder, task.identity)
            if outcome.has_started_from:
                row["started_from"] = task.starts_from
    row["seconds"] = time.perf_counter() - began
    row["cpu_seconds"] = time.process_time() - cpu
    row["threads"] = task.threads
    keep(task.folder, row)
    return row


def keep(folder: str | os.PathLike[str], row: Row) -> None:
    """Writes a design's row as a whole or not at all. A folder that cannot be reached from here is left to the sweep."""
    path = row_file(folder, row["identity"])
    if not path.parent.is_dir():
        return
    replace(path, json.dumps(row).encode())


def replace(path: Path, data: bytes) -> None:
    """Writes a file so that there is the old one or the new one, whenever this process or the machine dies."""
    part = path.with_name(f".{path.name}.{os.getpid()}-{threading.get_ident()}.part")
    with open(part, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, path)


# --- a process that solves designs: pickled tasks come in, pickled rows go out


def send(stream: IO[bytes], thing: Any) -> None:
    """Sends something to another process."""
    data = pickle.dumps(thing)
    stream.write(struct.pack("<Q", len(data)) + data)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """What another process sends.

    Raises
    ------
    EOFError
        If it has ended.
    """
    head = stream.read(8)
    size = struct.unpack("<Q", head)[0] if len(head) == 8 else 0
    data = stream.read(size)
    if len(head) < 8 or len(data) < size:
        raise EOFError
    return pickle.loads(data)


def main() -> None:
    """Solves what comes in until nothing more can come."""
    # What anything prints must not get among the rows.
    rows = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    tasks = sys.stdin.buffer
    while True:
        try:
            task = receive(tasks)
        except EOFError:
            return
        send(rows, solve_design(task))
