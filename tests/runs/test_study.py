"""Claim: a study reports every setting how wrong it is and what it costs, whatever fails."""

import csv
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckError
from crashsolve.integrators.rattle import ORDER
from crashsolve.study.convergence import analyse, divergence_time, order_of_errors
from crashsolve.study.findings import cheapest, find
from crashsolve.study.runner import Request, _axes, _verdict
from crashsolve.study.runner import study as run_study
from crashsolve.study.settings import Series, Setting, settings, suited
from crashsolve.study.trials import Trial
from crashsolve.study.watch import Watch

HERE = Path(__file__).parent
PENDULUM = HERE / "pendulum.yaml"
X, Y = "rbdout.bob.position.x final", "rbdout.bob.position.y final"
EXACT = {X: 0.9862917511, Y: -0.1650108531}
# the longest step breaks the deck's bound on the energy
STEPS = ("0.25", "8e-3", "4e-3", "2e-3", "1e-3")
SLOPE = 0.15
pytestmark = pytest.mark.xdist_group("runs")


def study(folder: Path, *words: object, **changes: str) -> str:
    """What a study of the pendulum prints."""
    done = crashsolve(
        *("study", PENDULUM, "-o", folder, "--integrators", "rattle"),
        *("--steps", ",".join(STEPS), *words),
        **changes,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def rows(folder: Path) -> dict[str, dict[str, str]]:
    """study.csv by setting."""
    with (folder / "study.csv").open(encoding="utf-8") as file:
        return {row["setting"]: row for row in csv.DictReader(file)}


def column(folder: Path, word: str) -> list[float]:
    """Numbers of the runs that reached their end, in the column that begins with a word."""
    good = [row for row in rows(folder).values() if row["exit code"] == "0"]
    (name,) = [name for name in good[0] if name.startswith(word)]
    return [float(row[name] or "nan") for row in good]


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, str]]:
    """A finished study, and what it printed."""
    folder = tmp_path_factory.mktemp("study")
    yield folder, study(folder, "--target", "1e-4")


