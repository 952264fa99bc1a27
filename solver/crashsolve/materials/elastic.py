"""Isotropic linear elastic material.

    sigma = E eps,   tau = G gamma,   G = E / (2 + 2 nu)

Consequence to test: a bar's elongation is N L / (E A).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.point import LANES
from crashsolve.foundation.record import Record, rows_of

if TYPE_CHECKING:
    from crashsolve.materials._rows.elastic import Parameters, Solid


class Elastic(Card):
    """Isotropic linear elastic material."""

    young: float = quantity("Pa", "E, modulus of elasticity", gt=0)
    poisson: float = quantity("1", "nu, Poisson's ratio", gt=-1, lt=0.5)
    density: float = quantity("kg/m^3", "mass per volume", gt=0)


PARAMETERS = Record("""
    young    Pa      E
    poisson  1       nu
    shear    Pa      G
    density  kg/m^3  rho
    plane    Pa      E / (1 - nu^2)
    across   1       nu / (1 - nu)
""")
LAYER = rows_of(Record("stress  Pa  3  xx, yy, xy"))
FIBRE = Record()
SOLID = Record("stress  Pa  6  xx, yy, zz, xy, yz, zx")
VON_MISES = LARGE_STRAIN = DISSIPATES = False


def build(card: Elastic, scene: Scene) -> Columns:
    return {
        "young": card.young,
        "poisson": card.poisson,
        "shear": card.young / (2.0 + 2.0 * card.poisson),
        "density": card.density,
        "plane": card.young / (1.0 - card.poisson * card.poisson),
        "across": card.poisson / (1.0 - card.poisson),
    }


def layer_rows(card: Elastic) -> int:
    return int(LAYER.SIZE)


def initial_layer(card: Elastic, scene: Scene) -> np.ndarray:
    return np.zeros(LAYER.SIZE)


def stored(card: Elastic, layer: np.ndarray) -> np.ndarray:
    x, y, s = np.moveaxis(layer[..., :3], -1, 0)
    E, nu = card.young, card.poisson
    form: np.ndarray = x * x + y * y - 2.0 * nu * x * y + 2.0 * (1.0 + nu) * s * s
    return form / (2.0 * E)


def plastic_strain(card: Elastic, layer: np.ndarray) -> np.ndarray:
    return np.zeros(layer.shape[:-1])


@inlined
def update(m: Parameters, blocks, at, d, h, curves):
    """Update of a layer within its yield stress."""
    x, y, xy = d
    s_x = blocks[at] + m.plane * (x + m.poisson * y)
    s_y = blocks[at + LANES] + m.plane * (y + m.poisson * x)
    s_xy = blocks[at + 2 * LANES] + m.shear * xy
    return (s_x, s_y, s_xy), -m.across * (x + y), 0.0, 1.0


@inlined
def tangent(m: Parameters, blocks_before, blocks, at, d, direction, h, curves):
    both = m.young / (1.0 - m.poisson) * (direction[0] + direction[1])
    apart = 2.0 * m.shear * (direction[0] - direction[1])
    stress = (0.5 * (both + apart), 0.5 * (both - apart), m.shear * direction[2])
    return stress, -m.poisson / m.young * both


@inlined
def hooke(m, d):
    """Change of the stress (6) in three dimensions with the strains d, twice those of shear."""
    lame = m.young * m.poisson / ((1.0 + m.poisson) * (1.0 - 2.0 * m.poisson))
    mean, twice = lame * (d[0] + d[1] + d[2]), 2.0 * m.shear
    normal = (mean + twice * d[0], mean + twice * d[1], mean + twice * d[2])
    return (*normal, m.shear * d[3], m.shear * d[4], m.shear * d[5])


@inlined
def solid(m: Parameters, old: Solid, new: Solid, d, h, curves, material):
    grown = hooke(m, d)
    for k in range(6):
        new.stress[k] = old.stress[k] + grown[k]
    return new.stress, 0.0


@inlined
def solid_energy(m: Parameters, new: Solid):
    """Stored energy from the stress [J/m^3]."""
    s = new.stress
    trace = s[0] + s[1] + s[2]
    squares = s[0] * s[0] + s[1] * s[1] + s[2] * s[2]
    squares += 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])
    return 0.5 / m.young * ((1.0 + m.poisson) * squares - m.poisson * trace * trace)


@inlined
def energy(m: Parameters, blocks, at):
    """Stored energy from the stress [J/m^3]."""
    x, y, s = blocks[at], blocks[at + LANES], blocks[at + 2 * LANES]
    density = x * x + y * y - 2.0 * m.poisson * x * y + 2.0 * (1.0 + m.poisson) * s * s
    return 0.5 * density / m.young


@inlined
def fibre(m: Parameters, old, new, i, strain, rate, h, curves):
    sigma = m.young * strain
    return sigma, 0.5 * sigma * strain, 0.0


@inlined
def fibre_tangent(m: Parameters, old, i, strain, rate, curves):
    return 0.0, 0.0, 0.0
