"""Cases: set, check, solve, stop, resume, keep."""

from __future__ import annotations

import json
import multiprocessing
import pickle
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import FIXTURES, SMALL, small_case

import pneuflex
from pneuflex import Case, InputError, Interrupted, NotConverged, Result


def test_results_are_those_of_the_program_bit_for_bit(program: str, tmp_path: Path) -> None:
    keys = {"mesh": SMALL, "load.pressure_kpa": [5, 25]}
    case = Case.load(FIXTURES / "two_chamber.toml", keys | {"contact.method": "multi-point"})
    result = case.solve(threads=1)
    settings = ["mesh.size=3", "mesh.element=hex8-q1p0", "load.pressure_kpa=[5, 25]"]
    command = [program, "run", str(FIXTURES / "two_chamber.toml"), "--out", str(tmp_path / "out"), "--threads", "1"]
    subprocess.run([*command, "--quiet", *(x for s in settings for x in ("--set", s))], check=True)
    theirs = json.loads((tmp_path / "out/summary.json").read_text())
    assert [state.summary for state in result] == theirs["steps"]
    assert result.warnings == theirs["warnings"] and result.iterations == theirs["iterations_total"]
    opened = Result.open(tmp_path / "out")
    assert opened.status == result.status == "converged" and len(opened) == 2
    for mine, other in zip(result, opened, strict=True):
        for field in ("points", "displacement", "von_mises", "cauchy_stress", "hydrostatic_pressure", "tip"):
            assert np.array_equal(getattr(mine, field), getattr(other, field)), field
    assert repr(opened).splitlines()[1:] == repr(result).splitlines()[1:]


def test_results_are_arrays_over_the_states(solved: Result) -> None:
    assert solved.status == "converged" and len(solved) == 3 and solved.pressure_kpa.tolist() == [1, 2, 3]
    assert (np.diff(solved.end_face_angle_deg) > 0).all() and (np.diff(solved.cavity_volume_mm3) > 0).all()
    # The chord of an arc has half of the end face's angle.
    assert (abs(solved.chord_angle_deg / solved.end_face_angle_deg - 0.5) < 0.1).all()
    assert solved.tip.shape == (3, 3) and (solved.tip[:, 2] < 0).all()
    assert solved.reaction.shape == (3, 3) and abs(solved.reaction).max() < 1e-6
    assert set(solved.contact) >= {"area_mm2", "max_penetration_mm", "gaps_in_contact"}
    assert solved.at(2).pressure_kpa == 2 and solved[-1] is solved.states[2] and len(solved[1:]) == 2
    with pytest.raises(KeyError, match="4 kPa"):
        solved.at(4)
    assert "converged, 3 states" in repr(solved) and "2 kPa" in repr(solved[1])


