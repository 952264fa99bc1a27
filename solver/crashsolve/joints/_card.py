"""Words that joints share: two bodies, and where the joint is at the start of the run."""

from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word


class JointCard(Card):
    """Two bodies and the joint's point."""

    a: BodyName = word("first body; it carries the axis", default="ground")
    b: BodyName = word("second body")
    at: Vec3 = quantity("m", "joint point at the start, in `frame`")
    frame: str = word("frame of `at` and `axis`: world, or a body's own frame", default="world")


class AxisJointCard(JointCard):
    """A joint with an axis."""

    axis: Vec3 = word("direction of the joint axis at the start, in `frame`; any length")
