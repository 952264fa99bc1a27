"""Data of a contact pair in the step, as its kernels pass them on."""

from typing import NamedTuple

from crashsolve.foundation.rows import Row
from crashsolve.foundation.vec3 import Vector


class Pair(NamedTuple):
    """Data of a pair of elements."""

    p: Row  # row of parameters
    old: Row  # history: accepted, and new
    new: Row
    out: Row  # output
    first: Row  # elements of side a and of side b
    second: Row
    a: Row  # their bodies
    b: Row


class Ends(NamedTuple):
    """A pair of elements before its gap is known."""

    p: Row  # row of parameters
    old: Row  # history: accepted, and new
    new: Row
    a: Row  # elements of side a and of side b
    b: Row


class Totals(NamedTuple):
    """Sums to which a pair adds."""

    on_a: Row  # forces on both bodies: the bodies, or separate loads of the pair
    on_b: Row
    card: Row  # its contact card and the history of that, or those of its piece
    count: int


class ContactPoint(NamedTuple):
    """Point of contact of two elements, and the slip of a over b in the step."""

    depth: float  # [m]
    n: Vector  # unit normal out of b
    x: Vector  # position [m]
    # see work.motion_over; None where the work of both halves is not summed
    motion: tuple[Vector, ...] | None


class Slide(NamedTuple):
    """Arguments of a law of friction."""

    normal_force: float  # [N]
    slip: Vector  # velocity of a over b [m/s]
    # the same in the middle of the step; None where that counts for nothing: at nodes of shells,
    # and where power is summed
    middle: Vector | None
    displacement: Vector | None  # of a over b in the step [m]; None where power is summed
    n: Vector  # unit normal
    mass: float  # of both sides along n [kg]
    compliance: float  # slip that friction takes per newton in half a step [s/kg]


class Sliding(NamedTuple):
    """Sliding motion of a pair."""

    n: Vector  # unit normal
    slip: Vector  # velocity of a over b [m/s]
    displacement: Vector | None  # of a over b in the step [m]; None where power is summed
    f: float  # normal force [N]
    mass: float  # of both sides along n [kg]
    d_a: Vector  # arms of the position in both bodies [m]
    d_b: Vector


class NormalResponse(NamedTuple):
    """A normal force, and how it depends on the closing speed."""

    f: float  # [N]
    rate: float  # closing speed [m/s]
    damping: float  # slope over that [N s/m]
    weight: float  # of the speed that it leads to; see damping.py


class Closing(NamedTuple):
    """Closing motion of a pair."""

    rate: float  # closing speed [m/s]
    mass: float  # of both sides along n [kg]
    mobility: tuple[float, float]  # of each side [1/kg]
    applied: float  # share of the force that counts in the step
    corners: int  # of the area of contact; 0 in a point


class Friction(NamedTuple):
    """Friction of a pair: force, energies, stiffness."""

    t: Vector  # force on side a [N]
    # the same with the moment about the normal; None in a point
    force: tuple[Vector, Vector] | None
    displacement: Vector | None  # along which both do work; None in a point
    power: float  # lost [W]
    loss: float  # in the step [J]


class ProbeHit(NamedTuple):
    """The contact of a probe with the shape in which it is deepest."""

    x: Vector  # its position [m]
    v: Vector  # its velocity [m/s]
    hit: Row  # the deepest shape
    retained: bool  # whether it retains the face that it touched before
    over: float  # its distance beyond the middle of that [m]


class Touch(NamedTuple):
    """A probe in contact, or in contact at the start of the step."""

    number: int  # of its record
    probe: Row
    x: Vector | None  # its position [m]; None on faces
    v: Vector  # its velocity [m/s]
    old: Row  # its records: accepted, and new
    new: Row
    hit: Row  # the face or shape in contact
    old_displacement: Vector  # its displacement over that in the step, where it touched before [m]


class ProbeResponse(NamedTuple):
    """Normal force that presses a probe on a surface."""

    f: float  # normal force [N]
    mass: float  # of both sides along the normal [kg]
    displacement: Vector | None  # over the step in the present position [m]
