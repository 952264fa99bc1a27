"""Spring between two rigid segments of a beam, with the beam's stiffness, and a hinge that yields.

    u = R^T (x_b - x_a),   theta = log(A_a^T A_b),   R half-way between both triads
    f = K (u - u_p),   m = K_r (theta - theta_p)
    K = diag(E A / l, k_y, k_z),   K_r = diag(G J, E I_y, E I_z) / l
    1 / k_y = l^3 / (12 E I_z) + l / (kappa_y G A),   1 / k_z = l^3 / (12 E I_y) + l / (kappa_z G A)

of a beam of the length l, cut in its middle, each half of which has become rigid; x_a and x_b are
the two sides of the cut. Shear, and the change of moments along l, bend one spring: so a straight
chain of any number of segments has the elastic stiffness of Timoshenko's beam. A material that
yields limits tension and both moments together,

    (N / A)^2 + (M_y / Z_y)^2 + (M_z / Z_z)^2 <= Y(e)^2 (1 + (rate / D)^(1/q))^2

with plastic flow at right angles to this surface and e the mean plastic strain, plastic work over
Y A l, which grows at this rate. Z are the plastic moduli; shear and torsion stay elastic. A hinge
forms in the middle of l.
The ellipse stands for sections of any shape: that of a rectangle is |M| / M_p + (N / N_p)^2 = 1.
Consequence to test: forces are the gradient of the energy in any configuration; a spring that is
bent alone flows at Z Y.

References: Huston (1981), Multi-body dynamics including the effects of flexibility and compliance,
Computers and Structures 14, 443-451. Winget and Huston (1976), Cable dynamics - a finite segment
approach, Computers and Structures 6, 475-480. Powell and Chen (1986), ASCE J. Eng. Mech. 112,
627-641 (the ellipse). Simo and Hughes (1998), Computational Inelasticity, 3 (return to it).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import MaterialName, SectionName, Vec3, quantity, word
from crashsolve.elements.beams.corotational import (
    frame_lag,
    half_angle_over_sine,
    mean_frame_of,
    rotated_rate,
)
from crashsolve.elements.beams.fibres import squares
from crashsolve.foundation.angles import axes_at, check_rotation_limit
from crashsolve.foundation.columns import matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    apply_force,
    apply_torque,
    arm,
    mobility,
    relative,
    spin_mobility,
)
from crashsolve.foundation.orientation import quaternion_of
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import (
    ZERO,
    Vector,
    add,
    add_scaled,
    cross,
    dot,
    put,
    scale,
    sub,
    unit,
    vec,
)
from crashsolve.sections._plastic import plastic_moduli
from crashsolve.springs._between import POINTS
from crashsolve.springs._card import PointSpringCard
from crashsolve.springs._segment_statics import forces_by_motions, load_factor_to_yield, predict
from crashsolve.springs._segment_yield import (
    FLOWS,
    NO_STEP,
    factor_of,
    growth,
    resisting,
    softened,
)

if TYPE_CHECKING:
    from crashsolve.springs._rows.segment import History, Output, Parameters

__all__ = ["forces_by_motions", "predict", "load_factor_to_yield"]

STEPWISE = True
IMPLICIT = ("generalized_alpha", "radau_iia_5")
TANGENTS = 6
# of a side to the axis, across which it has no direction then; of both ends, over l
CLOSE_ENOUGH = 1e-6


class Segment(PointSpringCard):
    """Spring between two rigid segments of a beam, with the beam's stiffness; it yields."""

    axis: Vec3 = word("direction of the beam, in the frame of a")
    side: Vec3 = word("direction near the section's y axis, in the frame of a")
    length: float = quantity("m", "l, of the beam that the spring represents", gt=0)
    section: SectionName = word("cross section of the beam")
    material: MaterialName = word("material: elastic, or elastoplastic, which yields")
    damping: float = quantity("s", "beta, damping over stiffness", default=0.0, ge=0)
    buckling_load: float | None = quantity(
        "N", "compression along the beam above which the run warns at its end", default=None, gt=0
    )


