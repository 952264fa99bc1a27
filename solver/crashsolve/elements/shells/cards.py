"""The card of shells, and the tables within it: named nodes, traces, sections, supports, starts."""

from typing import Literal

from pydantic import model_validator

from crashsolve.deck.card import (
    BodyName,
    Card,
    Law,
    MaterialName,
    NewName,
    PartName,
    SetName,
    Vec3,
    quantity,
    word,
)
from crashsolve.elements.damping import Damped
from crashsolve.elements.shells.records import MAX_LAYERS
from crashsolve.foundation.vec3 import ZERO

MOTIONS = ("x", "y", "z", "rotation_x", "rotation_y", "rotation_z")
Motion = Literal["x", "y", "z", "rotation_x", "rotation_y", "rotation_z"]


class NamedNode(Card):
    """A node that is a body of the deck, for joints, loads, contacts, sensors and channels."""

    name: NewName = word("name; the body is called P_name in part P")
    at: Vec3 = quantity("m", "position; the nearest node is taken")


class Trace(Card):
    """A position whose history is written."""

    name: NewName = word("name in channels: P_name for part P")
    at: Vec3 = quantity("m", "position; the nearest node or element is taken")


class SectionCut(Card):
    """Section whose force and moment are written: the elements that a plane cuts at the start."""

    name: NewName = word("name in channels: P_name for part P")
    at: Vec3 = quantity("m", "point of the plane")
    normal: Vec3 = word("normal of the plane, towards the side on which the force acts")


class Support(Card):
    """Suppressed motions of the nodes of a set."""

    nodes: SetName = word("set of nodes of the mesh")
    motions: tuple[Motion, ...] = word("suppressed, along and about world axes", default=MOTIONS)


class Weld(Card):
    """Nodes that are part of a body: of a rigid one, or of nodes of beams and shells.

    Of a shell, its named nodes are bodies: those of `nodes`.
    """

    nodes: SetName = word("set of nodes of the mesh")
    to: BodyName | None = word("body, or node of a beam, of which they become part", default=None)
    part: PartName | None = word(
        "or a part of beams or shells: each is part of the nearest of its nodes that are bodies",
        default=None,
    )
    within: float | None = quantity(
        "m", "largest distance from it; the longest side of the elements there", None, gt=0
    )

    @model_validator(mode="after")
    def _one(self) -> "Weld":
        if (self.to is None) == (self.part is None):
            raise ValueError("needs either to or part")
        if self.within is not None and self.part is None:
            raise ValueError("within: is for part; a body named by to holds nodes at any distance")
        return self


class NodeVelocity(Card):
    """Velocity at the start of the nodes of a set, in place of that of the part."""

    nodes: SetName = word("set of nodes of the mesh")
    velocity: Vec3 = quantity("m/s", "velocity of each node", default=ZERO)
    angular_velocity: Vec3 = quantity(
        "rad/s", "angular velocity of each node, world axes", default=ZERO
    )


class Impulse(Card):
    """Impulse along the normals, at the start, on the elements whose middles lie in a box."""

    low: Vec3 = quantity("m", "corner of the box with the least coordinates")
    high: Vec3 = quantity("m", "corner of the box with the largest coordinates")
    speed: float = quantity("m/s", "impulse over the mass of the elements in the box")


class ShellCard(Damped):
    """Fields of a shell, from which its mesh, layout and outputs follow."""

    mesh: Card = Law("meshes", "positions of the nodes, elements, sets of nodes")
    thickness: float = quantity("m", "t, thickness", gt=0)
    element: Literal["reduced", "fully_integrated", "triangles"] = word(
        "quadrilaterals with one integration point in the plane, or 2 by 2, or each cut into two "
        "triangles",
        default="reduced",
    )
    material: MaterialName = word("material of the shell")
    layers: int = word("integration points through the thickness", 5, ge=1, le=MAX_LAYERS)
    rule: Literal["gauss", "lobatto"] = word(
        "positions of these points; lobatto: at the surfaces too", "gauss"
    )
    thinning: bool = word("the thickness follows the strain", default=False)
    nodes: tuple[NamedNode, ...] = word("nodes that are also bodies of the deck", default=())
    supports: tuple[Support, ...] = word("sets of nodes whose motions are suppressed", default=())
    welded: tuple[Weld, ...] = word("nodes that are part of a body", default=())
    traces: tuple[Trace, ...] = word("nodes with a history: nodout.P_name", default=())
    gauges: tuple[Trace, ...] = word("elements with a history: elout.P_name", default=())
    section_cuts: tuple[SectionCut, ...] = word(
        "sections with a history: secforc.P_name", default=()
    )
    velocity: Vec3 = quantity("m/s", "initial velocity of the mesh's first node", default=ZERO)
    angular_velocity: Vec3 = quantity(
        "rad/s", "initial angular velocity of the whole part, world axes", default=ZERO
    )
    velocities: tuple[NodeVelocity, ...] = word("initial velocities of sets of nodes", default=())
    impulses: tuple[Impulse, ...] = word("impulses at the start, on regions", default=())

    def node_names(self, part: str) -> list[str]:
        """Names of those nodes of a part of this name that are bodies."""
        return [f"{part}_{node.name}" for node in self.nodes]