def test_fields_are_there_without_a_copy(solved: Result) -> None:
    state = solved[-1]
    n = len(state.points)
    shapes = {"displacement": (n, 3), "von_mises": (n,), "cauchy_stress": (n, 6), "nodal_reaction": (n, 3)}
    for name, shape in shapes.items():
        field = getattr(state, name)
        assert field.shape == shape and field.dtype == np.float64 and np.shares_memory(field, getattr(state, name))
        assert not field.flags.writeable and not field.flags.owndata
    s = state.cauchy_stress.T
    equivalent = ((s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2) / 2 + 3 * (s[3:] ** 2).sum(0)
    assert np.allclose(equivalent**0.5, state.von_mises, rtol=1e-12)
    # What numpy shows lives on when the state is gone.
    kept = small_case(pressures=[1]).solve(threads=1)[0].displacement
    assert np.isfinite(kept).all() and abs(kept).max() > 0


def test_the_tip_is_where_the_actuator_ends(solved: Result, small: Case) -> None:
    assert small.length == 18
    node = int(np.flatnonzero((abs(solved[-1].points - [18, 0, 0]) < 1e-9).all(1))[0])
    assert np.allclose(solved[-1].tip, solved[-1].displacement[node], atol=1e-12)
    # A probe called tip that is elsewhere is another thing.
    probed = small_case(pressures=[3], probes=[{"name": "tip", "at": [9, 0, 13]}]).solve(threads=1)
    assert np.allclose(probed.tip[0], solved.tip[-1], atol=1e-12)
    assert not np.allclose(probed.probes["tip"], probed.tip)


def test_keys_are_set_together_or_not_at_all(small: Case) -> None:
    assert small.set({"actuator.gap": np.float64(1.5), "mesh": {"size": np.int64(4)}}) is small
    assert small["actuator.gap"] == 1.5 and small["mesh.size"] == [4, 4, 4] and small["mesh.element"] == "hex8-q1p0"
    with pytest.raises(InputError, match="did you mean `gap`") as unknown:
        small.set({"actuator.width": 30, "actuator.gpa": 1})
    assert small["actuator.width"] == 20
    assert isinstance(unknown.value, ValueError) and unknown.value.problems[0].key == "actuator.gpa"
    with pytest.raises(InputError, match=r"actuator.gap = -1 is out of range: must be at least 0 mm"):
        small.set({"actuator.gap": -1})
    with pytest.raises(InputError, match="did you mean dragon-skin-10,"):
        small.set({"material": "dragonskin"})
    with pytest.raises(TypeError, match="actuator.gap"):
        small.set({"actuator.gap": object()})
    # Lengths of single chambers, from 1; a number is that of all of them.
    several = Case.actuator(chambers=4, gap=np.array([2, 1.5, 0]), top_wall=[1, 1, 1, 1.5], side_wall=1.2)
    assert several["actuator.gap"] == [2, 1.5, 0] and several["actuator.gap[2]"] == 1.5
    assert several["actuator.side_wall[4]"] == 1.2 and several.length == 4 + 32 + 3.5
    several.set({"actuator.top_wall[4]": np.float64(2), "actuator.gap[3]": 1})
    assert several["actuator.top_wall"] == [1, 1, 1, 2] and several["actuator.gap"] == [2, 1.5, 1]
    for key in ["actuator.gap[4]", "actuator.gap[0]", "actuator.width[1]", "actuator.gap[x]"]:
        with pytest.raises(KeyError):
            several[key]
    with pytest.raises(InputError, match="entries from 1 to 3"):
        several.set({"actuator.gap[4]": 1})
    with pytest.raises(InputError, match="set actuator.channel.half_width = 0"):
        several.set({"load.chamber_factor": [1, 1, 1, 0.5]})
    apart = {"half_width": 0, "bottom": 2, "top": 3}
    assert Case.actuator(chambers=2, channel=apart, chamber_factor=[1, 0.5])["load.chamber_factor[2]"] == 0.5
    other = small.copy().set({"material": "dragon-skin-30"})
    assert other["material.c10"] == pneuflex.materials()["dragon-skin-30"].constants["c10"] != small["material.c10"]
    # A material is replaced as a whole: a law has no constants of another one.
    assert small.set({"material": {"law": "neo-hooke", "c10": 0.1}})["material.law"] == "neo-hooke"
    with pytest.raises(KeyError):
        small["actuator.nothing"]
    # A size that was set before would leave a resolution without any meaning.
    assert small.set({"mesh.resolution": "draft"})["mesh.size"] != [4, 4, 4]
    assert pickle.loads(pickle.dumps(small)).values == small.values


def test_everything_that_is_wrong_with_a_file_is_said(tmp_path: Path) -> None:
    text = (FIXTURES / "two_chamber.toml").read_text()
    path = tmp_path / "a.toml"
    path.write_text(text.replace("gap = ", "gpa = ").replace("side_wall = 1.0", "side_wall = -1.0"))
    with pytest.raises(InputError) as wrong:
        Case.load(path)
    assert len(wrong.value.problems) >= 2 and f"{path}:" in str(wrong.value) and "^" in str(wrong.value)
    line = next(p.line for p in wrong.value.problems if p.key == "actuator.side_wall")
    assert line is not None and "side_wall" in path.read_text().splitlines()[line - 1]
    assert str(pickle.loads(pickle.dumps(wrong.value))) == str(wrong.value)
    with pytest.raises(FileNotFoundError):
        Case.load(tmp_path / "none.toml")
    with pytest.raises(FileNotFoundError):
        Result.open(tmp_path / "none")
    with pytest.raises(InputError, match="no summary.json"):
        Result.open(tmp_path)
    with pytest.raises(InputError, match="use pneuflex.Model.load"):
        Case.load(next((FIXTURES / "models").glob("*.toml")))
    with pytest.raises(InputError, match="chambers = 0"):
        Case.actuator(0)
    for arguments in ({"threads": 0}, {"threads": 10**6}, {"times": [1.0]}, {"pressures": [2, 1]}, {"pressures": "5"}):
        with pytest.raises(InputError):
            small_case().solve(**arguments)  # type: ignore[arg-type]


def test_a_check_says_what_would_be_solved(small: Case) -> None:
    check = small.check()
    assert check.points.shape == (check.nodes, 3) and check.connectivity.shape == (check.cells, 8)
    assert check.element == "hex8-q1p0" and check.modelled == "half" and check.requested == [1, 2, 3]
    assert np.all(check.points[check.node_sets["clamp"], 0] == 0) and check.face_sets["end_face"].shape[1] == 2
    assert "2 chambers" in str(check) and check.warnings[0]["advice"] in str(check) and check.memory_bytes > 1e6
    large = Case.actuator(60, mesh={"size": 0.2})
    with pytest.raises(InputError, match="force=True"):
        large.check()


def test_other_python_threads_go_on() -> None:
    """The interpreter is held for the whole of a solve if it is held at all; what else a busy machine does is tried three times."""
    case = Case.actuator(4, pressures=[5, 10], mesh={"size": 2, "element": "hex8-q1p0"})
    longest = np.inf
    for _ in range(3):
        gaps, stop = [], threading.Event()

        def tick() -> None:
            last = time.perf_counter()
            while not stop.is_set():
                time.sleep(0.001)
                now = time.perf_counter()
                gaps.append(now - last)
                last = now

        thread = threading.Thread(target=tick)
        thread.start()
        began = time.perf_counter()
        case.solve(threads=1)
        spent = time.perf_counter() - began
        stop.set()
        thread.join()
        assert spent > 0.1
        longest = min(longest, max(gaps))
        if longest < 0.05:
            break
    assert longest < 0.05


def test_several_threads_solve_at_once(solved: Result) -> None:
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: small_case().solve(threads=1), range(4)))
    assert all(np.array_equal(other[-1].displacement, solved[-1].displacement) for other in found)