PARAMETERS = POINTS + Record("""
    rotation_a            1        4  unit quaternion, axes of the beam to those of a
    rotation_b            1        4  the same for b
    length                m           l
    stiffness             N/m      3  diagonal of K
    rotational_stiffness  N m/rad  3  diagonal of K_r
    damping               s           beta
    moduli                any      3  A, Z_y, Z_z
    volume                m^3         A l
    yields                flag        whether the material yields
    yield_stress          Pa          Y_0
    isotropic             Pa          H
    curve                 index       Y over e; 0 for none
    rate_D                1/s         D of Cowper and Symonds; 0 for none
    rate_q                1           q of Cowper and Symonds
    buckling              N           compression to warn of; infinite if there is none
    at_rest               flag        NO_STEP, FLOWS or FROZEN, in load steps
""")
HISTORY = Record("""
    plastic           any  3  u_p along the beam, theta_p about y and z
    resultant         any  3  N, M_y, M_z
    strain            1       e
    work              J       plastic work
    peak_compression  N       largest compression along the beam so far
""")
OUTPUT = Record("""
    force           N    3  tension, shear along y and z, axes of the beam
    moment          N m  3  torsion, bending about y and z, in the middle
    displacement    m    3  u
    angle           rad  3  theta
    plastic_angle   rad  2  theta_p about y and z
    plastic_strain  1       e, mean over the section
    plastic_work    J       so far
""")


def build(card: Segment, scene: Scene) -> Columns:
    section, material, moduli = _laws(card, scene)
    ends, T = _ends(card, scene), _triad(card, scene)
    a, b = ends["node_a"], ends["node_b"]
    in_b = scene.matrix(b).T @ scene.matrix(a) @ T
    E, G, A, length = material["young"], material["shear"], section["area"], card.length
    I_y, I_z = section["second"]
    shear_y, shear_z = section["shear"]
    return ends | {
        "rotation_a": quaternion_of(T),
        "rotation_b": quaternion_of(in_b),
        "length": length,
        "stiffness": (
            E * A / length,
            1.0 / (length**3 / (12.0 * E * I_z) + length / (shear_y * G * A)),
            1.0 / (length**3 / (12.0 * E * I_y) + length / (shear_z * G * A)),
        ),
        "rotational_stiffness": (
            G * section["torsion"] / length,
            E * I_y / length,
            E * I_z / length,
        ),
        "damping": card.damping,
        "moduli": moduli,
        "volume": A * length,
        "yields": "yield_stress" in material,
        "yield_stress": material.get("yield_stress", 0.0),
        "isotropic": material.get("isotropic", 0.0),
        "curve": material.get("curve", 0),
        "rate_D": material.get("rate_D", 0.0),
        "rate_q": material.get("rate_q", 1.0),
        "buckling": card.buckling_load or np.inf,
        "at_rest": FLOWS if scene.deck.control.solution == "quasi_static" else NO_STEP,
    }


def _ends(card: Segment, scene: Scene) -> Columns:
    """Both sides of the cut, which must be in one position at the start."""
    ends: Columns = scene.attachments(card)
    if (apart := scene.distance(ends)) > CLOSE_ENOUGH * card.length:
        message = f"is {apart:.3g} m from at_a at the start; they are two sides of one cut"
        raise scene.fail(message, "at_b")
    return ends


def _laws(card: Segment, scene: Scene) -> tuple[Columns, Columns, tuple[float, ...]]:
    """Constants of section and material, and A, Z_y, Z_z."""
    law, material_card = scene.law("materials", card.material)
    kind = law.__name__.rpartition(".")[2]
    if kind not in ("elastic", "elastoplastic"):
        raise scene.fail("needs a material of type elastic or elastoplastic", "material")
    for field in ("kinematic", "failure_strain"):
        if getattr(material_card, field, None):
            message = f"material '{card.material}' has {field}, which a segment does not follow"
            raise scene.fail(f"{message}; take fibre beams or shells for it", "material")
    material = law.build(material_card, scene)
    law, section_card = scene.law("sections", card.section)
    section = law.build(section_card, material["poisson"])
    if kind == "elastic":
        return section, material, (1.0, 1.0, 1.0)
    if not hasattr(law, "fibres"):
        raise scene.fail("a section without a shape has no plastic modulus", "section")
    return section, material, (section["area"], *plastic_moduli(law, section_card))


def _triad(card: Segment, scene: Scene) -> np.ndarray:
    """Axes of the beam as columns, in the frame of a."""
    axis, side = scene.unit(card.axis, "axis"), scene.unit(card.side, "side")
    across = side - axis * float(axis @ side)
    if np.linalg.norm(across) < CLOSE_ENOUGH:
        raise scene.fail("points along the beam; give a direction across it", "side")
    side = scene.unit(across, "side")
    return np.column_stack([axis, side, np.cross(axis, side)])


