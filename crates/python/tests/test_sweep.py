"""Sweeps: every design once, whatever dies."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import small_case, write_brick

import pneuflex
from pneuflex import Grid, InputError, LatinHypercube, Sobol, Sweep

GAPS = [1.0, 1.5, 2.0, 2.5]


def test_a_grid_is_solved_once(tmp_path: Path) -> None:
    case = small_case(pressures=[1, 2])
    seen: list[str] = []
    space = {"actuator.gap": GAPS[:3], "material": ["dragon-skin-30", "ecoflex-00-30"]}
    found = pneuflex.sweep(case, space, out=tmp_path, progress=False, on_row=lambda row: seen.append(row["identity"]))
    assert len(found) == len(seen) == 6 and not found.failures and not found.unfinished
    assert [row["inputs"]["actuator.gap"] for row in found] == [1.0, 1.0, 1.5, 1.5, 2.0, 2.0]
    alone = case.copy().set({"actuator.gap": 1.5, "material": "ecoflex-00-30"}).solve(threads=1)
    assert [state["end_face_angle_deg"] for state in found[3]["states"]] == alone.end_face_angle_deg.tolist()
    table = found.table()
    assert len(table) == 12 and [row["design"] for row in table] == [i // 2 for i in range(12)]
    # Once more, with one design more, and one that is there twice: only what is new is solved.
    seen.clear()
    more = [*Grid(space).designs(), {"actuator.gap": 2.5}, {"actuator.gap": 2.5}, {"actuator.gap": -1.0}]
    again = pneuflex.sweep(case, more, out=tmp_path, progress=False, on_row=lambda row: seen.append(row["identity"]))
    assert len(seen) == 2 and len(again) == 9 and again[6]["states"] == again[7]["states"] != []
    assert again[8]["status"] == "bad-input" and "at least 0 mm" in again[8]["message"] and again.failures == [again[8]]
    assert "9 of 9 designs finished, 1 of them failed" in repr(again) and Sweep.open(tmp_path).rows == again.rows
    with pytest.raises(InputError, match=r"another case \(load, solver differ\)"):
        pneuflex.sweep(case, space, out=tmp_path, pressures=[3], progress=False)


def test_tables_are_those_of_parquet_and_csv(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case = small_case(pressures=[1])
    designs = [{"actuator.gap": 1.0}, {"actuator.gap": -1.0}, {"actuator.gap": 2.0}]
    with ThreadPoolExecutor(2) as pool:
        found = pneuflex.sweep(case, designs, pool, out=tmp_path, progress=False)
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "pyarrow", None)
        path = found.write()
    rows = list(csv.DictReader(path.open()))
    assert [row["design"] for row in rows] == ["0", "1", "2"] and rows[1]["status"] == "bad-input"
    angle = found[2]["states"][0]["end_face_angle_deg"]
    assert float(rows[2]["end_face_angle_deg"]) == angle and float(rows[0]["seconds"]) > 0
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(found.write()).to_pylist()
    assert table[2]["end_face_angle_deg"] == angle and table[1]["end_face_angle_deg"] is None


def test_spaces_of_designs() -> None:
    assert len(Grid({"a": [1, 2], "b": np.array([3, 4, 5])}).designs()) == 6
    with pytest.raises(InputError, match="no values for b"):
        Grid({"a": [1], "b": []}).designs()
    pytest.importorskip("scipy")
    ranges: dict[str, Any] = {"actuator.gap": (1.0, 2.0), "actuator.chambers": (2, 4), "mesh.element": ["hex27", "tet10"]}
    for kind in (LatinHypercube, Sobol):
        designs = kind(ranges, count=12, seed=3).designs()
        assert designs == kind(ranges, count=12, seed=3).designs() != kind(ranges, count=12, seed=4).designs()
        assert len(designs) == 12 and all(1 <= d["actuator.gap"] <= 2 for d in designs)
        assert {d["actuator.chambers"] for d in designs} == {2, 3, 4}
        assert {d["mesh.element"] for d in designs} == {"hex27", "tet10"}
    assert Sobol(ranges, count=9).designs()[:8] == Sobol(ranges, count=8).designs()
    bins = sorted(int(d["actuator.gap"] * 12) for d in LatinHypercube(ranges, count=12).designs())
    assert bins == list(range(12, 24))
    for bad in ((2.0, 1.0), 3, []):
        with pytest.raises(InputError, match="a"):
            LatinHypercube({"a": bad}, count=2)  # type: ignore[dict-item]


def test_slips_are_said_before_anything_is_solved(tmp_path: Path) -> None:
    case = small_case()
    out = tmp_path / "sweep"
    for space, match in [
        ({"actuator.gpa": [1, 2]}, "did you mean `gap`"),
        ({"actuator.gap": [-1, -2]}, "at least 0 mm"),
        ([], "no designs"),
        (3, "is no space of designs"),
    ]:
        with pytest.raises(InputError, match=match):
            pneuflex.sweep(case, space, out=out, progress=False)
        assert not out.exists()
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="nothing was touched"):
        pneuflex.sweep(case, {"actuator.gap": [1]}, out=tmp_path, progress=False)
    with pytest.raises(InputError, match="workers"):
        pneuflex.sweep(case, {"actuator.gap": [1]}, out=out, workers=0)


def test_fields_of_every_design_are_kept_when_asked_for(tmp_path: Path) -> None:
    found = pneuflex.sweep(small_case(pressures=[1]), {"actuator.gap": [1.0]}, out=tmp_path, fields=True, progress=False)
    result = found.result(0)
    assert result.end_face_angle_deg[0] == found[0]["states"][0]["end_face_angle_deg"] and len(result[0].displacement)
    assert (result.folder or Path()) / "report.html"


class Losing(Executor):
    """Loses every design once, as a cluster does whose worker has died."""

    def __init__(self) -> None:
        self.lost: set[str] = set()

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        if args[0].identity in self.lost:
            future.set_result(fn(*args))
        else:
            self.lost.add(args[0].identity)
            future.set_exception(ConnectionError("the worker has gone"))
        return future


def test_what_an_executor_loses_is_solved_again(tmp_path: Path) -> None:
    found = pneuflex.sweep(small_case(pressures=[1]), {"actuator.gap": GAPS[:2]}, Losing(), out=tmp_path, progress=False)
    assert [row["status"] for row in found] == ["converged"] * 2


SCRIPT = """
import sys, pneuflex
case = pneuflex.Case.actuator(2, flange=0, pressures=[1, 2, 3], mesh={"size": 2.5, "element": "hex8-q1p0"})
pneuflex.sweep(case, {"actuator.gap": [1 + i / 20 for i in range(12)]}, out=sys.argv[1], workers=2, progress=False,
               on_row=lambda row: print(row["identity"], flush=True))
