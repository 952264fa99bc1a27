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


class Meeting(NamedTuple):
    """Where the elements meet, and how a has moved over b in the step."""

    depth: float  # [m]
    n: Any  # unit normal out of b
    x: Any  # place [m]
    motion: Any  # see work.motion_over; None where the work of both halves is not summed


class Sliding(NamedTuple):
    """What a law of friction is told of a pair."""

    n: Any  # unit normal
    slip: Any  # velocity of a over b [m/s]
    way: Any  # displacement of a over b in the step [m]; None where power is summed
    f: float  # normal force [N]
    mass: float  # of both sides along n [kg]
    d_a: Any  # arms of the place in both bodies [m]
    d_b: Any


class Push(NamedTuple):
    """A normal force and what it does to the step."""

    f: float  # [N]
    rate: float  # closing speed [m/s]
    damping: float  # slope over that [N s/m]
    most_stiffness: float  # bounds for the step control [N/m, N s/m]
    most_damping: float