class Deformation(NamedTuple):
    """Deformation of a spring, in axes of the beam but for R and the arms."""

    R: tuple[float, ...]  # mean triad, v and w of corotational.py
    v: Vector
    w: float
    d_a: Vector  # arms of both sides [m], world axes
    d_b: Vector
    u: Vector  # stretch and shear [m]
    theta: Vector  # twist and bends [rad]
    u_dot: Vector
    theta_dot: Vector


@kernel
def deformation_of(p: Parameters, nodes):
    """Deformation of the spring and its rates."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w = mean_frame_of(axes_at(a, p.rotation_a), axes_at(b, p.rotation_b))
    d_a, d_b = arm(a, vec(p.point_a)), arm(b, vec(p.point_b))
    x, x_dot = relative(a, d_a, b, d_b)
    eta, spin = half_angle_over_sine(v, w), matvec_t(R, sub(vec(b.w), vec(a.w)))
    mean = scale(0.5, matvec_t(R, add(vec(a.w), vec(b.w))))
    u = matvec_t(R, x)
    u_dot = sub(matvec_t(R, x_dot), cross(sub(mean, frame_lag(v, w, spin)), u))
    return Deformation(R, v, w, d_a, d_b, u, scale(2.0 * eta, v), u_dot, rotated_rate(eta, v, spin))


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    deformation = deformation_of(p, nodes)
    u, theta, u_dot, theta_dot = (
        deformation.u,
        deformation.theta,
        deformation.u_dot,
        deformation.theta_dot,
    )
    check_rotation_limit(curves, p.node_b, deformation.w)
    k, k_r = vec(p.stiffness), vec(p.rotational_stiffness)
    q = (u[0], theta[1], theta[2])
    resultant, stored, lost = resisting(p, old, new, h, q, curves)
    f = (resultant[0], k[1] * u[1], k[2] * u[2])
    m = (k_r[0] * theta[0], resultant[1], resultant[2])
    elastic = f[1] * u[1] + f[2] * u[2] + m[0] * theta[0]
    lag = scale(p.damping, (k[0] * u_dot[0], k[1] * u_dot[1], k[2] * u_dot[2]))
    drag = scale(p.damping, (k_r[0] * theta_dot[0], k_r[1] * theta_dot[1], k_r[2] * theta_dot[2]))
    out.stored = stored + 0.5 * elastic
    out.power = dot(lag, u_dot) + dot(drag, theta_dot)
    out.loss = lost
    new.work = old.work + lost
    f, m = add(f, lag), add(m, drag)
    new.peak_compression = max(old.peak_compression, -f[0])
    put(out.force, f)
    put(out.moment, m)
    put(out.displacement, u)
    put(out.angle, theta)
    out.plastic_angle[0], out.plastic_angle[1] = new.plastic[1], new.plastic[2]
    out.plastic_strain, out.plastic_work = new.strain, new.work
    act(p, nodes, deformation, f, m)
    report(p, nodes, deformation)


@kernel
def act(p: Parameters, nodes, deformation, f, m):
    """The force f and the moments m, which belong to u and theta, on both bodies. Writes: nodes."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    R, v, w, c = deformation.R, deformation.v, deformation.w, cross(deformation.u, f)
    m = sub(rotated_rate(half_angle_over_sine(v, w), v, m), frame_lag(v, w, c))
    pull = matvec(R, f)
    apply_force(a, pull, deformation.d_a)
    apply_force(b, scale(-1.0, pull), deformation.d_b)
    apply_torque(a, matvec(R, add_scaled(m, 0.5, c)))
    apply_torque(b, matvec(R, add_scaled(scale(-1.0, m), 0.5, c)))


