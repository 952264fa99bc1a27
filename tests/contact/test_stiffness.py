"""Stiffness from materials and radii, and contact cards that cannot be built."""

from math import inf, pi, sqrt
from pathlib import Path

import pytest
from touching import SPHERES, Contact

from crashsolve.foundation.errors import DeckErrors

STEEL = "young_{0}: 2.1e11, poisson_{0}: 0.3"
BOTH = f"{STEEL.format('a')}, {STEEL.format('b')}"


def stiffness(folder: Path, law: str, surfaces: str = SPHERES, sides: str = "") -> float:
    sides = sides or "a: [one], b: [other]"
    return float(Contact(folder, f"{{{law}}}", surfaces=surfaces, sides=sides).p.stiffness)


def test_two_steel_spheres_have_the_stiffness_of_the_benchmark(tmp_path: Path) -> None:
    spheres = SPHERES.replace("0.2", "0.01").replace("0.3", "0.01")
    computed = stiffness(tmp_path, f"type: hertz, {BOTH}", spheres)
    # half a unit of the last of eight digits quoted
    assert computed == pytest.approx(1.0878566e10, rel=5e-8)


@pytest.mark.parametrize("sides, published", (("a", 2.4246e7), ("ab", 1.2123e7)))
def test_the_beam_of_the_chapter_by_equation_19(
    tmp_path: Path, sides: str, published: float
) -> None:
    law = ", ".join(f"young_{side}: 1e8, poisson_{side}: 0.27" for side in sides)
    radius = sqrt(20 / 7850 / pi)
    computed = stiffness(tmp_path, f"type: hertz, {law}, radius: {radius}")
    # the figures use the printed 0.424, which stands for 4/(3 pi); five digits are quoted
    assert computed * 0.424 / (4 / (3 * pi)) == pytest.approx(published, rel=5e-5)


def test_radii_combine_and_a_flat_side_has_none(tmp_path: Path) -> None:
    flat = SPHERES + "  floor: {type: plane}\n"
    law = f"type: hertz, {BOTH}"
    spheres = stiffness(tmp_path, law)
    on_flat = stiffness(tmp_path, law, flat, "a: [one], b: [floor]")
    assert spheres / on_flat == pytest.approx(sqrt(0.12 / 0.2), rel=1e-12)


def test_surfaces_of_one_card_may_differ_in_radius(tmp_path: Path) -> None:
    more = SPHERES + "  floor: {type: plane}\n"
    sides = "a: [one, other], b: [floor]"
    pairs = Contact(tmp_path, f"{{type: hertz, {BOTH}}}", surfaces=more, sides=sides).pairs
    assert pairs.stiffness[0] / pairs.stiffness[1] == pytest.approx(sqrt(0.2 / 0.3), rel=1e-12)


FLOOR = "  floor: {type: plane}\n"
POINTS = SPHERES + "  tip: {type: point_set, body: a, points: [[0, 0, 0]]}\n"
REFUSED = {
    "normal: needs a stiffness: give stiffness, or young_a or young_b with their Poisson ratios": (
        "type: hertz",
        "a: [one], b: [other]",
    ),
    "normal.stiffness: stiffness is given twice: give stiffness, or young_a or young_b with their "
    "Poisson ratios": (f"type: hertz, stiffness: 1e9, {BOTH}", "a: [one], b: [other]"),
    "normal: the curvature of the surfaces where they touch is not known; "
    "give radius or stiffness": (
        f"type: hertz, {BOTH}",
        "a: [tip], b: [other]",
    ),
    "normal.exponent: materials give the stiffness of exponent 1.5 only": (
        f"type: hertz, {BOTH}, exponent: 2",
        "a: [one], b: [other]",
    ),
    "normal: young_a and poisson_a belong together": (
        "type: hertz, young_a: 1e9",
        "a: [one], b: [other]",
    ),
    "normal.density_b: needs young_b, for the speed of its waves": (
        "type: hertz, stiffness: 1e9, density_b: 7800",
        "a: [one], b: [other]",
    ),
    "normal: give one of: damping, restitution": (
        "type: kelvin_voigt, stiffness: 1e5",
        "a: [one], b: [other]",
    ),
    "normal.restitution: this law needs a restitution above 0: its damping grows without bound; "
    "give 0.01, or a crush_curve for an impact without rebound": (
        "type: flores, stiffness: 1e9, restitution: 0",
        "a: [one], b: [other]",
    ),
    "normal.restitution: must be at most 1, not 1.2": (
        "type: flores, stiffness: 1e9, restitution: 1.2",
        "a: [one], b: [other]",
    ),
    "normal.curve: curve 'from_one' must start at (0, 0)": (
        "type: crush_curve, curve: from_one, unloading_stiffness: 1e6",
        "a: [one], b: [other]",
    ),
    "normal.curve: curve 'pulls' must not be negative: contact cannot pull": (
        "type: crush_curve, curve: pulls, unloading_stiffness: 1e6",
        "a: [one], b: [other]",
    ),
    "normal.unloading_stiffness: curve 'stiff' rises by 100000 N/m, faster than it unloads; raise "
    "unloading_stiffness to that or more": (
        "type: crush_curve, curve: stiff, unloading_stiffness: 9e4",
        "a: [one], b: [other]",
    ),
    "normal.unloading_curve: curve 'stiff' must stay below that of loading, or the contact gives "
    "energy": (
        "type: padding, curve: soft, unloading_curve: stiff, unloading_stiffness: 2e5",
        "a: [one], b: [other]",
    ),
    "normal.unloading_curve: curve 'short' ends at 0.02 m, before that of loading at 1 m": (
        "type: padding, curve: stiff, unloading_curve: short, unloading_stiffness: 2e5",
        "a: [one], b: [other]",
    ),
    "b: all its surfaces are on the ground; give one of them a body": (
        "type: hertz, stiffness: 1e9",
        "a: [floor], b: [floor]",
    ),
    "b: all its surfaces are on one body; a body cannot touch itself": (
        "type: hertz, stiffness: 1e9",
        "a: [one], b: [tip]",
    ),
}


@pytest.mark.parametrize(("message", "law", "sides"), [(m, *c) for m, c in REFUSED.items()])
def test_a_contact_that_cannot_be_built_is_refused(
    tmp_path: Path, message: str, law: str, sides: str
) -> None:
    with pytest.raises(DeckErrors) as refused:
        Contact(tmp_path, f"{{{law}}}", surfaces=POINTS + FLOOR, sides=sides)
    assert f"contact 'hit': {message}" in str(refused.value)
    assert str(refused.value).count("error:") == 1


def test_all_parameters_are_finite_but_the_unknown_range(tmp_path: Path) -> None:
    contact = Contact(tmp_path, "{type: hertz, stiffness: 1e9}")
    assert contact.p.speed_limit == inf
