"""Elastoplastic material of von Mises, with isotropic, kinematic and tabulated hardening.

    sqrt(3/2) |dev(sigma - alpha)| <= Y(e) (1 + (rate / D)^(1/q)),   e the equivalent plastic strain
    Y = Y_0 + (1 - beta) H e, or a curve;   alpha_dot = 2/3 beta H eps_p_dot

rate is that of e (Cowper and Symonds). Consequence to test: a bar pulled beyond
Y_0 / E follows the slope E H / (E + H), and yields backwards after 2 Y_0 where beta is 1.

References: Simo and Taylor (1986), A return mapping algorithm for plane stress elastoplasticity,
Int. J. Num. Meth. Eng. 22, 649-670. Cowper and Symonds (1957), Strain-hardening and strain-rate
effects in the impact loading of cantilever beams, Brown University Report 28.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import CurveName, quantity, word
from crashsolve.foundation.curve import curve_line, curve_value
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.record import Record
from crashsolve.foundation.rows import as_rows
from crashsolve.materials import _von_mises, elastic

if TYPE_CHECKING:
    from crashsolve.materials._rows.elastoplastic import Parameters


class Elastoplastic(elastic.Elastic):
    """Elastoplastic material of von Mises."""

    curve_axes: ClassVar = {"curve": ("1", "Pa")}

    yield_stress: float | None = quantity(
        "Pa", "Y_0, initial yield stress; or give `curve`", default=None, gt=0
    )
    hardening: float = quantity("Pa", "H, stress over plastic strain", default=0.0, ge=0)
    kinematic: float = quantity("1", "beta, kinematic share of H", default=0.0, ge=0, le=1)
    curve: CurveName | None = word("Y over plastic strain e, instead of yield_stress", default=None)
    rate_D: float | None = quantity("1/s", "D of Cowper and Symonds", default=None, gt=0)
    rate_q: float = quantity("1", "q of Cowper and Symonds", default=5.0, gt=0)
    failure_strain: float | None = quantity(
        "1", "plastic strain e at which a layer fails", default=None, gt=0
    )

    @model_validator(mode="after")
    def _one_hardening(self) -> Elastoplastic:
        if (self.yield_stress is None) == (self.curve is None):
            raise ValueError("needs either yield_stress or curve")
        if self.curve is not None and self.hardening and self.kinematic < 1.0:
            raise ValueError(
                "hardening: is given by the curve; give it beside a curve only with kinematic: 1"
            )
        return self


PARAMETERS = _von_mises.PARAMETERS + Record("""
    yield_stress  Pa     Y_0
    isotropic     Pa     (1 - beta) H
    curve         index  Y over plastic strain; 0 for none
    line_row      index  of a layer: value at no strain, slope and end of the line of a curve
    rate_D        1/s    D of Cowper and Symonds; 0 for none
    rate_q        1      q of Cowper and Symonds
""")
LAYER, FIBRE, SOLID = _von_mises.LAYER, _von_mises.FIBRE, _von_mises.SOLID
VON_MISES = DISSIPATES = True
LARGE_STRAIN = SMOOTH = HEATS = False
LINE_ROWS = 3


def build(card: Elastoplastic, scene: Scene) -> Columns:
    kinematic = card.kinematic * card.hardening
    return _von_mises.build(card, scene, kinematic, card.rate_D is not None) | {
        "yield_stress": card.yield_stress or 0.0,
        "isotropic": (1.0 - card.kinematic) * card.hardening,
        "curve": scene.curve(card.curve) if card.curve else 0,
        "line_row": layer_rows(card) - LINE_ROWS,
        "rate_D": card.rate_D or 0.0,
        "rate_q": card.rate_q,
    }


def layer_rows(card: Elastoplastic) -> int:
    moves = card.kinematic * card.hardening > 0.0
    return int(LAYER.SIZE if moves else LAYER.alpha) + LINE_ROWS * (card.curve is not None)


def initial_layer(card: Elastoplastic, scene: Scene) -> np.ndarray:
    rows = np.zeros(layer_rows(card))
    if card.curve is not None:
        points = as_rows(scene.curve_points)
        rows[-LINE_ROWS:] = curve_line(points, scene.curve(card.curve), 0.0)
    return rows


stored, plastic_strain = elastic.stored, _von_mises.plastic_strain
update, energy = elastic.update, elastic.energy
solid, solid_energy = _von_mises.solid, elastic.solid_energy


@inlined
def flow(m: Parameters, e, curves):
    if m.curve > 0:
        Y, slope, _ = curve_value(curves, m.curve, e)
        return Y, slope
    return m.yield_stress + m.isotropic * e, m.isotropic


@inlined
def line(m: Parameters, e, curves):
    return curve_line(curves, m.curve, e)


@inlined
def rate_factor(m: Parameters, rate):
    return 1.0 + (rate / m.rate_D) ** (1.0 / m.rate_q)


@inlined
def rate_slopes(m: Parameters, rate, factor):
    over = 1.0 / (m.rate_q * rate)
    slope = (factor - 1.0) * over
    return slope, slope * over * (1.0 - m.rate_q)


@inlined
def rate_of(m: Parameters, factor):
    return m.rate_D * (factor - 1.0) ** m.rate_q


@inlined
def heat_factor(m: Parameters, temperature):
    return 1.0
