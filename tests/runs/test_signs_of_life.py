"""Claim: a run states where it is, who sets its step and why, and at the end what never
happened.
"""

import json
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve, differences, environment

from crashsolve.model.checks.gyration import inconsistency
from crashsolve.simulation import heartbeat
from crashsolve.simulation.heartbeat import Heartbeat
from crashsolve.simulation.progress import Account
from crashsolve.simulation.remarks import STEPS, StepWatch

pytestmark = pytest.mark.xdist_group("runs")

SCENE = """
control: {{end_time: 2e-3, {control}}}
output: {{history: {{interval: 1e-3}}}}
bodies:
  block: {{mass: 1, inertia: [{inertia}], position: [0, 0, 1], {motion}}}
  other: {{mass: 1, inertia: [1, 1, 1], position: [0, 5, 0.0995]}}
surfaces:
  ball: {{type: sphere, body: other, radius: 0.1}}
  floor: {{type: plane}}
contacts:
  landing: {{a: [ball], b: [floor], normal: {{type: penalty, stiffness: {contact}}}}}
springs:
  soft: {{type: linear, b: block, at_a: [0, 0, 3], stiffness: 1, length: 2}}
  tie:
    {{type: linear, b: block, at_a: [0, 0, 3], at_b: [{arm}, 0, 0], stiffness: {k}, damping: {c}}}
"""
PLAIN = {
    "control": "integrator: rattle",
    "inertia": "1, 1, 1",
    "motion": "",
    "contact": "1",
    "arm": "0",
    "k": "1e4",
    "c": "0",
}
# what differs from PLAIN, and what is reported
CAUSES = {
    "a stiff spring": ({}, "body 'block', stiffness of spring 'tie'"),
    "a damper": ({"c": "1e3"}, "body 'block', damping of spring 'tie'"),
    "a light body": (
        {"arm": "1", "inertia": "1e-4, 1e-4, 1e-4"},
        "body 'block', stiffness of spring 'tie', by its rotation",
    ),
    "a contact": (
        {"contact": "3e5"},
        "body 'other', stiffness of contact 'landing' with 'ground'",
    ),
    "a fast turn": (
        {"k": "1", "motion": "angular_velocity: [0, 0, 1e3]"},
        "body 'block', rotation at 1e+03 rad/s",
    ),
    "samples": ({"k": "1"}, "samples"),
    "the longest step": ({"k": "1", "control": "step_max: 1e-4"}, "control.step_max"),
    "the step of the deck": ({"control": "step: 1e-4"}, "control.step"),
    "samples, before the step of the deck": ({"k": "1", "control": "step: 1e-2"}, "samples"),
    "the error of a step": (
        {
            "control": "integrator: dormand_prince_5, tolerance: 1e-12",
            "motion": "velocity: [1, 0, 0]",
        },
        "error of a step, control.tolerance",
    ),
}


