"""Columns and state that metals with von Mises' yield criterion share.

    sqrt(3/2) |dev(sigma - alpha)| <= Y(e) f(rate) g(T),   alpha_dot = 2/3 H_k eps_p_dot
    T_dot = heating w_p_dot

e is the equivalent plastic strain, rate that of e over a step, w_p the plastic work per volume. A
law gives Y, f and g; elements return stresses to the yield surface (elements/shells/plasticity.py,
elements/beams/fibres.py).
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.record import Record, rows_of
from crashsolve.materials import elastic

if TYPE_CHECKING:
    from crashsolve.materials._rows._von_mises import Parameters, Solid

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
    plastic    1    plastic strain
    hardening  1    e, sum of the sizes of its steps
    rate       1/s  of the plastic strain in the last step, without sign
""")
SOLID = elastic.SOLID + Record("""
    plastic_strain  1      e
    alpha           Pa  6  middle of the yield surface
    temperature     1      from 0 at the start to 1 at melting
""")
# of Newton's method in a return, and share of the yield stress at which it ends: some round-off
ITERATIONS, CLOSE = 60, 1e-14
# share of a growth in a correction after which the rest is round-off: its cube, and its square
# where Y bends, whose second slope is left out
NEAR, NEAR_BENT = 1e-5, 1e-7
# before the first step of a point, or where it keeps no such record: rate, and size of the stress
UNKNOWN = (0.0, 0.0)
INFINITE = 1e300
# rate [1/s] below which the slope, which may overflow there, is not evaluated
SLOWEST = 1e-60
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
    strains: np.ndarray = layer[..., LAYER.plastic_strain]
    return strains


@inlined
def invariant(s):
    """Size [Pa] of a tensor (xx, yy, zz, xy, yz, zx): sqrt(3/2) of that of its deviator."""
    a, b, c = s[0] - s[1], s[1] - s[2], s[2] - s[0]
    shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5]
    return sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * shear)


@inlined
def softening(m: Parameters, temperature, material):
    """Factor of heat on the yield stress."""
    return material.heat_factor(m, temperature) if m.heating > 0.0 else 1.0


@inlined
def flowed(m: Parameters, size, falls, e, heat, h, before, curves, material):
    """Rate of the plastic strain [1/s] over a step of h with this trial stress.

    `falls`: by how much the size of the stress falls over that strain; `before`: the rate in the
    last step, and the size of the stress after it, to begin from, or UNKNOWN.
    """
    Y, _ = material.flow(m, e, curves)
    if h > 0.0 and size > heat * Y:
        return flow_rate(m, size, h * falls, e, heat * Y, heat, h, before, curves, material)
    return 0.0


@kernel
def flow_rate(m: Parameters, size, falls, e, limit, heat, h, before, curves, material):
    """Rate of the plastic strain [1/s] over a step of h that returns this trial stress to yield.

        size - falls r - heat Y(e + h r) f(r) = 0,   limit = heat Y(e)

    Halley's method, with bisection of the bracket of the root where its step leaves that: the
    slopes of powers of strain and rate are infinite at none.
    """
    r = first_rate(m, size, falls, e, limit, heat, h, before, curves, material)
    least, most, near = 0.0, INFINITE, NEAR_BENT if material.SMOOTH else NEAR
    for _ in range(ITERATIONS):
        factor = material.rate_factor(m, r) if m.rated == 1 else 1.0
        strength = resistance(m, e, r, heat, h, factor, curves, material)
        gap, flow = size - falls * r - strength[0], strength[0]
        if gap <= CLOSE * flow and (r == 0.0 or gap >= -CLOSE * flow):
            break
        if gap > 0.0:
            least = r
        else:
            most = r
        ahead = r + correction(gap, falls, strength)
        if not least < ahead < most:
            ahead = 0.5 * (least + min(most, size / falls))
        is_near, r = abs(ahead - r) <= near * r, ahead
        if is_near:
            break
    return r


@inlined
def first_rate(m: Parameters, size, falls, e, limit, heat, h, before, curves, material):
    """A first rate: the last one, corrected without asking for its factor again.

    Without one it is exact where nothing hardens and stress is linear in the rate.
    """
    if m.rated == 0:
        return 0.0
    r, stress = before
    if r > 0.0 and stress > limit:
        strength = resistance(m, e, r, heat, h, stress / limit, curves, material)
        step = correction(size - falls * r - strength[0], falls, strength)
        if abs(step) < 0.5 * r:
            return r + step
    at_once, slowed = (size - limit) / falls, material.rate_of(m, size / limit)
    return at_once / (1.0 + at_once / (slowed + 1e-300))


@inlined
def correction(gap, falls, strength):
    """Step of Halley's method for the rate."""
    steep = falls + strength[1]
    return gap * steep / (steep * steep + max(0.5 * gap * strength[2], -0.5 * steep * steep))


@inlined
def resistance(m: Parameters, e, r, heat, h, factor, curves, material):
    """Yield stress [Pa] after a step of h with this rate, its slope by the rate, the slope of that.

    `factor`: that of the rate.
    """
    Y, slope = material.flow(m, e + h * r, curves)
    slope *= h
    if m.rated == 0 or r < SLOWEST:
        return heat * factor * Y, heat * factor * slope, 0.0
    faster, bend = material.rate_slopes(m, r, factor)
    return (
        heat * factor * Y,
        heat * (factor * slope + faster * Y),
        heat * (2.0 * faster * slope + bend * Y),
    )


@inlined
def solid(m: Parameters, old: Solid, new: Solid, d, h, curves, material):
    """Radial return; heat is that before the step, and a step of no length leaves all as it is."""
    trial, grown = old.stress, elastic.hooke(m, d)
    xi = (
        trial[0] + grown[0] - old.alpha[0],
        trial[1] + grown[1] - old.alpha[1],
        trial[2] + grown[2] - old.alpha[2],
        trial[3] + grown[3] - old.alpha[3],
        trial[4] + grown[4] - old.alpha[4],
        trial[5] + grown[5] - old.alpha[5],
    )
    size, falls = invariant(xi), 3.0 * m.shear + m.kinematic
    heat = softening(m, old.temperature, material)
    x = h * flowed(m, size, falls, old.plastic_strain, heat, h, UNKNOWN, curves, material)
    mean, share = (xi[0] + xi[1] + xi[2]) / 3.0, x / (size + 1e-300)
    lost = 0.0
    for k in range(6):
        away = xi[k] - mean if k < 3 else xi[k]
        before, trial_k = old.stress[k], old.stress[k] + grown[k]
        new.stress[k] = trial_k - 3.0 * m.shear * share * away
        new.alpha[k] = old.alpha[k] + m.kinematic * share * away
        # shear counts twice, in half of the double strain
        weight = 1.5 if k < 3 else 3.0
        lost += 0.5 * (before + new.stress[k]) * weight * share * away
    new.plastic_strain = old.plastic_strain + x
    new.temperature = old.temperature + m.heating * lost
    return new.stress, lost
