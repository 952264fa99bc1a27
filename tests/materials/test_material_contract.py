"""Claim: every material of the folder answers to strain as its contract says, in layers and fibres.

Tangents against differences of the stress, energy in balance, nothing won, the same in turned axes,
a layer under uniaxial stress like a fibre, and both like the law's own formula.
"""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from one_layer import LANES, Example, Fibre, Layers, checks, tangent_error, walk
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from crashsolve.deck.laws import types_in

STEEL: Example = {"young": 2e5, "poisson": 0.3, "density": 8.0}
VON_MISES = STEEL | {"type": "elastoplastic", "yield_stress": 200.0}
COOK = STEEL | {"type": "johnson_cook", "yield_stress": 200.0, "hardening": 500.0, "exponent": 0.3}
CURVE = [[0.0, 200.0], [0.001, 230.0], [0.01, 260.0], [1.0, 300.0]]
EXAMPLES: dict[str, Example] = {
    "elastic": STEEL | {"type": "elastic"},
    "perfect": VON_MISES,
    "isotropic": VON_MISES | {"hardening": 2e3},
    "kinematic": VON_MISES | {"hardening": 2e3, "kinematic": 1.0},
    "mixed": VON_MISES | {"hardening": 2e3, "kinematic": 0.4},
    "curve": STEEL | {"type": "elastoplastic", "curve": CURVE},
    "rate": VON_MISES | {"hardening": 2e3, "rate_D": 40.0},
    "power": COOK,
    "power and rate": COOK | {"rate": 0.02, "reference_rate": 1e-3},
    "hot": COOK | {"rate": 0.02, "reference_rate": 1e-3, "melting_heat": 6.0, "softening": 1.03},
    "rubber": STEEL | {"type": "neo_hookean"},
}


def test_every_material_has_an_example() -> None:
    missing = set(types_in("materials")) - {example["type"] for example in EXAMPLES.values()}
    assert not missing, f"add an example of {missing} to EXAMPLES"


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_material_keeps_its_contract(name: str, tmp_path: Path) -> None:
    errors_of = checks(EXAMPLES[name], tmp_path)
    large = EXAMPLES[name]["type"] == "neo_hookean"
    # differences of 1e-6 of the strain: round-off of 1e-16 over 1e-6, and the next order
    assert errors_of["tangent"] < 1e-8
    # exact where stress is linear between the ends of a step; of rubber the square of steps of 1e-3
    assert errors_of["balance"] < (1e-5 if large else 1e-13)
    assert errors_of["least lost"] >= -1e-15
    assert errors_of["rotated"] < 1e-14
    if not large:
        assert errors_of["fibre stress"] < 1e-14
        assert errors_of["fibre by strain"] < 1e-8
        assert errors_of["fibre by rate"] < 1e-8
        assert errors_of["fibre balance"] < 1e-13
        # Newton's method across the layer ends at 1e-12 E; a return at 1e-14 of its yield stress
        assert errors_of["layer and fibre"] < 1e-8


@pytest.mark.parametrize("side", [1e-3, -1e-3])
def test_tangents_hold_on_both_sides_of_the_corner_of_a_logarithm_of_the_rate(
    side: float, tmp_path: Path
) -> None:
    """Johnson and Cook: the rate has a factor above rate_0 alone, here that of the flow found."""
    d = 3.0 * walk(Layers(tmp_path, EXAMPLES["hot"]), 1e-3, 3, 1, 1.0)
    for lane in range(0, LANES, 5):
        layers = Layers(tmp_path, EXAMPLES["hot"])
        one = np.tile(d[lane], (LANES, 1))
        # so slow that the rate does not count: what flows then does so at rate_0 in a step of
        strains: list[float] = []
        for h in (1e30, 0.0):
            kept = layers.blocks.copy()
            h = h or strains[0] / 1e-3 / (1.0 + side)
            error = tangent_error(layers, one, h, 1e-9)
            layers.step(one, h)
            strains.append(layers.plastic_strain())
            layers.blocks[:] = kept
        assert (strains[1] / h > 1e-3) == (side > 0.0)
        assert error < 1e-6
    fibre = Fibre(tmp_path, EXAMPLES["hot"])
    fibre.step(3e-3, 0.0, 1e30)
    h = fibre.new.hardening[0] / 1e-3 / (1.0 + side)
    _, slope, faster = fibre.tangent(3e-3, 0.0, h)
    ends = [fibre.step(3e-3 + size, 0.0, h)[0] for size in (1e-9, -1e-9)]
    assert slope == pytest.approx((ends[0] - ends[1]) / 2e-9, abs=1e-6 * 2e5)
    assert (fibre.new.rate[0] > 1e-3) == (side > 0.0)
    assert faster == 0.0