@pytest.mark.skipif(sys.platform != "linux", reason="forks")
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork:DeprecationWarning")
def test_a_process_that_has_solved_can_be_forked(solved: Result) -> None:
    with multiprocessing.get_context("fork").Pool(1) as pool:
        angles = pool.apply_async(_angles, (small_case(),)).get(timeout=60)
    assert angles == solved.end_face_angle_deg.tolist()


def _angles(case: Case) -> list[float]:
    return case.solve(threads=1).end_face_angle_deg.tolist()


def test_ctrl_c_ends_a_run_with_what_was_reached(solved: Result) -> None:
    def press(state: pneuflex.State) -> None:
        if state.pressure_kpa == 2:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(Interrupted) as interrupted:
        small_case().solve(threads=1, on_state=press)
    assert isinstance(interrupted.value, KeyboardInterrupt)
    result = interrupted.value.result
    assert result.status == "interrupted" and result.pressure_kpa.tolist() == [1, 2]
    whole = result.resume(threads=1)
    assert whole.status == "converged" and np.allclose(whole.tip, solved.tip, rtol=1e-9, atol=1e-12)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_is_heard_while_it_solves() -> None:
    case = Case.actuator(8, mesh="standard")
    main = threading.main_thread().ident
    assert main is not None
    timer = threading.Timer(0.2, signal.pthread_kill, (main, signal.SIGINT))

    def start(state: pneuflex.State) -> None:
        if state.pressure_kpa == 5:
            timer.start()

    with pytest.raises(Interrupted) as interrupted:
        case.solve(threads=1, on_state=start)
    # At the next iteration, and not at the end, seconds later.
    assert len(interrupted.value.result) < 5