"""


def children(pid: int) -> list[int]:
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    found = [int(word) for word in text.split()]
    for task in Path(f"/proc/{pid}/task").iterdir():
        found += [int(word) for word in (task / "children").read_text().split()]
    return sorted(set(found))


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks into /proc")
def test_killed_workers_and_drivers_lose_and_repeat_nothing(tmp_path: Path) -> None:
    out = tmp_path / "sweep"
    package = str(Path(pneuflex.__file__).parents[1])
    environment = os.environ | {"PYTHONPATH": package}

    def start() -> subprocess.Popen[str]:
        command = [sys.executable, "-c", SCRIPT, str(out)]
        return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)

    driver = start()
    assert driver.stdout is not None
    driver.stdout.readline()
    # Two workers die, one after the other, then the driver.
    for _ in range(2):
        worker = children(driver.pid)[0]
        os.kill(worker, signal.SIGKILL)
        driver.stdout.readline()
    orphans = children(driver.pid)
    driver.kill()
    driver.wait()
    deadline = time.monotonic() + 10
    while any(Path(f"/proc/{pid}").exists() for pid in orphans) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(Path(f"/proc/{pid}").exists() for pid in orphans), "a worker outlives its driver"
    before = {path.name: path.stat().st_mtime_ns for path in (out / "rows").glob("[!.]*.json")}
    assert 3 <= len(before) < 12
    assert len(Sweep.open(out).unfinished) == 12 - len(before)
    driver = start()
    said, _ = driver.communicate(timeout=120)
    assert driver.returncode == 0 and len(said.split()) == 12 - len(before)
    assert not set(said.split()) & {name.removesuffix(".json") for name in before}
    after = {path.name: path.stat().st_mtime_ns for path in (out / "rows").glob("[!.]*.json")}
    assert len(after) == 12 and before.items() <= after.items()
    found = Sweep.open(out)
    assert not found.failures and not found.unfinished
    assert [row["design"] for row in found.table()] == [i // 3 for i in range(36)]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks into /proc")
def test_ctrl_c_ends_a_sweep_and_keeps_what_is_finished(tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONPATH": str(Path(pneuflex.__file__).parents[1])}
    command = [sys.executable, "-c", SCRIPT, str(tmp_path)]
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    driver = subprocess.Popen(command, text=True, env=environment, **streams)
    assert driver.stdout is not None
    driver.stdout.readline()
    workers = children(driver.pid)
    driver.send_signal(signal.SIGINT)
    _, said = driver.communicate(timeout=60)
    assert "KeyboardInterrupt" in said and len(workers) == 2
    assert not any(Path(f"/proc/{pid}").exists() for pid in workers)
    found = Sweep.open(tmp_path)
    assert 0 < len(found.unfinished) < 12 and list(tmp_path.glob("table.*"))


def test_a_design_that_kills_its_workers_is_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from pneuflex._processes import Processes, WorkerDied
    from pneuflex._worker import Task

    pool = Processes(1)
    # What cannot be read ends the worker, each time.
    future = pool.submit(None, _Deadly())  # type: ignore[arg-type]
    with pytest.raises(WorkerDied, match="died 3 times"):
        future.result(timeout=60)
    task = Task("a", {}, b"", str(tmp_path), None, 1)
    assert pneuflex._sweep._lost(task, "x")["status"] == "worker-died"
    pool.shutdown()


class _Deadly:
    def __reduce__(self) -> tuple[Any, ...]:
        return os._exit, (9,)


def test_only_what_ended_by_itself_is_finished(tmp_path: Path) -> None:
    from pneuflex._worker import keep

    case = small_case(pressures=[1], solver={"min_step_kpa": 20})
    designs = [{"actuator.gap": 1.0}, {"actuator.gap": -1.0}, {"load.pressure_kpa": [1, 900]}, {"mesh.size": 0.01}]
    found = pneuflex.sweep(case, designs, out=tmp_path, progress=False)
    assert [row["status"] for row in found] == ["converged", "bad-input", "not-converged", "error"]
    assert found[3]["reason"] == "machine" and "will not fit in memory" in found[3]["message"]
    died = {**found[0], "status": "worker-died", "states": []}
    keep(tmp_path, died)
    assert len(Sweep.open(tmp_path).failures) == 4
    seen: list[str] = []
    again = pneuflex.sweep(case, designs, out=tmp_path, progress=False, on_row=lambda row: seen.append(row["identity"]))
    assert sorted(seen) == sorted([found[0]["identity"], found[3]["identity"]])
    assert [row["status"] for row in again] == [row["status"] for row in found]


def test_what_a_worker_does_not_foresee_is_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from pneuflex import Case

    def broken(*_: Any, **__: Any) -> None:
        raise LookupError("unforeseen")

    monkeypatch.setattr(Case, "_solve_in_sweep", broken)
    with ThreadPoolExecutor(1) as pool:
        found = pneuflex.sweep(small_case(), {"actuator.gap": [1.0]}, pool, out=tmp_path, progress=False)
    assert [found[0][key] for key in ("status", "reason", "message")] == ["error", "LookupError", "unforeseen"]


def test_another_case_in_the_same_place_is_another_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pneuflex._sweep, "LARGE", 0)
    out, space = tmp_path / "out", {"actuator.gap": [1.0]}
    with ThreadPoolExecutor(1) as pool:
        for height in (13, 14):
            case = small_case(pressures=[1], height=height)
            found = pneuflex.sweep(case, space, pool, out=out, progress=False)
            alone = case.copy().set({"actuator.gap": 1.0}).solve(threads=1)
            assert found[0]["states"][0]["tip.z_mm"] == alone.tip[0, 2]
            shutil.rmtree(out)


def test_everything_that_a_design_is_read_from_is_part_of_it(tmp_path: Path) -> None:
    path = write_brick(tmp_path / "model", 2)
    write_brick(tmp_path / "model/other", 4)
    model = pneuflex.Model.load(path)
    space = {"model.file": ["brick.inp", "other/brick.inp"]}
    seen: list[str] = []

    def swept(out: str = "out") -> list[float]:
        seen.clear()
        options: dict[str, Any] = {"progress": False, "on_row": lambda row: seen.append(row["identity"])}
        with ThreadPoolExecutor(1) as pool:
            found = pneuflex.sweep(model, space, pool, out=tmp_path / out, **options)
        assert not found.failures
        return [row["states"][0]["strain_energy_mj"] for row in found]

    first = swept()
    assert len(seen) == 2 and first[0] > 1.8 * first[1]
    assert swept() == first and not seen
    # A file that a deck of one design includes.
    write_brick(tmp_path / "model/other", 8)
    second = swept()
    assert len(seen) == 1 and second[0] == first[0] and first[1] > 1.8 * second[1]
    # Of the one that all have in common.
    write_brick(tmp_path / "model", 1)
    with pytest.raises(InputError, match="its mesh, its deck or what that includes differs"):
        swept()
    assert swept("new")[0] > 1.8 * first[0]
    # What was read once is what all designs are read from, here or on another machine.
    shutil.move(tmp_path / "model", tmp_path / "moved")
    model = pneuflex.Model.load(tmp_path / "moved/brick.toml")
    assert swept("new")[1] == second[1] and not seen
    base, _ = pneuflex._sweep._in_memory(model, [])
    shutil.rmtree(tmp_path / "moved")
    assert base.solve(threads=1)[0].strain_energy_mj == pytest.approx(second[0] * 2, rel=0.2)


def test_memory_is_that_of_the_library(monkeypatch: pytest.MonkeyPatch) -> None:
    assert pneuflex._native.available_memory() is None or pneuflex._native.available_memory() > 1e7  # type: ignore[operator]
    monkeypatch.setattr(pneuflex._native, "available_memory", lambda: 100.0)
    assert pneuflex._sweep._share(4, 60.0, None, 1)[0] == 1


FORKING = """
import multiprocessing, sys, pneuflex
from concurrent.futures import ProcessPoolExecutor
case = pneuflex.Case.actuator(2, flange=0, pressures=[1], mesh={"size": 3, "element": "hex8-q1p0"})
with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("fork")) as pool:
    pneuflex.sweep(case, {"actuator.gap": [1.0, 1.5]}, pool, out=sys.argv[1], progress=False,
                   on_row=lambda row: (print("row", flush=True), sys.stdin.read()))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="forks")
