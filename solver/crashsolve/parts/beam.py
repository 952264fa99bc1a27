"""Beam: a chain of nodes joined by two-node elements with shear and finite rotations.

    y = R^T (r_b - r_a),   theta = log(A_a^T A_b),   u = (e, y_y, y_z),   e = l_bent - l
    U = (u . K u + theta . K_r theta) / 2,   K = diag(E A / l, k_y, k_z)
    1 / k_y = l^3 / (12 E I_z) + l / (kappa_y G A),   1 / k_z = l^3 / (12 E I_y) + l / (kappa_z G A)
    K_r = diag(G J, E I_y, E I_z) / l

R is half-way between both triads. K and K_r are the exact stiffness of a straight Timoshenko
beam; e is the stretch of the line between the ends with the bending it has (`_bowing.py`), so that
tension resists bending. Forces on the nodes are f = K u and m = K_r theta through the derivatives
of u and theta, so they are the gradient of U. Damping adds beta times the rates of u and theta. A
node is a rigid body with half the mass and rotary inertia of each element beside it. Consequence to
test: a cantilever under a small load bends by P L^3 / (3 E I) + P L / (kappa G A) with one element;
under a moment of 2 pi E I / L it closes to a ring with any number; a taut string of any thinness
has its lateral stiffness.

References: Crisfield (1990), A consistent co-rotational formulation for non-linear,
three-dimensional beam-elements, Computer Methods in Applied Mechanics and Engineering 81, 131-150.
Simo and Vu-Quoc (1986), A three-dimensional finite-strain rod model. Part II: Computational
aspects, the same 58, 79-116.
"""

from math import dist
from typing import Any, Literal

import numpy as np

from crashsolve.deck.card import Card, MaterialName, SectionName, Vec3, quantity, word
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.motion import no_tangent
from crashsolve.foundation.posture import perpendicular, quaternion_of
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import (
    ZERO,
    add,
    add_scaled,
    add_to,
    cross,
    dot,
    matvec,
    matvec_t,
    put,
    scale,
    sub,
    unit,
    vec,
)
from crashsolve.parts import _beam_tangent
from crashsolve.parts._beam_rate import fastest_rate, rate_of_tension
from crashsolve.parts._beam_turn import bend_blocks, slope_of_viscosity
from crashsolve.parts._bowing import bowed, coefficient, stretched
from crashsolve.parts._damping import Damped, brake, coefficients, heavier, report_added
from crashsolve.parts._halfway import half_angle_over_sine, halfway, swing_of, turned_rate

DESCRIPTIONS = ("co-rotational",)
"""How deformation may be described; a study runs over them."""
ORDER = 2
"""Power of the length of elements with which errors fall."""


class Mesh(Card):
    """Nodes on a straight line, at equal distances."""

    shape: Literal["line"] = word("line: from one point to another")
    from_: Vec3 = quantity("m", "first node")
    to: Vec3 = quantity("m", "last node")
    elements: int = word("number of elements", ge=1)
    division: int = word(
        "every element is divided into so many, as crashsolve study does; new nodes follow P_k as "
        "P_k_1, P_k_2, ..., new elements likewise, and the old names stay where they begin",
        default=1,
        ge=1,
    )

    @property
    def count(self) -> int:
        """Number of elements after division."""
        return self.elements * self.division


class Beam(Damped):
    """Beam with shear and finite rotations; its nodes are bodies."""

    mesh: Mesh = word("nodes: P_start, P_1, P_2, ..., P_end of a part P; elements: P_1, P_2, ...")
    section: SectionName = word("cross section")
    material: MaterialName = word("what it is made of")
    side: Vec3 | None = word(
        "direction near the section's y axis; needed where I_y and I_z differ", default=None
    )
    offset: tuple[float, float] = quantity(
        "m", "of the section's centre from the line of nodes, along y and z", default=(0.0, 0.0)
    )
    velocity: Vec3 = quantity("m/s", "at the start, of the first node", default=ZERO)
    angular_velocity: Vec3 = quantity("rad/s", "of the whole, world axes", default=ZERO)

    @property
    def beams(self) -> int:
        """Number of elements."""
        return self.mesh.count

    def node_names(self, part: str) -> list[str]:
        """Names of the nodes of a part of this name."""
        words = ["start", *map(str, range(1, self.mesh.elements))]
        return [*self._divided(part, words), f"{part}_end"]

    def element_names(self, part: str) -> list[str]:
        """Names of its elements."""
        return self._divided(part, [str(k + 1) for k in range(self.mesh.elements)])

    def _divided(self, part: str, words: list[str]) -> list[str]:
        ends = ["", *(f"_{j}" for j in range(1, self.mesh.division))]
        return [f"{part}_{word}{end}" for word in words for end in ends]


