"""Tyre of Fiala: curves of its own along and across the wheel, of the size s of the whole slip.

    F_y = mu F_z (1 - H^3) s_y / s,   H = 1 - C_y s / (3 mu F_z), not below 0
    F_x = C_x s_x up to C_x s = mu F_z / 2,   mu F_z (1 - mu F_z / (4 C_x s)) s_x / s beyond
    M_z = -mu F_z l (1 - H) H^3 / 2 s_y / s

A second opinion on `gim`: across the wheel alone both are the same brush. Each direction has the
part of its curve that the slip has in it, so that the force is within mu F_z and a patch that
slides is braked against its motion; with a curve of its own slip for each it could reach
sqrt(2) mu F_z. Consequence to test: the pure lateral force and moment of `gim`, to round-off.

References: Fiala (1954), VDI-Zeitschrift 96, 973-979; Gim and Nikravesh (1990), International
Journal of Vehicle Design 11, 589-618; Pacejka (2012), Tire and Vehicle Dynamics, section 4.2
(similarity).
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
    from crashsolve.tyres._rows.fiala import History, Output, Parameters

STEPWISE = True


class Fiala(TyreCard):
    """Tyre whose forces along and across the wheel have curves of their own."""


PARAMETERS, HISTORY, OUTPUT = TYRE, CARCASS, FORCES_OF_TYRE
WARNINGS = OUT_OF_RANGE
build, shared_tables = tyre_columns, mesh_tables


@kernel
def forces(C_x, C_y, s_x, s_y, mu, F_z, length):
    """F_x, F_y [N], M_z [N m] and the share of the patch that slides."""
    s = sqrt(s_x * s_x + s_y * s_y)
    if s == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    most = mu * F_z
    H = max(1.0 - C_y * s / (3.0 * most), 0.0)
    F_x = C_x * s
    if F_x > 0.5 * most:
        F_x = most - most * most / (4.0 * F_x)
    F_y = most * (1.0 - H**3)
    M_z = -0.5 * most * length * (1.0 - H) * H**3
    sliding = min(sqrt((C_x * s_x) ** 2 + (C_y * s_y) ** 2) / (3.0 * most), 1.0)
    along, across = s_x / s, s_y / s
    return F_x * along, F_y * across, M_z * across, sliding


@kernel
def carcass_energy(p: Parameters, grip):
    """Energy of the deflected carcass, whose force is that of the tyre [J]."""
    s_x, s_y = grip.q_x / p.sigma_x, grip.q_y / p.sigma_y
    F_x, F_y, _, _ = forces(p.C_x, p.C_y, s_x, s_y, grip.mu, grip.F_z, 1.0)
    return 0.5 * (F_x * F_x / p.K_x + F_y * F_y / p.K_y)


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
            F_x, F_y, M_z, sliding = forces(
                p.C_x,
                p.C_y,
                grip.share * grip.s_x,
                grip.share * grip.s_y,
                grip.mu,
                grip.F_z,
                length,
            )
            M_z *= at.sense
            store = carcass_energy(p, grip)
            apply_patch_forces(p, i, old, new, out, h, nodes, at, grip, (F_x, F_y), M_z, store)
            show(out, at, grip, (F_x, F_y), M_z, sliding)
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