def test_the_run_that_others_are_compared_with_is_not_recommended(tmp_path: Path) -> None:
    deck = tmp_path / "spring.yaml"
    deck.write_text(
        "control: {end_time: 1, step: 1e-2}\n"
        "bodies: {m: {mass: 1, inertia: [1, 1, 1], velocity: [1, 0, 0]}}\n"
        "springs: {s: {type: linear, b: m, stiffness: 1, at_a: [-1, 0, 0]}}\n"
        "watch: [{channel: rbdout.m.position.x, statistic: final}]\n"
    )
    done = crashsolve(
        *("study", deck, "-o", tmp_path / "study", "--vary", "springs.s.stiffness=1,9"),
        *("--jobs", "1"),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    # 0.84 m and 0.05 m: neither serves for the other
    (name,) = re.findall(r"errors are differences from (.*), the most expensive run", done.stdout)
    assert "none of these settings meets it" in done.stdout
    assert f"target 0.05: {name}" not in done.stdout
    # both rows have the same setting, the step
    with (tmp_path / "study" / "study.csv").open(encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    errors = [row["rbdout.m.position.x final: error against most expensive run"] for row in table]
    assert sorted(error == "" for error in errors) == [False, True]
    assert all(error == "" or float(error) > 0.5 for error in errors)


def test_errors_are_those_against_the_exact_value(pendulum: tuple[Path, str]) -> None:
    folder, printed = pendulum
    for name, exact in EXACT.items():
        values, errors = column(folder, f"{name} ["), column(folder, f"{name}: error against exact")
        np.testing.assert_allclose(errors, np.abs(np.array(values) / exact - 1.0), rtol=1e-6)
        assert f"{name} = {exact:.9g} m (exact)" in printed


def test_the_order_of_the_method_is_observed(pendulum: tuple[Path, str]) -> None:
    folder, _ = pendulum
    for name in EXACT:
        orders = column(folder, f"{name}: order")[1:]
        assert np.allclose(orders, ORDER, atol=SLOPE)


def test_a_failing_setting_is_a_row(pendulum: tuple[Path, str]) -> None:
    folder, printed = pendulum
    row = rows(folder)["0.25"]
    assert row["exit code"] == "4"
    assert "energy balance" in row["message"]
    assert row[f"{X}: order"] == ""
    assert "rattle 0.25: exit code 4, t = " in printed


def test_the_cheapest_setting_that_meets_the_target_is_named(pendulum: tuple[Path, str]) -> None:
    folder, printed = pendulum
    good = [label for label in STEPS if rows(folder)[f"{float(label):g}"]["exit code"] == "0"]
    errors = np.max([column(folder, f"{name}: error") for name in EXACT], axis=0)
    first = next(float(h) for h, error in zip(good, errors, strict=True) if error <= 1e-4)
    assert f"target 0.0001: rattle {first:g}, " in printed
    assert first not in (float(good[0]), float(good[-1]))


def test_complete_runs_are_kept(pendulum: tuple[Path, str]) -> None:
    folder, _ = pendulum
    before = {path: path.stat().st_mtime_ns for path in folder.glob("*/log.txt")}
    printed = study(folder, "--target", "1e-12")
    assert {path: path.stat().st_mtime_ns for path in folder.glob("*/log.txt")} == before
    assert printed.count(": kept") == len(before) - 1 == 4
    assert "none of these settings meets it; the nearest is rattle 0.001" in printed
    assert "s should suffice" in printed


def test_without_a_known_value_the_runs_are_their_own_reference(
    pendulum: tuple[Path, str],
) -> None:
    folder, _ = pendulum
    words = ("--channel", "rbdout.bob.velocity.y:final", "--channel", "'rbdout.bob.position.x' * 1")
    printed = study(folder, *words)
    assert "rbdout.bob.velocity.y final = " in printed
    assert "(extrapolated)" in printed
    assert "'rbdout.bob.position.x' * 1 path against the extrapolated" in printed
    orders = column(folder, "rbdout.bob.velocity.y final: order")
    assert np.allclose(orders[2:], ORDER, atol=SLOPE)
    # a path of two samples, the second the one whose exact value is known
    name = "'rbdout.bob.position.x' * 1 path"
    estimated = column(folder, f"{name}: error against extrapolated")
    true = np.abs(np.array(column(folder, f"{name} [")) - EXACT[X])
    np.testing.assert_allclose(estimated, true, rtol=0.05)


def test_results_in_a_folder_serve_as_reference(pendulum: tuple[Path, str]) -> None:
    folder, _ = pendulum
    words = ("--channel", "rbdout.bob.velocity.x", "--reference", folder / "rattle_0.001")
    printed = study(folder, *words)
    assert "rbdout.bob.velocity.x path against the file" in printed
    errors = column(folder, "rbdout.bob.velocity.x path: error against file")
    assert errors[-1] == 0.0
    assert errors[0] > errors[1] > errors[2] > 0.0


def test_without_matplotlib_there_is_a_table_and_a_word(
    pendulum: tuple[Path, str], tmp_path: Path
) -> None:
    folder, _ = pendulum
    assert (folder / "study.png").read_bytes().startswith(b"\x89PNG")
    (tmp_path / "matplotlib.py").write_text("raise ImportError('not there')\n", "utf-8")
    root = HERE.parents[1]
    search = ":".join(map(str, (tmp_path, root / "solver", root / "postproc")))
    printed = study(folder, PYTHONPATH=search)
    assert "no plot: matplotlib is missing; pip install 'crashsolve[plot]'" in printed


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--steps", "1e-3,-1"), "'-1' is not a positive number"),
        (("--channel", "a.b.c:maximum"), "unknown statistic 'maximum'; did you mean 'max'?"),
        (("--reference", "nowhere"), "--reference nowhere: error: no results there"),
        (("--set", "lenth=1"), "unknown parameter 'lenth'"),
    ],
)
def test_a_wrong_request_exits_with_2(words: tuple[str, str], message: str, tmp_path: Path) -> None:
    done = crashsolve("study", PENDULUM, "-o", tmp_path / "study", *words)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_default_settings_are_multiples_of_the_steps_of_the_deck(tmp_path: Path) -> None:
    fixed = settings(read_deck(PENDULUM), (), None, None)
    assert [s.label for s in fixed] == ["0.008", "0.004", "0.002", "0.001", "0.0005", "0.00025"]
    deck = read_deck(PENDULUM, {"control.step": "auto", "control.step_max": "0.5"})
    auto = settings(deck, ("rattle", "other"), None, None)
    assert [s.label for s in auto[:6]] == ["auto*4", "auto*2", "auto", "auto/2", "auto/4", "auto/8"]
    assert [s.series.method for s in auto] == ["rattle"] * 6 + ["other"] * 6
    assert auto[3].overrides["control.safety"] == "0.05"
    assert auto[3].overrides["control.step_max"] == "0.25 s"


