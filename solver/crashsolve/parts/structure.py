"""Structure: members between named points, with the description of deformation that the deck names.

    rigid       every member moves with the points it joins
    hinges      rigid bars between plastic hinges: at both ends of a member and in its middle
    segments    a chain of rigid segments with springs that yield (springs/segment.py)
    beams       beam elements; of fibres where the material yields
    shells      thin-walled tubes of shells

At every point there is a rigid body, named after it, whose origin and axes stay those of the point
for any description: joints, contacts, masses, loads and sensors of the deck are attached to it. It
is the rigid joint of the members that meet there: of each member the length r from the point on
belongs to it, and the deformable part begins behind it. By default

    r = h / 2 max(1, 1 / tan(alpha / 2))

h is the greatest depth of the sections that meet, alpha the least angle between two members: then
tubes of shells touch at their inner edges, and do not cross. So joints are closed, and the members
of all descriptions have the same ends. A contact that names a structure means all its members
(parts/structures/surfaces.py). When the deck is read a structure is written out in ordinary
cards (parts/structures/), which `crashsolve explain DECK --expanded` prints. Consequence to test:
mass, mass centre, inertia and elastic stiffness are those of the members in closed form, in all
descriptions.
"""

from typing import Any, ClassVar, Literal

from pydantic import model_validator

from crashsolve.deck.card import (
    BodyName,
    Card,
    CurveName,
    MaterialName,
    NewName,
    SectionName,
    Vec3,
    quantity,
    word,
)
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import ZERO
from crashsolve.parts.structures.cards import DESCRIPTIONS, expand, unused
from crashsolve.parts.structures.surfaces import surfaces

__all__ = ["expand", "surfaces", "unused"]
PARAMETERS = HISTORY = OUTPUT = Record()
Deformation: Any = Literal[DESCRIPTIONS]  # type: ignore


class Point(Card):
    """A point where members meet or end: a rigid body called S_name in structure S."""

    name: NewName = word("name; the body is called S_name in structure S")
    at: Vec3 = quantity("m", "position", ge=-1e6, le=1e6)
    joint: float | None = quantity(
        "m",
        "r, length of each member that belongs to the rigid joint; from its depth when absent",
        None,
        lt=1e6,
    )
    part_of: BodyName | None = word(
        "rigid body that the point belongs to: the body at the point is part of it where all its "
        "members are beams and the method is explicit, and is welded to it otherwise (joint "
        "S_name_mount)",
        default=None,
    )


class Member(Card):
    """A straight member between two points."""

    name: NewName | None = word(
        "its hinges, elements or parts are called S_name in structure S; member_k by its number "
        "when absent",
        default=None,
    )
    from_: str = word("name of the point where it begins")
    to: str = word("name of the point where it ends")
    section: SectionName | None = word("that of the structure when absent", default=None)
    material: MaterialName | None = word("that of the structure when absent", default=None)
    side: Vec3 | None = word(
        "direction near the section's y axis; that of the structure when absent", default=None
    )
    divisions: int | None = word("that of the structure when absent", default=None, ge=1, le=1000)
    deformation: Deformation | None = word("that of the structure when absent", default=None)


class Structure(Card):
    """Members between named points: rigid, or deformed by hinges, segments, beams or shells."""

    curve_axes: ClassVar = {"collapse_curve": ("rad", "N m")}

    points: tuple[Point, ...] = word(
        "points where members meet or end: bodies S_name of structure S"
    )
    members: tuple[Member, ...] = word("straight members between points")
    deformation: Deformation = word("description of deformation of the members")
    section: SectionName | None = word("cross section, unless a member names its own", default=None)
    material: MaterialName | None = word("material, unless a member names its own", default=None)
    side: Vec3 | None = word(
        "direction near the y axes of sections; needed where I_y and I_z differ", default=None
    )
    divisions: int = word(
        "number of segments, of which two halves belong to the joints, or of beam elements, of "
        "each member",
        default=8,
        ge=1,
        le=1000,
    )
    across: int = word(
        "number of shells across the narrower walls, or a quarter of a round tube; along the "
        "member they are about square",
        default=4,
        ge=1,
        le=100,
    )
    self_contact: bool = word(
        "whether the shells of a member touch each other where it folds (contact S_name_folds, "
        "type penalty); without, they pass through each other",
        default=False,
    )
    fibres: tuple[int, int] = word("fibres of beams that yield, as in fibre_beam", default=(4, 16))
    collapse: Literal["plastic", "kecman", "given"] = word(
        "moment of hinges: constant plastic moment, that of a rectangular tube that folds, or by "
        "collapse_curve",
        default="plastic",
    )
    collapse_curve: CurveName | None = word(
        "moment over plastic angle of all hinges, about both axes; with collapse: given",
        default=None,
    )
    hinge_stress: float | None = quantity(
        "Pa",
        "stress at which hinges yield, which do not harden; needed where the material hardens",
        default=None,
        gt=0,
    )
    hinge_arm: float | None = quantity(
        "m",
        "hinges yield at 1 + 0.07 V^0.82 of their moment, V the rate of rotation times this "
        "length; needed where the material has rate_D",
        default=None,
        gt=0,
    )
    damping: float = quantity(
        "s", "beta, damping over stiffness, of segments, beams and shells", default=0.0, ge=0
    )
    velocity: Vec3 = quantity("m/s", "initial velocity of the first point", default=ZERO)
    angular_velocity: Vec3 = quantity(
        "rad/s", "initial angular velocity of the whole structure, world axes", default=ZERO
    )

    @model_validator(mode="after")
    def _curve_of_collapse(self) -> "Structure":
        if (self.collapse == "given") != (self.collapse_curve is not None):
            raise ValueError("collapse: given and collapse_curve belong together")
        return self
