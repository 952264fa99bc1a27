"""Claim: contacts between two samples are in the numbers of forces, with the same run as without.

A ball of 1 kg at 1 m/s strikes a floor within 0.9 ms. With `exact_restitution` of 0.5 it takes
1.5 N s; the peak is that of all steps but for the speed that a step predicts.
"""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from command import crashsolve, differences
from quick import first_quick

from crashpost.results.result import Result
from crashsolve.cli import main
from crashsolve.system import engine

DECK = """\
control: {end_time: 0.5, estimate: ESTIMATE}
output: {history: {interval: INTERVAL}}
bodies:
  a:
    primitive: {shape: sphere, radius: 0.1}
    mass: 1
    position: [0, 0, 0.2043]
    velocity: [0, 0, -1]
surfaces: {a: {type: sphere, body: a, radius: 0.1}, f: {type: plane}}
contacts:
  c: {a: [a], b: [f], normal: {type: exact_restitution, stiffness: 1e9, restitution: 0.5}}
watch:
  - {channel: rcforc.c.normal, statistic: max}
  - {channel: rcforc.c.normal, statistic: integral}
  - {channel: rbdout.a.acceleration.z, statistic: max}
  - {channel: rcforc.c.peak_normal, statistic: final}
"""


def run(folder: Path, interval: str, estimate: str = "auto") -> dict[str, Any]:
    """Watched numbers with their errors, by channel and statistic."""
    deck = folder / "deck.yaml"
    deck.write_text(DECK.replace("INTERVAL", interval).replace("ESTIMATE", estimate), "utf-8")
    command = [sys.executable, "-m", "crashsolve", str(deck), "-o", str(folder / "out")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    # none of a peak between samples
    assert "warning:" not in done.stdout
    status = json.loads((folder / "out" / "status.json").read_text("utf-8"))
    return {f"{w['channel']} {w['statistic']}": w for w in status.get("watched", [])}


@pytest.mark.parametrize("interval", first_quick(["0.01", "0.017", "0.1"]))
def test_numbers_of_a_short_touch_are_right_at_any_interval(tmp_path: Path, interval: str) -> None:
    watched = run(tmp_path, interval)
    peak = watched["rcforc.c.peak_normal final"]["value"]
    for name in ("rcforc.c.normal max", "rbdout.a.acceleration.z max"):
        # a quarter of a per cent: eleven steps a touch see its speed so well
        assert watched[name]["value"] == pytest.approx(peak, rel=2.5e-3)
        assert watched[name]["error"] > 0.0
    impulse = watched["rcforc.c.normal integral"]
    assert abs(impulse["value"] - 1.5) < 10.0 * impulse["error"]
    # trapezia of ten steps
    assert impulse["value"] == pytest.approx(1.5, rel=0.02)


def test_the_run_is_as_without_samples_between(tmp_path: Path) -> None:
    run(tmp_path, "0.01", "off")
    with h5py.File(tmp_path / "out" / "history.h5") as file:
        time, z = file["rbdout/time"][:], file["rbdout/velocity/z"][:, 0]
        force = file["rcforc/normal"][:, 0]
    plain = np.isclose(time / 0.01, np.round(time / 0.01), rtol=0.0, atol=1e-9)
    assert np.all(np.diff(time) > 0.0)
    assert plain.sum() == 51 and 5 < (~plain).sum() < 200
    # between samples and in touch: nothing of it is in the plain ones
    assert force[plain].max() == 0.0 < force[~plain].min() + 1.0
    assert np.allclose(z[plain][:10], -1.0, rtol=1e-12)
    assert np.ptp(z[plain][11:]) < 1e-12


# stops at the first step after a time, within an interval, as a signal does that comes then
STOPPED = """\
import sys
from pathlib import Path
from crashsolve.foundation.errors import RunStopped
from crashsolve.simulation import solve
from crashsolve.system import engine

deck, folder, until = Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3])
engine.LONGEST_CALL = 0.0  # look at every step
engine.FIRST_CALL = 1

class Run(solve.Run):
    def _handle_requests_at_once(self):
        if float(self.engine.clock["time"]) > until:
            self.requests.words.add("stop")
        super()._handle_requests_at_once()

solve.Run = Run
try:
    solve.solve(deck, folder, {}, False)
except RunStopped:
    sys.exit(3)
"""


def test_a_run_that_goes_on_within_an_interval_begins_it_where_it_began(tmp_path: Path) -> None:
    deck = DECK.replace("{end_time", "{step_max: 2e-3, end_time").replace("ESTIMATE", '"off"')
    # states at events before a dump are not written after it
    deck = deck.replace("INTERVAL}", "0.1}, states: {interval: 0.1}")
    path, whole, cut = tmp_path / "deck.yaml", tmp_path / "whole", tmp_path / "cut"
    path.write_text(deck, "utf-8")
    assert crashsolve(path, "-o", whole).returncode == 0
    # during the touch, which lasts from 0.1043 to 0.1052 s
    command = [sys.executable, "-c", STOPPED, str(path), str(cut), "0.105"]
    assert subprocess.run(command, capture_output=True).returncode == 3
    assert 0.1 < json.loads((cut / "status.json").read_text("utf-8"))["time"] < 0.2
    assert crashsolve(path, "-o", cut, "--restart").returncode == 0
    assert [name for name in differences(cut, whole) if not name.startswith("dump:")] == []


FLAT = """\
control: {end_time: 0.1, estimate: off}
output: {history: {interval: INTERVAL}}
bodies:
  box:
    mass: 50
    primitive: {shape: box, size: [0.5, 0.5, 0.5]}
    position: [1, 0, 0]
    velocity: [10, 0, 0]
surfaces:
  box: {type: box, body: box, size: [0.5, 0.5, 0.5]}
  wall: {type: plane, at: [1.5, 0, 0], normal: [-1, 0, 0]}
contacts:
  c: {a: [box], b: [wall], normal: {type: kelvin_voigt, stiffness: 3e7, restitution: 0.3}}
"""


@pytest.mark.parametrize("interval", ["0.01", "0.013", "0.1"])
def test_a_box_on_four_corners_is_damped_between_samples_as_in_the_run(
    tmp_path: Path, interval: str
) -> None:
    """Its mass is found as the contact begins: also at the steps that are run again."""
    deck = tmp_path / "deck.yaml"
    deck.write_text(FLAT.replace("INTERVAL", interval), "utf-8")
    assert main(["run", str(deck), "-o", str(tmp_path / "out")]) == 0
    result = Result(tmp_path / "out")
    peak = result.value("rcforc.c.peak_normal", "final")
    # a damper pushes by a predicted velocity in a step, by the present one in a sample
    assert result.value("rcforc.c.normal", "max") == pytest.approx(peak, rel=1e-6)
    depth, speed = result.series("rcforc.c.peak_depth"), result.series("rbdout.box.velocity.x")
    assert np.all(np.diff(depth.values) >= 0.0)
    assert speed.values.min() == speed.values[-1] == pytest.approx(-3.0, rel=1e-3)


def test_pauses_of_the_loop_put_off_no_onset(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The loop pauses by the clock on the wall, and a run has the same bits on any machine."""
    deck = tmp_path / "deck.yaml"
    deck.write_text(FLAT.replace("INTERVAL", "0.0013"), "utf-8")
    assert main(["run", str(deck), "-o", str(tmp_path / "rarely")]) == 0
    monkeypatch.setattr(engine, "FIRST_CALL", 1)
    monkeypatch.setattr(engine, "LONGEST_CALL", 0.0)
    assert main(["run", str(deck), "-o", str(tmp_path / "often")]) == 0
    rarely, often = Result(tmp_path / "rarely"), Result(tmp_path / "often")
    for name in ("rbdout.box.velocity.x", "rcforc.c.normal"):
        assert np.array_equal(rarely.series(name).values, often.series(name).values)