def test_three_steps_of_any_ratio_give_order_and_limit() -> None:
    steps = [0.4, 0.25, 0.1]
    convergence = analyse(steps, [np.array([1.0 + h**2]) for h in steps], 2.0)
    assert convergence.order == pytest.approx(2.0)
    assert convergence.value[0] == pytest.approx(1.0)
    assert convergence.error == pytest.approx(0.01)
    assert convergence.stalls is None


def test_differences_that_do_not_shrink_are_reported() -> None:
    time = np.linspace(0.0, 1.0, 101)
    steps = [0.1 / 2**k for k in range(5)]
    # smooth until 0.6 s, then another branch with every run
    late = np.where(time > 0.605, 1.0, 0.0)
    paths = [np.sin(time) * (1 + h**2) + late * (-1) ** k for k, h in enumerate(steps)]
    convergence = analyse(steps, paths, 2.0)
    assert (convergence.stalls, convergence.diverges) == (1, True)
    assert convergence.error == pytest.approx(2.0, rel=0.02)
    assert divergence_time(time, paths) == pytest.approx(0.61)
    assert analyse(steps, [np.sin(time) * (1 + h**2) for h in steps], 2.0).stalls is None


def test_differences_that_stay_small_are_a_floor() -> None:
    steps = [0.1 / 2**k for k in range(10)]
    values = [np.array([1.0 + h**2 + 1e-6 * (-1) ** k]) for k, h in enumerate(steps)]
    convergence = analyse(steps, values, 2.0)
    assert (convergence.diverges, convergence.has_floor) == (False, True)
    assert convergence.error == pytest.approx(2e-6, rel=0.3)


def test_errors_that_grow_as_steps_shrink_are_reported_and_not_extrapolated() -> None:
    # what a study found where the iteration of a step was not as short as the step
    errors = {4e-3: 3.5e-6, 2e-3: 1.0e-6, 1e-3: 4.5e-4, 5e-4: 4.1e-4}
    trials = [trial(1, h, 1.0 + error) for h, error in errors.items()]
    finding = find(Watch("x", ("x",), "final"), 0, trials, None)
    assert finding.diverges
    assert "errors grow as the steps shrink, from step 0.002 s on" in finding.notes[-1]
    reported = [finding.error(t) for t in trials]
    # no error is reported too small, and the good runs are not the last
    assert all(e >= abs(wrong) for e, wrong in zip(reported, errors.values(), strict=True))
    assert max(reported[:2]) < min(reported[2:])
    assert cheapest([finding], trials, 4e-4) is None
    # runs that agree better and better, about a value that is not the exact one
    trials = [trial(1, h, 1.0 + h**2 - 4e-6) for h in (4e-3, 2e-3, 1e-3, 5e-4)]
    exact = Watch("x", ("x",), "final", value=1.0, because="exact")
    finding = find(exact, 0, trials, None)
    assert "its errors grow as the steps shrink" in finding.notes[-1]
    # long steps that agreed by luck do not spoil what follows in order
    lucky = [1.0, 1.0 + 1e-6, *(1.0 + h**2 for h in (0.2, 0.1, 0.05, 0.025))]
    steps = [0.8 / 2**k for k in range(6)]
    assert analyse(steps, [np.array([x]) for x in lucky], 2.0).value[0] == pytest.approx(1.0)


