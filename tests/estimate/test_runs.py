"""Claim: every run ends with the errors of what it watches, and keeps an accuracy asked for."""

import json
import signal
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from command import crashsolve, start
from quick import first_quick

from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.estimate.companion import Abandoned, Companions, _RecordedSamples
from crashsolve.estimate.error import Estimate
from crashsolve.estimate.estimator import OVER_BUDGET, Estimator
from crashsolve.estimate.runner import Estimating, _line
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.ledger import EXTERNAL_WORK, IMBALANCE, LARGEST
from crashsolve.recording.histories import Histories, families_of
from crashsolve.simulation.solve import solve
from crashsolve.study.watch import Watch
from crashsolve.system.energy import check
from crashsolve.system.engine import Engine

ROOT = Path(__file__).resolve().parents[2]
PENDULUM = ROOT / "tests" / "runs" / "pendulum.yaml"
X = "rbdout.bob.position.x"
# elliptic functions, as in the deck
EXACT = {X: 0.9862917511, "rbdout.bob.position.y": -0.1650108531}
FACTOR = 10.0
pytestmark = pytest.mark.xdist_group("runs")


def watched(folder: Path) -> dict[str, dict[str, Any]]:
    """The estimates of a run by channel."""
    status = json.loads((folder / "status.json").read_text("utf-8"))
    return {entry["channel"]: entry for entry in status["watched"]}


def run(folder: Path, *words: object) -> dict[str, dict[str, Any]]:
    """The estimates of the pendulum."""
    done = crashsolve(PENDULUM, "-o", folder, *words)
    assert done.returncode == 0, done.stdout + done.stderr
    return watched(folder)


# higher orders come too near the digits of these values; the battery has them
@pytest.mark.parametrize("step", first_quick(["2e-3", "8e-3"]))
def test_the_estimated_error_is_near_the_true_one(step: str, tmp_path: Path) -> None:
    numbers = run(tmp_path, "--set", f"control.step={step}")
    log = (tmp_path / "log.txt").read_text("utf-8")
    for channel, exact in EXACT.items():
        true = abs(numbers[channel]["value"] - exact)
        assert true / FACTOR < numbers[channel]["error"] < true * FACTOR
        assert f"{channel} final = " in log
    assert "cost of the error estimates" in log


@pytest.mark.parametrize(
    ("method", "accuracy"), first_quick([("rattle", 1e-4), ("dormand_prince_5", 1e-6)])
)
def test_an_accuracy_is_kept(method: str, accuracy: float, tmp_path: Path) -> None:
    # from rest nothing but the samples bounds an automatic step
    deck = tmp_path / "deck.yaml"
    deck.write_text(PENDULUM.read_text("utf-8").replace("interval: 1}", "interval: 0.02}"))
    words = ["--set", "control.step=auto", "--set", f"control.accuracy={accuracy}"]
    words += ["--set", f"control.integrator={method}"]
    done = crashsolve(deck, "-o", tmp_path, *words)
    assert done.returncode == 0, done.stdout + done.stderr
    numbers = watched(tmp_path)
    for channel, exact in EXACT.items():
        scale = numbers[channel]["scale"]
        assert numbers[channel]["error"] <= accuracy * scale
        assert abs(numbers[channel]["value"] - exact) <= accuracy * scale
    assert "pilot runs" in (tmp_path / "log.txt").read_text("utf-8")


def test_status_states_steps_constraints_and_times(tmp_path: Path) -> None:
    run(tmp_path)
    status = json.loads((tmp_path / "status.json").read_text("utf-8"))
    assert status["average_step"] == {"before": pytest.approx(2e-3), "during": None, "after": None}
    assert status["rejected"] == 0
    assert 0.0 < status["constraint_position"] <= 1e-10
    assert 0.0 < status["constraint_velocity"] < 1e-9
    stages = ["start of Python", "read", "build", "compile or load", "steps", "output"]
    assert list(status["cpu_stages"]) == [*stages, "estimates", "files and reports"]
    assert all(seconds > 0.0 for seconds in status["cpu_stages"].values())
    # all that the process took until it was written
    assert sum(status["cpu_stages"].values()) == pytest.approx(status["cpu"], rel=0.02)
    assert status["real_time_factor"] > 0.0