def test_what_a_callback_raises_ends_the_run() -> None:
    seen = []

    def hear(state: pneuflex.State) -> None:
        seen.append(state.pressure_kpa)
        if len(seen) == 2:
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        small_case().solve(threads=1, on_state=hear)
    assert seen == [1, 2]


def test_a_run_that_ends_early_says_why() -> None:
    with pytest.raises(NotConverged) as ended:
        small_case(pressures=[1, 900], solver={"min_step_kpa": 20}).solve(threads=1)
    result = ended.value.result
    assert result.status == "not-converged" and result.pressure_kpa.tolist() == [1]
    assert result.reason is not None and result.reason["message"] in str(ended.value) and ended.value.advice
    assert result.on_the_way and 1 < result.on_the_way[-1].pressure_kpa < 900
    assert abs(result.on_the_way[-1].displacement).max() > abs(result[-1].displacement).max()
    assert result.failure in repr(result)
    assert pickle.loads(pickle.dumps(ended.value)).args == ended.value.args


def test_runs_go_on_from_memory_and_from_folders(solved: Result, tmp_path: Path) -> None:
    first = small_case(pressures=[1, 2]).solve(threads=1)
    heard: list[float] = []
    again = first.resume([3], threads=1, on_state=lambda state: heard.append(state.pressure_kpa))
    assert heard == [3]
    assert again.pressure_kpa.tolist() == [1, 2, 3] and np.allclose(again.tip, solved.tip, rtol=1e-9, atol=1e-12)
    assert again.resume() is again
    with pytest.raises(InputError, match="1.5.* lie before 3"):
        again.resume([1.5, 4])
    folder = again.save(tmp_path / "saved")
    assert (folder / "report.html").stat().st_size > 1000
    opened = Result.open(folder)
    assert [state.summary for state in opened] == [state.summary for state in again]
    assert np.array_equal(opened[1].displacement, again[1].displacement)
    further = opened.resume([4], threads=1)
    straight = small_case(pressures=[1, 2, 3, 4]).solve(threads=1, out=tmp_path / "straight")
    assert further.folder == folder and further.pressure_kpa.tolist() == [1, 2, 3, 4]
    assert np.allclose(further.tip, straight.tip, rtol=1e-9, atol=1e-12)
    assert Result.open(tmp_path / "straight").resume(threads=1).pressure_kpa.tolist() == [1, 2, 3, 4]
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign/mine.txt").write_text("mine")
    with pytest.raises(InputError, match="no results of pneuflex"):
        small_case().solve(out=tmp_path / "foreign")


def test_a_run_in_memory_goes_on_as_one_in_a_folder(tmp_path: Path) -> None:
    def ended(pressures: list[float], **keys: object) -> list[Result]:
        found = []
        for out in (None, tmp_path / "out"):
            with pytest.raises(NotConverged) as early:
                small_case(pressures=pressures, solver={"min_step_kpa": 20}).solve(threads=1, out=out)
            found.append(early.value.result)
        return found

    memory, folder = ended([1, 900])
    reached = memory.on_the_way[-1].pressure_kpa
    assert reached > 10 and folder.on_the_way[-1].pressure_kpa == reached
    words = []
    for result in (memory, folder):
        with pytest.raises(InputError, match="leaves out what was reached; it may only change beyond") as refused:
            result.resume([reached / 2], threads=1)
        words.append(refused.value.problems[0].message)
    assert words[1].endswith(words[0])
    further = [result.resume([reached + 0.5, reached + 1], threads=1) for result in (memory, folder)]
    straight = small_case(pressures=[1, reached + 0.5, reached + 1]).solve(threads=1)
    for other in further:
        assert other.status == "converged" and other.pressure_kpa.tolist() == straight.pressure_kpa.tolist()
        assert np.allclose(other.tip, straight.tip, rtol=1e-6)
    assert further[0].warnings == further[1].warnings and further[0].iterations == further[1].iterations
    # Whatever may change between the two, and the number of states that are told of once more.
    assert further[0].resume(reached + 2, threads=1).pressure_kpa[-1] == reached + 2


