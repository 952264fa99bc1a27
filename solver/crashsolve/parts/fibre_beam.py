"""Fibre beam: the beam whose section yields, fibre by fibre.

    N, M_y, M_z from fibres (_fibres.py) with eps_0 = u_x / l, kappa = theta / l
    V_y = k_y u_y,   V_z = k_z u_z,   M_x = G J theta_x / l

at the one point of an element, its middle. Shear and torsion are elastic, and torsion is free of
warping; so is what varies along the element (the term l^3 / 12 E I of the beam). A hinge forms in
the middle of an element: a cantilever of length L bears M_p / (L - l / 2) at its end. Elastic, it
is the beam. Consequence to test: the limit moment of a rectangle is Y b h^2 / 4, and its moment
beyond yield 1 - (kappa_Y / kappa)^2 / 3 of it.

References: those of the beam and of _fibres.py.
"""

from typing import Any

import numpy as np

from crashsolve.deck.card import word
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, dot, scale
from crashsolve.parts import _fibres, beam
from crashsolve.parts._halfway import halfway

STEPWISE = True
ORDER, DESCRIPTIONS = 1, beam.DESCRIPTIONS
PARAMETERS = beam.PARAMETERS + Record(
    count=("count", "fibres"),
    y=("m", _fibres.MOST_FIBRES, "places along y of the section"),
    z=("m", _fibres.MOST_FIBRES, "places along z of the section"),
    area=("m^2", _fibres.MOST_FIBRES, "areas"),
    young=("Pa", "E"),
    yield_stress=("Pa", "Y_0"),
    isotropic=("Pa", "(1 - beta) H"),
    kinematic=("Pa", "beta H"),
    curve=("index", "Y over plastic strain; 0 for none"),
    rate_D=("1/s", "D of Cowper and Symonds; 0 for none"),
    rate_q=("1", "q of Cowper and Symonds"),
)
HISTORY = Record(
    stress=("Pa", _fibres.MOST_FIBRES, "of the fibres"),
    plastic=("1", _fibres.MOST_FIBRES, "plastic strain"),
    hardening=("1", _fibres.MOST_FIBRES, "e, sum of the sizes of its steps"),
    work=("J", "plastic work"),
)
OUTPUT = beam.OUTPUT + Record(
    plastic_strain=("1", "largest e of the fibres"),
    plastic_work=("J", "of the element"),
)
COLUMNS = ("yield_stress", "isotropic", "kinematic", "curve", "rate_D", "rate_q", "young")


class FibreBeam(beam.Beam):
    """Beam whose section is made of fibres that yield; its nodes are bodies."""

    fibres: tuple[int, int] = word(
        "so many along y and z (rectangle), of each wall along y and z (rectangular_tube, "
        "i_section), rings and sectors (circle, tube); at most 64 in all",
        default=(4, 16),
    )


def build(card: FibreBeam, scene: Any) -> list[dict[str, Any]]:
    """The nodes as bodies."""
    return beam.build(card, scene)


def elements(card: FibreBeam, nodes: list[int], scene: Any) -> list[dict[str, Any]]:
    """The elements between neighbours."""
    section, _ = beam.laws(card, scene)
    law, material_card = scene.law("materials", card.material)
    material = law.build(material_card, scene)
    y, z, area = _fibres.fit(_table(card, scene), section)
    room = np.zeros(_fibres.MOST_FIBRES - len(y))
    own = {name: material[name] for name in COLUMNS} | {"count": len(y)}
    own |= {"y": np.append(y, room), "z": np.append(z, room), "area": np.append(area, room)}
    return [row | own for row in beam.elements(card, nodes, scene)]


def _table(card: FibreBeam, scene: Any) -> np.ndarray:
    """Fibres (y, z, A) of the section."""
    law, section = scene.law("sections", card.section)
    if not hasattr(law, "fibres"):
        raise scene.fail("this section has no fibres; give its shape, or type: fibres", "section")
    if min(card.fibres) < 1:
        raise scene.fail("needs numbers of 1 at least", "fibres")
    table: np.ndarray = law.fibres(section, card.fibres)
    y, z, A = table.T
    if len(table) > _fibres.MOST_FIBRES:
        message = f"makes {len(table)} fibres of this section; at most {_fibres.MOST_FIBRES}"
        raise scene.fail(message, "fibres")
    if not ((y * y) @ A > 0.0 and (z * z) @ A > 0.0):
        raise scene.fail("fibres on one line do not resist bending; give 2 at least", "fibres")
    return table


@kernel
def force(p, old, new, out, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = halfway(a, b)
    y, u, theta, u_dot, theta_dot = beam.deformation(p, a, b, R, v, w)
    per = 1.0 / p.length
    N, M_y, M_z, stored, lost = _fibres.resultants(
        p, old, new, h, curves,
        (per * u[0], per * theta[1], per * theta[2]),
        (per * u_dot[0], per * theta_dot[1], per * theta_dot[2]),
    )  # fmt: skip
    k, k_r = p.stiffness, p.turning_stiffness
    f, m = (N, k[1] * u[1], k[2] * u[2]), (k_r[0] * theta[0], M_y, M_z)
    elastic = k[1] * u[1] * u[1] + k[2] * u[2] * u[2] + k_r[0] * theta[0] * theta[0]
    slow = p.viscosity - p.quick_viscosity * min(u_dot[0], 0.0)
    lag = (
        (p.damping * k[0] + slow) * u_dot[0],
        p.damping * k[1] * u_dot[1],
        p.damping * k[2] * u_dot[2],
    )
    turn = scale(p.damping, (k_r[0] * theta_dot[0], k_r[1] * theta_dot[1], k_r[2] * theta_dot[2]))
    out.stored = stored * p.length + 0.5 * elastic
    out.power = dot(lag, u_dot) + dot(turn, theta_dot)
    out.loss = lost * p.length
    new.work = old.work + out.loss
    beam.act(p, out, a, b, R, v, w, y, theta, add(f, lag), add(m, turn), slow)
    beam.drag(p, out, nodes)
    out.plastic_work, out.plastic_strain = new.work, 0.0
    for i in range(p.count):
        out.plastic_strain = max(out.plastic_strain, new.hardening[i])