def test_a_deck_may_do_without(tmp_path: Path) -> None:
    assert run(tmp_path, "--set", "control.estimate=off") == {}
    assert "watched" not in (tmp_path / "log.txt").read_text("utf-8")


def estimator(folder: Path, extra: str = "", integrator: str = "rattle") -> Estimator:
    deck_path = folder / "deck.yaml"
    deck_path.write_text(PENDULUM.read_text("utf-8") + extra, "utf-8")
    deck = read_deck(deck_path, {"control.integrator": integrator})
    return Estimator(deck, Histories(Engine(*build(deck))).families)


def test_a_companion_of_the_same_steps_is_the_run_itself(tmp_path: Path) -> None:
    run(tmp_path)
    series = Result(tmp_path).series(X)
    companion = estimator(tmp_path).companions.run(1.0)
    np.testing.assert_array_equal(companion.time, series.time)
    np.testing.assert_array_equal(companion.values[X], series.values)


def test_a_companion_gives_up_when_asked() -> None:
    deck = read_deck(PENDULUM)
    given = Estimator(deck, Histories(Engine(*build(deck))).families, lambda: True)
    with pytest.raises(Abandoned):
        given.companion_runs(1.0, 500, [])


HINGED = """
control: {end_time: 0.3, safety: 0.3}
bodies:
  c: {mass: 980, inertia: [100, 100, 100], position: [-1, 0, 0], velocity: [5, 0, 0]}
  l: {mass: 100, inertia: [0.01, 0.01, 0.01], velocity: [5, 0, 0]}
joints:
  rail: {type: prismatic, b: c, at: [-1, 0, 0], axis: [1, 0, 0]}
  hinge: {type: revolute, a: c, b: l, at: [0, 0, 0], axis: [0, 1, 0]}
surfaces:
  s: {type: sphere, body: l, radius: 0.1}
  w: {type: plane, at: [0.2, 0, 0], normal: [-1, 0, 0]}
contacts:
  k: {a: [s], b: [w], normal: {type: exact_restitution, stiffness: 1.0e+9, restitution: 0.5}}
watch: [{channel: rbdout.c.velocity.x, statistic: final}]
"""


def test_a_finer_run_that_agrees_by_chance_has_another(tmp_path: Path) -> None:
    # longer steps are unstable, and half of them return the same by chance
    deck = tmp_path / "deck.yaml"
    deck.write_text(HINGED, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "r")
    assert done.returncode == 0, done.stdout
    (speed,) = Result(tmp_path / "r").status["watched"]
    assert "2 finer runs of" in speed["how"]
    assert abs(speed["value"] + 2.5) < 10.0 * speed["error"] < 0.01


def test_samples_may_end_with_a_full_block(tmp_path: Path) -> None:
    estimator_of = estimator(tmp_path)
    engine = Engine(*build(estimator_of.deck))
    recorded = _RecordedSamples(engine, Histories(engine))
    engine.start()
    for k in range(recorded.histories.kept.capacity):
        engine.sample(0.0)
        recorded.take(1e-6 * k)
    recorded.close()
    assert [len(block["rbdout"]) for block in recorded.blocks] == [len(recorded.times)]


def test_companions_cost_no_more_than_is_left_for_them(tmp_path: Path) -> None:
    problems: list[str] = []
    begun = time.process_time()
    assert estimator(tmp_path).companion_runs(1.0, 500, problems, budget=0.0) == []
    spent = time.process_time() - begun
    # it ends at the first sample of the first companion, which takes seconds in all
    assert spent < 2.0
    assert problems == [OVER_BUDGET]
    # a method that would be compared with a finer run is compared with a coarser one
    given = estimator(tmp_path, integrator="dormand_prince_5")
    cycles = given.companions.run(1.0).cycles
    assert [r.cycles < cycles for r in given.companion_runs(1.0, cycles, [], 1e3)] == [True]
    assert [r.cycles > cycles for r in given.companion_runs(1.0, cycles, [])] == [True]
    # and that of a cheap run ends where it gets stuck
    problems.clear()
    assert given.companion_runs(1.0, cycles, problems, limit=0.0) == []
    assert problems == [OVER_BUDGET]


