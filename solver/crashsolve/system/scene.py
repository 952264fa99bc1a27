"""What a scene provides to an integrator. compose writes these functions for each deck.

This file only names and documents them, so that an integrator is ordinary Python to its reader
and to the checks; none of it is ever called.
"""

JOINTS = True  # has constraint rows
CAPTURES = True  # has unilateral constraints; without, what asks for it is not in the step at all
ASSEMBLED = True  # has shells or beams; without, no matrix of nodes is in an implicit step
CONTACTS = True  # has contact pairs
DENSE = True  # a sample may lie within a step
ONSETS = True  # something may begin within a step
PIECES = True  # has force laws of several pieces
REBUILDS = True  # keeps a list of near pairs that must be renewed


def residual(current, time, nodes, rows, curves, groups):
    """Phi(q, t) of every joint. Writes: rows.phi, new histories."""


def jacobian(current, time, nodes, rows, curves, groups):
    """D and nu = -Phi_t of every joint. Writes: rows.D, nu."""


def convective(current, time, nodes, rows, curves, groups):
    """gamma = -D_dot v - Phi_tt of every joint. Writes: rows.gamma."""


def tangents(clock, nodes, curves, compliant, groups):
    """Tangents of all springs and contacts, for implicit integrators. Writes: compliant."""


def elements(clock, h, groups):
    """Forces of elements after a step of h from what they kept before it. Writes: points, lanes."""


def bend(h, clock, nodes, curves, matrix, groups):
    """Tangents of shells after a step of h; what turns forces of beams, springs. Writes: matrix."""


def renew(h, clock, nodes, rows, curves, compliant, matrix, t, tt, groups):
    """All tangents and the factor, at the present place. Writes: matrix, compliant."""


def keep_elements(groups):
    """What elements keep at the start of a step. Writes: lanes_before."""


def force_pass(clock, time, h, nodes, rows, curves, groups):
    """Applied forces at the end of a step of length h. Writes: nodes, outputs, new histories."""


def hold(h, clock, control, nodes, groups):
    """Impulses in the first half of a step on what unilateral constraints hold. Writes: nodes."""


def react(h, clock, nodes, groups):
    """Impulses in the second half, and on what has just touched. Writes: nodes, new histories."""


def approach(current, nodes, groups):
    """Largest depth of what did not touch at the start of the step [m]; negative is a gap.

    Where ends of contacts are located too: and largest gap of what did touch.
    """
    return -1.0


def approach_before(current, groups):
    """The same at the start of the step [m]."""
    return -1.0


def beyond(current, h, nodes, curves, groups):
    """How far force laws are past the pieces on which a step of h began [m or rad]; 0: not yet."""
    return -1.0


def need_rebuild(clock, nodes, groups):
    """Whether the next step might touch a pair that is not in the list. Writes: clock.next_step."""
    return False


def sum_powers(current, h, groups):
    """Energy dissipated since the start of a step of h, by dense output. Writes: new histories."""


def energy(clock, nodes, groups, ledger):
    """Energies of the present state. Writes: ledger."""


def measure(time, nodes, rows, curves, groups):
    """Readings of all sensors. Writes: outputs."""
