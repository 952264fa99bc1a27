"""Posture by the angles of joints: every body of a chain is placed through them from the root.

    A_b = A_a Q R_ab,   x_b = x_a + A_a s_a - A_b s_b

R_ab, s_a and s_b are the orientation of b in a and the joint's point in both where the cards of the
bodies have them, the zero posture; Q is the rotation of b against a, in axes of a (`_chain.py`).
Without rates the chain moves as one rigid body: v = v_0 + w x (x - x_0). Consequence to test: all
joints close to round-off, and the zero posture leaves the bodies where their cards have them.
"""

from collections.abc import Container
from importlib import import_module

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Jointed, Scene
from crashsolve.deck.card import BodyName, Card, JointName, Rotation, Vec3, quantity, word
from crashsolve.foundation.orientation import matrix, quaternion_of
from crashsolve.postures._chain import Link, Motion, in_order, link, next_body

# directions typed with six digits agree to this
TYPED = 1e-5


class JointAngle(Card):
    """A joint of the chain, its rotation from the zero posture, and the rate of that."""

    joint: JointName = word("joint between two bodies of the chain, with `frame` a body")
    angle: float | None = quantity(
        "rad", "angle of b about the joint's axis, right-handed", default=None
    )
    rotation: Rotation | None = word("rotation of b against a, in axes of a", default=None)
    rate: float | None = quantity("rad/s", "rate of the angle", default=None)
    angular_velocity: Vec3 | None = quantity(
        "rad/s", "angular velocity of b against a, in axes of a", default=None
    )

    @model_validator(mode="after")
    def _one_of_each(self) -> "JointAngle":
        if self.angle is not None and self.rotation is not None:
            raise ValueError("give one of: angle, rotation")
        if self.rate is not None and self.angular_velocity is not None:
            raise ValueError("give one of: rate, angular_velocity")
        return self


class Angles(Card):
    """Joint angles of a chain of bodies at the start, and where its root is."""

    root: BodyName = word("body from which the others are placed")
    position: Vec3 = quantity("m", "position of the origin of the root", default=(0.0, 0.0, 0.0))
    rotation: Rotation = word(
        "rotation of the root, body to world", default_factory=Rotation.model_construct
    )
    velocity: Vec3 = quantity("m/s", "velocity of the origin of the root", default=(0.0, 0.0, 0.0))
    angular_velocity: Vec3 = quantity(
        "rad/s",
        "angular velocity of the root, and of all joints without a rate",
        default=(0.0, 0.0, 0.0),
    )
    joints: tuple[JointAngle, ...] = word(
        "every joint of the chain; one without an angle is at zero"
    )


def build(card: Angles, scene: Scene) -> None:
    """Writes: positions, rotations and velocities of the chain in the scene."""
    root = scene.node(card.root)
    if root == 0:
        raise scene.fail("the ground cannot be placed; name a body", "root")
    turned = [(link(scene, one.joint, _card(one, i, scene)), one, i)
              for i, one in enumerate(card.joints)]  # fmt: skip
    given_at: dict[str, tuple[JointAngle, int]] = {}
    for one, given, i in turned:
        _check_link(one, i, given_at, scene)
        given_at[one.joint] = given, i
    order, rest = in_order(root, [one for one, _, _ in turned])
    if rest:
        known = {root} | {node for one in order for node in (one.a, one.b)}
        one = next((one for one in rest if {one.a, one.b} <= known), rest[0])
        closes = {one.a, one.b} <= known
        how = "closes a loop of this chain" if closes else (
            f"is not connected to '{card.root}' by the joints of this posture"
        )  # fmt: skip
        raise scene.fail(f"'{one.joint}' {how}", f"joints.{given_at[one.joint][1]}.joint")
    twice = next((node for one in order for node in (one.a, one.b) if node in scene.posed), None)
    if twice is not None:
        by = scene.posed[twice]
        raise scene.fail(f"'{scene.names[twice]}' is placed by the posture of '{by}' too", "joints")
    A, w = matrix(card.rotation.quaternion()), np.asarray(card.angular_velocity)
    arm = A @ scene.offset[root]
    v = np.asarray(card.velocity) + np.cross(w, arm)
    placed = {root: Motion(A, np.asarray(card.position) + arm, v, w)}
    for one in order:
        given, i = given_at[one.joint]
        next_body(one, *_rotation(given, one, i, scene), placed)
    for node, motion in placed.items():
        scene.A[node], scene.q[node] = motion.A.ravel(), quaternion_of(motion.A)
        scene.r[node], scene.v[node], scene.w[node] = motion.x, motion.v, motion.w
        scene.posed[node] = card.root