def test_a_worker_that_was_forked_does_not_keep_the_folder(tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONPATH": str(Path(pneuflex.__file__).parents[1])}
    streams: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    driver = subprocess.Popen([sys.executable, "-W", "ignore", "-c", FORKING, str(tmp_path)], env=environment, **streams)
    assert driver.stdout is not None
    assert driver.stdout.readline() == b"row\n"
    workers = children(driver.pid)
    driver.kill()
    driver.wait()
    try:
        assert workers and all(Path(f"/proc/{pid}").exists() for pid in workers)
        case, space = small_case(pressures=[1]), {"actuator.gap": [1.0, 1.5]}
        assert not pneuflex.sweep(case, space, out=tmp_path, progress=False, threads=1).unfinished
    finally:
        for pid in workers:
            os.kill(pid, signal.SIGKILL)


def test_slips_are_named_with_their_argument(tmp_path: Path) -> None:
    case, space = small_case(), {"actuator.gap": [1.0]}
    for match, call in [
        ("threads = -1 must be a whole number from 1 on", lambda: pneuflex.sweep(case, space, out=tmp_path, threads=-1)),
        ("workers = 'x'", lambda: pneuflex.sweep(case, space, out=tmp_path, workers="x")),  # type: ignore[arg-type]
        ("study = 3 must be", lambda: pneuflex.sweep(3, space, out=tmp_path)),  # type: ignore[arg-type]
        ("executor = 3 must be", lambda: pneuflex.sweep(case, space, 3, out=tmp_path)),  # type: ignore[arg-type]
        ("actuator.gap = 1 must be a list", lambda: Grid({"actuator.gap": 1})),  # type: ignore[dict-item]
        ("count = 2.5", lambda: Sobol({"actuator.gap": (1, 2)}, count=2.5)),  # type: ignore[arg-type]
        ("values by keys", lambda: LatinHypercube(3, count=2)),  # type: ignore[arg-type]
    ]:
        with pytest.raises(InputError, match=match):
            call()


def test_two_sweeps_do_not_share_a_folder(tmp_path: Path) -> None:
    case = small_case(pressures=[1])

    def other(_: Any) -> None:
        with pytest.raises(InputError, match="another sweep is writing"):
            pneuflex.sweep(case, {"actuator.gap": [1.0]}, out=tmp_path, progress=False)

    pneuflex.sweep(case, {"actuator.gap": [1.0]}, out=tmp_path, progress=False, on_row=other)


def test_models_are_swept(tmp_path: Path) -> None:
    from test_models import plate

    model = plate(times=[1.0])
    found = pneuflex.sweep(model, {"material.c10": [0.1, 0.2]}, out=tmp_path, progress=False)
    assert [row["status"] for row in found] == ["converged"] * 2
    soft, stiff = (row["states"][0]["probe.tip.z_mm"] for row in found)
    assert 1.8 < soft / stiff < 2.1


def test_progress_says_what_is_left(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with ThreadPoolExecutor(1) as pool:
        pneuflex.sweep(small_case(pressures=[1]), {"actuator.gap": [1.0, -1.0]}, pool, out=tmp_path)
    assert "2 of 2 designs, 1 failed" in capsys.readouterr().err
    assert json.loads((tmp_path / "sweep.json").read_text())["program"] == "pneuflex"


def test_a_cluster_of_dask_solves_the_same(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    case, space = small_case(pressures=[1, 2]), {"actuator.gap": GAPS}
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            found = pneuflex.sweep(case, space, client.get_executor(pure=False), out=tmp_path / "dask", progress=False)
    here = pneuflex.sweep(case, space, out=tmp_path / "here", progress=False, threads=1)
    assert [row["states"] for row in found] == [row["states"] for row in here] and not found.failures


SWEEP_FILE = """
case = "finger.toml"
[set]
mesh = { size = 3, element = "hex8-q1p0" }
load.pressure_kpa = [1, 2]
[space]
"actuator.gap" = [1, 1.5, 2]
material = ["dragon-skin-30", "ecoflex-00-30"]
[[design]]
actuator.gap = -1
"""


def test_the_program_and_the_package_go_on_with_each_others_sweeps(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str
) -> None:
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> None:
        subprocess.run([program, *arguments], check=True, capture_output=True)

    run("new", "two-chamber", "finger.toml")
    Path("gaps.toml").write_text(SWEEP_FILE)
    # As people name a file: by where they are.
    case = pneuflex.Case.load("finger.toml").set({"mesh": {"size": 3, "element": "hex8-q1p0"}, "load.pressure_kpa": [1, 2]})
    space = Grid({"actuator.gap": [1, 1.5, 2], "material": ["dragon-skin-30", "ecoflex-00-30"]})
    designs = [*space.designs(), {"actuator.gap": -1}]
    seen: list[str] = []

    def swept(out: str) -> Sweep:
        seen.clear()
        return pneuflex.sweep(
            case, designs, out=out, threads=1, progress=False, on_row=lambda row: seen.append(row["identity"])
        )

    run("sweep", "gaps.toml", "--out", "program", "--threads", "1")
    by_program = list(csv.reader(Path("program/table.csv").open()))
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    both, package = swept("program"), None
    assert not seen and not both.unfinished and both.write().read_text() == Path("program/table.csv").read_text()
    package = swept("package")
    assert len(seen) == 7
    by_package = list(csv.reader(Path("package/table.csv").open()))
    assert by_package[0] == by_program[0] and len(by_package) == 14
    times = [by_package[0].index(name) for name in ("seconds", "cpu_seconds")]
    without = [[[cell for i, cell in enumerate(row) if i not in times] for row in rows] for rows in (by_package, by_program)]
    assert without[0] == without[1]
    assert [row["status"] for row in package] == ["converged"] * 6 + ["bad-input"]
    before = {path.name: path.stat().st_mtime_ns for path in Path("package/rows").iterdir()}
    run("sweep", "gaps.toml", "--out", "package")
    assert before == {path.name: path.stat().st_mtime_ns for path in Path("package/rows").iterdir()}
    # Another case is refused by both.
    with pytest.raises(InputError, match=r"another case \(actuator differ\)"):
        pneuflex.sweep(case.copy().set({"actuator.width": 19}), designs, out="program", progress=False)


def test_designs_start_from_neighbours_as_the_program_s_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    subprocess.run([program, "new", "two-chamber", "finger.toml"], check=True, capture_output=True)
    case = pneuflex.Case.load("finger.toml").set({"mesh": {"size": 3, "element": "hex8-q1p0"}, "load.pressure_kpa": [10, 40]})
    gaps = [1.0, 1.02, 0.97, 1.3, 1.32]
    rest = pneuflex.sweep(case, {"actuator.gap": gaps}, out="rest", threads=1, progress=False)
    options: dict[str, Any] = {"threads": 1, "progress": False, "start": "neighbours"}
    near = pneuflex.sweep(case, {"actuator.gap": gaps}, out="near", workers=2, **options)
    assert [row["started_from"] for row in near.table()][::2] == [None, 0, 0, None, 3] and not Path("near/neighbours").exists()
    assert "started_from" not in rest.table()[0]
    angles = [[[state["end_face_angle_deg"] for state in row["states"]] for row in found] for found in (near, rest)]
    np.testing.assert_allclose(angles[0], angles[1], rtol=1e-8)
    count = [sum(state["iterations"] for row in found for state in row["states"]) for found in (near, rest)]
    assert count[0] < count[1]
    # The same from another executor, and from the program.
    with ThreadPoolExecutor(2) as pool:
        other = pneuflex.sweep(case, {"actuator.gap": gaps}, pool, out="other", **options)
    assert [row["states"] for row in other] == [row["states"] for row in near]
    text = 'case = "finger.toml"\nstart = "neighbours"\n[set]\nmesh = { size = 3, element = "hex8-q1p0" }\nload.pressure_kpa = [10, 40]\n'
    Path("gaps.toml").write_text(f"{text}[space]\nactuator.gap = {gaps}\n")
    subprocess.run([program, "sweep", "gaps.toml", "--out", "program", "--threads", "1"], check=True, capture_output=True)
    tables = [list(csv.DictReader(Path(folder, "table.csv").open())) for folder in ("near", "program")]
    times = ("seconds", "cpu_seconds")
    plain = [[{key: cell for key, cell in row.items() if key not in times} for row in table] for table in tables]
    assert plain[0] == plain[1]
    # A sweep that was killed before its last design, whose neighbour is there, damaged, or not there any more.
    def killed_before(design: int) -> Sweep:
        Path("near/rows", f"{near[design]['identity']}.json").unlink()
        return pneuflex.sweep(case, {"actuator.gap": gaps}, out="near", **options)

    again = killed_before(1)
    assert again[1].get("started_from") is None
    for file in (b"", b"pneuflex and more"):
        Path("near/neighbours").mkdir()
        Path("near/neighbours", f"{near[0]['identity']}.bin").write_bytes(file)
        assert killed_before(1)[1]["states"] == again[1]["states"]
    with pytest.raises(InputError, match="start = 'near' must be"):
        pneuflex.sweep(case, {"actuator.gap": gaps}, out="x", start="near")  # type: ignore[arg-type]


def test_a_table_of_before_does_not_stay_beside_the_new_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyarrow")
    found = pneuflex.sweep(small_case(pressures=[1]), {"actuator.gap": [1.0]}, out=tmp_path, progress=False)
    assert {path.name for path in tmp_path.glob("table.*")} == {"table.parquet"}
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    found.write()
    assert {path.name for path in tmp_path.glob("table.*")} == {"table.csv"}


def test_a_base_is_only_a_template(tmp_path: Path) -> None:
    path = write_brick(tmp_path / "model", 2)
    path.write_text(path.read_text().replace("brick.inp", "to-be-named.inp"))
    model = pneuflex.Model.load(path)
    with pytest.raises(InputError):
        model.check()
    space = {"model.file": ["brick.inp", "missing.inp"]}
    with ThreadPoolExecutor(1) as pool:
        found = pneuflex.sweep(model, space, pool, out=tmp_path / "out", progress=False)
    assert [row["status"] for row in found] == ["converged", "bad-input"]
    assert not pneuflex.sweep(model, {"model.file": ["brick.inp"]}, out=tmp_path / "other", progress=False).failures


def test_a_job_script_of_slurm_is_what_it_should_be() -> None:
    dask_jobqueue = pytest.importorskip("dask_jobqueue")
    options: dict[str, Any] = {"cores": 8, "processes": 8, "memory": "32GB", "walltime": "04:00:00"}
    with dask_jobqueue.SLURMCluster(**options, scheduler_options={"dashboard_address": None}) as cluster:
        script = cluster.job_script()
    lines = script.splitlines()
    assert lines[0].startswith("#!") and "#SBATCH --cpus-per-task=8" in lines and "#SBATCH -t 04:00:00" in lines
    assert "--nworkers 8" in script and "--nthreads 1" in script
    assert subprocess.run(["bash", "-n"], input=script, text=True).returncode == 0
