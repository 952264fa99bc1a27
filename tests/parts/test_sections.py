"""Sections of beams against integrals, tables and each other."""

from math import pi

import numpy as np
import pytest

from crashsolve.deck.card import law_class
from crashsolve.deck.laws import types_in

NU = 0.3
SECTIONS = {
    "circle": {"radius": 0.3},
    "tube": {"radius": 0.3, "thickness": 0.1},
    "rectangle": {"width": 0.2, "height": 0.5},
    "rectangular_tube": {"width": 0.2, "height": 0.5, "thickness": 0.001},
    "i_section": {"width": 0.2, "height": 0.4, "flange": 0.01, "web": 0.008},
    "fibres": {
        "fibres": [[1, 1, 2], [-1, 1, 2], [1, -1, 2], [-1, -1, 2]],
        "torsion": 5,
        "shear_y": 0.6,
        "shear_z": 0.7,
    },
    "general": {"area": 2, "I_y": 3, "I_z": 4, "torsion": 5, "shear_y": 0.6, "shear_z": 0.7},
}


def section(word: str, poisson: float = NU, **fields: object) -> dict:
    kind = law_class("sections", word)
    return __import__(kind.__module__, fromlist=["build"]).build(kind(**fields), poisson)


def test_every_section_is_under_this_contract() -> None:
    assert set(types_in("sections")) == set(SECTIONS)


@pytest.mark.parametrize("word", list(SECTIONS))
def test_a_section_is_complete(word: str) -> None:
    constants = section(word, **SECTIONS[word])
    assert set(constants) == {"area", "second", "torsion", "shear"}
    assert (
        min(constants["area"], constants["torsion"], *constants["second"], *constants["shear"])
        > 0.0
    )
    # a shape with its own shear coefficient bears no more than its area
    assert max(constants["shear"]) < 1.0


def integrals(inside, size: float, n: int = 2000) -> tuple[float, float, float]:
    """Area and second moments of a shape by midpoints of squares."""
    x = (np.arange(n) + 0.5) / n * 2.0 * size - size
    y, z = np.meshgrid(x, x)
    hit, cell = inside(y, z), (2.0 * size / n) ** 2
    return cell * hit.sum(), cell * (z**2 * hit).sum(), cell * (y**2 * hit).sum()


SHAPES = {
    "circle": lambda y, z: np.hypot(y, z) < 0.3,
    "tube": lambda y, z: (np.hypot(y, z) < 0.3) & (np.hypot(y, z) > 0.2),
    "rectangle": lambda y, z: (abs(y) < 0.1) & (abs(z) < 0.25),
}


@pytest.mark.parametrize("word", list(SHAPES))
def test_area_and_second_moments_are_the_integrals(word: str) -> None:
    constants = section(word, **SECTIONS[word])
    area, I_y, I_z = integrals(SHAPES[word], 0.31)
    # edges lie within a square of 3e-4 m: up to 3e-4 / 0.1 for a side, thrice that for its cube
    np.testing.assert_allclose(
        [constants["area"], *constants["second"]], [area, I_y, I_z], rtol=1e-2
    )


def test_the_thin_box_is_the_difference_of_two_rectangles() -> None:
    thin = section("rectangular_tube", **SECTIONS["rectangular_tube"])
    outer = section("rectangle", width=0.2, height=0.5)
    inner = section("rectangle", width=0.198, height=0.498)
    for name in ("area", "second"):
        difference = np.subtract(outer[name], inner[name])
        # a thin wall: (t / a)^2 = 2.5e-5
        np.testing.assert_allclose(thin[name], difference, rtol=3e-5)


@pytest.mark.parametrize(("ratio", "factor"), [(1.0, 0.1406), (2.0, 0.229), (10.0, 0.312)])
def test_torsion_of_a_rectangle_is_that_of_the_table(ratio: float, factor: float) -> None:
    """Timoshenko and Goodier (1970), Theory of Elasticity, 109: k_1, as rounded there."""
    torsion = section("rectangle", width=0.1, height=0.1 * ratio)["torsion"]
    assert torsion / (0.1**4 * ratio) == pytest.approx(factor, abs=6e-4)