BEAM = """
control: {end_time: 2e-4, step: 1e-6}
materials: {steel: {type: elastic, young: 2e11, poisson: 0.3, density: 7850}}
sections: {rod: {type: circle, radius: 0.01}}
parts:
  bar: {type: beam, section: rod, material: steel, velocity: [0, 0, 1],
        mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 1}}
output: {history: {interval: 1e-4}}
watch: [rbdout.bar_end.velocity.z]
"""


def test_estimates_say_that_they_leave_the_mesh_out(tmp_path: Path) -> None:
    (tmp_path / "deck.yaml").write_text(BEAM)
    done = crashsolve(tmp_path / "deck.yaml", "-o", tmp_path, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stdout + done.stderr
    assert watched(tmp_path)["rbdout.bar_end.velocity.z"]["how"].endswith("; without the mesh")
    log = (tmp_path / "log.txt").read_text("utf-8")
    assert "has 1, which cannot be divided by 2 and stay above 1" in log


def test_a_balance_above_its_limit_is_said_though_it_closes_again() -> None:
    deck = read_deck(PENDULUM)
    engine = Engine(*build(deck))
    clock, control = engine.clock, engine.model.control.view(np.recarray)[0]
    ledger = engine.state.ledger
    # from outside comes more and more of what is missing less and less: the run goes on
    for work, missing in ((1.0, 0.5), (10.0, 0.8), (100.0, 0.1)):
        ledger[:] = 0.0
        ledger[[EXTERNAL_WORK, LARGEST, IMBALANCE]] = work, work, missing
        clock.time, clock.cycle, clock.status = work, 1000, 0
        check(clock, control, engine.state.nodes.view(np.recarray), ledger)
        assert clock.status == 0
    engine.ledger[LARGEST] = 100.0
    (text,) = engine.step_warnings()
    # what most was missing, 0.8 of 10
    assert "at t = 10 s the energy balance was off by 8 % of the largest energy by then" in text
    # what is nothing beside the energy of the run is no matter
    engine.ledger[LARGEST] = 1e5
    assert engine.step_warnings() == []


def test_an_error_larger_than_the_value_is_a_warning() -> None:
    texts: list[str] = []
    log = SimpleNamespace(warning=texts.append, section=lambda *_: None, line=lambda _: None)
    estimating = Estimating.__new__(Estimating)
    estimating.log, estimating.problems = log, []  # type: ignore[assignment]
    estimating.cpu, estimating.accuracy = 1.0, None
    watches = [Watch(name, (name,), "final") for name in ("lost", "known", "nothing")]
    # of the third nothing is left but the round-off of its vector
    estimating.estimates = [
        Estimate(watch, value, "m/s", error, 10.0, "2 coarser runs, order 2.00")
        for watch, value, error in zip(watches, (5.0, 5.0, 1e-9), (16.0, 1.0, 2e-9), strict=True)
    ]
    estimating._report(1.0)
    (text,) = texts
    assert "lost: the estimated error, 16, is larger than the value, 5" in text
    assert text.endswith("take shorter steps or a smaller control.tolerance")
    lost = estimating.estimates[0]
    estimating.estimates = [replace(lost, mesh=15.0)]
    estimating._report(1.0)
    assert texts[-1].endswith("take smaller elements")


@pytest.mark.parametrize("error", [2.4e-3, 36.0, 1e-6, 1e5])
def test_digits_of_a_number_reach_below_its_error(error: float) -> None:
    # nine digits of this energy end at 0.1 J
    value = 19839886.9753086
    watch = Watch("lost", ("lost",), "final")
    printed = _line(Estimate(watch, value, "J", error, value, "")).split(" = ")[1].split()[0]
    assert abs(float(printed) - value) < 0.1 * error


def test_a_watched_channel_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors) as caught:
        estimator(tmp_path, "watch: [rbdout.bop.position.x, {channel: nodes.a.b}]\n")
    first, second = str(caught.value).splitlines()
    assert (
        "watch 1: channel: 'rbdout.bop.position.x': no rbdout of 'bop'; did you mean 'bob'?"
        in first
    )
    assert "watch 2: channel: 'nodes.a.b': unknown family 'nodes'" in second
    assert "deck.yaml:13:9" in first
    with pytest.raises(DeckErrors) as caught:
        estimator(tmp_path, "watch: [jntforc.bob.force.x]\n")
    assert "no jntforc of 'bob', which has rbdout" in str(caught.value)


