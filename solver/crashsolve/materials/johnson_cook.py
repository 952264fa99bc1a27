"""Plasticity of Johnson and Cook: power hardening, rate of strain, softening by heat of the work.

    Y = (A + B e^n) (1 + C ln(rate / rate_0)) (1 - T^m)
    T_dot = chi w_p_dot / (rho q),   q = c (T_melt - T_room)

e is the equivalent plastic strain, rate that of e, T the temperature from 0 in the
room, where everything starts, to 1 where it melts; w_p is the plastic work per volume. Below
rate_0 the second factor is 1. Every layer keeps its own temperature: heat stays where it is made,
as it does within milliseconds. Without q nothing softens; a molten layer keeps a millionth of
its strength. Consequence to test: a bar pulled at one rate follows the formula.

Reference: Johnson and Cook (1983), A constitutive model and data for metals subjected to large
strains, high strain rates and high temperatures, 7th Int. Symposium on Ballistics, 541-547.
"""

from __future__ import annotations

from math import exp, log
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.record import Record
from crashsolve.materials import _von_mises, elastic

if TYPE_CHECKING:
    from crashsolve.materials._rows.johnson_cook import Parameters


class JohnsonCook(elastic.Elastic):
    """Plasticity of Johnson and Cook."""

    yield_stress: float = quantity("Pa", "A, initial yield stress", gt=0)
    hardening: float = quantity("Pa", "B, of hardening by plastic strain", default=0.0, ge=0)
    exponent: float = quantity("1", "n, exponent of plastic strain", default=1.0, gt=0, le=1)
    rate: float = quantity("1", "C, of rate hardening", default=0.0, ge=0)
    reference_rate: float = quantity(
        "1/s", "rate_0, strain rate above which C counts", default=1.0, gt=0
    )
    melting_heat: float | None = quantity(
        "J/kg", "q = c (T_melt - T_room); no thermal softening when absent", default=None, gt=0
    )
    softening: float = quantity("1", "m, exponent of thermal softening", default=1.0, gt=0)
    heat_share: float = quantity(
        "1", "chi, share of the plastic work that becomes heat", 0.9, gt=0, le=1
    )
    failure_strain: float | None = quantity(
        "1", "plastic strain e at which a layer fails", default=None, gt=0
    )


PARAMETERS = _von_mises.PARAMETERS + Record("""
    yield_stress  Pa   A
    power         Pa   B
    exponent      1    n
    rate_C        1    C
    rate_0        1/s  rate above which C counts
    softening     1    m
""")
LAYER, FIBRE, SOLID = _von_mises.LAYER, _von_mises.HEATED_FIBRE, _von_mises.SOLID
VON_MISES = DISSIPATES = SMOOTH = HEATS = True
LARGE_STRAIN = False
# share of its strength that a molten layer keeps
MOLTEN = 1e-6


def build(card: JohnsonCook, scene: Scene) -> Columns:
    heated = card.heat_share / (card.density * card.melting_heat) if card.melting_heat else 0.0
    return _von_mises.build(card, scene, 0.0, card.rate > 0.0, heated) | {
        "yield_stress": card.yield_stress,
        "power": card.hardening,
        "exponent": card.exponent,
        "rate_C": card.rate,
        "rate_0": card.reference_rate,
        "softening": card.softening,
    }


def layer_rows(card: JohnsonCook) -> int:
    return int(LAYER.alpha) + (card.melting_heat is not None)


def initial_layer(card: JohnsonCook, scene: Scene) -> np.ndarray:
    return np.zeros(layer_rows(card))


stored, plastic_strain = elastic.stored, _von_mises.plastic_strain
update, energy = elastic.update, elastic.energy
solid, solid_energy = _von_mises.solid, elastic.solid_energy


@inlined
def flow(m: Parameters, e, curves):
    # the slope of the power at no strain has no bound
    rises = m.power * e**m.exponent
    return m.yield_stress + rises, m.exponent * rises / max(e, 1e-300)


@inlined
def strain_of_rise(m: Parameters, rise):
    return (rise / m.power) ** (1.0 / m.exponent)


@inlined
def rate_factor(m: Parameters, rate):
    return 1.0 + m.rate_C * log(rate / m.rate_0) if rate > m.rate_0 else 1.0


@inlined
def rate_slopes(m: Parameters, rate, factor):
    slope = m.rate_C / rate if rate > m.rate_0 else 0.0
    return slope, -slope / rate


@inlined
def rate_of(m: Parameters, factor):
    # any rate beyond numbers is beyond the bound of a step as well
    return m.rate_0 * exp(min((factor - 1.0) / m.rate_C, 600.0))


@inlined
def heat_factor(m: Parameters, temperature):
    # most metals have m = 1, which needs no power
    T = min(temperature, 1.0)
    return max(1.0 - (T if m.softening == 1.0 else T**m.softening), MOLTEN)