def trial(mesh: int, h: float, value: float) -> Trial:
    """A run on elements divided by `mesh`, with steps h."""
    made = Trial(Setting(Series("rattle", mesh), f"{h}", {}), Path(), 0, step=h, cpu_steps=mesh / h)
    made.cycles = round(1 / h)
    made.answers = [{"value": value, "unit": "m"}]
    return made


def test_steps_and_meshes_have_orders_of_their_own() -> None:
    runs = [(m, h) for m in (1, 2, 4) for h in (0.2, 0.1, 0.05)]
    trials = [trial(m, h, 1.0 + h**2 + 0.3 / m**2) for m, h in runs]
    finding = find(Watch("x", ("x",), "final"), 0, trials, None, 2.0)
    assert finding.kind == "extrapolated of rattle, meshes x1 to x4"
    assert finding.reference[0] == pytest.approx(1.0, abs=1e-12)
    for (m, h), t in zip(runs[:-1], trials, strict=False):
        assert finding.error(t) == pytest.approx(h**2 + 0.3 / m**2)
    assert [finding.order(trials[k]) for k in (2, 5, 8)] == pytest.approx([2.0] * 3)
    # of every step on the finest mesh, since the cheapest of them is the nearest to a target
    assert [finding.mesh_order(t) for t in trials[6:]] == pytest.approx([2.0] * 3)
    # 0.3 / 16 by the mesh, and 0.0025 by the step of the finest run: 0.0213 over 0.01
    assert "elements divided by 6 should suffice" in _verdict([finding], trials, 0.01)
    # of the finest run what shorter steps and finer meshes would still change
    assert finding.error(trials[8]) == pytest.approx(0.05**2 + 0.3 / 16)
    assert (
        "0.3, 0.075, 0.019 away; order 2.00 +- 0.00 in the length of elements" in finding.notes[-1]
    )


def test_methods_that_contradict_each_other_are_not_believed() -> None:
    trials = []
    for method, limit, order in (("rattle", 1.0, 2), ("dormand_prince_5", 1.1, 5)):
        for h in (0.2, 0.1, 0.05, 0.025):
            t = trial(1, h, limit + h**order)
            t.setting = Setting(Series(method), f"{h}", {})
            trials.append(t)
    finding = find(Watch("x", ("x",), "final"), 0, trials, None)
    assert "methods converge to values" in finding.notes[0]
    assert finding.error(trials[7]) == pytest.approx(0.1 / 1.1, rel=0.05)
    assert cheapest([finding], trials, 1e-2) is None
    # where they agree the error is that of the better one
    for t in trials[4:]:
        t.answers[0]["value"] -= 0.1
    finding = find(Watch("x", ("x",), "final"), 0, trials, None)
    assert finding.error(trials[7]) < 1e-6