PARAMETERS = Record(
    node_a=("index", "first node"),
    node_b=("index", "second node"),
    length=("m", "l"),
    stiffness=("N/m", 3, "diagonal of K"),
    turning_stiffness=("N m/rad", 3, "diagonal of K_r"),
    bowing=("1", 2, "c_y and c_z"),
    damping=("s", "beta"),
    drag_a=("1/s", "alpha, times the element's share in its first node"),
    drag_b=("1/s", "the same of the second"),
    viscosity=("N s/m", "rho A c b_1, of the stretch"),
    quick_viscosity=("N s^2/m^2", "rho A b_2^2, of its square in compression"),
    rate_a=("1/s^2", "largest k times mobility at the first node"),
    rate_b=("1/s^2", "the same at the second"),
    taut_a=("1/(kg m)", "what a tension of 1 N adds to it at the first node"),
    taut_b=("1/(kg m)", "the same at the second"),
)
HISTORY = Record()
TANGENTS = 6
OUTPUT = Record(
    force=("N", 3, "tension, shear along y and z, axes of the element"),
    moment_a=("N m", 3, "torsion, bending about y and z, at the first node"),
    moment_b=("N m", 3, "torsion, bending about y and z, at the second node"),
    strain=("1", 3, "stretch of the bent line, shear along y and z, u / l"),
    curvature=("1/m", 3, "twist, bending about y and z, theta / l"),
)


def build(card: Beam, scene: Any) -> list[dict[str, Any]]:
    """The nodes as bodies."""
    section, material, length = _numbers(card, scene)
    start, end, n = np.asarray(card.mesh.from_), np.asarray(card.mesh.to), card.mesh.count
    quaternion = quaternion_of(_triad(card, section, scene))
    mass, J = halves(card, section, material, length, scene)
    report_added(card, *scaled(card, section, material, np.full(n, length), scene), scene)
    nodes = []
    for k in range(n + 1):
        way, ends = (end - start) * (k / n), 1 if k in (0, n) else 2
        nodes.append(
            {
                "mass": mass * ends,
                "inertia": J * ends,
                "mass_centre": (0.0, *card.offset),
                "position": start + way,
                "quaternion": quaternion,
                "velocity": np.asarray(card.velocity) + np.cross(card.angular_velocity, way),
                "angular_velocity": card.angular_velocity,
            }
        )
    return nodes


def halves(
    card: Any, section: dict[str, Any], material: dict[str, Any], length: float, scene: Any
) -> tuple[float, np.ndarray]:
    """Mass [kg] and inertia (3, 3) [kg m^2] of half an element, axes of the section."""
    mass, factor = scaled(card, section, material, np.array([length]), scene)
    share = 0.5 * float(factor[0]) * length
    return 0.5 * float(mass[0] * factor[0]), share * rotary_inertia(section, material)


def scaled(
    card: Any, section: dict[str, Any], material: dict[str, Any], lengths: np.ndarray, scene: Any
) -> tuple[np.ndarray, np.ndarray]:
    """Masses of elements of these lengths [kg], and the factors by which they are heavier."""
    mass = material["density"] * section["area"] * lengths
    per_length, squares = rotary_inertia(section, material), []
    for length, m in zip(lengths, mass, strict=True):
        row = stiffness_row(section, material, length)
        squares.append(2.0 * fastest_rate(row, 0.5 * m, 0.5 * length * per_length))
    return mass, heavier(card, np.array(squares), scene)


