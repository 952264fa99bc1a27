"""Claim: a contact that makes energy stops the run, whatever other energy the scene has."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from small_runs import last

from crashpost.results.result import Result

DECK = """
title: a ball meets a stiff floor in steps that are far too long
control: {{end_time: 0.5, step: 2.5e-3}}
bodies:
  a: {{primitive: {{shape: sphere, radius: 0.1}}, mass: 1, position: [0, 0, {top}]}}
  far: {{mass: 1000, inertia: [1, 1, 1], position: [50, 0, 0], velocity: [{speed}, 0, 0]}}
surfaces: {{a: {{type: sphere, body: a, radius: 0.1}}, f: {{type: plane, at: [0, 0, {floor}]}}}}
contacts: {{c: {{a: [a], b: [f], normal: {{type: hertz, stiffness: 1e9}}}}}}
loads: {{g: {{type: gravity}}}}
"""


@pytest.mark.parametrize(("height", "speed"), [(1e5, 0.0), (0.0, 1e4)])
def test_no_other_energy_hides_it(height: float, speed: float, tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    text = DECK.format(top=height + 0.4, floor=height, speed=speed)
    deck.write_text(text.replace("1e+", "1.0e+"), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 4
    assert "contact 'c': the normal force has created energy" in done.stdout + done.stderr


PULSE = """
title: a force rises and falls between two samples
control: {end_time: 1}
output: {history: {interval: 1.0e-2}}
bodies: {m: {mass: 1, inertia: [1, 1, 1]}}
curves: {p: {points: [[0, 0], [0.503, 0], [0.504, 1000], [0.505, 0], [2, 0]]}}
loads: {f: {type: force, body: m, force: [1, 0, 0], curve: p}}
"""


def test_the_work_of_a_pulse_is_the_energy_it_gives(tmp_path: Path) -> None:
    """The impulse of 1 N s gives 1 kg at rest 0.5 J."""
    deck = tmp_path / "deck.yaml"
    deck.write_text(PULSE, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout
    assert "external work          5.000000e-01 J" in done.stdout


CRUSH = """
title: two masses go on together after a crush at constant force
control: {{end_time: 0.5, safety: {safety}, estimate: "off"}}
curves: {{f: {{points: [[0, 0], [{ramp}, 1.0e+7], [10, 1.0e+7]]}}}}
bodies:
  a: {{mass: 340000, inertia: [1, 1, 1], position: [-1, 0, 0], velocity: [15, 0, 0]}}
  b: {{mass: 340000, inertia: [1, 1, 1], position: [1, 0, 0]}}
surfaces:
  a: {{type: point_set, body: a, points: [[0.99, 0, 0]]}}
  b: {{type: plane, body: b, at: [-1, 0, 0], normal: [-1, 0, 0]}}
contacts:
  c: {{a: [a], b: [b], normal: {{type: crush_curve, curve: f, unloading_stiffness: {k}}}}}
"""


@pytest.mark.parametrize(
    ("k", "safety", "ramp"), [(1e10, 0.3, 1e-3), (1e10, 0.5, 2e-3), (2e10, 0.5, 5e-4)]
)
def test_no_more_is_lost_than_there_was(
    k: float, safety: float, ramp: float, tmp_path: Path
) -> None:
    """M v^2 / 4 less F^2 / (2 k), which the ends give back, though one step passes the ramp."""
    deck = tmp_path / "deck.yaml"
    text = CRUSH.format(k=f"{k:.1e}", safety=safety, ramp=f"{ramp:.1e}")
    deck.write_text(text, "utf-8")
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    there = 340000 * 15**2 / 4
    # steps of the order of the unloading: the speed given back, 0.24 m/s, to a hundredth
    expected = pytest.approx(there - 1e14 / (2 * k), abs=0.02 * 1e14 / (2 * k))
    assert last(Result(tmp_path / "out"), "rcforc.c.dissipated") == expected


@pytest.mark.parametrize("method", ["dormand_prince_5", "radau_iia_5", "generalized_alpha"])
@pytest.mark.parametrize("interval", [0.05, 0.002])
def test_methods_that_choose_their_steps_meet_the_reversal_of_a_crush(
    interval: float, method: str, tmp_path: Path
) -> None:
    """The ends part with F / sqrt(k m / 2), after an unloading far shorter than the samples."""
    deck, k = tmp_path / "deck.yaml", 1e12
    text = CRUSH.format(k=f"{k:.1e}", safety=0.1, ramp="1.0e-3").replace(" safety: 0.1,", "")
    text = text.replace('estimate: "off"', f"estimate: off, integrator: {method}")
    deck.write_text(text + f"output: {{history: {{interval: {interval}}}}}\n", "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout
    result = Result(tmp_path / "out")
    speed = last(result, "rbdout.b.velocity.x") - last(result, "rbdout.a.velocity.x")
    # half a thousandth by the tolerance of a step
    assert speed == pytest.approx(1e7 / np.sqrt(k * 170000), rel=5e-4)


PADDED = """
control: {{end_time: 0.3, estimate: off, integrator: {method}}}
output: {{history: {{interval: {interval}}}}}
curves:
  y: {{points: [[0, 0], [1, 1.0e+5]]}}
  u: {{points: [[0, 0], [1, 2.0e+4]]}}
bodies: {{a: {{mass: 2, inertia: [1, 1, 1], position: [0, 0, 0.1], velocity: [0, 0, -2]}}}}
surfaces: {{a: {{type: sphere, body: a, radius: 0.1}}, f: {{type: plane}}}}
contacts:
  c: {{a: [a], b: [f], normal: {{type: padding, curve: y, unloading_curve: u,
       unloading_stiffness: 1.0e+9}}}}
"""


@pytest.mark.parametrize("method", ["dormand_prince_5", "radau_iia_5", "generalized_alpha"])
def test_methods_that_choose_their_steps_meet_the_branches_of_a_padding(
    method: str, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(PADDED.format(method=method, interval=0.05), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout
    # loading to d along y = K d, along a line of slope k to u = q K x, and along u to 0
    K, q, k = 1e5, 0.2, 1e9
    force = 2.0 * np.sqrt(2.0 * K)
    x = (force / K - force / k) * k / (k - q * K)
    returned = 0.5 * (force**2 / k - (q * K * x) ** 2 / k + q * K * x**2)
    speed = last(Result(tmp_path / "out"), "rbdout.a.velocity.z")
    assert speed == pytest.approx(np.sqrt(2.0 * returned / 2.0), rel=2e-4)
