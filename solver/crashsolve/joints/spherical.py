"""Spherical joint (ball and socket): the points coincide.

    Phi = x_b - x_a = 0

Consequence to test: three degrees of freedom; a conical pendulum at the angle alpha goes round with
omega^2 = g / (L cos alpha).
"""

from typing import Any

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._card import POINTS, JointCard
from crashsolve.joints._rows import point_convective, point_jacobian, point_residual

ROWS = 3
ANGULAR = (False, False, False)
FREE = ("ball",)
PARAMETERS = POINTS


class Spherical(JointCard):
    """Ball and socket: a point of b stays on a point of a."""


def build(card: Spherical, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    point_residual(p, nodes, rows, p.first_row)


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    point_jacobian(p, nodes, rows, p.first_row)


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    point_convective(p, nodes, rows, p.first_row)
