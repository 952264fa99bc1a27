"""What metals that yield by von Mises' stress share: columns, and what a point remembers.

    sqrt(3/2) |dev(sigma - alpha)| <= Y(e) f(rate) g(T),   alpha_dot = 2/3 H_k eps_p_dot
    T_dot = heating w_p_dot

e is the equivalent plastic strain, w_p the plastic work per volume. A law says Y, f and g; elements
return stresses to the yield surface (elements/shells/plasticity.py, elements/beams/fibres.py).
"""

from math import sqrt
from typing import Any

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.record import Record, rows_of
from crashsolve.materials import elastic

PARAMETERS = elastic.PARAMETERS + Record("""
    softness         1/Pa   nu / E
    falls_1          Pa     c_1 of the plastic return
    falls_2          Pa     c_2
    kinematic        Pa     H_k, of what moves the yield surface
    rated            flag   whether the rate of strain has a factor
    heating          m^3/J  temperature, 1 at melting, over plastic work per volume; 0 for none
    temperature_row  index  of a layer
    failure          1      plastic strain at which a layer fails; 0 for none
""")
# then, where there are any: the temperature, and the line of a curve
LAYER = rows_of(
    Record("""
        stress          Pa  3  xx, yy, xy
        plastic_strain  1      e
        alpha           Pa  3  middle of the yield surface, where it moves
    """)
)
FIBRE = Record("""
    plastic    1  plastic strain
    hardening  1  e, sum of the sizes of its steps
""")
SOLID = elastic.SOLID + Record("""
    plastic_strain  1      e
    alpha           Pa  6  middle of the yield surface
    temperature     1      from 0 at the start to 1 at melting
""")
# of Newton's method in the return of a point, and share of the yield stress at which it ends
PASSES, CLOSE = 60, 1e-14
HEATED_FIBRE = FIBRE + Record("temperature  1  from 0 at the start to 1 at melting")


def build(card: Any, scene: Scene, kinematic: float, rated: bool, heating: float = 0.0) -> Columns:
    """Columns of PARAMETERS; an equilibrium has no rate."""
    rated = rated and scene.deck.control.solution != "quasi_static"
    words = elastic.build(card, scene)
    E, nu, moves = words["young"], words["poisson"], 2.0 / 3.0 * kinematic
    return words | {
        "softness": nu / E,
        "falls_1": E / (3.0 - 3.0 * nu) + moves,
        "falls_2": 2.0 * words["shear"] + moves,
        "kinematic": kinematic,
        "rated": rated,
        "heating": heating,
        "temperature_row": LAYER.SIZE if kinematic else LAYER.alpha,
        "failure": card.failure_strain or 0.0,
    }


def plastic_strain(card: Card, layer: np.ndarray) -> np.ndarray:
    """Equivalent plastic strain [1] of layers (..., rows)."""
    found: np.ndarray = layer[..., LAYER.plastic_strain]
    return found


@inlined
def factor_of(m, rate, temperature, material):
    """Factor [1] on the yield stress: it is higher at a rate of strain, lower at a temperature."""
    factor = material.rate_factor(m, rate) if m.rated == 1 else 1.0
    return factor * material.heat_factor(m, temperature) if m.heating > 0.0 else factor


@inlined
def has_factor(m):
    """Whether there is a factor on the yield stress."""
    return m.rated == 1 or m.heating > 0.0


@inlined
def invariant(s):
    """Size [Pa] of a tensor (xx, yy, zz, xy, yz, zx): sqrt(3/2) of that of its deviator."""
    a, b, c = s[0] - s[1], s[1] - s[2], s[2] - s[0]
    shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5]
    return sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * shear)


@inlined
def plastic_step(m, e, size, factor, curves, material):
    """Plastic strain of a step in three dimensions that returns a trial stress of this size.

    size - (3 G + H_k) x - f Y(e + x) = 0, which falls in x and is convex, by Newton's method.
    """
    x, falls = 0.0, 3.0 * m.shear + m.kinematic
    Y, slope = material.flow(m, e, curves)
    for _ in range(PASSES):
        gap = size - falls * x - factor * Y
        if (x == 0.0 and gap <= 0.0) or abs(gap) <= CLOSE * size:
            break
        x = max(0.5 * x, x + gap / (falls + factor * slope))
        Y, slope = material.flow(m, e + x, curves)
    return x


@inlined
def solid(m, old, new, d, h, curves, material):
    """Radial return; the rate is that of the strain without its mean, heat that before the step."""
    trial, grown = old.stress, elastic.hooke(m, d)
    xi = (
        trial[0] + grown[0] - old.alpha[0],
        trial[1] + grown[1] - old.alpha[1],
        trial[2] + grown[2] - old.alpha[2],
        trial[3] + grown[3] - old.alpha[3],
        trial[4] + grown[4] - old.alpha[4],
        trial[5] + grown[5] - old.alpha[5],
    )
    size, factor = invariant(xi), 1.0
    if has_factor(m):
        half = (d[0], d[1], d[2], 0.5 * d[3], 0.5 * d[4], 0.5 * d[5])
        rate = 2.0 / 3.0 * invariant(half) / h if h > 0.0 else 0.0
        factor = factor_of(m, rate, old.temperature, material)
    x = plastic_step(m, old.plastic_strain, size, factor, curves, material)
    mean, share = (xi[0] + xi[1] + xi[2]) / 3.0, x / (size + 1e-300)
    lost = 0.0
    for k in range(6):
        away = xi[k] - mean if k < 3 else xi[k]
        before, trial_k = old.stress[k], old.stress[k] + grown[k]
        new.stress[k] = trial_k - 3.0 * m.shear * share * away
        new.alpha[k] = old.alpha[k] + m.kinematic * share * away
        # shear counts twice, in half of what is twice the strain
        weight = 1.5 if k < 3 else 3.0
        lost += 0.5 * (before + new.stress[k]) * weight * share * away
    new.plastic_strain = old.plastic_strain + x
    new.temperature = old.temperature + m.heating * lost
    return new.stress, lost
