"""Neo-Hookean material: elastic at any strain, for rubber and foam.

    W = G/2 (tr b - 3 - 2 ln J) + L/2 (ln J)^2,   L = E nu / ((1 + nu) (1 - 2 nu))
    sigma = G (b - lambda_3^2) / J   in plane stress,   G (lambda_3^2 - 1) + L ln J = 0

b is the left Cauchy-Green tensor, lambda_3 the stretch across the thickness, W per volume at the
start. Young's modulus and Poisson's ratio are those of small strain. Consequence to test: the
stress at a stretch is that of the formula, and a closed path of strain costs nothing.

Reference: Bonet and Wood (2008), Nonlinear Continuum Mechanics for Finite Element Analysis, 6.4.
"""

from __future__ import annotations

from math import exp, expm1, log1p, sqrt
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.point import LANES
from crashsolve.foundation.record import Record, rows_of
from crashsolve.materials import elastic

if TYPE_CHECKING:
    from crashsolve.materials._rows.neo_hookean import Parameters, Solid


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
SOLID = elastic.SOLID + Record("metric  1  6  C - 1: xx, yy, zz, xy, yz, zx")
# iterations of the root of C: each doubles the digits, and seven serve stretches of 0.1 to 10
ROOTS = 9
# the strain of beams is small
FIBRE = None
VON_MISES = DISSIPATES = False
LARGE_STRAIN = True


def build(card: NeoHookean, scene: Scene) -> Columns:
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
    energy: np.ndarray = np.exp(-volume) * 0.5 * (shear * trace + card.volumetric * volume**2)
    return energy


plastic_strain = elastic.plastic_strain


@inlined
def update(m: Parameters, blocks, at, d, h, curves):
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
def tangent(m: Parameters, blocks_before, blocks, at, d, direction, h, curves):
    row = at + LANES * LAYER.metric
    old = (blocks_before[row], blocks_before[row + LANES], blocks_before[row + 2 * LANES])
    new = (blocks[row], blocks[row + LANES], blocks[row + 2 * LANES])
    across, more = (
        blocks[at + LANES * LAYER.across],
        (direction[0], direction[1], 0.5 * direction[2]),
    )
    x, y, s, by = slopes(m, old, new, across, d, more)
    return (x, y, s), by


@inlined
def slopes(m: Parameters, old, new, across, d, more):
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
def energy(m: Parameters, blocks, at):
    C, across = at + LANES * LAYER.metric, blocks[at + LANES * LAYER.across]
    x, y, s = blocks[C], blocks[C + LANES], blocks[C + 2 * LANES]
    volume = 0.5 * log1p(x + y + x * y - s * s) + across
    trace = x + y + expm1(2.0 * across) - 2.0 * volume
    return exp(-volume) * 0.5 * (m.shear * trace + m.volumetric * volume * volume)


@inlined
def inverse(a):
    """Inverse of a symmetric tensor (xx, yy, zz, xy, yz, zx)."""
    x, y, z, u, v, w = a
    xx, yy, zz = y * z - v * v, z * x - w * w, x * y - u * u
    xy, yz, zx = v * w - u * z, w * u - v * x, u * v - w * y
    k = 1.0 / (x * xx + u * xy + w * zx)
    return k * xx, k * yy, k * zz, k * xy, k * yz, k * zx


@inlined
def middle(a, b):
    """Half of the sum of two symmetric tensors."""
    normal = (0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2]))
    return (*normal, 0.5 * (a[3] + b[3]), 0.5 * (a[4] + b[4]), 0.5 * (a[5] + b[5]))


@inlined
def root_of(a):
    """Root of a symmetric tensor, by the iteration of Denman and Beavers."""
    root, other = a, (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
    for _ in range(ROOTS):
        after = middle(root, inverse(other))
        other = middle(other, inverse(root))
        root = after
    return root


@inlined
def between(a, b):
    """a b a of symmetric tensors."""
    x, y, z, u, v, w = a
    p, q, r, s, t, o = b
    # rows of a b
    c = (x * p + u * s + w * o, x * s + u * q + w * t, x * o + u * t + w * r)
    e = (u * p + y * s + v * o, u * s + y * q + v * t, u * o + y * t + v * r)
    f = (w * p + v * s + z * o, w * s + v * q + z * t, w * o + v * t + z * r)
    return (
        c[0] * x + c[1] * u + c[2] * w,
        e[0] * u + e[1] * y + e[2] * v,
        f[0] * w + f[1] * v + f[2] * z,
        c[0] * u + c[1] * y + c[2] * v,
        e[0] * w + e[1] * v + e[2] * z,
        f[0] * x + f[1] * u + f[2] * w,
    )


@inlined
def doubled(d):
    """exp(2 d) - 1 to third order, of strains (xx, yy, zz, twice xy, yz, zx)."""
    x, y, z, u, v, w = d[0], d[1], d[2], 0.5 * d[3], 0.5 * d[4], 0.5 * d[5]
    return (
        2.0 * (x + x * x + u * u + w * w),
        2.0 * (y + y * y + u * u + v * v),
        2.0 * (z + z * z + v * v + w * w),
        2.0 * (u + u * (x + y) + w * v),
        2.0 * (v + v * (y + z) + u * w),
        2.0 * (w + w * (z + x) + u * v),
    )


@inlined
def volume_of(c):
    """ln J of C = 1 + c, without cancellation for small strain."""
    x, y, z, u, v, w = c[0], c[1], c[2], c[3], c[4], c[5]
    shear = u * u + v * v + w * w
    third = x * (y * z - v * v) - u * (u * z - v * w) + w * (u * v - w * y)
    return 0.5 * log1p(x + y + z + (x * y + y * z + z * x - shear) + third)


@inlined
def solid(m: Parameters, old: Solid, new: Solid, d, h, curves, material):
    """Update of a point as of a layer, with all six strains: C becomes U exp(2 d) U."""
    c = old.metric
    root = root_of((1.0 + c[0], 1.0 + c[1], 1.0 + c[2], c[3], c[4], c[5]))
    grown = between(root, doubled(d))
    for k in range(6):
        new.metric[k] = c[k] + grown[k]
    volume = volume_of(new.metric)
    less = exp(-volume)
    for k in range(6):
        pressure = m.volumetric * volume if k < 3 else 0.0
        new.stress[k] = less * (m.shear * new.metric[k] + pressure)
    return new.stress, 0.0


@inlined
def solid_energy(m: Parameters, new: Solid):
    c, volume = new.metric, volume_of(new.metric)
    trace = c[0] + c[1] + c[2] - 2.0 * volume
    return exp(-volume) * 0.5 * (m.shear * trace + m.volumetric * volume * volume)
