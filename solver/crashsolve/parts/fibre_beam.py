"""Fibre beam: the beam whose section yields, fibre by fibre.

    N, M_y, M_z from fibres (beams/fibres.py) with eps_0 = e / l, kappa = theta / l
    V_y = k_y u_y,   V_z = k_z u_z,   M_x = G J theta_x / l

at the one point of an element, its middle. Shear and torsion are elastic, and torsion is free of
warping; so is the bending that varies along the element (the term l^3 / 12 E I of the beam). A
hinge forms in the middle of an element: a cantilever of length L carries M_p / (L - l / 2) at its
end. Elastic, it is the beam. Implicit steps have the tangent of the step as it is computed: the
beam's, with the present forces, and the changes by the fibres (beams/tangent.py). Consequence to
test: the limit moment of a rectangle is Y b h^2 / 4, and its moment beyond yield 1 - (kappa_Y /
kappa)^2 / 3 of it.

References: those of the beam and of beams/fibres.py.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import word
from crashsolve.elements.beams import element, fibres, properties
from crashsolve.elements.beams.corotational import (
    frame_lag,
    half_angle_over_sine,
    mean_frame,
    rotated_rate,
)
from crashsolve.elements.beams.tangent import add_tangent_blocks
from crashsolve.foundation.angles import check_rotation_limit
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import no_tangent
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, scale, sub
from crashsolve.parts import beam

if TYPE_CHECKING:
    from crashsolve.parts._rows.fibre_beam import History, Output, Parameters

STEPWISE = CALLS_MATERIAL = True
IMPLICIT = ("generalized_alpha", "radau_iia_5")
# a row each for the rates of N, M_y and M_z
RATES = 3
MAX_FIBRES = fibres.MAX_FIBRES
TANGENTS = element.TANGENTS + RATES
ORDER, DESCRIPTIONS = 1, beam.DESCRIPTIONS
PARAMETERS = (
    beam.PARAMETERS
    + fibres.SECTION
    + Record("law  index  of the material's law among those of the group")
)
# the material adds the columns of its fibres
HISTORY = beam.HISTORY + fibres.STATE + Record("work  J  plastic work")
OUTPUT = beam.OUTPUT + Record("""
    plastic_strain  1  largest e of the fibres
    plastic_work    J  of the element
""")


class FibreBeam(beam.Beam):
    """Beam whose section is made of fibres that yield; its nodes are bodies."""

    fibres: tuple[int, int] = word(
        "number of fibres along y and z (rectangle), of each wall along y and z (rectangular_tube, "
        "i_section), or of rings and sectors (circle, tube); at most 64 in all",
        default=(4, 16),
    )


def build(card: FibreBeam, scene: Scene) -> list[Columns]:
    """The nodes as bodies."""
    return beam.build(card, scene)


def elements(card: FibreBeam, nodes: list[int], scene: Scene) -> list[Columns]:
    """The elements between neighbours."""
    section, _ = properties.laws(card, scene)
    law, material_card = scene.law("materials", card.material)
    material = law.build(material_card, scene)
    table = fibres.fit(_table(card, scene), section)
    own = fibres.columns(table, material["young"]) | {"material": material}
    return [row | own for row in beam.elements(card, nodes, scene)]


def _table(card: FibreBeam, scene: Scene) -> np.ndarray:
    """Fibres (y, z, A) of the section."""
    law, section = scene.law("sections", card.section)
    if not hasattr(law, "fibres"):
        raise scene.fail("this section has no fibres; give its shape, or type: fibres", "section")
    if min(card.fibres) < 1:
        raise scene.fail("both numbers must be at least 1", "fibres")
    if max(card.fibres) > fibres.MAX_FIBRES:
        raise scene.fail(f"at most {fibres.MAX_FIBRES} fibres in all", "fibres")
    table: np.ndarray = law.fibres(section, card.fibres)
    y, z, A = table.T
    if len(table) > fibres.MAX_FIBRES:
        message = f"makes {len(table)} fibres of this section; at most {fibres.MAX_FIBRES}"
        raise scene.fail(message, "fibres")
    if not ((y * y) @ A > 0.0 and (z * z) @ A > 0.0):
        raise scene.fail(
            "fibres on one line do not resist bending; give at least 2 in each direction", "fibres"
        )
    return table


@kernel
def force(
    p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves, material
):
    """Writes: nodes, new, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame(a, b)
    check_rotation_limit(curves, p.node_b, w)
    strained = element.deformation(p, a, b, R, v, w)
    _, u, theta, u_dot, theta_dot, _, _, _ = strained
    strain, rate = at_section(p, strained)
    load, stored, lost = fibres.resultants(p, old, new, h, curves, strain, rate, material)
    k, k_r = p.stiffness, p.rotational_stiffness
    f, m = (load[0], k[1] * u[1], k[2] * u[2]), (k_r[0] * theta[0], load[1], load[2])
    elastic = k[1] * u[1] * u[1] + k[2] * u[2] * u[2] + k_r[0] * theta[0] * theta[0]
    slow = p.viscosity - p.quadratic_viscosity * min(u_dot[0], 0.0)
    lag = (
        (p.damping * k[0] + slow) * u_dot[0],
        p.damping * k[1] * u_dot[1],
        p.damping * k[2] * u_dot[2],
    )
    rotation = scale(
        p.damping, (k_r[0] * theta_dot[0], k_r[1] * theta_dot[1], k_r[2] * theta_dot[2])
    )
    out.stored = stored * p.length + 0.5 * elastic
    out.power = dot(lag, u_dot) + dot(rotation, theta_dot)
    out.loss = lost * p.length
    new.work = old.work + out.loss
    damped = (add(f, lag), add(m, rotation), slow)
    growth = element.apply_load(p, out, a, b, (R, v, w), strained, damped)
    if not material.VON_MISES:
        growth *= fibres.stiffening(p, old, curves, strain, rate, material)
        a.stiffness += growth * p.rate_a
        b.stiffness += growth * p.rate_b
    element.add_drag(p, out, nodes)
    # other laws leave it at 0
    out.plastic_work, out.plastic_strain = new.work, new.plastic_strain
    new.peak_compression = max(old.peak_compression, -out.force[0])