@pytest.mark.parametrize("name", CAUSES)
def test_who_sets_the_step_is_named_with_the_reason(name: str, tmp_path: Path) -> None:
    changes, reported = CAUSES[name]
    deck, folder = tmp_path / "deck.yaml", tmp_path / "out"
    deck.write_text(SCENE.format(**PLAIN | changes), "utf-8")
    done = crashsolve(deck, "-o", folder, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    assert json.loads((folder / "status.json").read_text("utf-8"))["step_set_by"] == reported
    lines = (folder / "log.txt").read_text("utf-8").splitlines()
    assert any(line.endswith(f"  {reported}") for line in lines)


def test_Reporting_leaves_no_trace_in_the_results(
    uninterrupted: dict[Path, Path], tmp_path: Path
) -> None:
    # pairs come and go
    deck = next(path for path in uninterrupted if path.stem == "heap")
    # a line at every block of samples and every pause, and the culprit looked for at each of them
    code = (
        "import crashsolve.simulation.heartbeat as pulse, crashsolve.system.bounds as bounds, sys;"
        "pulse.AT_PAUSE = bounds.RENEWAL_INTERVAL = -1.0;"
        "from crashsolve.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    words = [sys.executable, "-c", code, str(deck), "-o", str(tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, env=environment())
    assert done.returncode == 0, done.stderr
    assert len((tmp_path / "log.txt").read_text("utf-8").splitlines()) > 150
    assert differences(tmp_path, uninterrupted[deck]) == []


def run_by(code: str, deck: Path, out: Path) -> subprocess.CompletedProcess[str]:
    """A run in a process that changes the solver before it calls the command."""
    words = [sys.executable, "-c", code, str(deck), "-o", str(out)]
    return subprocess.run(words, capture_output=True, text=True, env=environment())


def test_a_sign_of_life_at_the_end_leaves_the_run_finished(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(SCENE.format(**PLAIN), "utf-8")
    # the thread reports while totals are written, after the status of the end
    code = (
        "import time, crashsolve.simulation.heartbeat as pulse, crashsolve.simulation.solve as s;"
        "pulse.FIRST = pulse.AT_LATEST = 0.05; pulse.POLL = 0.01; totals = s.write_totals;"
        "s.write_totals = lambda account: (totals(account), time.sleep(0.5));"
        "from crashsolve.cli import main; import sys; sys.exit(main(sys.argv[1:]))"
    )
    done = run_by(code, deck, tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "ending the run" in (tmp_path / "out" / "log.txt").read_text("utf-8")
    status = json.loads((tmp_path / "out" / "status.json").read_text("utf-8"))
    assert (status["state"], status["exit_code"], status["message"]) == ("finished", 0, "")


def test_what_lasts_long_is_reported_from_the_first_second_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(heartbeat, "FIRST", 0.05)
    monkeypatch.setattr(heartbeat, "AT_LATEST", 0.2)
    monkeypatch.setattr(heartbeat, "POLL", 0.01)
    reported: list[tuple[float, str]] = []
    begun = time.monotonic()
    with Heartbeat(
        "reading", lambda text: reported.append((time.monotonic() - begun, text))
    ) as beat:
        time.sleep(0.3)
        beat.does("compiling")
        time.sleep(0.3)
        count = len(reported)
        for _ in range(6):
            # who states something is not interrupted
            beat.reported()
            time.sleep(0.05)
        assert len(reported) == count
    # a busy machine may be late, and never early
    assert reported[0][0] >= 0.05 and reported[0][1] == "reading: 0 s"
    assert reported[-1][1].startswith("compiling: ")
    assert count >= 3
    time.sleep(0.3)
    assert len(reported) == count


@pytest.mark.long
def test_a_first_run_states_that_it_compiles(tmp_path: Path) -> None:
    # the scene that compiles longest, some four seconds of a fast core
    deck = Path(__file__).parents[2] / "decks/verification/parts/shell_radau.yaml"
    words = ("--set", "control.end_time=1e-4", "--set", "control.estimate=off")
    done = crashsolve(deck, "-o", tmp_path / "out", *words, CRASHSOLVE_CACHE=str(tmp_path / "own"))
    assert "compiling the step: " in done.stdout, done.stdout + done.stderr


def test_a_collapse_of_the_step_is_reported_once() -> None:
    watch, now, cycle = StepWatch(), 0.0, 0
    said = []
    for step in (1e-3, 1e-3, 1.1e-6, 0.9e-6, 0.9e-6):
        now, cycle = now + STEPS * step, cycle + STEPS
        said.append(watch.warning(now, cycle))
    # the first look only takes note of the start
    assert [bool(text) for text in said] == [False, False, False, True, False]
    assert "the average step has fallen from 0.001 s to 9e-07 s" in said[3]


LANDING = """
control: {end_time: 0.2605}
output: {history: {interval: 0.01}}
bodies: {ball: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 1.2595], velocity: [0, 0, -1]}}
surfaces:
  ball: {type: sphere, body: ball, radius: 1}
  floor: {type: plane}
  roof: {type: plane, at: [0, 0, 9], normal: [0, 0, -1]}
contacts:
  landing: {a: [ball], b: [floor], normal: {type: kelvin_voigt, stiffness: 1, damping: 15000}}
  roof: {a: [ball], b: [roof], normal: {type: penalty, stiffness: 1}}
materials: {steel: {type: elastic, young: 2e5, poisson: 0.3, density: 7850}}
sections: {bar: {type: circle, radius: 0.5}}
parts:
  idle: {type: beam, mesh: {shape: line, from: [5, 0, 0], to: [105, 0, 0], elements: 1},
         section: bar, material: steel}
"""


def test_a_run_reports_a_collapse_and_of_what_never_happened(tmp_path: Path) -> None:
    deck, folder = tmp_path / "deck.yaml", tmp_path / "out"
    deck.write_text(LANDING, "utf-8")
    done = crashsolve(deck, "-o", folder, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    log = (folder / "log.txt").read_text("utf-8")
    (warning,) = [text for text in log.splitlines() if text.startswith("warning: the average step")]
    assert "it is set by: body 'ball', damping of contact 'landing' with 'ground'" in warning
    assert "contacts that never touched" in log and "parts that never deformed" in log
    status = json.loads((folder / "status.json").read_text("utf-8"))
    assert (status["untouched"], status["undeformed"], status["deleted"]) == (
        ["roof"],
        ["idle"],
        {},
    )


def cube(point: tuple[float, float, float], half: float) -> list[tuple[np.ndarray, float]]:
    """Middles of the faces of a cube."""
    directions = [sign * half * axis for axis in np.eye(3) for sign in (-1.0, 1.0)]
    return [(np.add(point, direction), 0.0) for direction in directions]


@pytest.mark.parametrize("size", [1e-3, 1.0, 100.0])
@pytest.mark.parametrize(("factor", "unit"), [(1e6, "kg mm^2"), (1e4, "kg cm^2"), (1e9, "g mm^2")])
def test_an_inertia_in_another_unit_is_noticed(size: float, factor: float, unit: str) -> None:
    # a solid cube
    J, own = np.diag([1.0, 1.0, 1.0]) * 7.0 * (2.0 * size) ** 2 / 6.0, cube((0, 0, 0), size)
    assert inconsistency(7.0, J, own, own) == ""
    small, large = (
        inconsistency(7.0, J / factor, own, own),
        inconsistency(7.0, J * factor, own, own),
    )
    assert f"looks too small: {J[0, 0] / factor:.3g} kg m^2" in small
    assert f"were these numbers in kg m^2, and read as {unit}?" in small
    assert f"were these numbers in {unit}, and read as kg m^2?" in large


def test_slender_flat_and_hollow_bodies_are_left_alone() -> None:
    # a rod of 10 m and 20 mm, a sheet of 2 m and 2 mm, a ring at its rim
    rod = [(np.array([0.0, 0.0, z]), 0.01) for z in (-5.0, 5.0)]
    assert inconsistency(24.0, np.diag([200.0, 200.0, 24.0 * 0.01**2 / 2]), rod, rod) == ""
    sheet = [(np.array([x, y, 0.0]), 1e-3) for x in (-1.0, 1.0) for y in (-1.0, 1.0)]
    assert inconsistency(60.0, np.diag([20.0, 20.0, 40.0]), sheet, sheet) == ""
    assert inconsistency(1.0, np.diag([0.5, 0.5, 1.0]), sheet, sheet) == ""
    # joints in its middle say nothing of how large a body is
    middle = [(np.zeros(3), 0.0)]
    assert inconsistency(1.0, np.eye(3), [], middle) == ""
    assert inconsistency(1.0, np.eye(3), [], []) == ""


def test_check_warns_of_a_light_car_and_refuses_what_is_no_solid(tmp_path: Path) -> None:
    deck = tmp_path / "car.yaml"
    text = (
        "control: {end_time: 1}\n"
        "bodies: {car: {mass: 1500, inertia: [500 kg mm^2, 2000 kg mm^2, 2000 kg mm^2]}}\n"
        "surfaces: {wheel: {type: sphere, body: car, at: [1.3, 0.7, 0], radius: 0.3}}\n"
    )
    deck.write_text(text, "utf-8")
    done = crashsolve("check", deck)
    assert done.returncode == 0, done.stderr
    assert "warning: body 'car': its inertia looks too small: 0.0005 kg m^2" in done.stdout
    deck.write_text(text.replace("500 kg mm^2", "9000 kg mm^2"), "utf-8")
    assert crashsolve("check", deck).returncode == 2


def test_a_late_sign_of_life_leaves_the_end_of_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    # its thread may have waited while the end was written
    account, states = Account.__new__(Account), []
    account._writing, account._has_ended = threading.RLock(), False
    monkeypatch.setattr(account, "_write_status", lambda state, *others: states.append(state))
    for state in ("running", "failed", "running"):
        account.status(state, None, "")
    assert states == ["running", "failed"]


def test_a_request_during_pilot_runs_stops_before_the_run_begins(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    text = SCENE.format(**PLAIN | {"control": "accuracy: 1e-6"})
    deck.write_text(
        text + "watch: [{channel: rbdout.block.position.z, statistic: final}]\n", "utf-8"
    )
    code = (
        "import os, signal, sys, crashsolve.estimate.runner as runner;"
        "pilots = runner.Estimating._calibrate;"
        "runner.Estimating._calibrate = lambda *words: ("
        "os.kill(os.getpid(), signal.SIGTERM), pilots(*words))[1];"
        "from crashsolve.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    done = run_by(code, deck, tmp_path / "out")
    assert done.returncode == 3, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    status = json.loads((tmp_path / "out" / "status.json").read_text("utf-8"))
    assert (status["state"], status["exit_code"]) == ("stopped", 3)
    assert status["message"] == "stopped on request before the run began"
