"""Tyre of Gim and Nikravesh: a brush with parabolic pressure and comprehensive slip.

    S_n = |(C_x s_x, C_y s_y)| / (3 mu F_z),   l_n = 1 - S_n (0 at full sliding)
    F   = (C_x s_x, C_y s_y) l_n^2 + mu F_z (1 - 3 l_n^2 + 2 l_n^3) s / |s|
    M_z = -[C_y s_y (2 l_n / 3 - 1 / 2) + 3 / 2 mu_y F_z S_n^2] l l_n^2

with the slips s of `_tyre.py`; the camber gamma takes C_gamma sin(gamma) / C_y from s_y, and mu
falls with the slip from friction_max to friction_min. Consequences to test: dF/ds = C at zero,
|F| <= mu F_z, and along one direction |F| = mu F_z (1 - l_n^3).

References: Ambrosio (2003), section 5.3; Gim and Nikravesh (1990, 1991), International Journal of
Vehicle Design 11, 589-618; 12, 19-39; 12, 217-228.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from crashsolve.foundation.kernels import kernel
from crashsolve.tyres._carcass import grip_of
from crashsolve.tyres._road import mesh_tables, record_double
from crashsolve.tyres._tyre import (
    CARCASS,
    FORCES_OF_TYRE,
    OUT_OF_RANGE,
    TYRE,
    TyreCard,
    apply_patch_forces,
    bound_step,
    patch_length,
    patch_of,
    reset,
    show,
    tyre_columns,
)

if TYPE_CHECKING:
    from crashsolve.tyres._rows.gim import History, Output, Parameters

STEPWISE = True


class Gim(TyreCard):
    """Tyre with combined slip, camber, aligning and overturning moments."""


PARAMETERS, HISTORY, OUTPUT = TYRE, CARCASS, FORCES_OF_TYRE
WARNINGS = OUT_OF_RANGE
build, shared_tables = tyre_columns, mesh_tables


@kernel
def brush(C_x, C_y, s_x, s_y, mu, F_z, length):
    """F_x, F_y [N], M_z [N m] and S_n, 1 at full sliding."""
    q_x, q_y = C_x * s_x, C_y * s_y
    s = sqrt(s_x * s_x + s_y * s_y)
    if s == 0.0 or F_z <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    S_n = min(sqrt(q_x * q_x + q_y * q_y) / (3.0 * mu * F_z), 1.0)
    l_n = 1.0 - S_n
    stick, friction = l_n * l_n, mu * F_z / s
    slide = friction * (1.0 - stick * (3.0 - 2.0 * l_n))
    twist = q_y * (2.0 / 3.0 * l_n - 0.5) + 1.5 * friction * s_y * S_n * S_n
    return (
        q_x * stick + slide * s_x,
        q_y * stick + slide * s_y,
        -twist * length * stick,
        S_n,
    )


@kernel
def carcass_energy(p: Parameters, grip):
    """Work of the brush over the deflection from rest to (q_x, q_y), straight there [J]."""
    s_x, s_y = grip.q_x / p.sigma_x, grip.q_y / p.sigma_y
    s = sqrt(s_x * s_x + s_y * s_y)
    if s == 0.0:
        return 0.0
    most = grip.mu * grip.F_z
    a = sqrt((p.C_x * s_x) ** 2 + (p.C_y * s_y) ** 2) / (3.0 * most)
    # up to the share of the patch from which on all slides
    t = min(1.0, 1.0 / a)
    b = a * t
    stick = p.C_x * s_x * grip.q_x + p.C_y * s_y * grip.q_y
    along = most * (s_x * grip.q_x + s_y * grip.q_y) / s
    stick *= t * t * (0.5 - 2.0 / 3.0 * b + 0.25 * b * b)
    return stick + along * (t * b * b * (1.0 - 0.5 * b) + 1.0 - t)


@kernel
def roll(p: Parameters, old: History, new: History, out: Output, h, nodes, curves, data):
    """All roads of a tyre. Writes: nodes, new, out."""
    reset(p, new, out)
    before = (0.0, 0.0, 0.0)
    for i in range(p.roads):
        at = patch_of(p, i, nodes, curves, data)
        grip = grip_of(p, i, old, new, out, at, h, curves)
        if grip.F_z > 0.0:
            record_double(new, at.n, before)
            before = at.n
            length = patch_length(p, at)
            F_x, F_y, M_z, S_n = brush(p.C_x, p.C_y, grip.s_x, grip.s_y, grip.mu, grip.F_z, length)
            M_z *= at.sense
            store = carcass_energy(p, grip)
            apply_patch_forces(p, i, old, new, out, h, nodes, at, grip, (F_x, F_y), M_z, store)
            show(out, at, grip, (F_x, F_y), M_z, S_n)
    if out.normal == 0.0:
        bound_step(p, nodes, curves, data)


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    roll(p, old, new, out, h, nodes, curves, None)


@kernel
def force_with_tables(
    p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves, data
):
    """Apply the tyre forces where some roads are meshes. Writes: nodes, new, out."""
    roll(p, old, new, out, h, nodes, curves, data)