def test_a_mesh_is_not_its_own_judge() -> None:
    # of no order in the mesh
    wrong = {1: 0.5, 2: 0.1, 4: 0.03}
    trials = [trial(m, h, 1.0 + h**2 + wrong[m]) for m in wrong for h in (0.2, 0.1, 0.05)]
    finding = find(Watch("x", ("x",), "final"), 0, trials, None, 2.0)
    finest = trials[6:]
    # the finest mesh differs from the one before by 0.07: a third of that, if its order is 2
    assert min(finding.error(t) for t in finest) > 0.02
    assert cheapest([finding], trials, 1e-2) is None
    # a force that each mesh halves, and of which the finest still has an error of 0.5
    halved = {1: 8.0, 2: 4.0, 4: 2.1}
    trials = [trial(m, h, halved[m] + h**2) for m in halved for h in (0.2, 0.1, 0.05)]
    finding = find(Watch("x", ("x",), "final"), 0, trials, None, 2.0)
    errors = [finding.error(t) for t in trials]
    assert min(errors[:6]) > max(errors[6:])


def test_a_verdict_does_not_contradict_itself() -> None:
    # the last differences are too small for any order: the finest mesh states no error
    for values in ((1.024, 1.01, 1.0), (1.0 + 2.6e-5, 1.0 + 7.3e-7, 1.0), (1.2, 1.1, 1.0)):
        trials = [trial(m, 0.1, v) for m, v in zip((1, 2, 3), values, strict=True)]
        text = _verdict([find(Watch("x", ("x",), "final"), 0, trials, None)], trials, 0.05)
        shares = [float(word) for word in re.findall(r"error (?:of )?([0-9.e-]+)", text)]
        assert shares, text
        if "none of these settings meets it" in text:
            assert min(shares) > 0.05, text


def test_three_meshes_of_one_step_state_an_order_and_a_mesh() -> None:
    trials = [trial(m, 0.1, 1.0 + 0.3 / m**2) for m in (1, 2, 4)]
    finding = find(Watch("x", ("x",), "final"), 0, trials, None, 2.0)
    assert "order 2.00 +- 0.00 in the length of elements" in finding.notes[-1]
    # 0.3 / 4 is more than 5 %, 0.3 / 16 is less; what the step adds is said not to be known
    text = _verdict([finding], trials, 0.05)
    assert text.startswith("target 0.05: rattle, mesh x4 0.1, ")
    assert "error 0.019 by the mesh alone; the error of a single step is not known" in text


def test_a_number_that_meshes_do_not_bring_to_a_value_is_named_beside_the_others() -> None:
    trials = [trial(m, 0.1, 1.0 + 0.3 / m**2) for m in (1, 2, 4)]
    # of order log2(0.5 / 0.46) = 0.12 in the length of elements: no mesh leads to 5 % of it
    for t, peak in zip(trials, (2.0, 1.5, 1.04), strict=True):
        t.answers.append({"value": peak, "unit": "N"})
    findings = [find(Watch(name, (name,), "final"), at, trials, None, 2.0)
                for at, name in enumerate(("x", "peak"))]  # fmt: skip
    text = _verdict(findings, trials, 0.05)
    assert text.startswith("target 0.05: rattle, mesh x4 0.1, ")
    assert text.endswith("none meets it in peak, which finer meshes hardly bring to a value")
    # alone it has no mesh that would suffice
    assert "should suffice" not in _verdict(findings[1:], trials, 0.05)


GIVEN = """
control: {end_time: 1}
materials: {m: {type: elastic, young: 2e11, poisson: 0.3, density: 7850}}
parts:
  made: {type: shell, thickness: 1e-3, material: m,
         mesh: {type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [2, 2]}}
  given: {type: shell, thickness: 1e-3, material: m,
          mesh: {type: listed, nodes: [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
                 quads: [[1, 2, 3, 4]]}}
"""


def test_parts_that_are_not_divided_are_named(tmp_path: Path) -> None:
    (tmp_path / "deck.yaml").write_text(GIVEN, "utf-8")
    *_, last = _axes(read_deck(tmp_path / "deck.yaml"), ["rattle"], "1,2,4")
    assert last.startswith("not divided, for their mesh is listed or of a file: given;")


EQUILIBRIUM = """
control: {end_time: 1, solution: quasi_static, steps: 5}
bodies: {m: {mass: 1, inertia: [1, 1, 1]}}
output: {history: {interval: INTERVAL}}
"""


