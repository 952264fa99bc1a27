"""Words that springs between two points share."""

from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word


class PointSpringCard(Card):
    """Two bodies and a point in each body's own frame."""

    a: BodyName = word("first body", default="ground")
    b: BodyName = word("second body")
    at_a: Vec3 = quantity("m", "attachment in the frame of a", default=(0.0, 0.0, 0.0))
    at_b: Vec3 = quantity("m", "attachment in the frame of b", default=(0.0, 0.0, 0.0))
