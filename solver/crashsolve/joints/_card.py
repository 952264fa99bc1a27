"""Words that joints share: two bodies, and where the joint is at the start of the run."""

from typing import Literal, Protocol

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.record import Record

POINTS = Record("""
    node_a   index     first body
    node_b   index     second body
    point_a  m      3  joint point from the mass centre of a, axes of a
    point_b  m      3  joint point from the mass centre of b, axes of b
""")
FRAME = POINTS + Record("""
    axis_a   1  3  joint axis, axes of a
    side_a   1  3  at right angles to the axis, axes of a
    third_a  1  3  axis x side, axes of a
    axis_b   1  3  joint axis, axes of b
    side_b   1  3  side at the start, axes of b
    third_b  1  3  third at the start, axes of b
""")


class JointCard(Card):
    """Two bodies and the joint's point."""

    a: BodyName = word("first body; it carries the axis", default="ground")
    b: BodyName = word("second body")
    at: Vec3 = quantity("m", "joint point at the start, in `frame`")
    frame: Literal["world"] | BodyName = word(
        "frame of `at` and `axis`: world, or a body's own frame", default="world"
    )


class AxisJointCard(JointCard):
    """A joint with an axis."""

    axis: Vec3 = word("direction of the joint axis at the start, in `frame`; any length")


def own_frame(card: JointCard, scene: Scene) -> Columns:
    """Bodies and points of a joint, and its axes where it has some: `build` of most joints."""
    return dict(scene.joint_frame(card))


class Framed(Protocol):
    """A card with directions in a frame."""

    @property
    def frame(self) -> str: ...


def direction(card: Framed, scene: Scene, field: str) -> np.ndarray:
    """World components (3,) of a direction given in the frame of the card; length 1."""
    u: np.ndarray = scene.unit(getattr(card, field), field)
    return u if card.frame == "world" else scene.matrix(scene.node(card.frame)) @ u


def named_frame(scene: Scene, field: str, name: str, motion: str) -> Columns:
    """Columns of a joint that another card names, which must have a motion."""
    scene.refuse_joint(name, (motion,), field)
    try:
        frame: Columns = scene.built(scene.joint_entry(name).card)
    except ValueError:
        # reported at its own card
        raise scene.fail(f"'{name}' cannot be built", field) from None
    return frame
