"""Claim: no quasi-static run passes a limit point from one equilibrium to another beyond it."""

import re
from pathlib import Path

import pytest
from command import crashsolve
from quick import first_quick

from crashpost.results.result import Result

# Williams (1964), Quarterly Journal of Mechanics and Applied Mathematics 17, 451-469: his toggle,
# in pounds and inches; it bears 33.8 lbf by shallow beams
TOGGLE = """
title: Williams' toggle
control: {end_time: 1, solution: quasi_static, steps: STEPS, estimate: off}
parameters: {h: 0.386, L: 12.943}
materials: {m: {type: elastic, young: 1.03e7, poisson: 0.3, density: 1}}
sections:
  s: {type: general, area: 0.18301, I_y: 9.0e-4, I_z: 9.0e-4, torsion: 1e-3, shear_y: 1000,
      shear_z: 1000}
curves: {rise: {points: [[0, 0], [1, 1]]}}
parts:
  left: {type: beam, section: s, material: m,
         mesh: {shape: line, from: [0, 0, 0], to: ["${L}", 0, "${h}"], elements: 4}}
  right: {type: beam, section: s, material: m,
          mesh: {shape: line, from: ["${L}", 0, "${h}"], to: ["${2*L}", 0, 0], elements: 4}}
joints:
  a: {type: weld, b: left_start, at: [0, 0, 0]}
  b: {type: weld, b: right_end, at: ["${2*L}", 0, 0]}
  c: {type: weld, a: left_end, b: right_start, at: ["${L}", 0, "${h}"]}
  plane: {type: planar, b: left_end, at: ["${L}", 0, "${h}"], axis: [0, 1, 0]}
loads: {p: {type: force, body: left_end, force: [0, 0, -LOAD], curve: rise}}
"""
LIMIT = 33.8


def ended(folder: Path, load: float, steps: int) -> tuple[int, str]:
    deck = folder / "toggle.yaml"
    deck.write_text(TOGGLE.replace("LOAD", f"{load}").replace("STEPS", f"{steps}"), "utf-8")
    done = crashsolve(deck, "-o", folder / "out")
    return done.returncode, done.stderr


@pytest.mark.parametrize(
    ("load", "steps"), first_quick([(60.0, 2), (60.0, 4), (60.0, 20), (200.0, 10)])
)
def test_it_stops_at_the_limit_load(tmp_path: Path, load: float, steps: int) -> None:
    code, message = ended(tmp_path, load, steps)
    assert code == 4
    reached = load * float(re.findall(r"t = (\S+) s, cycle", message)[-1])
    # from below, by no more than a load step halved seven times and another; of the closed form
    # four elements differ by a percent
    assert 0.97 * LIMIT - load / steps / 64 < reached < 1.02 * LIMIT
    assert "a limit point between" in message
    assert "control.path: arc_length, prescribe the motion by a driver" in message


def test_below_it_the_run_ends_normally(tmp_path: Path) -> None:
    assert ended(tmp_path, 32.0, 4)[0] == 0


def test_long_steps_that_miss_little_each_and_much_together_are_divided(tmp_path: Path) -> None:
    # the path beyond the limit point is curved: a quarter of it misses 1 to 4 % of the energy
    pushed = TOGGLE.replace(
        "{rise: {points: [[0, 0], [1, 1]]}}", "{rise: {points: [[0, 0], [1, -0.8]]}}"
    )
    load = "loads: {p: {type: force, body: left_end, force: [0, 0, -LOAD], curve: rise}}"
    driver = "  push: {type: point_driver, body: left_end, axis: [0, 0, 1], curve: rise}"
    watch = "watch: [{channel: jntforc.push.force.z, statistic: final}]"
    text = pushed.replace(load, f"{driver}\n{watch}")
    forces = []
    for steps in (4, 40):
        deck = tmp_path / f"pushed_{steps}.yaml"
        deck.write_text(text.replace("STEPS", f"{steps}"), "utf-8")
        done = crashsolve(deck, "-o", tmp_path / f"out_{steps}")
        assert done.returncode == 0, done.stderr
        force = Result(tmp_path / f"out_{steps}").value("jntforc.push.force.z", "final")
        forces.append(force)
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)