@pytest.mark.parametrize("rate", [1e-6, 1e-2, 1.0, 1e3])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_tangents_hold_down_to_rates_where_the_law_is_steep(
    rate: float, direction: float, tmp_path: Path
) -> None:
    """Cowper and Symonds, vertical at no rate: E - E^2 / (E + H f + Y f' / h)."""
    fibre, h = Fibre(tmp_path, EXAMPLES["rate"]), 5e-3 / rate
    sigma, slope, _ = fibre.tangent(direction * 5e-3, 0.0, h)
    ends = [fibre.step(direction * 5e-3 + size, 0.0, h)[0] for size in (1e-9, -1e-9)]
    # round-off of 1e-13 of the stress over 2e-9
    assert slope == pytest.approx((ends[0] - ends[1]) / 2e-9, rel=1e-4)
    e = 5e-3 - abs(sigma) / 2e5
    over = (e / h / 40.0) ** 0.2
    assert abs(sigma) == pytest.approx((200.0 + 2e3 * e) * (1.0 + over), rel=1e-12)
    rises = 2e3 * (1.0 + over) + (200.0 + 2e3 * e) * over / (5.0 * e)
    assert slope == pytest.approx(2e5 - 2e5**2 / (2e5 + rises), rel=1e-8)
    layers = Layers(tmp_path, EXAMPLES["rate"])
    d = walk(layers, 2e-3, 2, 3, 1.0)
    assert tangent_error(layers, d, 2e-3 / rate, 1e-9) < 1e-6


RATED = {
    "rate": EXAMPLES["rate"],
    "logarithm": COOK | {"hardening": 2e3, "exponent": 1.0, "rate": 0.1, "reference_rate": 1.0},
}
# strain of a fibre: to 1 % at a rate that rises and falls, then back to compression
PERIOD, MOST = 2e-3, 1e-2


def moving(t: float) -> float:
    return MOST * np.sin(2.0 * np.pi * t / PERIOD)


def overstress(example: Example, stress: float, e: float) -> float:
    """Rate of the plastic strain at a stress, from the formula of the card solved for the rate."""
    over = abs(stress) / (200.0 + 2e3 * e) - 1.0
    if over <= 0.0:
        return 0.0
    # trial steps of the integration may lead beyond numbers
    rate = 40.0 * over**5 if "rate_D" in example else np.exp(min(over / 0.1, 40.0))
    return float(np.copysign(rate, stress))


@pytest.mark.parametrize("name", RATED)
def test_steps_approach_the_viscoplastic_law_with_order_1(name: str, tmp_path: Path) -> None:
    """Against SciPy's integration of e_p_dot = f^-1(|sigma| / Y), an equation in time."""
    example = RATED[name]

    def rates(t: float, x: np.ndarray) -> list[float]:
        flow = overstress(example, 2e5 * (moving(t) - x[0]), max(x[1], 0.0))
        return [flow, abs(flow)]

    exact = solve_ivp(
        rates, (0.0, 0.7 * PERIOD), [0.0, 0.0], "Radau", rtol=1e-9, atol=1e-13, max_step=1e-5
    )
    assert exact.success
    wanted = 2e5 * (moving(0.7 * PERIOD) - exact.y[0, -1])
    errors = []
    for steps in (140, 280, 560):
        fibre, h = Fibre(tmp_path, example), 0.7 * PERIOD / steps
        for k in range(1, steps + 1):
            stress = fibre.step(moving(k * h), 0.0, h)[0]
            fibre.accept()
        errors.append(abs(stress - wanted))
    assert errors[-1] < 1e-3 * abs(wanted)
    for coarse, fine in pairwise(errors):
        # order 1: halves, but for the next term
        assert 1.7 < coarse / fine < 2.3