def test_an_accuracy_of_nothing_but_the_run_itself_is_refused(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    text = PENDULUM.read_text("utf-8").split("expect:")[0]
    deck.write_text(text + "watch: [glstat.model.balance]\n", "utf-8")
    words = ["--set", "control.step=auto", "--set", "control.accuracy=1e-4"]
    done = crashsolve(deck, "-o", tmp_path, *words, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 2
    assert "every watched channel is itself a measure of the run's errors" in done.stderr


def test_a_run_that_watches_its_own_errors_alone_makes_no_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object) -> None:
        raise AssertionError("there is nothing to compare")

    monkeypatch.setattr(Companions, "run", never)
    text = PENDULUM.read_text("utf-8").split("expect:")[0]
    (tmp_path / "deck.yaml").write_text(text + "watch: [glstat.model.balance]\n", "utf-8")
    assert solve(tmp_path / "deck.yaml", tmp_path / "out", {}, restart=False) == 0
    log = (tmp_path / "out" / "log.txt").read_text("utf-8")
    assert "not estimated: it measures the errors of the run itself" in log
    assert OVER_BUDGET not in log


def test_estimates_may_begin_with_a_restart(tmp_path: Path) -> None:
    every, off = {"output.restart.every": "0.2"}, {"control.estimate": "off"}
    assert solve(PENDULUM, tmp_path, every | off | {"control.end_time": "0.5"}, restart=False) == 0
    assert solve(PENDULUM, tmp_path, every, restart=True) == 0
    assert all(entry["error"] for entry in watched(tmp_path).values())


def test_a_stop_while_errors_are_estimated_keeps_the_finished_run(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(PENDULUM.read_text("utf-8").replace("interval: 1}", "interval: 0.02}"))
    # slow enough for a signal to come in time
    process = start(deck, "-o", tmp_path, CRASHSOLVE_PLAIN="1")
    status, end = tmp_path / "status.json", time.monotonic() + 600
    while process.poll() is None and time.monotonic() < end:
        time.sleep(0.05)
        if status.exists() and "estimating" in status.read_text("utf-8"):
            break
    process.send_signal(signal.SIGTERM)
    out, errors = process.communicate(timeout=600)
    assert process.returncode == 0, out + errors
    position = watched(tmp_path)[X]
    # one of the coarser runs may have been through before the signal came
    assert position["value"] == pytest.approx(EXACT[X], abs=1e-4)
    assert Result(tmp_path).finished


def test_a_finer_run_divides_load_steps_that_were_cut(tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    path.write_text(
        "control: {end_time: 1, solution: quasi_static, steps: 2}\n"
        "bodies: {m: {mass: 1, inertia: [1, 1, 1]}}\n"
        "watch: [rbdout.m.position.x]\n",
        "utf-8",
    )
    deck = read_deck(path)
    estimator = Estimator(deck, families_of(*build(deck)))
    # the start and two load steps; the same, each in four pieces
    assert estimator._finer(1.0, 3) == (0.5, 0.25)
    assert estimator._finer(1.0, 9) == (0.125, 0.0625)
