"""Springs that cannot be meant are refused, with the reason."""

from pathlib import Path

import pytest
from bench import Bench

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build

CURVES = """
curves:
  force: {points: [[-1, -100], [0, 0], [1, 100]]}
  dips: {points: [[-1, -100], [0, 0], [0.5, 50], [1, -10]]}
  above: {points: [[-1, -200], [0, 0], [1, 200]]}
  lifted: {points: [[0, 10], [1, 50]]}
  late: {points: [[0.1, 10], [1, 50]]}
  pulls: {points: [[0, 0], [0.5, 50], [1, -10]]}
  low: {points: [[-1, -10], [0, 0], [1, 10]]}
springs:
"""
WRONG = {
    "unloading_stiffness: must exceed every slope of the curves; the largest is 100": (
        "curve: force, unloading_stiffness: 50"
    ),
    "curve: must not change sign where it is used with unloading": (
        "curve: dips, unloading_stiffness: 1000"
    ),
    "unloading_curve: must start at 0 and stay between 0 and the curve": (
        "curve: force, unloading_curve: above, unloading_stiffness: 1000"
    ),
    "unloading_curve: needs unloading_stiffness, the slope down to it": (
        "curve: force, unloading_curve: low"
    ),
    "give one of: rate_curve, cowper_symonds, power_law": (
        "curve: force, rate_curve: low, power_law: {}"
    ),
}


@pytest.mark.parametrize("message", list(WRONG))
def test_wrong_curve_spring_is_refused(tmp_path: Path, message: str) -> None:
    with pytest.raises(DeckErrors, match=message.replace("(", r"\(")):
        Bench(tmp_path, f"{CURVES}  s: {{type: curve, b: b, {WRONG[message]}}}\n")


def test_lower_curve_that_starts_above_zero_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors, match="must start at 0 and stay between"):
        Bench(
            tmp_path,
            f"{CURVES}  s: {{type: curve, b: b, curve: force, acts: tension,"
            " unloading_curve: lifted, unloading_stiffness: 1000}\n",
        )


def test_a_curve_is_judged_only_where_it_acts(tmp_path: Path) -> None:
    spring = "{type: curve, b: b, curve: dips, acts: compression, unloading_stiffness: 1000}"
    Bench(tmp_path, f"{CURVES}  s: {spring}\n")


STRUTS = {
    "needs one of stiffness and curve": "damping_curve: force",
    "damping_curve: drives at .* m/s": "stiffness: 1, damping_curve: dips",
    "damping_curve: must reach from bump": "stiffness: 1, damping_curve: late",
    "damping_curve: takes the place of bump_damping": (
        "stiffness: 1, damping_curve: force, bump_damping: 1"
    ),
    "bump_length: is missing": "stiffness: 1, bump_stiffness: 5",
    "needs one of rebound_stiffness and rebound_curve": "stiffness: 1, rebound_length: 2",
    r"bump_curve: must begin at \(0, 0\)": "stiffness: 1, bump_length: 1, bump_curve: lifted",
    "bump_curve: must not fall below 0": "stiffness: 1, bump_length: 1, bump_curve: pulls",
    "bump_length: must not exceed": (
        "stiffness: 1, bump_length: 3, bump_stiffness: 5, rebound_length: 2, rebound_stiffness: 5"
    ),
}


@pytest.mark.parametrize("message", list(STRUTS))
def test_a_strut_that_cannot_be_meant_is_refused(tmp_path: Path, message: str) -> None:
    with pytest.raises(DeckErrors, match=message):
        Bench(tmp_path, f"{CURVES}  s: {{type: strut, b: b, {STRUTS[message]}}}\n")


def test_tangent_not_below_the_stiffness_is_refused(tmp_path: Path) -> None:
    spring = "{type: elastoplastic, b: b, stiffness: 10, yield_force: 1, tangent: 10}"
    with pytest.raises(DeckErrors, match="must be below stiffness, 10 N/m"):
        Bench(tmp_path, f"springs:\n  s: {spring}\n")


@pytest.mark.parametrize("law", ["torsional, stiffness: 1", "curve_torsional, curve: force"])
def test_axis_without_length_is_refused(tmp_path: Path, law: str) -> None:
    with pytest.raises(DeckErrors, match="a direction needs a length"):
        Bench(tmp_path, f"{CURVES}  s: {{type: {law}, b: b, axis: [0, 0, 0]}}\n")


def test_a_segment_whose_ends_begin_apart_is_refused(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(
        "control: {end_time: 1}\n"
        "materials: {m: {type: elastic, young: 1e9, poisson: 0.3, density: 1000}}\n"
        "sections: {bar: {type: circle, radius: 0.02}}\n"
        "bodies: {one: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [0.6, 0, 0]}}\n"
        "springs: {s: {type: segment, b: one, at_b: [-0.5, 0, 0], axis: [1, 0, 0], "
        "side: [0, 1, 0], length: 1, section: bar, material: m}}\n",
        "utf-8",
    )
    with pytest.raises(DeckErrors, match=r"at_b: is 0\.1 m from at_a at the start"):
        build(read_deck(deck))
