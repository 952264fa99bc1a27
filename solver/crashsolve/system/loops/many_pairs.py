"""Many contact pairs in pieces: the work of each piece, and the sums of all.

One thread does the pieces one after the other, and adds the loads of each pair to its bodies at
once. Several do the pieces side by side (pieces.py), and bodies add up their loads afterwards, in
the same order (model/contact/pieces.py). What both run is apart (foundation/kernels.py).
Consequence to test: the same bits for any number of threads.
"""

from crashsolve.foundation.kernels import apart, kernel
from crashsolve.system.contact import resting, touches
from crashsolve.system.loops.approach import depth_before, gaps_of
from crashsolve.system.loops.contact_pairs import contact_pairs


@apart
def pair_forces_piece(group, k, clock, h, scene):
    """Forces of some pairs. Writes: loads, applied, sums, counts, outputs, new histories."""
    touches.clear_card(group.sums[k], resting.least_depth(h, clock, scene.control[0]))
    touches.clear_counts(group.counts[k])
    contact_pairs(group, k, clock, h, scene.nodes, scene.curves, scene)


@apart
def load_bodies_piece(group, k, scene):
    """Add to some bodies the forces of their pairs, pair by pair. Writes: scene.nodes."""
    for j in range(group.ranges[k].first, group.ranges[k].end):
        loaded = group.loaded_bodies[j]
        body = scene.nodes[loaded.node]
        for at in range(loaded.first, loaded.end):
            if group.applied[at] == 1:
                touches.add_load(body, group.loads[at])


@kernel
def sum_pieces(group, clock, scene):
    """Add the sums of the pieces to the contact cards. Writes: scene.cards, card_history."""
    for k in range(group.pieces.shape[0]):
        card = group.pieces[k].card
        history = scene.card_history[1 - clock.current, card]
        touches.add_sums(scene.cards[card], history, group.sums[k], group.counts[k])


@apart
def approach_piece(group, k, clock, floor, scene):
    """Largest depth of some pairs at both ends of a step. Writes: pieces."""
    piece = group.pieces[k]
    piece.nearest = gaps_of(group, k, clock.current, scene.nodes, floor, -1e300, scene)
    piece.before = depth_before(group, k, clock.current, -1e300, scene)


@kernel
def nearest_of_pieces(group, deepest, scene):
    """The largest of these depths, and of another [m]."""
    for k in range(group.pieces.shape[0]):
        deepest = max(deepest, group.pieces[k].nearest)
    return deepest


@kernel
def before_of_pieces(group, deepest, scene):
    """The largest depth at the start of the step [m], as of the last search."""
    for k in range(group.pieces.shape[0]):
        deepest = max(deepest, group.pieces[k].before)
    return deepest
