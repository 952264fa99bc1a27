"""Posture by the angles of joints: every body of a chain is placed through them from the root.

    A_b = A_a Q R_ab,   x_b = x_a + A_a s_a - A_b s_b

R_ab, s_a and s_b are the orientation of b in a and the joint's point in both where the cards of the
bodies have them, the zero posture; Q is the rotation of b against a, in axes of a. The chain moves
as one rigid body: v = v_0 + w x (x - x_0). Consequence to test: all joints close to round-off, and
the zero posture leaves the bodies where their cards have them.
"""

from typing import Any

import numpy as np
from pydantic import model_validator

from crashsolve.deck.card import BodyName, Card, JointName, Rotation, Vec3, quantity, word
from crashsolve.foundation.orientation import matrix, quaternion_of


class Turned(Card):
    """A joint of the chain, and how far it is turned from the zero posture."""

    joint: JointName = word("joint between two bodies of the chain, with `frame` a body")
    angle: float | None = quantity("rad", "of b about the joint's axis, right-handed", default=None)
    rotation: Rotation | None = word("of b against a, in axes of a", default=None)

    @model_validator(mode="after")
    def _one_direction(self) -> "Turned":
        if self.angle is not None and self.rotation is not None:
            raise ValueError("give one of: angle, rotation")
        return self


class Angles(Card):
    """Joint angles of a chain of bodies at the start, and where its root is."""

    root: BodyName = word("body from which the others are placed")
    position: Vec3 = quantity("m", "of the origin of the root", default=(0.0, 0.0, 0.0))
    rotation: Rotation = word("of the root, body to world", default_factory=Rotation)
    velocity: Vec3 = quantity("m/s", "of the origin of the root", default=(0.0, 0.0, 0.0))
    angular_velocity: Vec3 = quantity("rad/s", "of the whole chain", default=(0.0, 0.0, 0.0))
    joints: tuple[Turned, ...] = word("every joint of the chain; one without an angle is at zero")


def build(card: Angles, scene: Any) -> None:
    """Writes: positions, rotations and velocities of the chain in the scene."""
    root = scene.node(card.root)
    if root == 0:
        raise scene.fail("the ground cannot be placed; name a body", "root")
    zero = {name: getattr(scene, name).copy() for name in ("r", "A")}
    A = matrix(card.rotation.quaternion())
    origin = np.asarray(card.position)
    placed = {root: (A, origin + A @ scene.offset[root])}
    waiting = list(enumerate(card.joints))
    while waiting:
        ready = [(i, rotated) for i, rotated in waiting if _next(rotated, i, placed, zero, scene)]
        if not ready:
            i, rotated = waiting[0]
            raise scene.fail(
                f"'{rotated.joint}' does not hang on '{card.root}' by the joints of this posture",
                f"joints.{i}.joint",
            )
        waiting = [one for one in waiting if one not in ready]
    w = np.asarray(card.angular_velocity)
    for node, (rotation, x) in placed.items():
        scene.A[node], scene.q[node] = rotation.ravel(), quaternion_of(rotation)
        scene.r[node], scene.w[node] = x, w
        scene.v[node] = np.asarray(card.velocity) + np.cross(w, x - origin)


def _next(rotated: Turned, i: int, placed: dict[int, Any], zero: Any, scene: Any) -> bool:
    """Whether one body of a joint is in place, by which the other is put there. Writes: placed."""
    card = scene.joint_entry(rotated.joint).card
    field = f"joints.{i}"
    if getattr(card, "frame", "world") == "world":
        raise scene.fail(
            f"'{rotated.joint}' is given in the world, where a posture moves its bodies; give its "
            "point in the frame of one of them",
            f"{field}.joint",
        )
    a, b, point = scene.joint_point(card)
    if a in placed and b in placed:
        raise scene.fail(f"'{rotated.joint}' closes a loop of this chain", f"{field}.joint")
    if a not in placed and b not in placed:
        return False
    A_a, A_b = zero["A"][a].reshape(3, 3), zero["A"][b].reshape(3, 3)
    s_a, s_b = A_a.T @ (point - zero["r"][a]), A_b.T @ (point - zero["r"][b])
    # axes of b in a, as the joint is turned
    inner = _rotation(rotated, card, A_a, field, scene) @ A_a.T @ A_b
    if a in placed:
        A, x = placed[a]
        placed[b] = A @ inner, x + A @ s_a - A @ inner @ s_b
    else:
        A, x = placed[b]
        placed[a] = A @ inner.T, x + A @ s_b - A @ inner.T @ s_a
    return True


def _rotation(rotated: Turned, card: Any, A_a: np.ndarray, field: str, scene: Any) -> np.ndarray:
    """Q (3, 3), in axes of a. Writes: the angle that the joint has at the start."""
    if rotated.rotation is not None:
        return matrix(rotated.rotation.quaternion())
    if rotated.angle is None:
        return np.eye(3)
    if not hasattr(card, "axis"):
        message = f"'{rotated.joint}' has no axis to rotate about; give a rotation"
        raise scene.fail(message, f"{field}.angle")
    x, y, z = A_a.T @ scene.matrix(scene.node(card.frame)) @ scene.unit(card.axis, field)
    scene.angles_at_start[rotated.joint] = rotated.angle
    rotation = Rotation(axis=(float(x), float(y), float(z)), angle=rotated.angle)
    return matrix(rotation.quaternion())
