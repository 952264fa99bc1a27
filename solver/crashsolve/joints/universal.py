"""Universal joint (Hooke, Cardan): the points coincide; two crossed axes, one in each body.

    Phi = ( x_b - x_a,  axis_a . axis_b ) = 0

Consequence to test: two degrees of freedom; two shafts bent by beta turn with
omega_b / omega_a = cos beta / (1 - sin^2 beta cos^2 phi_a), phi_a = 0 with axis_a in the plane of
the shafts.
Reference: Seherr-Thoss, Schmelz and Aucktor (2006), Universal Joints and Driveshafts, ch. 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.joints._card import POINTS, AxisJointCard, direction
from crashsolve.joints._constraint_rows import square_convective, square_jacobian, square_residual
from crashsolve.joints.basic import point, rows_of

if TYPE_CHECKING:
    from crashsolve.joints._rows.universal import Parameters

CONSTRAINTS = (point,)
ROWS, ANGULAR = rows_of(CONSTRAINTS, True)
FREE = ("swing",)
PARAMETERS = POINTS + Record("""
    axis_a  1  3  arm of the cross in a, axes of a
    axis_b  1  3  arm of the cross in b, axes of b
""")
# directions typed with six digits are square to this; a worse one is an error
SQUARE = 1e-5


class Universal(AxisJointCard):
    """Hooke joint: b rotates about two crossed axes, the first fixed in a, the second in b."""

    second_axis: Vec3 = word("direction of the axis fixed in b, at right angles to `axis`")


def build(card: Universal, scene: Scene) -> Columns:
    frame = scene.joint_frame(card)
    first, second = direction(card, scene, "axis"), direction(card, scene, "second_axis")
    cosine = float(first @ second)
    if abs(cosine) > SQUARE:
        raise scene.fail(
            f"must be at right angles to axis; their cosine is {cosine:.3g}", "second_axis"
        )
    second = scene.unit(second - cosine * first, "second_axis")
    frame["axis_b"] = scene.rotation_to_body(frame["node_b"], second)
    return PARAMETERS.columns_of(frame)


@kernel
def residual(p: Parameters, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    rows[p.first_row + 3].phi = square_residual(p, p.axis_a, p.axis_b, nodes)


@kernel
def jacobian(p: Parameters, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    square_jacobian(p, p.axis_a, p.axis_b, nodes, rows[p.first_row + 3])


@kernel
def convective(p: Parameters, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    rows[p.first_row + 3].gamma = square_convective(p, p.axis_a, p.axis_b, nodes)
