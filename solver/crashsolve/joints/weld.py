"""Weld: b is fixed to a.

    Phi = ( x_b - x_a,  side_a . axis_b,  third_a . axis_b,  side_a . third_b ) = 0

Consequence to test: no degree of freedom; two welded halves fall and spin as the whole, and the
moment on a cantilever of length L is m g L / 2.
"""

from typing import Any

import numpy as np

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._card import FRAME, JointCard
from crashsolve.joints._rows import (
    parallel_convective,
    parallel_jacobian,
    parallel_residual,
    point_convective,
    point_jacobian,
    point_residual,
    square_convective,
    square_jacobian,
    square_residual,
)

ROWS = 6
ANGULAR = (False, False, False, True, True, True)
PARAMETERS = FRAME


class Weld(JointCard):
    """Fixes b to a; the reaction is reported at `at`."""


def build(card: Weld, scene: Any) -> dict[str, Any]:
    frame = dict(scene.joint_frame(card))
    for name, u in zip(("axis", "side", "third"), np.eye(3), strict=True):
        frame[f"{name}_a"] = scene.turn_to_body(frame["node_a"], u)
        frame[f"{name}_b"] = scene.turn_to_body(frame["node_b"], u)
    return frame


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    r = p.first_row
    point_residual(p, nodes, rows, r)
    parallel_residual(p, nodes, rows, r + 3)
    square_residual(p, p.side_a, p.third_b, nodes, rows[r + 5])


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    r = p.first_row
    point_jacobian(p, nodes, rows, r)
    parallel_jacobian(p, nodes, rows, r + 3)
    square_jacobian(p, p.side_a, p.third_b, nodes, rows[r + 5])


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    r = p.first_row
    point_convective(p, nodes, rows, r)
    parallel_convective(p, nodes, rows, r + 3)
    square_convective(p, p.side_a, p.third_b, nodes, rows[r + 5])
