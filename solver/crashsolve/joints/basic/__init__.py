"""Basic constraints: rows of which joints are made, each with Jacobian and convective term.

A joint names those that it is made of (CONSTRAINTS). With d = x_b - x_a between the joint's points,
each file has kernels of (p, nodes, rows, r): `residual` writes Phi, `jacobian` D and nu,
`convective` gamma, from row r on; ANGULAR states how many rows it has, and which of them are
angles.

Reference: Haug (1989), Computer Aided Kinematics and Dynamics of Mechanical Systems, ch. 9.
"""

from collections.abc import Sequence
from typing import Protocol


class Rotating(Protocol):
    """A basic constraint, by which of its rows are rotations."""

    @property
    def ANGULAR(self) -> tuple[bool, ...]: ...


def rows_of(constraints: Sequence[Rotating], *own: bool) -> tuple[int, tuple[bool, ...]]:
    """ROWS and ANGULAR of a joint: the rows of its basic constraints, then those of its own."""
    angular = (*(row for basic in constraints for row in basic.ANGULAR), *own)
    return len(angular), angular
