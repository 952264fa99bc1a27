"""The interface of a law's `build` to the scene, while cards become numbers; see `model/scene.py`.

Frames: a body's own axes and origin are those of its card; inside, points are measured from the
mass centre. Nodes are rows of the node table, the ground is 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from types import ModuleType
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from crashsolve.foundation.errors import DeckError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# values by the names of columns of a record: numbers, vectors, indices of nodes
Columns = dict[str, Any]


class Pair(Protocol):
    """The contact and its two surfaces, for the build of a normal law."""

    contact: str
    radius_a: float | None  # [m]; infinite for a plane, None where the surface has none
    radius_b: float | None


class EntryOfScene(Protocol):
    """A named card of the deck, and the module of its law."""

    @property
    def name(self) -> str: ...
    @property
    def type(self) -> str: ...
    @property
    def module_name(self) -> str: ...
    @property
    def card(self) -> Any: ...
    @property
    def is_made(self) -> bool: ...


class DeckOfScene(Protocol):
    """The deck: its control card, and entries by section and name."""

    @property
    def control(self) -> Any: ...
    @property
    def entries(self) -> Mapping[str, Mapping[str, EntryOfScene]]: ...


class JointOfScene(Protocol):
    """Rows of a joint that another card names; its point and axis in axes of both bodies."""

    name: str
    nodes: tuple[int, ...]  # a and b; and two for each further part of the rows
    first_row: int
    rows: int  # of each part
    angular: tuple[bool, ...]
    frame: Columns

    @property
    def node_a(self) -> int: ...
    @property
    def node_b(self) -> int: ...
    @property
    def parts(self) -> int: ...


class SurfaceOfScene(Protocol):
    """A surface and its elements."""

    @property
    def entry(self) -> EntryOfScene: ...
    @property
    def module(self) -> ModuleType: ...
    @property
    def shape(self) -> str: ...
    @property
    def elements(self) -> list[Columns]: ...


class MeshOfScene(Protocol):
    """The mesh of a part, see meshes/_mesh.py."""

    points: np.ndarray  # (n, 3) [m]
    quads: np.ndarray  # (m, 4) corners of elements
    sets: dict[str, np.ndarray]
    element_sets: dict[str, np.ndarray]
    own: slice | None  # of a shared mesh: points that this part moves
    origin: np.ndarray | None  # first point of a shared mesh, as it was written [m]


class PartOfScene(Protocol):
    """A part with points in place."""

    @property
    def card(self) -> Any: ...
    @property
    def mesh(self) -> MeshOfScene: ...

    first: int  # of its points among all
    used: np.ndarray  # points of its elements
    fixed: np.ndarray  # (n,) how each point moves, see foundation/point.py
    mass: np.ndarray  # (n,) of the points [kg]
    J: np.ndarray  # (n,) [kg m^2]
    area: np.ndarray  # of the elements [m^2]
    quad_count: int  # of them, quadrilaterals
    can_fail: bool  # whether elements may be deleted
    is_damped: bool
    lumps: tuple[np.ndarray, np.ndarray, np.ndarray] | None  # of a shared mesh, corner by corner
    velocity: np.ndarray  # (n, 3) at the start [m/s]
    spin: np.ndarray  # (n, 3) at the start [rad/s]
    momentum: np.ndarray  # (n, 3) of impulses at the start [N s]

    def velocities(self) -> np.ndarray:
        """Velocities of the points at the start (n, 3) [m/s], with those of impulses."""

    def set_of(self, name: str, field: str, scene: Scene) -> np.ndarray:
        """Points of a set of its mesh; an unknown one is refused at `field`."""


class BetweenBodies(Protocol):
    """A card that names two bodies."""

    @property
    def a(self) -> str: ...
    @property
    def b(self) -> str: ...


class Attached(BetweenBodies, Protocol):
    """A card of a law between points of two bodies."""

    @property
    def at_a(self) -> ArrayLike: ...
    @property
    def at_b(self) -> ArrayLike: ...


class AboutAxis(BetweenBodies, Protocol):
    """A card of a law about an axis of a."""

    @property
    def axis(self) -> ArrayLike: ...


class Meshed(Protocol):
    """A card with a mesh."""

    @property
    def mesh(self) -> object: ...


class Jointed(BetweenBodies, Protocol):
    """A card of a joint: its point, in axes of `frame`."""

    @property
    def at(self) -> ArrayLike: ...
    @property
    def frame(self) -> str: ...


class Scene(Protocol):
    """Names, configurations at the start, curves and errors of one deck."""

    names: list[str]  # of the nodes (n,)
    mass: np.ndarray  # (n,) [kg]
    J: np.ndarray  # (n, 9) inertia in body axes [kg m^2]
    r: np.ndarray  # (n, 3) mass centre [m]
    v: np.ndarray  # (n, 3) [m/s]
    w: np.ndarray  # (n, 3) [rad/s]
    q: np.ndarray  # (n, 4) unit quaternion, body to world
    A: np.ndarray  # (n, 9) rotation matrix, by rows
    offset: np.ndarray  # (n, 3) mass centre from the body's origin, body axes [m]
    size: float  # of the model [m]
    part_nodes: dict[str, list[int]]  # of each part that has bodies for nodes
    welded: dict[int, int]  # nodes that are part of a rigid body, and the body
    inertia_shares: dict[int, float]  # of attached nodes: inertia in bounds of the step, over own
    attached: dict[str, list[tuple[int, int]]]  # points of a part, and their bodies
    angles_at_start: dict[str, float]  # of joints that a posture has rotated [rad]
    posed: dict[int, str]  # bodies that a posture has placed, and its root
    joints: dict[str, JointOfScene]
    surfaces: Mapping[str, SurfaceOfScene]
    curves: dict[str, int]
    curve_points: np.ndarray  # all curves, as kernels read them
    warnings: list[str]
    errors: list[DeckError]  # found so far
    tied_mass: float  # of tied nodes, whose faces have it besides [kg]
    stepwise: list[str]  # laws that count in whole steps
    methods: list[str]  # integrators of all families; empty for any

    @property
    def deck(self) -> DeckOfScene: ...

    # messages
    def fail(self, message: str, field: str | None = None) -> ValueError:
        """The exception for a card that cannot be built: `raise scene.fail(...)`."""

    def warn(self, message: str) -> None:
        """A line of the log."""

    def building(self, entry: Any) -> AbstractContextManager[None]:
        """Collects the errors of one card, with its position in the deck."""

    # other cards
    def law(self, keyword: str, name: str) -> tuple[ModuleType, Any]:
        """Module and card of an entry that another card names."""

    def built(self, card: object) -> Any:
        """Columns that a law within a card builds."""

    def curve(self, name: str) -> int:
        """Number of a curve of the deck."""

    def own_backbones(self) -> dict[str, Any]:
        """Backbones of the hinge that is being built, by the fields that name their curves."""

    def joint_entry(self, name: str) -> EntryOfScene:
        """Entry of a joint that another card names, of whichever family."""

    def refuse_joint(self, name: str, motions: tuple[str, ...], field: str) -> None:
        """Refuses a named joint without any of some motions: `angle`, `travel`, `ball`."""

    # bodies and points at the start
    def node(self, body: str) -> int:
        """Row of a body, or of a node of a part that may move by itself."""

    def matrix(self, node: int) -> np.ndarray:
        """Rotation matrix (3, 3), body to world."""

    def unit(self, direction: ArrayLike, field: str) -> np.ndarray:
        """Unit vector; a direction without length is refused at `field`."""

    def from_mass_centre(self, node: int, point: ArrayLike) -> np.ndarray:
        """Point of the body's card frame, measured from the mass centre, body axes [m]."""

    def world_point(self, node: int, point: ArrayLike) -> np.ndarray:
        """Position of a point of the body's card frame [m]."""

    def to_body(self, node: int, x: np.ndarray) -> np.ndarray:
        """World point, from the mass centre in body axes [m]."""

    def rotation_to_body(self, node: int, u: np.ndarray) -> np.ndarray:
        """World direction in body axes."""

    def placed_nodes(self) -> dict[str, np.ndarray]:
        """Positions and configurations, as the node table names them."""

    # columns of laws between two bodies
    def attachments(self, card: Attached) -> Columns:
        """`node_a`, `node_b`, `point_a`, `point_b`, of the fields `a`, `b`, `at_a`, `at_b`."""

    def distance(self, ends: Columns) -> float:
        """Distance between two attachments [m]."""

    def rotation_about_axis(self, card: AboutAxis) -> Columns:
        """Rotation of b about `axis` of a, with sides that meet at the start."""

    def joint_point(self, card: Jointed) -> tuple[int, int, np.ndarray]:
        """Both nodes and the joint's point in world components."""

    def joint_frame(self, card: Jointed) -> Columns:
        """Point and right-handed triad (axis, side, third) of a joint, axes of both bodies."""

    # parts
    def mesh(self, card: Meshed) -> MeshOfScene:
        """The mesh of a part, refused where its elements do not hang together."""

    def own_share(self) -> MeshOfScene:
        """Elements and points of a shared mesh that the part being built has."""

    def meshed(self, part: str) -> PartOfScene:
        """A part with points in place."""

    def on_mesh_of(self, meshed: PartOfScene) -> Sequence[PartOfScene]:
        """All parts in place that share the mesh of one."""

    def has_points(self, part: str) -> bool:
        """Whether the nodes of a part are points."""

    def can_fail(self, part: str) -> bool:
        """Whether elements of a part may be deleted."""

    def skin(self, part: str, field: str) -> tuple[PartOfScene, int, int]:
        """A part with points in place, its first corner and its first point."""

    def faces(self, part: str, field: str) -> tuple[int, int, int]:
        """First corner of a part with points, its quadrilaterals and its triangles."""