def test_warnings_are_those_of_the_whole_run() -> None:
    case = small_case(pressures=[1, 2], material={"law": "neo-hooke", "c10": 0.1, "fitted_to": 1.001})
    straight = case.copy().solve([1, 2, 3], threads=1)
    resumed = case.solve(threads=1).resume([3], threads=1)
    assert resumed.warnings == straight.warnings and resumed.iterations == straight.iterations


def test_a_folder_with_another_run_is_not_taken_for_the_one_that_was_opened(tmp_path: Path) -> None:
    out = tmp_path / "out"
    solved = small_case(pressures=[1, 2]).solve(threads=1, out=out)
    first, second = Result.open(out), Result.open(out)
    whole = second.resume([3], threads=1)
    # It is the same run that has gone on.
    assert np.array_equal(first[1].displacement, whole[1].displacement) and first._repr_html_().startswith("<iframe")
    # Nothing of it has been read yet.
    late = Result.open(out)
    small_case(pressures=[1, 2], gap=1.5).solve(threads=1, out=out)
    assert np.array_equal(first[1].displacement, whole[1].displacement)
    for read in (
        lambda: first[0].displacement,
        lambda: late[0].points,
        lambda: late[-1].von_mises,
        lambda: late.resume([4], threads=1),
        lambda: solved.resume([4], threads=1),
    ):
        with pytest.raises(InputError, match="another run has been recorded there since"):
            read()
    for result in (late, solved, second):
        assert result._repr_html_().startswith("<pre>")
    assert not np.allclose(Result.open(out)[1].displacement, first[1].displacement)


def test_slips_are_named_with_their_argument() -> None:
    case, result = small_case(pressures=[1]), small_case(pressures=[1]).solve(threads=1)
    for match, call in [
        ("threads = -1 must be a whole number from 1 on", lambda: case.solve(threads=-1)),
        ("threads = 1.5 must be a whole number", lambda: result.resume([2], threads=1.5)),  # type: ignore[arg-type]
        ("pressures must be a list of numbers", lambda: result.resume("x")),
        ("pressures is no array", lambda: case.solve([1, [2]])),  # type: ignore[list-item]
        ("on_state = 3 cannot be called", lambda: case.solve(on_state=3)),  # type: ignore[arg-type]
        ("obstacles: a list of tables", lambda: small_case(obstacles={"name": "plate"})),
        ("values by keys are wanted", lambda: case.set(3)),  # type: ignore[arg-type]
        ("chambers = 10000000 must be a whole number from 1 to 1000000", lambda: Case.actuator(10**7)),
        ("either a pressure or a time", lambda: result.at()),
    ]:
        with pytest.raises(InputError, match=match):
            call()
    # A single pressure is a list of one, as it is for `solve`.
    assert result.resume(3, threads=1).pressure_kpa.tolist() == [1, 3]


def test_results_without_fields_say_so() -> None:
    result = small_case(pressures=[1]).solve(threads=1, fields=False)
    assert result.end_face_angle_deg.shape == (1,)
    with pytest.raises(AttributeError, match="fields=True"):
        result[0].displacement  # noqa: B018
    with pytest.raises(InputError, match="fields=True"):
        result.save("nowhere")