@pytest.mark.parametrize(("interval", "count"), [("null", 5), ("0.1", 10)])
def test_equilibria_are_compared_over_load_steps(interval: str, count: int, tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    path.write_text(EQUILIBRIUM.replace("INTERVAL", interval), "utf-8")
    deck = read_deck(path)
    methods, _ = suited(deck)
    grid = settings(deck, methods, None, None)
    assert [s.name for s in grid] == [f"newton {count * k} load steps" for k in (1, 2, 4)]
    # each is a deck that can be read, of as many steps
    for k, setting in zip((1, 2, 4), grid, strict=True):
        given = {name: text for name, text in setting.overrides.items() if "estimate" not in name}
        own = read_deck(path, given, refuses_ineffective=False)
        assert own.sample_interval == pytest.approx(1.0 / (count * k), rel=1e-15)
    with pytest.raises(DeckError, match="load steps, which a study divides"):
        run_study(Request(path, tmp_path / "study", steps="0.1,0.05"))


def test_orders_are_those_that_steps_and_methods_can_have() -> None:
    assert order_of_errors((0.2, 0.1), (0.04, 0.01)) == pytest.approx(2.0)
    # steps bound by samples hardly differ, and round-off shrinks by any factor
    assert np.isnan(order_of_errors((1.003e-3, 1e-3), (2e-6, 1e-6)))
    assert np.isnan(order_of_errors((0.2, 0.1), (1e-3, 1e-9)))


def test_a_series_that_does_not_converge_is_not_recommended() -> None:
    trials = []
    for method, values in (
        ("dormand_prince_5", (1.3, 1.3, 1.7, 1.0)),
        ("rattle", (1.04, 1.01, 1.0025, 1.000625)),
    ):
        for h, value in zip((0.2, 0.1, 0.05, 0.025), values, strict=True):
            t = trial(1, h, value)
            t.setting = Setting(Series(method), f"{h}", {})
            t.cpu_steps = 1.0 if method == "dormand_prince_5" else 10.0 + t.cycles
            trials.append(t)
    finding = find(Watch("x", ("x",), "final"), 0, trials, None)
    # its last run is right by luck, and cheaper
    assert finding.error(trials[3]) > 0.5
    best = cheapest([finding], trials, 1e-2)
    assert best is not None
    assert best.setting.series.method == "rattle"


def test_times_below_the_noise_are_not_ranked() -> None:
    trials = [trial(1, h, 1.0 + h**2) for h in (0.1, 0.05, 0.025, 0.0125)]
    # shorter steps cannot cost less
    for t, cpu in zip(trials, (0.013, 0.012, 0.011, 0.010), strict=True):
        t.cpu_steps = cpu
    finding = find(Watch("x", ("x",), "final"), 0, trials, None)
    assert cheapest([finding], trials, 0.02) is trials[0]


BAR = """
control: {end_time: 0.08}
output: {history: {interval: 0.01}}
materials: {m: {type: elastic, young: 1e5, poisson: 0, density: 1000}}
sections: {s: {type: circle, radius: 0.05}}
parts:
  bar: {type: beam, section: s, material: m,
        mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 2}}
joints: {clamp: {type: weld, b: bar_start, at: [0, 0, 0]}}
loads: {pull: {type: gravity, acceleration: [1, 0, 0]}}
expect:
  # the end falls freely until the wave from the clamp comes, at L / c = 0.1 s
  - {channel: rbdout.bar_end.position.x - 1, statistic: final, value: 3.2e-3, tolerance: 5 %,
     because: exact, source: g t^2 / 2}
"""


@pytest.mark.long
def test_a_mesh_converges_to_the_exact_bar(tmp_path: Path) -> None:
    (tmp_path / "bar.yaml").write_text(BAR, "utf-8")
    words = ["--integrators", "rattle", "--steps", "2e-3,1e-3", "--target", "0.01"]
    done = crashsolve(
        *("study", tmp_path / "bar.yaml", "-o", tmp_path / "study", *words),
        CRASHSOLVE_PLAIN="1",
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "meshes: elements of all parts times 1, 2, 4" in done.stdout
    assert "deformation: co-rotational, the only description" in done.stdout
    with (tmp_path / "study" / "study.csv").open(encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    assert [row["mesh"] for row in table] == ["1", "1", "2", "2", "4", "4"]
    (name,) = [word for word in table[0] if "error against exact" in word]
    errors = [float(row[name]) for row in table[1::2]]
    # the elements are of order 2 in what is smooth; what runs ahead of a front falls faster
    assert np.all(np.log2(np.array(errors[:-1]) / errors[1:]) > 1.85)
    assert errors[0] == pytest.approx(0.030, abs=0.001)
    assert "of mesh" in ", ".join(table[0])
    assert (tmp_path / "study" / "rattle_mesh_x4_0.001" / "log.txt").exists()
    assert "target 0.01: rattle, mesh x" in done.stdout


def test_meshes_that_a_deck_has_not_are_refused(tmp_path: Path) -> None:
    done = crashsolve("study", PENDULUM, "-o", tmp_path / "study", "--meshes", "1,2")
    assert done.returncode == 2
    assert "--meshes 1,2: error: the deck has no part whose elements can be divided" in done.stderr


def test_the_runs_of_a_study_estimate_nothing_and_keep_no_accuracy() -> None:
    deck = read_deck(PENDULUM, {"control.step": "auto", "control.accuracy": "1e-3"})
    for setting in settings(deck, ("rattle", "radau_iia_5"), None, None):
        words = {"control.step": "auto", "control.accuracy": "1e-3"} | setting.overrides
        control = read_deck(PENDULUM, words).control
        assert (control.estimate, control.accuracy) == ("off", None)


def test_all_methods_that_can_run_a_deck_are_compared() -> None:
    able, notes = suited(read_deck(PENDULUM))
    assert able[0] == "rattle"
    assert set(able) >= {"dormand_prince_5", "generalized_alpha", "radau_iia_5"}
    assert not notes
    heap = read_deck(HERE / "mechanism.yaml")
    able, notes = suited(heap)
    assert len(able) + len(notes) == 5


def test_a_published_value_the_runs_do_not_lead_to_is_reported_but_no_reference() -> None:
    trials = []
    for k, h in enumerate((0.4, 0.2, 0.1, 0.05)):
        trial = Trial(
            Setting(Series("rattle"), f"{h}", {}), Path(), 0, cycles=k + 1, step=h, cpu_steps=1 / h
        )
        trial.answers = [{"value": 1.0 + h**2, "unit": "m"}]
        trials.append(trial)
    for because, value, kind in (
        ("published", 1.1, "extrapolated"),
        ("published", 1.0, "published"),
        ("exact", 1.1, "exact"),
    ):
        watch = Watch("x", ("x",), "final", value=value, because=because)
        finding = find(watch, 0, trials, None)
        assert finding.kind == kind
        assert ("0.091 away" in " ".join(finding.notes)) == (kind == "extrapolated")
        if kind != "exact":
            assert finding.error(trials[0]) == pytest.approx(0.16)
    assert "it is no error of the step" in finding.notes[0]


def test_a_method_that_chooses_its_step_is_given_tolerances() -> None:
    deck = read_deck(PENDULUM, {"control.step": "auto"})
    listed = settings(deck, ("dormand_prince_5", "rattle"), "1e-3", "1e-6,1e-3")
    labels = [(setting.series.method, setting.label) for setting in listed]
    chosen = [("dormand_prince_5", "tolerance 0.001"), ("dormand_prince_5", "tolerance 1e-06")]
    assert labels == [*chosen, ("rattle", "0.001")]
    assert listed[1].overrides["control.tolerance"] == "1e-06"
