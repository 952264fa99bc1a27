"""Hinges that cannot be meant are refused, with the reason."""

import re
from pathlib import Path

import pytest
from bench import Bench

from crashsolve.foundation.errors import DeckErrors

HEAD = """
materials:
  steel: {type: elastoplastic, young: 2.1e11, poisson: 0.3, density: 7850, yield_stress: 3e8}
  elastic: {type: elastic, young: 2.1e11, poisson: 0.3, density: 7850}
sections:
  tube: {type: rectangular_tube, width: 0.06, height: 0.06, thickness: 0.002}
  thin: {type: rectangular_tube, width: 0.06, height: 0.06, thickness: 0.0004}
  bar: {type: circle, radius: 0.01}
  flat: {type: rectangular_tube, width: 0.06, height: 0.03, thickness: 0.002}
curves:
  good: {points: [[0, 0], [0.01, 10], [0.1, 10]]}
  lifted: {points: [[0, 5], [0.1, 10]]}
  late: {points: [[0.001, 0], [0.1, 10], [0.2, 10]]}
  straight: {points: [[0, 0], [0.1, 10]]}
  below: {points: [[0, 0], [0.1, 10], [0.2, -1]]}
  down: {points: [[0, 0], [0.1, -10], [0.2, -10]]}
  falling: {points: [[0, 0], [0.01, 10], [0.1, 5]]}
  falling_on: {points: [[0, 0], [0.01, 10], [0.1, 5]], extrapolate: linear}
  stiffening: {points: [[0, 0], [0.01, 10], [0.02, 11], [0.03, 31]]}
  again: {points: [[0, 0], [0.01, 10], [0.02, 11], [0.03, 21]]}
  steep: {points: [[0, 3000], [0.001, 10], [1, 10]]}
  gone: {points: [[0, 0], [0.01, 10], [0.1, 0], [0.2, 0]]}
hinges:
"""
AT = "b: b, at: [0, 0, 0], axis: [0, 0, 1]"
BENDING = f"type: bending, {AT}"
BIAXIAL = f"type: biaxial, {AT}, side: [1, 0, 0]"
BOTH = f"type: axial_bending, {AT}, beam: [1, 0, 0], axial_curve: good"
TUBE = "section: tube, material: steel, length: 0.2"
WRONG = {
    "must begin at [0, 0], not at [0, 5]": f"{BENDING}, curve: lifted",
    "must begin at [0, 0], not at [0.001, 0]": f"{BENDING}, curve: late",
    "never yields": f"{BENDING}, curve: straight",
    "must not fall below 0, as it does at 0.2": f"{BENDING}, curve: below",
    "must rise from 0": f"{BENDING}, curve: down",
    "would continue below 0; set extrapolate: hold": f"{BENDING}, curve: falling_on",
    "more steeply than the elastic stiffness 1000": f"{BENDING}, curve: stiffening",
    "more steeply than the elastic stiffness 900": f"{BENDING}, curve: good, stiffness: 900",
    "rises with the elastic stiffness 1000 again": f"{BENDING}, curve: again",
    "and kinematic hardening has no softening": f"{BENDING}, curve: falling, cyclic: kinematic",
    "yields from 0 on": f"{BENDING}, curve: good, stiffness: 2000, cyclic: kinematic",
    "would begin beyond yield": f"{BENDING}, curve: good, initial_angle: 0.02",
    "leads to -50": f"{BIAXIAL}, curve: good, initial_angles: [0, 0.05]",
    "lead to 1.273 times its ellipse": f"{BIAXIAL}, curve: good, initial_angles: [0.009, 0.009]",
    "lead to 1.131 times its ellipse": f"{BOTH}, curve: good, initial_angle: 8e-3,"
    " initial_stroke: -8e-3",
    "would have failed at the start": f"{BIAXIAL}, curve: good, initial_angles: [4e-3, 4e-3],"
    " failure_angle: 5e-3",
    "an axial hinge has no arm": f"type: axial, {AT}, curve: good, rate: {{arm: 2}}",
    "model given and plastic_curve belong together": f"{BENDING}, curve: {{{TUBE}, model: given}}",
    "must begin with the moment of first yield": (
        f"{BENDING}, curve: {{{TUBE}, model: given, plastic_curve: good}}"
    ),
    "more steeply than the elastic stiffness 2.732e+05": (
        f"{BENDING}, curve: {{{TUBE}, model: given, plastic_curve: steep}}"
    ),
    "unknown curve 'nothing'": f"{BENDING}, curve: nothing",
    "joins 'b' with itself": f"{BENDING}, curve: good, a: b",
    "failure_angle: must be greater than 0": f"{BENDING}, curve: good, failure_angle: -1",
    "must be at right angles to axis": f"type: biaxial, {AT}, side: [1, 0, 1], curve: good",
    "an ellipse hardens and softens as a whole": f"{BIAXIAL}, curve: good, cyclic: kinematic",
    "an ellipse needs": f"{BIAXIAL}, curve: gone",
    "needs second_curve": f"{BIAXIAL}, curve: good, second_stiffness: 2000",
    "an ellipse is the same in both directions": f"{BOTH}, curve: good, curve_negative: good",
    "needs the arm": f"{BOTH}, curve: good, rate: {{}}",
    "belong together": f"{BENDING}, curve: good, rate: {{reference_rate: 40}}",
    "give coefficient and exponent, or": (
        f"{BENDING}, curve: good, rate: {{reference_rate: 40, reference_exponent: 5, exponent: 1}}"
    ),
    "give the name of a curve, or section": f"{BENDING}, curve: {{}}",
    "needs material and length beside it": f"{BENDING}, curve: {{section: tube}}",
    "a curve of the deck needs nothing beside it": (f"{BENDING}, curve: {{name: good, length: 1}}"),
    "has no yield stress": (f"{BENDING}, curve: {{section: tube, material: elastic, length: 0.2}}"),
    "that of a rectangular_tube": (
        f"{BENDING}, curve: {{section: bar, material: steel, length: 0.2, model: kecman}}"
    ),
    "the tests behind this model": (
        f"{BENDING}, curve: {{section: thin, material: steel, length: 0.2, model: kecman}}"
    ),
    "beyond 0.89": f"{BENDING}, curve: {{{TUBE}, model: kecman, until: 1}}",
    "before it yields": f"{BENDING}, curve: {{{TUBE}, until: 1e-4}}",
    "is that of square tubes": (
        f"type: axial, {AT}, curve: {{section: flat, material: steel, length: 0.2, model: crush}}"
    ),
}


@pytest.mark.parametrize("message", list(WRONG))
def test_a_wrong_hinge_is_refused(tmp_path: Path, message: str) -> None:
    with pytest.raises(DeckErrors, match=re.escape(message)):
        Bench(tmp_path, f"{HEAD}  h: {{{WRONG[message]}}}\n")


def test_a_hinge_and_a_joint_have_different_names(tmp_path: Path) -> None:
    joints = "joints:\n  h: {type: spherical, b: b, at: [0, 0, 0]}\n"
    with pytest.raises(DeckErrors, match="a joint has that name"):
        Bench(tmp_path, f"{HEAD}  h: {{{BENDING}, curve: good}}\n{joints}")