def test_a_notebook_shows_the_report(solved: Result, tmp_path: Path) -> None:
    page = solved._repr_html_()
    assert page.startswith("<iframe srcdoc=") and len(page) > 100_000
    assert small_case(pressures=[1]).solve(threads=1, fields=False)._repr_html_().startswith("<pre>")


def test_progress_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    small_case(pressures=[1]).solve(threads=1, progress=True)
    assert capsys.readouterr().err.rstrip("\n").split("\r")[-1].startswith("converged: ")


def test_cases_can_be_sent_to_other_processes(small: Case, tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text((FIXTURES / "two_chamber.toml").read_text())
    case = Case.load(path).set({"actuator.gap": 1.5})
    path.unlink()
    assert pickle.loads(pickle.dumps(case)).values == case.values
    # What its file leaves out was set.
    path.write_text((FIXTURES / "two_chamber.toml").read_text().replace("gap = ", "# gap = "))
    case = Case.load(path, {"actuator.gap": 1.5})
    assert pickle.loads(pickle.dumps(case)).values == case.values
    assert pickle.loads(pickle.dumps(small)).set({"actuator.gap": 1}).length == 17
    assert repr(small) == "Case('actuator', 2 chambers, 18 mm long, at 1, 2, 3 kPa)"


def test_values_come_with_their_derivatives() -> None:
    case = small_case().set({"load.pressure_kpa": [2, 4]})
    results, keys = ["end_face_angle", "tip.z@2", "centreline[50%].z"], ["actuator.top_wall", "material.c10"]
    values, slopes = case.value_and_grad(results, keys)
    assert values.shape == (3,) and slopes.shape == (3, 2)
    solved = case.solve()
    assert abs(values[0] - solved[-1].end_face_angle_deg) < 1e-9 and abs(values[1] - solved[0].tip[2]) < 1e-9
    ends = [case.copy().set({"material.c10": case["material.c10"] * share}).solve() for share in (0.99, 1.01)]
    change = ends[1][-1].end_face_angle_deg - ends[0][-1].end_face_angle_deg
    assert abs(change / (0.02 * case["material.c10"]) / slopes[0, 1] - 1) < 1e-3
    for wanted, by in [(["von_mises_p99"], keys), (results, ["mesh.size"])]:
        with pytest.raises(InputError, match="no derivative"):
            case.value_and_grad(wanted, by)
    with pytest.raises(InputError, match="lists of names"):
        case.value_and_grad("end_face_angle", keys)


def test_derivatives_by_nodes_add_up_to_those_by_lengths() -> None:
    case = small_case().set({"load.pressure_kpa": [4]})
    (angle,), (slopes,) = case.value_and_shape_grad(["end_face_angle"])
    (value,), ((slope,),) = case.value_and_grad(["end_face_angle"], ["actuator.top_wall"])
    assert abs(angle - value) < 1e-9
    nodes = [case.copy().set({"actuator.top_wall": wall, "load.pressure_kpa": [1]}).solve()[-1].points for wall in (0.99, 1.01)]
    assert slopes.shape == nodes[0].shape
    assert abs(np.sum(slopes * (nodes[1] - nodes[0])) / 0.02 / slope - 1) < 1e-6
    with pytest.raises(InputError, match="not differentiated by nodes"):
        case.value_and_shape_grad(["von_mises_norm[12]"])


def test_scipy_minimises_with_them() -> None:
    optimize = pytest.importorskip("scipy.optimize")
    case = small_case().set({"load.pressure_kpa": [4]})

    def miss(x: np.ndarray) -> tuple[float, np.ndarray]:
        design = case.copy().set({"material.c10": float(x[0])})
        (angle,), slopes = design.value_and_grad(["end_face_angle"], ["material.c10"])
        return 0.5 * (angle - 1.5) ** 2, (angle - 1.5) * slopes[0]

    found = optimize.minimize(miss, [case["material.c10"]], jac=True, bounds=[(0.1, 1)])
    assert found.fun < 1e-6, found
