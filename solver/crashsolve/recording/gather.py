"""The numbers of a sample, copied from the tables of a run to the columns of a block.

In a block, as in the history, a column has the samples one after the other, and of each the numbers
of all entities side by side. Addresses alone differ between scenes, so that one machine code is for
all of them (march.py).
"""

from math import inf

from crashsolve.foundation.addresses import copy_bytes, number_at
from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import cross

BLOCK = Record("""
    count     count  samples taken
    rows      count  samples whose extremes are sought
    is_sound  flag   whether all numbers of these are finite
""")
# columns of a block whose extremes are sought
BOUND = Record("""
    source   index  address of the first number
    column   count  bytes from one column to the next
    advance  count  bytes from one sample to the next
    width    count  columns
    number   count  entities
    first    index  extremes of the first
""")
# of a channel in a block, with the first samples that have them
EXTREME = Record("""
    least        1      in the unit of the channel
    greatest     1      in the unit of the channel
    at_least     count  sample
    at_greatest  count  sample
""")
# columns of a block that lie side by side in a table of a run
PIECE = Record("""
    target   index  address of the first number
    column   count  bytes from one column to the next
    advance  count  bytes from one sample to the next
    source   index  address of the first number
    stride   count  bytes from one entity to the next
    half     count  bytes of a history, of which there are two; 0 of other tables
    width    count  columns
    number   count  entities
""")
JOINT = Record("""
    joint       index  its number
    node        index  body b
    first       index  first row
    rows        count  its rows
    point       m    3  from the mass centre of b, body axes; 0 without a point
    force       N    3  on body b
    moment      N m  3  the same, about the point
""")
ORIGIN = Record("""
    node  index  of the body
    arm   m    3  from the origin to the mass centre, body axes
    r     m    3  position
""")


@kernel
def add_sample(scene):
    """Add the present sample to the block. Writes: block, joints, origins, memory."""
    for i in range(scene.joints.shape[0]):
        find_reaction(scene.joints[i], scene.nodes, scene.rows)
    for i in range(scene.origins.shape[0]):
        find_origin(scene.origins[i], scene.nodes)
    block, current = scene.block[0], scene.clock[0].current
    for i in range(scene.pieces.shape[0]):
        copy_piece(scene.pieces[i], block.count, current)
    block.count += 1


@kernel
def copy_piece(piece, sample, current):
    """Copy numbers of a sample; `current` is the half of a history. Writes: memory."""
    target = piece.target + sample * piece.advance
    source = piece.source + current * piece.half
    for i in range(piece.width):
        for j in range(piece.number):
            copy_bytes(target + i * piece.column + 8 * j, source + 8 * i + j * piece.stride, 8)


@kernel
def find_extremes(scene):
    """Extremes of every channel of a block, and whether all numbers are finite.

    Writes: block, extremes.
    """
    block = scene.block[0]
    block.is_sound = 1
    for i in range(scene.bounds.shape[0]):
        own = scene.bounds[i]
        for c in range(own.width):
            for j in range(own.number):
                extreme = scene.extremes[own.first + c * own.number + j]
                find_extreme(own.source + c * own.column + 8 * j, own.advance, block, extreme)


@kernel
def find_extreme(address, advance, block, extreme):
    """Extremes of numbers that lie `advance` bytes apart. Writes: block, extreme."""
    low = number_at(address)
    high, at_low, at_high = low, 0, 0
    for k in range(block.rows):
        x = number_at(address + k * advance)
        if not low <= x <= high:
            if x < low:
                low, at_low = x, k
            elif x > high:
                high, at_high = x, k
            else:
                block.is_sound = 0
    if not high - low < inf:
        block.is_sound = 0
    extreme.least, extreme.greatest = low, high
    extreme.at_least, extreme.at_greatest = at_low, at_high


@kernel
def find_reaction(joint, nodes, rows):
    """Force and moment of a joint on its body b at its point, world axes. Writes: joint."""
    for k in range(3):
        joint.force[k] = reaction_along(joint, 6 + k, rows)
        joint.moment[k] = reaction_along(joint, 9 + k, rows)
    lever = cross(matvec(nodes[joint.node].A, joint.point), joint.force)
    for k in range(3):
        joint.moment[k] -= lever[k]


@kernel
def reaction_along(joint, k, rows):
    """Component k of D^T lambda, over the rows of a joint."""
    # from 0: nothing is not -0
    reaction = 0.0
    for i in range(joint.first, joint.first + joint.rows):
        reaction += rows[i].D[k] * rows[i].reaction
    return reaction


@kernel
def find_origin(origin, nodes):
    """Position of the origin of a body. Writes: origin."""
    node = nodes[origin.node]
    arm = matvec(node.A, origin.arm)
    for k in range(3):
        origin.r[k] = node.r[k] - arm[k]
