"""Claim: every material answers to strain in three dimensions as its contract says.

Energy in balance and nothing won, the same in turned axes, plane stress by condensation that of a
layer, and closed forms under tension and shear.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import solid_driver
from one_layer import Layers
from one_point import E, Point, layer_and_point
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from test_material_contract import EXAMPLES, YIELD

from crashsolve.compiler.machine import machine_code
from crashsolve.compiler.table import Tables

NU = 0.3
G = E / (2.0 + 2.0 * NU)
PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


def path(seed: int, size: float, count: int) -> np.ndarray:
    """Strains of steps (count, 6) that turn and come back."""
    random = np.random.default_rng(seed)
    d = size * random.normal(size=(count, 6))
    return np.concatenate([d, -0.7 * d[::-1]])


def size_of(name: str) -> float:
    return 5e-2 if EXAMPLES[name]["type"] == "neo_hookean" else 8e-4


@pytest.mark.parametrize("name", EXAMPLES)
def test_energy_is_in_balance_and_none_is_created(name: str, tmp_path: Path) -> None:
    point, work, lost, before = Point(tmp_path, EXAMPLES[name]), 0.0, 0.0, np.zeros(6)
    large = EXAMPLES[name]["type"] == "neo_hookean"
    size, parts = size_of(name), 100 if large else 1
    volume = 0.0
    for d in np.repeat(path(1, size, 6), parts, axis=0) / parts:
        stress = point.step(d, 1e-2)
        # energies are those of the present volume, which strains change
        now = volume + float(d[:3].sum())
        grown = np.exp(0.5 * (volume + now)) if large else 1.0
        work += grown * float(0.5 * (before + stress) @ d)
        assert point.lost >= -1e-15
        lost += point.lost
        before, volume = stress, now
    stored = point.energy * (np.exp(volume) if large else 1.0)
    # exact where stress is linear within a step; of rubber the first order of steps of 5e-4, whose
    # axes at the start are not those at the end where strains turn
    assert work == pytest.approx(stored + lost, rel=1e-3 if large else 1e-12)
    assert (lost > 0.0) == (EXAMPLES[name]["type"] in ("elastoplastic", "johnson_cook"))


@pytest.mark.parametrize("name", EXAMPLES)
def test_axes_may_be_turned(name: str, tmp_path: Path) -> None:
    R = Rotation.random(random_state=3).as_matrix()

    def turned(values: np.ndarray, shear: np.ndarray) -> np.ndarray:
        tensor = np.zeros((3, 3))
        for value, factor, (i, j) in zip(values, shear, PLACES, strict=True):
            tensor[i, j] = tensor[j, i] = value / factor
        tensor = R @ tensor @ R.T
        return np.array([tensor[slot] for slot in PLACES]) * shear

    one, other = Point(tmp_path, EXAMPLES[name]), Point(tmp_path, EXAMPLES[name])
    for d in path(2, size_of(name), 4):
        stress = one.step(d, 1e-2)
        assert other.step(turned(d, TWICE), 1e-2) == pytest.approx(
            turned(stress, np.ones(6)), abs=1e-11 * E * size_of(name)
        )


@pytest.mark.parametrize("name", EXAMPLES)
def test_plane_stress_by_condensation_is_that_of_a_layer(name: str, tmp_path: Path) -> None:
    # ends of both iterations: 1e-13 E, and those of the layers, 1e-14 of the yield stress
    assert layer_and_point(tmp_path, EXAMPLES[name], size_of(name), 1e-2) < 1e-9 * 200.0 / E


@pytest.mark.parametrize("name", YIELD)
def test_tension_and_shear_follow_the_yield_curve(name: str, tmp_path: Path) -> None:
    pulled, sheared = Point(tmp_path, EXAMPLES[name]), Point(tmp_path, EXAMPLES[name])
    for k in range(1, 9):
        sigma = pulled.free(np.array([1e-3, 0, 0, 0, 0, 0]), (1, 2))[0]
        e = 1e-3 * k - sigma / E
        assert sigma == pytest.approx(E * 1e-3 if k == 1 else YIELD[name](e), rel=1e-9)
        tau = sheared.step(np.array([0, 0, 0, 2e-3, 0, 0]))[3]
        # e = gamma_p / sqrt(3), tau = Y(e) / sqrt(3)
        e = (2e-3 * k - tau / G) / np.sqrt(3.0)
        assert tau == pytest.approx(YIELD[name](e) / np.sqrt(3.0), rel=1e-9)


def test_elastic_stress_is_hookes(tmp_path: Path) -> None:
    d = 1e-3 * np.array([1.0, -0.3, 0.6, 0.4, -0.7, 0.2])
    stress = Point(tmp_path, EXAMPLES["elastic"]).step(d)
    lame = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
    exact = np.append(lame * d[:3].sum() + 2.0 * G * d[:3], G * d[3:])
    assert stress == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize("kind", ["uniaxial", "pure shear"])
def test_rubber_follows_its_energy(kind: str, tmp_path: Path) -> None:
    """sigma_i = (G (lambda_i^2 - 1) + L ln J) / J, from many small steps."""
    point, L, n = Point(tmp_path, EXAMPLES["rubber"]), E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), 200
    sides = {"uniaxial": (1, 2), "pure shear": (2,)}[kind]
    stress = np.zeros(6)
    for _ in range(n):
        d = np.array([0.5 / n, 0.0, 0.0, 0.0, 0.0, 0.0])
        if kind == "pure shear":
            d[1] = -0.5 / n
        stress = point.free(d, sides)
    stretch = np.exp(0.5)
    other = np.exp(-0.5) ** 2

    def gap(b: float) -> Any:
        """Stress across a side that is free, by the square of its stretch."""
        J = stretch * (b if kind == "uniaxial" else np.sqrt(b * other))
        return G * (b - 1.0) + L * np.log(J)

    b = brentq(gap, 1e-3, 4.0, xtol=1e-15)
    J = stretch * (b if kind == "uniaxial" else np.sqrt(b * other))
    exact = (G * (stretch**2 - 1.0) + L * np.log(J)) / J
    # exp(2 d) to third order: 0.5 n (2 / n)^3 / 24 of the metric
    assert stress[0] == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("name", ["elastic", "mixed", "hot", "rubber"])
def test_compiled_points_are_those_of_plain_python(name: str, tmp_path: Path) -> None:
    layers, d = Layers(tmp_path, EXAMPLES[name]), path(4, size_of(name), 5)
    parts = layers.model.element_groups()[0].parameters

    def arrays() -> dict[str, np.ndarray]:
        steps = np.zeros(len(d), solid_driver.STEP.dtype)
        steps["d"] = d
        points = np.zeros(len(d) + 1, layers.law.SOLID.dtype)
        return {"parts": parts, "curves": layers.model.curves, "steps": steps, "points": points}

    compiled, plain = arrays(), arrays()
    drive = f"drive_{EXAMPLES[name]['type']}"
    tables = Tables(compiled)
    machine_code(Path(solid_driver.__file__), drive, tables)(1e-2, False, tables)
    getattr(solid_driver, drive)(1e-2, False, Tables(plain))
    for table in ("steps", "points"):
        for column in plain[table].dtype.names or ():
            one, other = compiled[table][column], plain[table][column]
            # functions of numbers are another library's, and sums may be contracted
            np.testing.assert_allclose(one, other, rtol=1e-10, atol=1e-12 * np.abs(other).max())
    assert np.abs(compiled["points"]["stress"]).max() > 1.0
