"""Constraints: residuals, Jacobians and convective terms of all joints."""

from crashsolve.foundation.kernels import kernel
from crashsolve.system.placeholders import JOINTS


@kernel
def residual(current, time, nodes, rows, curves, scene):
    """Phi(q, t) of every joint. Writes: rows.phi, new histories."""
    for group in JOINTS:
        p, history = group.parameters, group.history
        for i in range(p.shape[0]):
            old, new = history[current, i], history[1 - current, i]
            group.law.residual(p[i], old, new, time, nodes, rows, curves)


@kernel
def jacobian(current, time, nodes, rows, curves, scene):
    """D and nu = -Phi_t of every joint. Writes: rows.D, nu."""
    for group in JOINTS:
        p, history = group.parameters, group.history
        for i in range(p.shape[0]):
            group.law.jacobian(p[i], history[current, i], time, nodes, rows, curves)


@kernel
def convective(current, time, nodes, rows, curves, scene):
    """gamma = -D_dot v - Phi_tt of every joint. Writes: rows.gamma."""
    for group in JOINTS:
        p, history = group.parameters, group.history
        for i in range(p.shape[0]):
            group.law.convective(p[i], history[current, i], time, nodes, rows, curves)
