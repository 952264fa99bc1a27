"""Constraints: residuals, Jacobians and convective terms of all joints.

The rows of a joint are those of its basic constraints, one after the other, then those of its own;
a joint that has separated has rows without effect.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.system.placeholders import JOINTS


@kernel
def residual(current, time, nodes, rows, curves, scene):
    """Phi(q, t) of every joint. Writes: rows.phi, new histories."""
    for group in JOINTS:
        p, history = group.parameters, group.history
        for i in range(p.shape[0]):
            old, new = history[current, i], history[1 - current, i]
            for basic, first in group.constraints:
                basic.residual(p[i], nodes, rows, p[i].first_row + first)
            if group.has_own_rows:
                group.law.residual(p[i], old, new, time, nodes, rows, curves)
            if group.can_separate:
                group.law.release_rows(p[i], old, rows, group.module.ROWS)


@kernel
def jacobian(current, time, nodes, rows, curves, scene):
    """D and nu = -Phi_t of every joint. Writes: rows.D, nu."""
    for group in JOINTS:
        p, history = group.parameters, group.history
        for i in range(p.shape[0]):
            for basic, first in group.constraints:
                basic.jacobian(p[i], nodes, rows, p[i].first_row + first)
            if group.has_own_rows:
                group.law.jacobian(p[i], history[current, i], time, nodes, rows, curves)
            if group.can_separate:
                group.law.release_rows(p[i], history[current, i], rows, group.module.ROWS)


@kernel
def convective(current, time, nodes, rows, curves, scene):
    """gamma = -D_dot v - Phi_tt of every joint. Writes: rows.gamma."""
    for group in JOINTS:
        p, history = group.parameters, group.history
        for i in range(p.shape[0]):
            for basic, first in group.constraints:
                basic.convective(p[i], nodes, rows, p[i].first_row + first)
            if group.has_own_rows:
                group.law.convective(p[i], history[current, i], time, nodes, rows, curves)
            if group.can_separate:
                group.law.release_rows(p[i], history[current, i], rows, group.module.ROWS)
