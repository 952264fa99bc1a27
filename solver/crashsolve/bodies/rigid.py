"""Rigid body: mass and inertia given, or from a primitive of uniform density.

    m v_dot = f,   d/dt (J w) = tau   about the mass centre

Consequence to test: the inertia of a solid sphere is 2/5 m r^2 about any axis.
"""

from typing import Literal

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Rotation, SectionName, Vec3, quantity, word
from crashsolve.foundation.orientation import matrix
from crashsolve.foundation.record import Record


class Primitive(Card):
    """Uniform solid: its mass follows from density, its inertia from its shape."""

    shape: Literal["sphere", "cylinder", "box", "rod"] = word("solid; cylinder and rod along z")
    density: float | None = quantity(
        "kg/m^3", "density; or give `mass` of the body", default=None, gt=0
    )
    radius: float | None = quantity("m", "radius of sphere or cylinder", default=None, gt=0)
    length: float | None = quantity("m", "length of cylinder or rod, along z", default=None, gt=0)
    size: Vec3 | None = quantity("m", "edges of the box", default=None)

    @model_validator(mode="after")
    def _complete(self) -> "Primitive":
        needs = {"sphere": "radius", "cylinder": "radius length", "box": "size", "rod": "length"}
        for field in needs[self.shape].split():
            if getattr(self, field) is None:
                raise ValueError(f"a {self.shape} needs {field}")
        return self


class Bar(Card):
    """Length of a section drawn for a body; it has no mass and no contact."""

    from_: Vec3 = quantity("m", "middle of the section where it begins, in the body's frame")
    to: Vec3 = quantity("m", "middle of the section where it ends, in the body's frame")
    side: Vec3 = word("direction near the section's y axis, in the body's frame")
    section: SectionName = word("cross section")

    @model_validator(mode="after")
    def _has_axes(self) -> "Bar":
        along = np.subtract(self.to, self.from_)
        if not np.any(along):
            raise ValueError("from and to are the same point")
        if not np.any(np.cross(along, self.side)):
            raise ValueError("side: must not lie along the bar")
        return self


class Rigid(Card):
    """Rigid body with its position, orientation and velocity at the start."""

    mass: float | None = quantity("kg", "mass", default=None, gt=0)
    inertia: Vec3 | None = quantity("kg m^2", "Ixx, Iyy, Izz about the mass centre", default=None)
    products: Vec3 = quantity(
        "kg m^2", "Ixy, Ixz, Iyz, elements of the inertia tensor", default=(0.0, 0.0, 0.0)
    )
    primitive: Primitive | None = word("uniform solid instead of mass and inertia", default=None)
    mass_centre: Vec3 = quantity(
        "m", "mass centre from the body's origin, body axes", default=(0.0, 0.0, 0.0)
    )
    position: Vec3 = quantity(
        "m",
        "of the body's origin; the channel rbdout.NAME.position is that of the mass centre, "
        "rbdout.NAME.origin, where some body's mass centre is elsewhere, that of the origin",
        default=(0.0, 0.0, 0.0),
    )
    rotation: Rotation = word(
        "configuration, body to world", default_factory=Rotation.model_construct
    )
    velocity: Vec3 = quantity("m/s", "velocity of the body's origin", default=(0.0, 0.0, 0.0))
    angular_velocity: Vec3 = quantity("rad/s", "world axes", default=(0.0, 0.0, 0.0))
    angular_velocity_axes: Literal["world", "body"] = word(
        "axes in which angular_velocity is given", default="world"
    )

    welded: tuple[BodyName, ...] = word(
        "nodes of flexible parts that are part of it: their mass and inertia add to its own",
        default=(),
    )
    part_of: BodyName | None = word(
        "body that this one is part of, with what is welded to it: its mass and inertia add to "
        "that, it has no motion of its own, and joints, springs and loads name that body; surfaces "
        "may be given on either",
        default=None,
    )
    drawn: tuple[Bar, ...] = word(
        "sections by which the body is drawn, beside its surfaces", default=()
    )

    @model_validator(mode="after")
    def _mass_or_primitive(self) -> "Rigid":
        if self.primitive is None and (self.mass is None or self.inertia is None):
            raise ValueError("needs mass and inertia, or a primitive")
        if self.primitive is not None and self.inertia is not None:
            raise ValueError("inertia: given twice; leave out inertia or primitive")
        return self


PARAMETERS = HISTORY = OUTPUT = Record()


def build(card: Rigid, scene: Scene) -> Columns:
    mass, inertia = _mass_and_inertia(card, scene)
    quaternion = card.rotation.quaternion()
    spin = np.asarray(card.angular_velocity)
    if card.angular_velocity_axes == "body":
        spin = matrix(quaternion) @ spin
    return {
        "mass": mass,
        "inertia": inertia,
        "mass_centre": card.mass_centre,
        "position": card.position,
        "quaternion": quaternion,
        "velocity": card.velocity,
        "angular_velocity": spin,
    }


def _mass_and_inertia(card: Rigid, scene: Scene) -> tuple[float, np.ndarray]:
    if card.primitive is not None:
        volume, per_mass = _primitive(card.primitive)
        density = card.primitive.density
        if card.mass is None and (density is None or volume == 0.0):
            raise scene.fail("needs a mass, or a primitive with density and volume", "primitive")
        if card.mass is not None and density is not None:
            raise scene.fail("mass is given twice: leave out mass or primitive.density", "mass")
        mass = card.mass if card.mass is not None else (density or 0.0) * volume
        return mass, mass * np.diag(per_mass)
    xy, xz, yz = card.products
    x, y, z = card.inertia or (0.0, 0.0, 0.0)
    inertia = np.array([[x, xy, xz], [xy, y, yz], [xz, yz, z]])
    moments = np.linalg.eigvalsh(inertia)
    if moments[0] <= 0.0 or moments[2] > (moments[0] + moments[1]) * (1.0 + 1e-9):
        raise scene.fail(
            "no solid has these moments of inertia: principal values "
            f"{moments[0]:.4g}, {moments[1]:.4g}, {moments[2]:.4g} must be positive and the "
            "largest at most the sum of the others",
            "inertia",
        )
    return float(card.mass or 0.0), inertia


def _primitive(p: Primitive) -> tuple[float, np.ndarray]:
    """Volume [m^3] and moments of inertia per mass [m^2]."""
    radius, length = p.radius or 0.0, p.length or 0.0
    if p.shape == "sphere":
        return 4.0 / 3.0 * np.pi * radius**3, np.full(3, 0.4 * radius**2)
    if p.shape == "box":
        x, y, z = p.size or (0.0, 0.0, 0.0)
        return x * y * z, np.array([y * y + z * z, x * x + z * z, x * x + y * y]) / 12.0
    across = length**2 / 12.0
    if p.shape == "rod":
        # a rod has no inertia about its axis: a millionth keeps the tensor invertible
        return 0.0, np.array([across, across, 1e-6 * across])
    side = radius**2 / 4.0 + across
    return np.pi * radius**2 * length, np.array([side, side, radius**2 / 2.0])
