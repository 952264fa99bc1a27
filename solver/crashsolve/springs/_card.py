"""Words that springs share: their bodies and points, and forces given by a curve."""

from pydantic import model_validator

from crashsolve.deck.card import BodyName, Card, CurveName, Vec3, quantity, word


class PointSpringCard(Card):
    """Two bodies and a point in each body's own frame."""

    a: BodyName = word("first body", default="ground")
    b: BodyName = word("second body")
    at_a: Vec3 = quantity("m", "attachment in the frame of a", default=(0.0, 0.0, 0.0))
    at_b: Vec3 = quantity("m", "attachment in the frame of b", default=(0.0, 0.0, 0.0))


class AxisSpringCard(Card):
    """Two bodies and an axis of the first; angles are measured from the one at the start."""

    a: BodyName = word("first body; it carries the axis", default="ground")
    b: BodyName = word("second body")
    axis: Vec3 = word("direction of the axis in the frame of a; any length")


class CowperSymonds(Card):
    """Factor 1 + (|rate| / D)^(1/q) on the force while it grows."""

    reference_rate: float = quantity("any", "D, rate that doubles the force", gt=0)
    exponent: float = quantity("1", "q, exponent", gt=0)


class PowerLaw(Card):
    """Factor 1 + a |rate|^b on the force while it grows, rate in m/s or rad/s."""

    coefficient: float = quantity("1", "a, coefficient of the power law", default=0.07, ge=0)
    exponent: float = quantity("1", "b, exponent of the power law", default=0.82, gt=0)


class ResistanceCard(Card):
    """Fields of a force given by a curve: unloading path, growth with the rate."""

    curve: CurveName = word("force over deformation while it grows; see also gap")
    unloading_curve: CurveName | None = word(
        "lower bound of the force when it falls; needs unloading_stiffness", default=None
    )
    rate_curve: CurveName | None = word(
        "factor on the force over the rate of deformation", default=None
    )
    cowper_symonds: CowperSymonds | None = word(
        "or factor by Cowper and Symonds: 1 + (|rate| / D)^(1/q)", default=None
    )
    power_law: PowerLaw | None = word("or factor by a power law: 1 + a |rate|^b", default=None)

    @model_validator(mode="after")
    def _consistent(self) -> "ResistanceCard":
        if self.unloading_curve and getattr(self, "unloading_stiffness", None) is None:
            raise ValueError("unloading_curve: needs unloading_stiffness, the slope down to it")
        factors = [self.rate_curve, self.cowper_symonds, self.power_law]
        if sum(factor is not None for factor in factors) > 1:
            raise ValueError("give one of: rate_curve, cowper_symonds, power_law")
        return self
