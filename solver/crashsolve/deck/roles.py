"""Functions that the file of a law may provide, role by role; the step calls no others.

The Protocol of a family is made of the roles that every law of it plays. The others are hooks: a
law that provides one is asked by it, wherever its family stands. Type checkers, the error for a
law that lacks something, the contract tests and ADDING.md all read these classes.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from crashsolve.deck.building import Columns, Pair, Scene


class Built(Protocol):
    """Every law: its card becomes one row of PARAMETERS."""

    def build(self, card: Any, scene: Scene) -> Any:
        """Words into symbols, names into indices: one row of PARAMETERS."""


class Expanded(Protocol):
    """A law that is written out in other cards, when the deck is read, and not built itself."""

    def expand(
        self, name: str, card: object, laws: Mapping[str, object], control: Mapping[str, object]
    ) -> Sequence[object]:
        """Entries by keyword and name, as a deck has them."""

    def unused(self, card: Any) -> Mapping[tuple[str | int, ...], str]:
        """Reasons why fields of the card have no effect beside the others, by path."""


class BasicConstraint(Protocol):
    """Rows of which joints are made, from row r on (joints/basic)."""

    ANGULAR: tuple[bool, ...]

    def residual(self, p, nodes, rows, r):
        """Phi(q) [m or 1]. Writes: rows.phi."""

    def jacobian(self, p, nodes, rows, r):
        """D, and nu = 0. Writes: rows.D, nu."""

    def convective(self, p, nodes, rows, r):
        """gamma = -D_dot v. Writes: rows.gamma."""


class Constraint(Protocol):
    """Constraint rows between bodies, from row p.first_row on: basic ones, then its own."""

    CONSTRAINTS: tuple[BasicConstraint, ...]
    ROWS: int
    ANGULAR: tuple[bool, ...]


class OwnRows(Protocol):
    """A constraint with rows that its file writes itself, behind its basic ones.

    Units are those of ROW (model/nodes.py): Phi in m or 1, nu in m/s, gamma in m/s^2.
    """

    def residual(self, p, old, new, t, nodes, rows, curves):
        """Phi(q, t). Writes: rows.phi, new."""

    def jacobian(self, p, old, t, nodes, rows, curves):
        """D and nu = -Phi_t. Writes: rows.D, nu."""

    def convective(self, p, old, t, nodes, rows, curves):
        """gamma = -D_dot v - Phi_tt. Writes: rows.gamma."""


class Releasing(Protocol):
    """A constraint that comes apart."""

    def release_rows(self, p, old, rows, count):
        """Clear the constraint rows of a joint that has been released.

        Writes: rows.phi, D, nu, gamma.
        """


class Force(Protocol):
    """Forces on bodies, evaluated in every step.

    `p` is the row of PARAMETERS, `old` and `new` are those of HISTORY, `out` that of OUTPUT with
    `stored` [J], `power` [W], which is lost at this moment, and `loss` [J], which was in the step;
    `t` the time and `h` the step [s], 0 at samples; tables of nodes, constraint rows and curves.
    """

    def force(self, p, old, new, out, t, h, nodes, rows, curves):
        """Forces on bodies, stored energy, power and loss.

        Writes: nodes, out, new.
        """


class Reading(Protocol):
    """A law that is evaluated at samples and acts on nothing."""

    def measure(self, p, out, t, nodes, rows, curves):
        """Readings at a sample. Writes: out."""


class Following(Protocol):
    """A sensor that is evaluated in every step."""

    def follow(self, p, old, new, out, nodes):
        """Update its history by a step. Writes: new, out."""


class Tangent(Protocol):
    """A law of force whose slopes implicit methods use, in TANGENTS rows for each entry."""

    TANGENTS: int

    def tangent(self, p, state, nodes, curves, rows, first):
        """Directions, stiffness and damping, from row `first` on. Writes: rows."""


class RotationalForce(Protocol):
    """A law whose force rotates with its bodies, reported where elements have blocks of nodes."""

    def geometric_stiffness(self, p, out, nodes, slot, blocks):
        """Stiffness from the rotation of the present force. Writes: blocks."""


class Branches(Protocol):
    """A law of force with corners, at which Runge-Kutta steps end."""

    def event(self, p, old, h, nodes, curves):
        """Distance beyond the branch on which the step of h began, 0 at the corner."""


class NormalLaw(Protocol):
    """A law of the normal force of contact."""

    def build(self, card: Any, scene: Scene, pair: Pair) -> Columns:
        """The row of PARAMETERS of a card; `pair` has the radii of both surfaces."""

    def normal_force(self, p, old, new, h, depth, rate, mass, curves):
        """Force >= 0 [N], stored [J], power [W], loss [J], stiffness, damping. Writes: new.

        Of the depth [m], its rate [m/s], and the mass of both sides along the normal [kg].
        """

    def normal_tangent(self, p, state, depth, rate, mass, curves):
        """Slopes of the force over the depth [N/m] and over its rate [N s/m]."""

    def release(self, p, old, new):
        """The surfaces are apart. Writes: new."""


class ImplicitDamping(Protocol):
    """A normal law whose damping is by the closing speed to which it leads, in steps of kicks."""

    def rate_slope(self, p, old, new, h, depth, mass):
        """Rise of the force over small closing speeds [N s/m]."""

    def implicit_rate(self, p, slope, depth, free, compliance):
        """Closing speed u = free - compliance f(u) [m/s]."""

    def resolved_slopes(self, p, new, rate, mass, stored, stiffness, damping):
        """Stiffness and damping that bound the step, of those of normal_force [N/m, N s/m]."""


class FrictionLaw(Protocol):
    """A law of friction of contact."""

    def build(self, card: Any, scene: Scene) -> Columns:
        """Words into symbols."""

    def friction_force(self, p, old, new, slide, curves):
        """Force on a (3) [N], stored [J], power [W], loss [J], stiffness, damping. Writes: new.

        `slide` is a Slide (system/contact/pair.py): normal force, slip, displacement, normal, mass,
        compliance.
        """

    def release(self, p, old, new):
        """The surfaces are apart. Writes: new."""


class FrictionTangent(Protocol):
    """Friction that depends on the sliding speed alone, as implicit methods ask for it."""

    def friction_tangent(self, p, normal_force, slip):
        """Slopes of the force over the slip, along it and across it [N s/m]."""


class FrictionRate(Protocol):
    """Friction that depends on the sliding speed alone, as explicit steps resolve it."""

    def slip_rate(self, p, slide, h):
        """Change of the slip per time over its distance from where friction vanishes [1/s]."""


class FrictionBranches(Protocol):
    """Friction with corners, at which Runge-Kutta steps end."""

    def regime_left(self, p, old, slip):
        """Difference of the slip from the regime in which the step began [m/s]."""


class NormalBranches(Protocol):
    """Normal force with corners, at which steps that are chosen by their error end."""

    def branch_left(self, p, old, h, depth, rate, curves):
        """Distance beyond the branch on which the step of h began [m]; below 0: on it."""


class GapRoutine(Protocol):
    """The gap between two shapes, first and second in the name of the file."""

    def gap(self, a, b, nodes, data):
        """Signed depth [m], unit normal (3) out of b, point of contact (3) [m]."""


class Shape(Protocol):
    """A shape that a surface may have: the elements that gap routines take."""

    def build(self, card: Any, scene: Scene) -> list[Columns]:
        """A list of elements, each a row of PARAMETERS."""

    def curvature_radius(self, card: Any) -> float | None:
        """Radius for laws that ask for one; infinite for a plane, None for none."""


class PointForce(Protocol):
    """A load on the points of parts that keep their elements in blocks."""

    def members(self, card: Any, scene: Scene) -> np.ndarray:
        """Points that an entry acts on (n,); without it those of all parts."""

    def force_on_points(self, p, old, new, out, t, h, nodes, curves, scene, members=None):
        """Forces on these points; `members` of all entries, if it names any. Writes: scene, out."""


class ElementLoad(Protocol):
    """A load on elements kept in blocks; its PARAMETERS have the columns BLOCKS."""

    def load_elements(self, p, old, out, h, scene):
        """Forces on some blocks, which one of several threads does. Writes: scene.points, sums."""

    def add_up(self, p, out, h, nodes, block_sums):
        """Sums over all blocks of the part, in their order. Writes: nodes, out."""


class KickingPoints(Protocol):
    """A load on points, whose half kick the balance of energy has to know."""

    def kick_rate(self, p, out, scene, members=None):
        """f . M^-1 F of its forces f on points and all forces F on them [W/s]."""


class Bending(Protocol):
    """Elements whose tangent goes to the blocks of their nodes, beside the rows of `tangent`."""

    def tangent_blocks(self, p, state, nodes, curves, slot, blocks):
        """Tangent by positions. Writes: blocks."""


class ElementEnergies(Protocol):
    """Parts that keep their elements in blocks."""

    def energies(self, p, new, out, scene):
        """Stored and dissipated energies of the part. Writes: new, out."""


class FibreLaw(Protocol):
    """Elements of fibres, which call the law of their material."""

    def force(self, p, old, new, out, t, h, nodes, rows, curves, material):
        """Forces on bodies, stored energy, power and loss.

        Writes: nodes, out, new.
        """

    def tangent(self, p, state, nodes, curves, rows, first, material):
        """Compliant rows from row `first` on. Writes: rows."""

    def tangent_blocks(self, p, state, h, nodes, curves, slot, blocks, material):
        """Slopes of its forces by the positions of its nodes after a step of h. Writes: blocks."""


class TableForce(Protocol):
    """A law of force that reads tables which all its entries share.

    `shared_tables(cards, table, scene)` makes them, once; () where this scene needs none.
    """

    def force_with_tables(self, p, old, new, out, t, h, nodes, rows, curves, data):
        """`force`, where there are such tables: a tuple of them. Writes: nodes, out, new."""


class StepLaw(
    OwnRows,
    Releasing,
    Force,
    TableForce,
    Reading,
    Following,
    Tangent,
    RotationalForce,
    Branches,
    PointForce,
    ElementLoad,
    Bending,
    ElementEnergies,
    Protocol,
):
    """All that the loops of a step may call of a law; each plays some of the roles."""


class KeptFace(Protocol):
    """A gap routine of shapes with faces: contact continues with the face that it has."""

    def gap_by(self, a, b, nodes, data, n):
        """Gap along the normal n of the touch so far, and whether it still is one."""


class RoundMiddle(Protocol):
    """A gap routine that gives the depth of the middle of a round shape."""

    def middle(self, a, b, nodes, n):
        """Depth at which the middle passes [m]."""


class QuickBound(Protocol):
    """A gap routine with a cheaper bound of its depth."""

    def bound(self, a, b, nodes, data):
        """Not below the depth; negative where the shapes are apart [m]."""


class Exits(Protocol):
    """A gap routine of shapes that may leave each other by several exits."""

    def search(self, a, b, nodes, data):
        """Gap along the shortest exit, and its lead over the next one [m]."""

    def follow(self, a, b, nodes, data, n):
        """Gap along the exit nearest to direction n."""


class Area(Protocol):
    """A gap routine of sides that press on each other over an area."""

    def patch(self, a, b, nodes, data, n, x):
        """Number of corners of the area, and the radius with which friction resists a spin."""


class StepGap(GapRoutine, KeptFace, RoundMiddle, QuickBound, Exits, Area, Protocol):
    """All that the loops of a step may call of a gap routine."""


class StepFriction(FrictionLaw, FrictionTangent, FrictionRate, FrictionBranches, Protocol):
    """All that the loops of a step may call of a law of friction."""
