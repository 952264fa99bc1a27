"""Words that hinges share, and the columns of the kernels of _law.py."""

from typing import ClassVar, Literal, NamedTuple, TypeVar

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, MaterialName, SectionName, quantity, word
from crashsolve.hinges._backbone import Backbone, backbone, over_plastic_work, refuse_kinematic
from crashsolve.hinges._law import ISOTROPIC, KINEMATIC, PEAK_ORIENTED
from crashsolve.hinges._sections import Points, axial_curve, bending_curve
from crashsolve.joints._card import AxisJointCard

Curve = TypeVar("Curve", "MomentCurve", "AxialCurve")
CYCLIC = {"isotropic": ISOTROPIC, "kinematic": KINEMATIC, "peak_oriented": PEAK_ORIENTED}


class MomentCurve(Card):
    """Moment over angle: a curve of the deck, or the collapse of a section; a name is enough."""

    shorthand: ClassVar = "name"
    curve_axes: ClassVar = {"name": ("rad", "N m"), "plastic_curve": ("rad", "N m")}

    name: CurveName | None = word("curve that begins at 0", default=None)
    section: SectionName | None = word("section whose bending makes the curve", default=None)
    material: MaterialName | None = word("material of the section, elastoplastic", default=None)
    about: Literal["y", "z"] = word("axis of the section that it bends about", default="y")
    model: Literal["plastic", "kecman", "given"] = word(
        "plastic: constant plastic moment; kecman: collapse of a rectangular tube; given: by "
        "plastic_curve",
        default="plastic",
    )
    plastic_curve: CurveName | None = word(
        "of model given: moment over plastic angle (the measured angle less the elastic one), from "
        "0",
        default=None,
    )
    length: float | None = quantity(
        "m",
        "length of the member whose bending the hinge's elastic stiffness represents",
        None,
        gt=0,
    )
    until: float | None = quantity(
        "rad",
        "angle at which the curve ends, constant beyond; when absent nowhere, or of model kecman "
        "where the fold closes, beyond which the run stops",
        default=None,
        gt=0,
    )
    flow_stress: float | None = quantity(
        "Pa",
        "flow stress of the hinge lines of a fold; the yield stress when absent",
        default=None,
        gt=0,
    )

    @model_validator(mode="after")
    def _one_source(self) -> "MomentCurve":
        if (self.model == "given") != (self.plastic_curve is not None):
            raise ValueError("model given and plastic_curve belong together")
        if self.model == "given" and self.until is not None:
            raise ValueError("until: plastic_curve ends where its last point is")
        return _named_or_made(self)


class AxialCurve(Card):
    """Force over change of length: a curve of the deck, or of a section; a name is enough."""

    shorthand: ClassVar = "name"
    curve_axes: ClassVar = {"name": ("m", "N")}

    name: CurveName | None = word("curve that begins at 0", default=None)
    section: SectionName | None = word("section that is pulled or crushed", default=None)
    material: MaterialName | None = word("material of the section, elastoplastic", default=None)
    model: Literal["plastic", "crush"] = word(
        "plastic: constant force at yield; crush: mean force of a folding square tube",
        default="plastic",
    )
    length: float | None = quantity(
        "m",
        "length of the member whose stretch the hinge's elastic stiffness represents",
        None,
        gt=0,
    )
    until: float | None = quantity(
        "m", "stroke at which the curve ends, constant beyond; nowhere when absent", None, gt=0
    )
    flow_stress: float | None = quantity(
        "Pa", "flow stress of the crushed walls; the yield stress when absent", default=None, gt=0
    )

    @model_validator(mode="after")
    def _one_source(self) -> "AxialCurve":
        return _named_or_made(self)


def _named_or_made(card: Curve) -> Curve:
    fields = (card.section, card.material, card.length)
    if (card.name is None) == (card.section is None):
        raise ValueError("give the name of a curve, or section, material and length")
    if card.section is not None and None in fields:
        raise ValueError("section: needs material and length beside it")
    if card.name is not None and any(word in card.model_fields_set for word in MAKING):
        raise ValueError("name: a curve of the deck needs nothing beside it")
    return card


MAKING = (
    "section",
    "material",
    "about",
    "model",
    "length",
    "until",
    "flow_stress",
    "plastic_curve",
)