def elements(card: Beam, nodes: list[int], scene: Any) -> list[dict[str, Any]]:
    """The elements between neighbours."""
    section, material, length = _numbers(card, scene)
    half, _ = halves(card, section, material, length, scene)
    row = stiffness_row(section, material, length) | damping_row(card, section, material, scene)
    return [
        row | ends_row(card, row, (a, b), scene, np.eye(3), half)
        for a, b in zip(nodes[:-1], nodes[1:], strict=True)
    ]


def stiffness_row(
    section: dict[str, Any], material: dict[str, Any], length: float
) -> dict[str, Any]:
    """Length and stiffness of an element."""
    E, G, A = material["young"], material["shear"], section["area"]
    I_y, I_z = section["second"]
    shear_y, shear_z = section["shear"]
    k_y = 1.0 / (length**3 / (12.0 * E * I_z) + length / (shear_y * G * A))
    k_z = 1.0 / (length**3 / (12.0 * E * I_y) + length / (shear_z * G * A))
    bending_z, bending_y = E * I_z / length, E * I_y / length
    return {
        "length": length,
        "stiffness": (E * A / length, k_y, k_z),
        "turning_stiffness": (G * section["torsion"] / length, bending_y, bending_z),
        "bowing": (coefficient(k_y, bending_z, length), coefficient(k_z, bending_y, length)),
    }


def damping_row(
    card: Any, section: dict[str, Any], material: dict[str, Any], scene: Any
) -> dict[str, Any]:
    """Damping and viscosity of an element."""
    b_1, b_2_squared = coefficients(card, scene)
    per_length = material["density"] * section["area"]
    speed = np.sqrt(material["young"] / material["density"])
    return {
        "damping": card.damping,
        "viscosity": b_1 * per_length * speed,
        "quick_viscosity": b_2_squared * per_length,
    }


def ends_row(
    card: Any, row: dict[str, Any], nodes: tuple[int, int], scene: Any, T: np.ndarray, half: float
) -> dict[str, Any]:
    """Nodes of an element with half its mass each, drag on them and its bound of the step.

    T are its axes in those of the nodes, as columns.
    """
    ends: dict[str, Any] = {}
    for end, node in zip("ab", nodes, strict=True):
        mass, J = scene.mass[node], T.T @ scene.J[node].reshape(3, 3) @ T
        ends |= {
            f"node_{end}": node,
            f"drag_{end}": card.drag * half / mass,
            f"rate_{end}": fastest_rate(row, mass, J),
            f"taut_{end}": rate_of_tension(row, mass, J),
        }
    return ends


def rotary_inertia(section: dict[str, Any], material: dict[str, Any]) -> np.ndarray:
    """Rotary inertia per length (3, 3), axes of the section [kg m]."""
    R_y, R_z = section.get("rotary", section["second"])
    return material["density"] * np.diag([R_y + R_z, R_y, R_z])


def _numbers(card: Beam, scene: Any) -> tuple[dict[str, Any], dict[str, Any], float]:
    """Section, material and length of an element."""
    length = dist(card.mesh.from_, card.mesh.to) / card.mesh.count
    if not length > 0.0:
        raise scene.fail("begins and ends in one point; a beam needs a length", "mesh.to")
    return *laws(card, scene), length


