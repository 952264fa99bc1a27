"""Weld: b is fixed to a.

    Phi = ( x_b - x_a,  side_a . axis_b,  third_a . axis_b,  side_a . third_b ) = 0

Consequence to test: no degree of freedom; two welded halves fall and spin as the whole, and the
moment on a cantilever of length L is m g L / 2.
"""

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.joints._card import FRAME, JointCard
from crashsolve.joints.basic import parallel, point, rows_of, square

CONSTRAINTS = (point, parallel, square)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
PARAMETERS = FRAME


class Weld(JointCard):
    """Fixes b to a; the reaction is reported at `at`."""


def build(card: Weld, scene: Scene) -> Columns:
    frame = dict(scene.joint_frame(card))
    for name, u in zip(("axis", "side", "third"), np.eye(3), strict=True):
        frame[f"{name}_a"] = scene.rotation_to_body(frame["node_a"], u)
        frame[f"{name}_b"] = scene.rotation_to_body(frame["node_b"], u)
    return frame