class RateFactor(Card):
    """Factor 1 + a V^b, or that of Cowper and Symonds, on the moment at which a hinge yields."""

    coefficient: float | None = quantity("1", "a; 0.07 when absent", default=None, ge=0)
    exponent: float | None = quantity("1", "b; 0.82 when absent", default=None, gt=0)
    reference_rate: float | None = quantity(
        "any", "D of Cowper and Symonds: speed that doubles the moment", default=None, gt=0
    )
    reference_exponent: float | None = quantity("1", "q of Cowper and Symonds", None, gt=0)
    speed: Literal["current", "start"] = word(
        "V: the present speed of the hinge, or that at its first yield", default="current"
    )
    arm: float | None = quantity(
        "m",
        "distance of the tip: V is the speed there in m/s; when absent V of an angle is in rad/s",
        default=None,
        gt=0,
    )

    @model_validator(mode="after")
    def _one_law(self) -> "RateFactor":
        symonds = (self.reference_rate, self.reference_exponent)
        if (symonds[0] is None) != (symonds[1] is None):
            raise ValueError("reference_rate and reference_exponent belong together")
        if symonds[0] is not None and (self.coefficient, self.exponent) != (None, None):
            raise ValueError("give coefficient and exponent, or reference_rate and its exponent")
        return self

    def power_law(self) -> tuple[float, float]:
        """a and b of 1 + a V^b."""
        if self.reference_rate is not None and self.reference_exponent is not None:
            b = 1.0 / self.reference_exponent
            return self.reference_rate**-b, b
        a = 0.07 if self.coefficient is None else self.coefficient
        return a, 0.82 if self.exponent is None else self.exponent


class HingeCard(AxisJointCard):
    """Fields of all hinges: two bodies, position, axis, and behaviour in cycles."""

    cyclic: Literal["isotropic", "kinematic", "peak_oriented"] = word(
        "isotropic: yield in both directions follows the curve along the plastic displacement; "
        "kinematic: the elastic range moves with it; peak_oriented: reloading aims at the largest "
        "deformation so far",
        default="isotropic",
    )
    rate: RateFactor | None = word("growth of the yield moment with the rate", default=None)
    after_failure: Literal["apart", "loose"] = word(
        "apart: failure frees the whole joint; loose: it leaves the joint without resistance",
        default="apart",
    )

    @property
    def can_release(self) -> bool:
        """Whether failure may free the whole joint."""
        limits = [name for name in type(self).model_fields if name.startswith("failure_")]
        fails = any(getattr(self, name) is not None for name in limits)
        return fails and self.after_failure == "apart"


class RotationalCard(HingeCard):
    """A hinge that rotates about one axis."""

    curve: MomentCurve = word("moment over angle as it grows, from [0, 0]")
    curve_negative: MomentCurve | None = word(
        "the same for negative angles, both counted positive; as curve when absent", default=None
    )
    stiffness: float | None = quantity(
        "N m/rad", "elastic, also of unloading; the first slope when absent", default=None, gt=0
    )
    initial_angle: float = quantity(
        "rad", "rotation of b from the start at which the hinge has no moment", default=0.0
    )
    failure_angle: float | None = quantity(
        "rad", "angle in either direction at which the hinge fails", default=None, gt=0
    )


class PairCard(HingeCard):
    """A hinge of two motions."""

    interaction: Literal["elliptic", "uncoupled"] = word(
        "elliptic: squares of both moments (or moment and force), over those at yield, sum to "
        "1 at most; uncoupled: each for itself",
        default="elliptic",
    )


class Motion(NamedTuple):
    """Fields of a card that belong to one free motion; "" for one that the card lacks."""

    curve: str
    negative: str
    stiffness: str
    initial: str
    failure: str


def backbones(
    motions: tuple[Motion, ...], card: HingeCard, built: Columns, scene: Scene
) -> dict[str, Backbone]:
    """Yield moments over plastic angles, by the fields of a card that name curves."""
    backbone_of: dict[str, Backbone] = {}
    for motion in motions:
        k = getattr(card, motion.stiffness)
        for field in filter(None, (motion.curve, motion.negative)):
            source = getattr(card, field)
            if source is not None:
                backbone_of[field] = backbone(_points(source, field, built, scene), k, field, scene)
                # both directions have the stiffness of the first
                k = backbone_of[field].stiffness
                if card.cyclic == "kinematic":
                    refuse_kinematic(backbone_of[field], field, scene)
    return backbone_of