def laws(card: Any, scene: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Section and material of a card."""
    law, material_card = scene.law("materials", card.material)
    is_fibrous, word = hasattr(card, "fibres"), law.__name__.rpartition(".")[2]
    if word != ("elastoplastic" if is_fibrous else "elastic"):
        advice = "say type: beam" if is_fibrous else "say type: fibre_beam for one that yields"
        wanted = "elastoplastic" if is_fibrous else "elastic"
        raise scene.fail(f"needs a material of type {wanted}; or {advice}", "material")
    if is_fibrous:
        # nodes are built before curves are; what yields is the fibres' business
        material_card = material_card.model_copy(update={"curve": None})
    material = law.build(material_card, scene)
    law, section_card = scene.law("sections", card.section)
    return law.build(section_card, material["poisson"]), material


def _triad(card: Beam, section: dict[str, Any], scene: Any) -> np.ndarray:
    """Axes of the section at the start as columns: along the beam, y, z."""
    along = scene.unit(np.subtract(card.mesh.to, card.mesh.from_), "mesh.to")
    return axes_of(card, along, section, scene)


def axes_of(card: Any, along: np.ndarray, section: dict[str, Any], scene: Any) -> np.ndarray:
    """Axes of the section of an element as columns: along it, y, z."""
    if card.side is None:
        I_y, I_z = section["second"]
        if abs(I_y - I_z) > 1e-9 * I_z:
            message = "this section bends more easily one way: say where its y axis points"
            raise scene.fail(message, "section")
        side = perpendicular(along)
    else:
        side = scene.unit(card.side, "side")
        across = side - along * float(along @ side)
        if np.linalg.norm(across) < 1e-6:
            raise scene.fail("points along the beam; give a direction across it", "side")
        side = scene.unit(across, "side")
    return np.column_stack([along, side, np.cross(along, side)])


def forces_by_motions(p: Any, nodes: Any) -> np.ndarray:
    """Derivatives (n, 12, 12) of the forces on both nodes of all elements at rest."""
    a, b = nodes[p["node_a"]], nodes[p["node_b"]]
    return _beam_tangent.forces_by_motions(p, a["q"], b["q"], b["r"] - a["r"])


@kernel
def force(p, old, new, out, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = halfway(a, b)
    pull(p, out, a, b, R, v, w)
    drag(p, out, nodes)


@kernel
def pull(p, out, a, b, R, v, w):
    """Forces on the nodes a and b of an element whose frame is R. Writes: a, b, out."""
    strained = deformation(p, a, b, R, v, w)
    _, u, theta, u_dot, theta_dot, _, _ = strained
    f, energy, power = answer(p.stiffness, p.damping, u, u_dot)
    slow = p.viscosity - p.quick_viscosity * min(u_dot[0], 0.0)
    f, power = (f[0] + slow * u_dot[0], f[1], f[2]), power + slow * u_dot[0] * u_dot[0]
    m, bending, turning = answer(p.turning_stiffness, p.damping, theta, theta_dot)
    out.stored = energy + bending
    out.power = power + turning
    out.loss = 0.0
    act(p, out, a, b, R, v, w, strained, f, m, slow)


@kernel
def deformation(p, a, b, R, v, w):
    """y, u, theta, rates of u and theta, slopes of the stretch (_bowing.stretched), rate of y."""
    eta = half_angle_over_sine(v, w)
    y = matvec_t(R, sub(vec(b.r), vec(a.r)))
    spin = matvec_t(R, sub(vec(b.w), vec(a.w)))
    mean = scale(0.5, matvec_t(R, add(vec(a.w), vec(b.w))))
    theta, theta_dot = scale(2.0 * eta, v), turned_rate(eta, v, spin)
    y_dot = matvec_t(R, sub(vec(b.v), vec(a.v)))
    y_dot = sub(y_dot, cross(sub(mean, swing_of(v, w, spin)), y))
    e, bent = stretched(p, y, theta)
    e_dot = dot(bent[3], y_dot) + dot(bent[4], theta_dot)
    u, u_dot = (e, y[1], y[2]), (e_dot, y_dot[1], y_dot[2])
    return y, u, theta, u_dot, theta_dot, bent, y_dot


@kernel
def act(p, out, a, b, R, v, w, strained, f, m, slow):
    """The force f and the moments m, which belong to u and theta, on both nodes.

    Writes: a, b, out.
    """
    y, u, theta, _, _, bent, _ = strained
    eta, tension = half_angle_over_sine(v, w), f[0]
    f = add_scaled((0.0, f[1], f[2]), tension, bent[3])
    m = add_scaled(m, tension, bent[4])
    # the force acts in both nodes; half of its moment about the other falls to each
    c = scale(0.5, cross(f, y))
    m = add(turned_rate(eta, v, m), scale(2.0, swing_of(v, w, c)))
    put(out.force, f)
    put(out.moment_a, sub(m, c))
    put(out.moment_b, add(m, c))
    put(out.strain, scale(1.0 / p.length, u))
    put(out.curvature, scale(1.0 / p.length, theta))
    f = matvec(R, f)
    add_to(a.force, f)
    add_to(a.torque, matvec(R, sub(m, c)))
    add_to(b.force, scale(-1.0, f))
    add_to(b.torque, matvec(R, scale(-1.0, add(m, c))))
    # rows of a bent or stretched element are longer than those of a straight one; that of its
    # stretch gains what twice the tension of its bow would add
    growth = eta**4 * max(1.0, dot(y, y) / (p.length * p.length))
    bow, taut = 2.0 * growth * bowed(y, theta, bent), growth * max(tension, 0.0)
    tell(p, a, growth * p.rate_a, bow * p.taut_a, taut * p.taut_a, slow)
    tell(p, b, growth * p.rate_b, bow * p.taut_b, taut * p.taut_b, slow)


@kernel
def drag(p, out, nodes):
    """Drag on both nodes. Writes: nodes, out."""
    if p.drag_a > 0.0:
        out.power += brake(nodes, p.node_a, p.drag_a) + brake(nodes, p.node_b, p.drag_b)


@kernel
def answer(stiffness, damping, x, x_dot):
    """Force K (x + beta x_dot), stored energy and power lost."""
    k = vec(stiffness)
    f = (k[0] * x[0], k[1] * x[1], k[2] * x[2])
    lag = (damping * k[0] * x_dot[0], damping * k[1] * x_dot[1], damping * k[2] * x_dot[2])
    return add(f, lag), 0.5 * dot(f, x), dot(lag, x_dot)


@kernel
def tell(p, body, rate, bow, taut, viscosity):
    """Tell the step control of an element, of its bow over E A / l, and of its tension.

    Writes: body.
    """
    strained = rate + p.stiffness[0] * bow
    body.stiffness += strained + taut
    body.damping += p.damping * strained + viscosity * (body.mass_inv + bow)


@kernel
def tangent(p, state, nodes, curves, rows, first):
    """By the velocities; by the places see bend. Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = halfway(a, b)
    yield_rows(p, a, b, R, v, w, rows, first)


@kernel
def bend(p, state, nodes, curves, place, blocks):
    """Tangent by the places. Writes: blocks."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = halfway(a, b)
    strained = deformation(p, a, b, R, v, w)
    bend_blocks(p, None, a, b, R, v, w, strained, place, blocks)


@kernel
def yield_rows(p, a, b, R, v, w, rows, first):
    """Rows of the damping of an element whose frame is R. Writes: rows."""
    for k in range(TANGENTS):
        no_tangent(rows[first + k])
    if not (p.damping > 0.0 or p.viscosity > 0.0 or p.quick_viscosity > 0.0):
        return
    eta = half_angle_over_sine(v, w)
    y, _, _, u_dot, _, bent, _ = deformation(p, a, b, R, v, w)
    for k in range(3):
        e = bent[3] if k == 0 else unit(k)
        c = scale(0.5, cross(e, y))
        m = scale(2.0, swing_of(v, w, c))
        if k == 0:
            m = add(m, turned_rate(eta, v, bent[4]))
        damp(rows[first + k], R, e, sub(m, c), add(m, c), p.damping * p.stiffness[k])
        m = turned_rate(eta, v, unit(k))
        damp(rows[first + 3 + k], R, ZERO, m, m, p.damping * p.turning_stiffness[k])
    rows[first].damping += slope_of_viscosity(p, u_dot[0])


@kernel
def damp(row, R, f, m_a, m_b, damping):
    """Tangent of a unit force f with moments m_a and m_b at the ends, axes of R. Writes: row."""
    f, m_a, m_b = matvec(R, f), matvec(R, m_a), matvec(R, m_b)
    for k in range(3):
        row.D[k], row.D[6 + k] = f[k], -f[k]
        row.D[3 + k], row.D[9 + k] = m_a[k], -m_b[k]
    for k in range(12):
        row.G[k] = 0.0
    row.damping = damping