@kernel
def at_section(p: Parameters, strained):
    """Stretch and bending of the section, and their rates, from element.deformation."""
    _, u, theta, u_dot, theta_dot, _, _, _ = strained
    per = 1.0 / p.length
    strain = (per * u[0], per * theta[1], per * theta[2])
    return strain, (per * u_dot[0], per * theta_dot[1], per * theta_dot[2])


@kernel
def yielding(p: Parameters, old: History, h, curves, strained, material):
    """What fibres have besides K: N, M_y, M_z, and derivatives by e, theta_y, theta_z (6 each).

    Those by the rates of these follow.
    """
    strain, rate = at_section(p, strained)
    lack, by_strain, by_rate = fibres.moduli(p, old, h, curves, strain, rate, material)
    per = 1.0 / p.length
    return lack, fibres.scaled(per, by_strain), fibres.scaled(per, by_rate)


@kernel
def tangent_blocks(p: Parameters, state: History, h, nodes, curves, slot, blocks, material):
    """Tangent by the positions after a step of h. Writes: blocks."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame(a, b)
    strained = element.deformation(p, a, b, R, v, w)
    section = yielding(p, state, h, curves, strained, material)
    add_tangent_blocks(p, section, a, b, (R, v, w), strained, slot, blocks)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first, material):
    """Derivatives of the forces by velocities; for those by positions see tangent_blocks.

    Writes: rows.
    """
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame(a, b)
    element.damping_rows(p, a, b, R, v, w, rows, first)
    first += element.TANGENTS
    for k in range(RATES):
        no_tangent(rows[first + k])
    # yield by von Mises' stress takes its rate from the step, and depends on positions
    if material.VON_MISES:
        return
    strained = element.deformation(p, a, b, R, v, w)
    _, _, by_rate = yielding(p, state, 0.0, curves, strained, material)
    weight, side = fibres.squares(by_rate)
    add_rate_tangent(rows[first], R, v, w, strained, (1.0, side[0], side[1]), weight[0])
    add_rate_tangent(rows[first + 1], R, v, w, strained, (0.0, 1.0, side[2]), weight[1])
    add_rate_tangent(rows[first + 2], R, v, w, strained, (0.0, 0.0, 1.0), weight[2])


@kernel
def add_rate_tangent(row, R, v, w, strained, flow, damping):
    """Tangent of N, M_y and M_z in this proportion. Writes: row."""
    bent = strained[5]
    f, m = scale(flow[0], bent[3]), add_scaled((0.0, flow[1], flow[2]), flow[0], bent[4])
    c = scale(0.5, cross(f, strained[0]))
    m = add(rotated_rate(half_angle_over_sine(v, w), v, m), scale(2.0, frame_lag(v, w, c)))
    element.write_damping_row(row, R, f, sub(m, c), add(m, c), damping)
