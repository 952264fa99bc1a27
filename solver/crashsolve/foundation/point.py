"""Points: the nodes of shells, which have no triad; elements keep plain numbers in blocks of 16.

A point is smaller than a row of the node table: its rotary inertia is the same about any axis, and
elements need its spin alone. A point that the deck names is attached to a body of that name, so
that joints, loads, contacts and sensors act on it as on any body.
"""

from typing import TYPE_CHECKING, Any

from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    import numpy as np

# elements side by side, so that the compiler works on several at a time
LANES = 16

# bits of POINT.fixed: motions along and about the world axes, and all of them by a body
ATTACHED = 64
# beside it: the body is there for the point alone, in implicit steps
OWN = 128


POINT = Record("""
    r          m           3  position
    v          m/s         3  velocity; during a step that of its middle
    w          rad/s       3  angular velocity; during a step that of its middle
    mass_inv   1/kg           inverse mass
    J_inv      1/(kg m^2)     inverse inertia about any axis
    force      N           3  applied force
    torque     N m         3  applied torque
    load       N/m            squared frequencies of the elements times their mass here
    spin_load  N m            the same times their inertia
    fixed      flag           bits: x, y, z, rotates about them, 64 where it is attached to a body,
                              128 on its own
""")

# of all points that are attached to no body
MOTION = Record("""
    linear        N s    3  sum of the momenta
    angular       N m s  3  the same about the origin
    linear_size   N s       sum of |p|
    angular_size  N m s     sum of |r| |p| + |J w|
""")

ATTACHED_POINT = Record("""
    point  index     point
    node   index     body it is attached to
    spot   m      3  from the mass centre, body axes
""")

# a point that is tied to a face
TIE = Record("""
    point   index     that is tied
    corner  index  4  points of the face; of a triangle the third comes twice
    weight  1      4  N, of the corners
    height  m         c, along the normal of the face
""")

HOLD = Record("point  index  that is held")

# of a load on the elements of a part: which blocks it acts on
BLOCKS = Record("""
    first_corner  index  of the corners of the first block
    aside         count  from there to the corners that take its forces; not 0 of a piece alone
    quads         count  quadrilaterals
    triangles     count  triangles, in the blocks after theirs
    first_block   index  of the part's, and of its sums
""")


def blocks_of(p: "np.ndarray | np.void") -> Any:
    """Number of blocks of a row of these columns, or of all rows of a table."""
    return (p["quads"] + LANES - 1) // LANES + (p["triangles"] + LANES - 1) // LANES


# resultants of such a load on a block
BLOCK_SUM = Record("""
    force   N    3  in all
    moment  N m  3  about the origin
    work    W       power of the mean force of the step
""")
