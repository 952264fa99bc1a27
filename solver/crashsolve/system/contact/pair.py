"""A contact pair in the step, as its kernels hand it on."""

from typing import Any, NamedTuple


class Pair(NamedTuple):
    """What belongs to a pair of elements."""

    p: Any  # row of parameters
    old: Any  # history: accepted, and new
    new: Any
    out: Any  # output
    first: Any  # elements of side a and of side b
    second: Any
    a: Any  # their bodies
    b: Any


class Ends(NamedTuple):
    """A pair of elements before it is known to touch."""

    p: Any  # row of parameters
    old: Any  # history: accepted, and new
    new: Any
    a: Any  # elements of side a and of side b
    b: Any


class Totals(NamedTuple):
    """What a pair adds to."""

    on_a: Any  # forces on both bodies: the bodies, or loads of the pair's own
    on_b: Any
    card: Any  # its contact card, and what that remembers, or such of its piece
    count: Any


class Meeting(NamedTuple):
    """Where the elements meet, and how a has moved over b in the step."""

    depth: float  # [m]
    n: Any  # unit normal out of b
    x: Any  # place [m]
    motion: Any  # see work.motion_over; None where the work of both halves is not summed


class Slide(NamedTuple):
    """What a law of friction is reported."""

    normal_force: float  # [N]
    slip: Any  # velocity of a over b [m/s]
    displacement: Any  # displacement of a over b in the step [m]; None where power is summed
    n: Any  # unit normal
    mass: float  # of both sides along n [kg]
    ease: float  # slip that friction takes per newton in half a step [s/kg]


class Sliding(NamedTuple):
    """How a pair slides."""

    n: Any  # unit normal
    slip: Any  # velocity of a over b [m/s]
    displacement: Any  # displacement of a over b in the step [m]; None where power is summed
    f: float  # normal force [N]
    mass: float  # of both sides along n [kg]
    d_a: Any  # arms of the position in both bodies [m]
    d_b: Any


class Push(NamedTuple):
    """A normal force and what it does to the step."""

    f: float  # [N]
    rate: float  # closing speed [m/s]
    damping: float  # slope over that [N s/m]
    most_stiffness: float  # bounds for the step control [N/m, N s/m]
    most_damping: float


class Closing(NamedTuple):
    """How a pair closes."""

    rate: float  # closing speed [m/s]
    mass: float  # of both sides along n [kg]
    applied: float  # share of the force that counts in the step
    corners: int  # of the area over which the sides press; 0 in a point


class Friction(NamedTuple):
    """What friction does to a pair."""

    t: Any  # force on side a [N]
    force: Any  # the same with the moment about the normal; None in a point
    displacement: Any  # and what both work over; None in a point
    power: float  # lost [W]
    loss: float  # in the step [J]


class Seen(NamedTuple):
    """What a probe has found among the shapes."""

    x: Any  # its position [m]
    v: Any  # its velocity [m/s]
    hit: Any  # the deepest shape
    held: bool  # whether it goes on by the face that it touched before
    over: float  # how far it is past the middle of that [m]


class Touch(NamedTuple):
    """A probe that touches, or has touched."""

    number: int  # of its record
    probe: Any
    x: Any  # its position [m]; None on faces
    v: Any  # its velocity [m/s]
    old: Any  # its records: accepted, and new
    new: Any
    hit: Any  # what it touches
    past: Any  # its displacement over that in the step, where it touched before [m]


class Pressing(NamedTuple):
    """What presses a probe on what it touches."""

    f: float  # normal force [N]
    mass: float  # of both sides along the normal [kg]
    displacement: Any  # displacement over the step in the present position [m]
