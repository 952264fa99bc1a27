"""Neo-Hookean material: elastic at any strain, for rubber and foam.

    W = G/2 (tr b - 3 - 2 ln J) + L/2 (ln J)^2,   L = E nu / ((1 + nu) (1 - 2 nu))
    sigma = G (b - lambda_3^2) / J   in plane stress,   G (lambda_3^2 - 1) + L ln J = 0

b is the left Cauchy-Green tensor, lambda_3 the stretch across the thickness, W per volume at the
start. Young's modulus and Poisson's ratio are those of small strain. Consequence to test: the
stress at a stretch is that of the formula, and a closed path of strain costs nothing.

Reference: Bonet and Wood (2008), Nonlinear Continuum Mechanics for Finite Element Analysis, 6.4.
"""

from math import exp, expm1, log1p, sqrt
from typing import Any

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.point import LANES
from crashsolve.foundation.record import Record, rows_of
from crashsolve.materials import elastic


class NeoHookean(elastic.Elastic):
    """Neo-Hookean material, for shells with `thinning: true`."""

    @property
    def volumetric(self) -> float:
        """L [Pa]."""
        return self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson))


PARAMETERS = elastic.PARAMETERS + Record("volumetric  Pa  L")
LAYER = rows_of(
    Record("""
        stress  Pa  3  xx, yy, xy
        metric  1   3  C - 1: xx, yy, xy
        across  1      ln lambda_3
    """)
)
# the strain of beams is small
FIBRE = None
VON_MISES = DISSIPATES = False
LARGE_STRAIN = True


def build(card: NeoHookean, scene: Scene) -> dict[str, Any]:
    return elastic.build(card, scene) | {"volumetric": card.volumetric}


def layer_rows(card: NeoHookean) -> int:
    return int(LAYER.SIZE)


def initial_layer(card: NeoHookean, scene: Scene) -> np.ndarray:
    return np.zeros(LAYER.SIZE)


def stored(card: NeoHookean, layer: np.ndarray) -> np.ndarray:
    """Elastic energy by present volume [J/m^3] of layers (..., rows)."""
    x, y, s, across = np.moveaxis(layer[..., LAYER.metric :], -1, 0)
    volume = 0.5 * np.log1p(x + y + x * y - s * s) + across
    trace = x + y + np.expm1(2.0 * across) - 2.0 * volume
    shear = card.young / (2.0 + 2.0 * card.poisson)
    found: np.ndarray = np.exp(-volume) * 0.5 * (shear * trace + card.volumetric * volume**2)
    return found


plastic_strain = elastic.plastic_strain


@inlined
def update(m, blocks, at, d, h, curves):
    """C grows by U exp(2 d) U, U the root of C; axes turn with the material, so that b is C."""
    G, L = m.shear, m.volumetric
    row, to = at + LANES * LAYER.metric, at + LANES * LAYER.across
    x, y, s = grown((blocks[row], blocks[row + LANES], blocks[row + 2 * LANES]), d)
    blocks[row], blocks[row + LANES], blocks[row + 2 * LANES] = x, y, s
    # ln of the change of area, without cancellation for small strain
    area = 0.5 * log1p(x + y + x * y - s * s)
    across = -area * m.poisson / (1.0 - m.poisson)
    for _ in range(6):
        gap = G * expm1(2.0 * across) + L * (area + across)
        across -= gap / (2.0 * G * exp(2.0 * across) + L)
    thick = expm1(2.0 * across)
    k = exp(-area - across)
    more = across - blocks[to]
    blocks[to] = across
    stress = (G * k * (x - thick), G * k * (y - thick), G * k * s)
    return stress, more, 0.0, 0.5 * k * (3.0 + x + y + thick)


@inlined
def grown(C, d):
    """C - 1 [1] after strains d (xx, yy, twice xy)."""
    x, y, s = C
    a, b, c = d[0], d[1], 0.5 * d[2]
    # X = exp(2 d) - 1 to third order
    X, Y, Z = square_of(a, b, c)
    xx, yy, xy = 2.0 * (a + X), 2.0 * (b + Y), 2.0 * (c + Z)
    # root of C: U = (C + det) / sqrt(tr C + 2 det)
    det = sqrt((1.0 + x) * (1.0 + y) - s * s)
    k = 1.0 / sqrt(2.0 + x + y + 2.0 * det)
    u, v, w = k * (1.0 + x + det), k * (1.0 + y + det), k * s
    # U X U
    p, q, r, o = u * xx + w * xy, u * xy + w * yy, w * xx + v * xy, w * xy + v * yy
    return x + p * u + q * w, y + r * w + o * v, s + p * w + q * v


@inlined
def square_of(a, b, c):
    """Square of a symmetric tensor (xx, yy, xy)."""
    return a * a + c * c, b * b + c * c, c * (a + b)


@inlined
def tangent(m, kept, blocks, at, d, direction, h, curves):
    row = at + LANES * LAYER.metric
    old = (kept[row], kept[row + LANES], kept[row + 2 * LANES])
    new = (blocks[row], blocks[row + LANES], blocks[row + 2 * LANES])
    across, more = (
        blocks[at + LANES * LAYER.across],
        (direction[0], direction[1], 0.5 * direction[2]),
    )
    x, y, s, by = slopes(m, old, new, across, d, more)
    return (x, y, s), by


@inlined
def slopes(m, old, new, across, d, more):
    """Change of the stress [Pa] of a neo-Hookean layer, and of the strain across, with its strains.

    `more` is the change of the strains, its last that of xy, not of twice xy.
    """
    a, b, c = d[0], d[1], 0.5 * d[2]
    u, v, w = more
    # of exp(2 d) - 1 as it is taken
    xx, yy = 2.0 * (u + 2.0 * (a * u + c * w)), 2.0 * (v + 2.0 * (b * v + c * w))
    xy = 2.0 * (w + w * (a + b) + c * (u + v))
    x, y, s = old
    det = sqrt((1.0 + x) * (1.0 + y) - s * s)
    k = 1.0 / sqrt(2.0 + x + y + 2.0 * det)
    u, v, w = k * (1.0 + x + det), k * (1.0 + y + det), k * s
    o_1, o_2, o_3, o_4 = u * xx + w * xy, u * xy + w * yy, w * xx + v * xy, w * xy + v * yy
    d_x, d_y, d_s = o_1 * u + o_2 * w, o_3 * w + o_4 * v, o_1 * w + o_2 * v
    x, y, s = new
    square = 1.0 + x + y + x * y - s * s
    area = 0.5 * (d_x * (1.0 + y) + d_y * (1.0 + x) - 2.0 * s * d_s) / square
    thick = 2.0 * exp(2.0 * across)
    d_across = -m.volumetric * area / (m.shear * thick + m.volumetric)
    k, falls = m.shear * exp(-across) / sqrt(square), area + d_across
    rises, high = thick * d_across, expm1(2.0 * across)
    return (
        k * (d_x - rises - falls * (x - high)),
        k * (d_y - rises - falls * (y - high)),
        k * (d_s - falls * s),
        d_across,
    )


@inlined
def energy(m, blocks, at):
    C, across = at + LANES * LAYER.metric, blocks[at + LANES * LAYER.across]
    x, y, s = blocks[C], blocks[C + LANES], blocks[C + 2 * LANES]
    volume = 0.5 * log1p(x + y + x * y - s * s) + across
    trace = x + y + expm1(2.0 * across) - 2.0 * volume
    return exp(-volume) * 0.5 * (m.shear * trace + m.volumetric * volume * volume)