@kernel
def report(p: Parameters, nodes, deformation):
    """Report all six directions to the step control. Writes: nodes."""
    a, b, R = nodes[p.node_a], nodes[p.node_b], deformation.R
    # rows of a bent spring are longer than those of a straight one, and end half-way between
    growth, gap = (
        half_angle_over_sine(deformation.v, deformation.w) ** 2,
        scale(0.5, matvec(R, deformation.u)),
    )
    at_a, at_b = add(deformation.d_a, gap), sub(deformation.d_b, gap)
    for k in range(3):
        e = (R[k], R[3 + k], R[6 + k])
        stiffness, rotational = p.stiffness[k], growth * p.rotational_stiffness[k]
        add_stiffness_bound(a, mobility(a, at_a, e), stiffness, p.damping * stiffness)
        add_stiffness_bound(b, mobility(b, at_b, e), stiffness, p.damping * stiffness)
        add_stiffness_bound(a, spin_mobility(a, e), rotational, p.damping * rotational)
        add_stiffness_bound(b, spin_mobility(b, e), rotational, p.damping * rotational)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Tangent of the forces by positions and velocities, without the rotation of the forces.

    Writes: rows.
    """
    deformation = deformation_of(p, nodes)
    u, theta, u_dot, theta_dot = (
        deformation.u,
        deformation.theta,
        deformation.u_dot,
        deformation.theta_dot,
    )
    k = (p.stiffness[0], p.rotational_stiffness[1], p.rotational_stiffness[2])
    trial = (
        k[0] * (u[0] - state.plastic[0]),
        k[1] * (theta[1] - state.plastic[1]),
        k[2] * (theta[2] - state.plastic[2]),
    )
    flow, share, factor = 0.0, 0.0, 1.0
    if p.yields == 1:
        factor = factor_of(p, (u_dot[0], theta_dot[1], theta_dot[2]))
        # of a step of unknown length: the rate of the whole strain stands for that of the flow
        flow, share = growth(p, k, trial, state.strain, factor, 0.0, curves)
    for i in range(3):
        k_u, k_t = p.stiffness[i], p.rotational_stiffness[i]
        shear_row(rows[first + i], deformation, i)
        rotation_row(rows[first + 3 + i], deformation, i)
        rows[first + i].stiffness, rows[first + 3 + i].stiffness = k_u, k_t
        rows[first + i].damping, rows[first + 3 + i].damping = p.damping * k_u, p.damping * k_t
    if flow > 0.0:
        # in place of N, M_y and M_z three mixtures of them; their damping is left to iteration
        left = softened(p, k, trial, flow, share, state.strain, factor, curves)
        weight, mixed = squares(left)
        combined_row(rows, first, 1.0, mixed[0], mixed[1], rows[first], weight[0])
        combined_row(rows, first, 0.0, 1.0, mixed[2], rows[first + 4], weight[1])
        rows[first + 5].stiffness, rows[first + 5].damping = weight[2], 0.0


@kernel
def combined_row(rows, first, stretch, about_y, about_z, own, stiffness):
    """Row of N, M_y and M_z in this proportion. Writes: own."""
    N, M_y, M_z = rows[first], rows[first + 4], rows[first + 5]
    for j in range(12):
        own.D[j] = stretch * N.D[j] + about_y * M_y.D[j] + about_z * M_z.D[j]
    own.stiffness, own.damping = stiffness, 0.0


@kernel
def shear_row(row, deformation, k):
    """Derivative of -u_k by the motions of both bodies. Writes: row."""
    e = unit(k)
    c = cross(deformation.u, e)
    m = scale(-1.0, frame_lag(deformation.v, deformation.w, c))
    write(row, deformation.R, e, add_scaled(m, 0.5, c), add_scaled(scale(-1.0, m), 0.5, c))
    pull = matvec(deformation.R, e)
    rotation_a, rotation_b = cross(deformation.d_a, pull), cross(deformation.d_b, pull)
    for j in range(3):
        row.D[3 + j] += rotation_a[j]
        row.D[9 + j] -= rotation_b[j]


@kernel
def rotation_row(row, deformation, k):
    """Derivative of -theta_k by the rotations of both bodies. Writes: row."""
    m = rotated_rate(half_angle_over_sine(deformation.v, deformation.w), deformation.v, unit(k))
    write(row, deformation.R, ZERO, m, scale(-1.0, m))


@kernel
def write(row, R, f, m_a, m_b):
    """Force f with moments m_a and m_b on both ends, axes of R. Writes: row."""
    f, m_a, m_b = matvec(R, f), matvec(R, m_a), matvec(R, m_b)
    for j in range(3):
        row.D[j], row.D[6 + j] = f[j], -f[j]
        row.D[3 + j], row.D[9 + j] = m_a[j], m_b[j]
    for j in range(12):
        row.G[j] = 0.0