@pytest.mark.parametrize("name", RATED)
def test_at_no_rate_it_is_the_static_curve_and_unloads_elastically(
    name: str, tmp_path: Path
) -> None:
    still = {k: v for k, v in RATED[name].items() if k not in ("rate_D", "rate", "reference_rate")}
    slow, static = Fibre(tmp_path, RATED[name]), Fibre(tmp_path, still)
    for strain in (1e-3, 5e-3, 9e-3, 4e-3, -6e-3):
        one, other = slow.step(strain, 0.0, 1e90)[0], static.step(strain, 0.0, 1e90)[0]
        slow.accept()
        static.accept()
        # Cowper and Symonds: (1e-92 / 40)^(1/5)
        assert one == pytest.approx(other, rel=1e-14)
    fast = Fibre(tmp_path, RATED[name])
    top = fast.step(8e-3, 0.0, 1e-5)[0]
    fast.accept()
    assert top > 1.03 * Fibre(tmp_path, still).step(8e-3, 0.0, 1.0)[0]
    # to within the static yield stress: until then it flows on, ever more slowly
    assert fast.step(6e-3, 0.0, 1e-5)[0] == pytest.approx(top - 2e5 * 2e-3, rel=1e-12)
    assert fast.new.rate[0] == 0.0


def line(Y: float, H: float) -> Callable[[float], float]:
    return lambda e: Y + H * e


YIELD: dict[str, Callable[[float], float]] = {
    "perfect": line(200.0, 0.0),
    "isotropic": line(200.0, 2e3),
    "kinematic": line(200.0, 2e3),
    "mixed": line(200.0, 2e3),
    "curve": lambda e: float(np.interp(e, *np.transpose(CURVE))),
    "power": lambda e: 200.0 + 500.0 * e**0.3,
}


@pytest.mark.parametrize("name", YIELD)
def test_the_uniaxial_yield_curve_is_that_of_the_card(name: str, tmp_path: Path) -> None:
    layers, fibre = Layers(tmp_path, EXAMPLES[name]), Fibre(tmp_path, EXAMPLES[name])
    for k in range(1, 13):
        strain = 1e-3 * k
        layer, sigma = layers.pull(1e-3), fibre.step(strain, 1.0)[0]
        fibre.accept()
        e = strain - sigma / 2e5
        wanted = 2e5 * strain if k == 1 else YIELD[name](e)
        # 1e-14 of the return, over strains that add up to a round-off of 1e-18 E
        assert sigma == pytest.approx(wanted, rel=1e-12)
        assert layer == pytest.approx(sigma, rel=1e-8)


def test_rubber_follows_its_energy_under_uniaxial_stress(tmp_path: Path) -> None:
    layers, G = Layers(tmp_path, EXAMPLES["rubber"]), 2e5 / 2.6
    L = 2e5 * 0.3 / (1.3 * 0.4)
    for k in range(1, 6):
        stress = layers.pull(0.1)
        stretch = np.exp(0.1 * k)
        # no stress across: G (b - 1) + L ln J = 0, the same along y and z

        def across(b: float, stretch: float = stretch) -> Any:
            return G * (b - 1.0) + L * np.log(stretch * b)

        b = brentq(across, 1e-3, 2.0, xtol=1e-15)
        wanted = G * (stretch**2 - b) / (stretch * b)
        # exp(2 d) is taken to second order in a step: 0.1^3 of it, five times
        assert stress == pytest.approx(wanted, rel=1e-2)


def test_lanes_do_not_know_of_each_other(tmp_path: Path) -> None:
    """One layer beyond yield beside others within it."""
    layers = Layers(tmp_path, EXAMPLES["hot"])
    d = np.zeros((LANES, 3))
    d[5] = 4e-3, 0.0, 1e-3
    change = layers.step(d, 1.0)
    alone = Layers(tmp_path, EXAMPLES["hot"]).step(np.tile(d[5], (LANES, 1)), 1.0)
    assert (change[5] == alone[0]).all()
    assert not change[np.arange(LANES) != 5].any()
