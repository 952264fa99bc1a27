"""Numbers of points to the lanes of a block and back, eight elements at a time.

    work[row + 3 quantity + k, e] = points[corner of e].quantity[k]   and   points[...] += work[...]

One number at a time this takes a third of the time of an elastic shell: as many stores as numbers.
Here it is as plain Python runs it; `translation/lanes.py` compiles it to loads of whole points and
a transposition of eight by eight numbers. Consequence to test: the same numbers by both.
"""

from crashsolve.foundation.point import LANES

# elements at a time, and rows of `work` from one quantity of a corner to the next
EIGHT, NEXT = 8, 12


def gather_motion(points, corners, first, work, at):
    """Positions, velocities and spins of eight points to rows of `work`. Writes: work."""
    for e in range(EIGHT):
        b = points[corners[first + e]]
        for k in range(3):
            work[at + LANES * k + e] = b.r[k]
            work[at + LANES * (NEXT + k) + e] = b.v[k]
            work[at + LANES * (2 * NEXT + k) + e] = b.w[k]


def add_forces(points, corners, first, work, at, loads, live):
    """Forces, torques and both loads in rows of `work` onto as many of eight points.

    Writes: points.
    """
    for e in range(min(live, EIGHT)):
        b = points[corners[first + e]]
        for k in range(3):
            b.force[k] += work[at + LANES * k + e]
            b.torque[k] += work[at + LANES * (NEXT + k) + e]
        b.load += work[loads + e]
        b.spin_load += work[loads + LANES + e]
