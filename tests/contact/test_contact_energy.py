"""Claim: a contact that makes energy stops the run, whatever other energy the scene has."""

from pathlib import Path

import pytest
from command import crashsolve

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
    assert "contact 'c': the normal force has given its bodies" in done.stdout + done.stderr


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
