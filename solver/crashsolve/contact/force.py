"""Contact card: which surfaces may touch, with which normal force and friction.

force on side a = f n + t,   n the normal out of side b, t against the slip of a over b

With torsion_radius r friction acts on (slip, r w_n) together, w_n the spin of a over b about n.
"""

from pydantic import model_validator

from crashsolve.deck.card import Card, Law, SurfaceName, quantity, word


class Force(Card):
    """Continuous-force contact between the surfaces of side a and those of side b."""

    a: tuple[SurfaceName, ...] = word(
        "surfaces of one side; the name of a structure stands for all its members"
    )
    b: tuple[SurfaceName, ...] = word("surfaces of the other side; the normal points out of them")
    normal: Card = Law("contact/normal", "law of the normal force")
    friction: Card | None = Law("friction", "law of friction; none when absent", default=None)
    torsion_radius: float | None = quantity(
        "m",
        "lever arm of friction against a spin about the normal (2/3 of the radius of an evenly "
        "pressed disc); between boxes and cylinders a lower bound, since their contact areas "
        "have a lever arm of their own",
        default=None,
        gt=0,
    )
    speed_floor: float | None = quantity(
        "m/s",
        "closing speed below which a contact counts as resting once it is deeper "
        "than a free impact of that speed; when absent 1e-3 m/s, or less where initial speeds and "
        "a fall through the model's size are slow and nothing else moves the bodies: 1e-3 of the "
        "fastest of these",
        default=None,
        gt=0,
    )

    @model_validator(mode="after")
    def _has_friction(self) -> "Force":
        if self.torsion_radius is not None and self.friction is None:
            raise ValueError("torsion_radius: needs a law of friction")
        return self
