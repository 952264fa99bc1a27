"""Contact card: which surfaces may touch, with which normal force and friction.

force on side a = f n + t,   n the normal out of side b, t against the slip of a over b
"""

from crashsolve.deck.card import Card, Law, SurfaceName, quantity, word


class Force(Card):
    """Continuous-force contact between the surfaces of side a and those of side b."""

    a: tuple[SurfaceName, ...] = word("surfaces of one side")
    b: tuple[SurfaceName, ...] = word("surfaces of the other side; the normal points out of them")
    normal: Card = Law("contact/normal", "law of the normal force")
    friction: Card | None = Law("friction", "law of friction; none when absent", default=None)
    speed_floor: float = quantity(
        "m/s", "closing speed below which a touch counts as resting", default=1e-3, gt=0
    )