def _card(turned: JointAngle, i: int, scene: Scene) -> Jointed:
    """The card of a joint, which must move with its bodies."""
    card: Jointed = scene.joint_entry(turned.joint).card
    if getattr(card, "frame", "world") == "world":
        raise scene.fail(
            f"'{turned.joint}' is given in the world, where a posture moves its bodies; give its "
            "point in the frame of one of them",
            f"joints.{i}.joint",
        )
    return card


def _check_link(one: Link, i: int, earlier: Container[str], scene: Scene) -> None:
    """Refuse joints of the ground, which no posture moves, and joints that are named twice."""
    message = ""
    if 0 in (one.a, one.b):
        message = f"'{one.joint}' joins the chain to the ground, which a posture does not move; "
        message += "leave it out: it then joins them where the posture places its body"
    elif one.joint in earlier:
        message = f"'{one.joint}' is named twice"
    if message:
        raise scene.fail(message, f"joints.{i}.joint")


def _rotation(turned: JointAngle, one: Link, i: int, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Q (3, 3) and its angular velocity (3,) in axes of a.

    Writes: the angle that the joint has at the start.
    """
    for name in ("angle", "rate"):
        if getattr(turned, name) is not None and one.axis is None:
            other = "rotation" if name == "angle" else "angular_velocity"
            message = f"'{turned.joint}' has no axis to rotate about; give {_article(other)}"
            raise scene.fail(message, f"joints.{i}.{name}")
    Q, w_Q = np.eye(3), np.asarray(turned.angular_velocity or (0.0, 0.0, 0.0))
    if turned.rotation is not None:
        Q = matrix(turned.rotation.quaternion())
    if turned.rate is not None and one.axis is not None:
        w_Q = turned.rate * one.axis
    angle = turned.angle
    if angle is not None and one.axis is not None:
        x, y, z = (float(value) for value in one.axis)
        Q = matrix(Rotation(axis=(x, y, z), angle=angle).quaternion())
    _check_freedom(turned, one, Q, w_Q, f"joints.{i}", scene)
    if turned.rotation is not None and one.axis is not None:
        # of the same rotation about the axis, between -pi and pi
        sine = 0.5 * np.array([Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]])
        angle = float(np.arctan2(sine @ one.axis, 0.5 * (np.trace(Q) - 1.0)))
    if one.axis is not None:
        scene.angles_at_start[turned.joint] = angle or 0.0
    return Q, w_Q


def _check_freedom(
    turned: JointAngle, one: Link, Q: np.ndarray, w_Q: np.ndarray, where: str, scene: Scene
) -> None:
    """Refuse what the joint does not allow: it would be mounted anew, turned, on one body."""
    joint = import_module(scene.joint_entry(turned.joint).module_name)
    free = getattr(joint, "FREE", ())
    if "ball" in free or not any(joint.ANGULAR):
        return
    along = np.zeros((3, 0)) if "angle" not in free or one.axis is None else one.axis[:, None]
    # what Q and w_Q do besides rotating about the axis; directions are typed with six digits
    others = np.eye(3) - along @ along.T
    fixed = along if along.size else np.eye(3)
    rotation = "rotation" if turned.angle is None else "angle"
    for field, excess in ((rotation, Q @ fixed - fixed), ("angular_velocity", others @ w_Q)):
        if np.abs(excess).max() > TYPED * max(1.0, float(np.linalg.norm(w_Q))):
            what = "rotates about its axis alone; give an angle" if along.size else (
                "leaves no rotation that a posture can give it; give its bodies theirs"
            )  # fmt: skip
            raise scene.fail(f"'{turned.joint}' {what}", f"{where}.{field}")


def _article(other: str) -> str:
    return f"{'an' if other.startswith('a') else 'a'} {other}"