def pair_backbones(
    motions: tuple[Motion, ...], card: PairCard, built: Columns, scene: Scene
) -> dict[str, Backbone]:
    """Yield moments of two motions over plastic angles; on one ellipse, their squares over plastic
    work.
    """
    if card.interaction == "uncoupled":
        return backbones(motions, card, built, scene)
    if card.cyclic != "isotropic":
        raise scene.fail(
            "an ellipse hardens and softens as a whole; set cyclic: isotropic", "cyclic"
        )
    for motion in motions:
        if motion.negative and getattr(card, motion.negative) is not None:
            raise scene.fail(
                "an ellipse is the same in both directions; set interaction: uncoupled",
                motion.negative,
            )
    return {
        field: over_plastic_work(by_angle, field, scene)
        for field, by_angle in backbones(motions, card, built, scene).items()
    }


def _points(source: MomentCurve | AxialCurve, field: str, built: Columns, scene: Scene) -> Points:
    """Breakpoints, coefficients and the code of extrapolation."""
    if source.name is not None:
        if source.name not in built:
            raise scene.fail(f"curve '{source.name}' cannot be built", field)
        return built[source.name]
    if isinstance(source, MomentCurve):
        return bending_curve(source, field, built, scene)
    return axial_curve(source, field, built, scene)


def law(card: HingeCard, motions: tuple[Motion, ...], scene: Scene) -> Columns:
    """Columns of LAW."""
    backbone_of = scene.own_backbones()
    # a second direction without a curve has the first one's
    backbone_of = {motion.curve: backbone_of[motions[0].curve] for motion in motions} | backbone_of
    stiffness, curves = np.zeros(2), np.zeros(4, np.int64)
    initial, limits, failure = np.zeros(2), np.zeros(2), np.full(2, np.inf)
    initial[: len(motions)] = _initial(card, motions)
    for c, motion in enumerate(motions):
        both = (
            backbone_of[motion.curve],
            backbone_of.get(motion.negative, backbone_of[motion.curve]),
        )
        stiffness[c] = both[0].stiffness
        curves[2 * c : 2 * c + 2] = [scene.curve(side.name) for side in both]
        # the moment at the start has the other sign
        limits[c] = both[0 if initial[c] <= 0.0 else 1].limit
        if motion.failure and getattr(card, motion.failure) is not None:
            failure[c] = getattr(card, motion.failure)
    field = next((m.initial for m, x in zip(motions, initial, strict=False) if x), "")
    _refuse_start(card, field, initial, stiffness * initial, limits, failure, scene)
    a, b = card.rate.power_law() if card.rate else (0.0, 1.0)
    return {
        "stiffness": stiffness,
        "backbone": curves,
        "cyclic": CYCLIC[card.cyclic],
        "initial": initial,
        "failure": failure,
        "is_apart": card.after_failure == "apart",
        "rate_coefficient": a,
        "rate_exponent": b,
        "rate_floor": (0.1 / a) ** (1.0 / b) if a else 0.0,
        "latched": bool(card.rate and card.rate.speed == "start"),
    }


def _initial(card: object, motions: tuple[Motion, ...]) -> tuple[float, ...]:
    """Motions from the start at which there is no moment; two of one field, or one of each."""
    if len({motion.initial for motion in motions}) < len(motions):
        angles: tuple[float, ...] = getattr(card, motions[0].initial)
        return angles
    return tuple(getattr(card, motion.initial) for motion in motions)


def _refuse_start(
    card: object,
    field: str,
    initial: np.ndarray,
    moments: np.ndarray,
    limits: np.ndarray,
    failure: np.ndarray,
    scene: Scene,
) -> None:
    """Raise DeckErrors where a hinge begins beyond yield, or has failed."""
    for begins, limit in zip(moments, limits, strict=True):
        if abs(begins) > limit:
            raise scene.fail(
                f"the hinge would begin beyond yield: its elastic line leads to {-begins:.4g}, "
                f"and it yields at {limit:.4g}",
                field,
            )
    share = float(np.hypot(*(moments / np.where(limits > 0.0, limits, 1.0))))
    if getattr(card, "interaction", "") == "elliptic" and share > 1.0:
        raise scene.fail(
            f"the hinge would begin beyond yield: its elastic lines lead to {share:.4g} times its "
            "ellipse",
            field,
        )
    # two rotations of one hinge fail together
    is_rotation = field == "initial_angles"
    sizes = np.array([np.hypot(*initial), 0.0]) if is_rotation else np.abs(initial)
    if (sizes >= failure).any():
        raise scene.fail("the hinge would have failed at the start", field)


def rate_arm(card: HingeCard) -> float:
    """Arm of the speed in the rate factor [m/rad]; 1 where that speed is in rad/s."""
    return float(card.rate.arm) if card.rate and card.rate.arm else 1.0