def test_torsion_of_a_round_section_is_polar() -> None:
    assert section("circle", radius=0.3)["torsion"] == pytest.approx(pi * 0.3**4 / 2.0, rel=1e-14)


def test_a_tube_is_a_circle_with_a_hole() -> None:
    solid = section("circle", radius=0.3)["shear"][0]
    assert section("tube", radius=0.3, thickness=0.3 - 1e-9)["shear"][0] == pytest.approx(solid)
    # Cowper (1966), thin-walled round tube; the next term is (t / R)^2
    thin = section("tube", radius=0.3, thickness=1e-5)["shear"][0]
    assert thin == pytest.approx(2.0 * (1.0 + NU) / (4.0 + 3.0 * NU), rel=1e-7)


def test_webs_alone_bear_shear_as_a_rectangle() -> None:
    """Five sixths, Cowper's rectangle at nu = 0, as the flanges vanish."""
    tall = section("rectangular_tube", width=0.0101, height=20.0, thickness=1e-4)
    # flanges are 5e-4 of the webs
    assert tall["shear"][1] == pytest.approx(5.0 / 6.0, rel=3e-3)


def test_a_web_without_flanges_is_a_thin_rectangle() -> None:
    web = section("i_section", width=0.0401, height=0.4, flange=1e-9, web=0.008)
    flat = section("rectangle", width=0.008, height=0.4)
    assert web["second"][0] == pytest.approx(flat["second"][0], rel=1e-6)
    # of the thin rectangle: 5/6 without the 1 % that its Poisson's ratio takes in Cowper's formula
    assert web["shear"][1] == pytest.approx(5 / 6, rel=1e-6)
    # the thin formula of torsion errs by 0.63 t / h
    assert web["torsion"] == pytest.approx(flat["torsion"], rel=0.7 * 0.008 / 0.4)


def test_the_shear_flow_of_an_i_is_that_of_its_integral() -> None:
    b, H, t_f, t_w = 0.2, 0.39, 0.01, 0.008
    constants = section("i_section", **SECTIONS["i_section"])
    inertia = t_w * H**3 / 12 + 2 * b * t_f * (H / 2) ** 2
    s = (np.arange(4000) + 0.5) / 4000
    flange = t_f * s * (b / 2) * (H / 2) / inertia
    z = H * (s - 0.5)
    web = (b * t_f * H / 2 + t_w * (H**2 / 4 - z**2) / 2) / inertia
    flow = 4 * (flange**2).mean() * (b / 2) / t_f + (web**2).mean() * H / t_w
    # midpoints: (1/4000)^2
    assert 1 / (constants["shear"][1] * constants["area"]) == pytest.approx(flow, rel=1e-6)
    # equilibrium: the flow of the web is the whole force
    assert web.mean() * H == pytest.approx(1.0, rel=1e-6)


def test_mass_elsewhere_than_stiffness_has_second_moments_of_its_own() -> None:
    numbers = SECTIONS["general"]
    assert "rotary" not in section("general", **numbers)
    assert section("general", **numbers, rotary_z=9)["rotary"] == (3, 9)


@pytest.mark.parametrize("word", ["circle", "rectangle", "i_section"])
def test_the_outline_of_a_solid_section_has_its_second_moments(word: str) -> None:
    """Of the polygon (Green's theorem); sixteen corners of a circle have 5 % less."""
    fields = SECTIONS[word] | ({"flange": 0.07, "web": 0.04} if word == "i_section" else {})
    kind = law_class("sections", word)
    law = __import__(kind.__module__, fromlist=["outline"])
    y, z = law.outline(kind(**fields)).T
    y2, z2 = np.roll(y, -1), np.roll(z, -1)
    cross = y * z2 - y2 * z
    area = abs(cross.sum()) / 2.0
    I_y = abs((cross * (z * z + z * z2 + z2 * z2)).sum()) / 12.0
    constants = law.build(kind(**fields), NU)
    share = 0.06 if word == "circle" else 1e-12
    assert area == pytest.approx(constants["area"], rel=share)
    assert I_y == pytest.approx(constants["second"][0], rel=share)
