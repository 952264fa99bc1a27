"""Shell: four-node elements with one point in their plane and layers through the thickness.

    eps = eps_m + z kappa,   sigma from the material in plane stress,   gamma in 5/6 G gamma
    N = int sigma dz,   M = int sigma z dz

in axes that turn with the element (`_quad.py`). Strains of a step are those of its middle, so that
a rigid motion strains nothing. What one point cannot see is resisted by the stiffness of bending
in the plane, of bending, and of the assumed shear of the sides; its energy is `hourglass`. A node
has a quarter of the mass m of each element beside it and m / 4 (A + t^2) / 12 about any axis.
Consequence to test: any patch of elements holds constant strain and constant curvature.

References: Belytschko, Lin and Tsay (1984), Explicit algorithms for the nonlinear dynamics of
shells, Computer Methods in Applied Mechanics and Engineering 42, 225-251.
"""

from dataclasses import replace
from importlib import import_module
from math import exp, expm1, log1p
from typing import Any, Literal

import numpy as np
from pydantic import model_validator

from crashsolve.deck.card import (
    BodyName,
    Card,
    Law,
    MaterialName,
    NewName,
    PartName,
    SetName,
    Vec3,
    quantity,
    word,
)
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.curve import curve_line
from crashsolve.foundation.point import LANES, OWN, RIDES
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import ZERO, dot, vec
from crashsolve.parts._beside import (
    clear_weak,
    relax_modes,
    relax_shear,
    see_modes,
    see_shear,
)
from crashsolve.parts._damping import Damped, coefficients, heavier, report_added
from crashsolve.parts._failure import (
    add_losses,
    delete,
    diagonal,
    has_failed,
    mute_forces,
    mute_strains,
)
from crashsolve.parts._layers import (
    ACROSS,
    ALL_ROWS,
    BACK_ROWS,
    FAILED_ROWS,
    HYPER_ROWS,
    LINE_ROWS,
    METRIC,
    MOST_LAYERS,
    PLASTIC_ROWS,
    STRAIN,
    grow_rate,
    layers,
)
from crashsolve.parts._quad import hourglass_stiffness, plane_axes, rate_bound
from crashsolve.parts._quad_block import (
    DRILL,
    DRILLING,
    HOURGLASS,
    LAYERS,
    LOSS,
    PLANE_Q,
    RADIUS_2,
    SHAPE,
    SHEAR,
    THICKNESS,
    WEIGHT,
    gather,
    note_rate,
    push,
    scatter,
    slow_corners,
    strain,
)
from crashsolve.parts._viscous import HEAVIER, SLOW_ROWS, allow, damp

STEPWISE = True
# but for these, which strain elements from the start of a step to its end, and to its stages
IMPLICIT = ("generalized_alpha", "radau_iia_5")
# the column that counts elements of a kind, and the file of its kernels
KINDS = {"one_point": "shell", "four_points": "_full", "triangles": "_triangle"}
# points in the plane of a quadrilateral
POINTS = {"reduced": 1, "fully_integrated": 4, "triangles": 1}
# beside the rows of layers, sums over the points of a plane
ROWS = ALL_ROWS + 24
FAMILY = "matsum"
MOTIONS = ("x", "y", "z", "turn_x", "turn_y", "turn_z")
Motion = Literal["x", "y", "z", "turn_x", "turn_y", "turn_z"]
# elements worked on at a time where memory counts
PIECE = 1024


class NamedNode(Card):
    """A node that is a body of the deck, for joints, loads, contacts, sensors and channels."""

    name: NewName = word("the body is called P_name in part P")
    at: Vec3 = quantity("m", "place; the nearest node is meant")


class Trace(Card):
    """A place whose history is written."""

    name: NewName = word("in channels P_name, for part P")
    at: Vec3 = quantity("m", "place; the nearest node or element is meant")


class Cut(Card):
    """Section whose force and moment are written: the elements that a plane cuts at the start."""

    name: NewName = word("in channels P_name, for part P")
    at: Vec3 = quantity("m", "point of the plane")
    normal: Vec3 = word("of the plane, towards the side on which the force acts")


class Hold(Card):
    """Motions that the nodes of a set do not make."""

    nodes: SetName = word("set of nodes of the mesh")
    motions: tuple[Motion, ...] = word("along and about world axes", default=MOTIONS)


class Weld(Card):
    """Nodes that are part of a body: of a rigid one, or of nodes of beams and shells.

    Of a shell, its named nodes are bodies: those of `nodes`.
    """

    nodes: SetName = word("set of nodes of the mesh")
    to: BodyName | None = word("body, or node of a beam, that they are part of", default=None)
    part: PartName | None = word(
        "or a part of beams or shells: each is part of the nearest of its nodes that are bodies",
        default=None,
    )
    within: float | None = quantity(
        "m", "largest distance from it; the longest side of the elements there", None, gt=0
    )

    @model_validator(mode="after")
    def _one(self) -> "Weld":
        if (self.to is None) == (self.part is None):
            raise ValueError("needs either to or part")
        if self.within is not None and self.part is None:
            raise ValueError("within: is for part; a body named by to holds nodes at any distance")
        return self


class NodeVelocity(Card):
    """Velocity at the start of the nodes of a set, in place of that of the part."""

    nodes: SetName = word("set of nodes of the mesh")
    velocity: Vec3 = quantity("m/s", "of each of them", default=ZERO)
    angular_velocity: Vec3 = quantity("rad/s", "of each about itself, world axes", default=ZERO)


class Blow(Card):
    """Impulse along the normals, at the start, on the elements whose middles lie in a box."""

    low: Vec3 = quantity("m", "corner of the box with the least coordinates")
    high: Vec3 = quantity("m", "corner with the largest")
    speed: float = quantity("m/s", "impulse over mass; a node has its share of the elements there")


class Shell(Damped):
    """Thin shell of quadrilaterals."""

    mesh: Card = Law("meshes", "places of the nodes, elements, sets of nodes")
    thickness: float = quantity("m", "t", gt=0)
    element: Literal["reduced", "fully_integrated", "triangles"] = word(
        "quadrilaterals with one point in their plane, or 2 by 2, or each cut into two triangles",
        default="reduced",
    )
    material: MaterialName = word("what it is made of")
    layers: int = word("points through the thickness", default=5, ge=1, le=MOST_LAYERS)
    rule: Literal["gauss", "lobatto"] = word("where they lie; lobatto: at the faces too", "gauss")
    thinning: bool = word("the thickness follows the strain", default=False)
    nodes: tuple[NamedNode, ...] = word("nodes that are bodies", default=())
    hold: tuple[Hold, ...] = word("supports", default=())
    welded: tuple[Weld, ...] = word("nodes without a motion of their own", default=())
    traces: tuple[Trace, ...] = word("nodes with a history: nodout.P_name", default=())
    gauges: tuple[Trace, ...] = word("elements with a history: elout.P_name", default=())
    cuts: tuple[Cut, ...] = word("sections with a history: secforc.P_name", default=())
    velocity: Vec3 = quantity("m/s", "at the start, of the mesh's first node", default=ZERO)
    angular_velocity: Vec3 = quantity("rad/s", "of the whole, world axes", default=ZERO)
    velocities: tuple[NodeVelocity, ...] = word("at the start, of sets of nodes", default=())
    blows: tuple[Blow, ...] = word("impulses at the start, on regions", default=())

    def node_names(self, part: str) -> list[str]:
        """Names of those nodes of a part of this name that are bodies."""
        return [f"{part}_{node.name}" for node in self.nodes]


PARAMETERS = Record(
    first_point=("index", "of the part's points"),
    point_count=("count", "points"),
    first=("index", "of the part's numbers in blocks"),
    stride=("count", "numbers of a block"),
    first_corner=("index", "of the part's corners"),
    element_count=("count", "elements"),
    one_point=("count", "of them, quadrilaterals with one point in their plane"),
    four_points=("count", "quadrilaterals with 2 by 2 points"),
    triangles=("count", "triangles, which come after the quadrilaterals"),
    first_element=("index", "number of the part's first element among all"),
    layers=("count", "points through the thickness"),
    zeta=("1", MOST_LAYERS, "places of the layers, -1 to 1"),
    weight=("1", MOST_LAYERS, "weights of the layers, sum 2"),
    young=("Pa", "E"),
    shear=("Pa", "G"),
    poisson=("1", "nu"),
    density=("kg/m^3", "rho"),
    # quotients of these, which layers would compute again and again
    plane=("Pa", "E / (1 - nu^2)"),
    across=("1", "nu / (1 - nu)"),
    softness=("1/Pa", "nu / E"),
    falls_1=("Pa", "c_1 of the plastic return"),
    falls_2=("Pa", "c_2"),
    drag=("1/s", "alpha"),
    damping=("s", "beta"),
    linear=("1", "b_1"),
    quadratic=("1", "b_2^2"),
    slows=("flag", "whether elements keep rows of damping and added mass"),
    layer_rows=("count", "numbers of a layer"),
    thins=("flag", "whether the thickness follows the strain"),
    plastic=("flag", "whether the material yields"),
    yield_stress=("Pa", "Y_0"),
    isotropic=("Pa", "(1 - beta) H"),
    kinematic=("Pa", "beta H"),
    curve=("index", "Y over plastic strain; 0 for none"),
    rate_D=("1/s", "D of Cowper and Symonds; 0 for none"),
    rate_q=("1", "q of Cowper and Symonds"),
    power=("Pa", "B of Johnson and Cook; 0 for none"),
    exponent=("1", "n of Johnson and Cook"),
    rate_C=("1", "C of Johnson and Cook; 0 for none"),
    rate_0=("1/s", "rate above which C counts"),
    heating=("m^3/J", "temperature, 1 at melting, over plastic work per volume; 0 for none"),
    softening=("1", "m of Johnson and Cook"),
    hyper=("flag", "whether the material is neo-Hookean"),
    volumetric=("Pa", "L of a neo-Hookean material"),
    failure=("1", "plastic strain at which a layer fails; 0 for none"),
)
HISTORY = Record(damped=("J", "energy lost by drag"))
OUTPUT = Record(
    kinetic=("J", "of the nodes that are no bodies"),
    strain=("J", "elastic energy of the layers and of transverse shear"),
    hourglass=("J", "of what one point does not see"),
    drilling=("J", "of spins of the nodes about the normal against the turn of the plane"),
    plastic=("J", "plastic work"),
    drag=("J", "energy lost by drag"),
    damping=("J", "energy lost by damping of strains and viscosity"),
    eroded=("J", "elastic energy lost with layers that failed and elements deleted"),
    eroded_kinetic=(
        "J",
        "kinetic energy of elements when deleted; it stays with the nodes",
    ),
    eroded_mass=("kg", "of elements deleted; it stays with the nodes"),
    deleted=("count", "elements deleted"),
)

# of the elements in pictures: unit and components; resultants along the element's axes
FIELDS = {
    "thickness": ("m", 1),
    "membrane_force": ("N/m", 3),  # xx, yy, xy
    "moment": ("N", 3),  # xx, yy, xy
    "shear_force_xz": ("N/m", 1),
    "shear_force_yz": ("N/m", 1),
    "von_mises": ("Pa", 1),  # largest of the layers and points
    "elastic_energy_density": ("J/m^3", 1),
    "plastic_energy_density": ("J/m^3", 1),  # over the volume at the start
    "plastic_strain_top": ("1", 1),  # of the outermost layers and the middle one
    "plastic_strain_mid": ("1", 1),
    "plastic_strain_bottom": ("1", 1),
}


def rule(card: Shell, scene: Any) -> tuple[np.ndarray, np.ndarray]:
    """Places and weights of the layers."""
    if card.rule == "gauss":
        return np.polynomial.legendre.leggauss(card.layers)
    if card.layers < 2:
        raise scene.fail("lobatto needs 2 layers at least: one at each face", "layers")
    # ends, and roots of the derivative of the Legendre polynomial of one degree less
    polynomial = np.polynomial.legendre.Legendre.basis(card.layers - 1)
    zeta = np.concatenate([[-1.0], np.sort(polynomial.deriv().roots().real), [1.0]])
    return zeta, 2.0 / (card.layers * (card.layers - 1) * polynomial(zeta) ** 2)


def nearest(places: np.ndarray, card: NamedNode | Trace) -> int:
    """Number of the place nearest to that of a card."""
    return int(np.argmin(np.linalg.norm(places - np.asarray(card.at), axis=1)))


def sides(x: np.ndarray, card: Cut, scene: Any) -> np.ndarray:
    """Which corners (n, 4) of which elements, at x (n, 4, 3), a cut has on its front side.

    Rows of elements that are not cut are empty.
    """
    normal = scene.unit(card.normal, "cuts")
    is_front = (x - np.asarray(card.at)) @ normal > 0.0
    is_front &= ~is_front.all(axis=1, keepdims=True)
    if not is_front.any():
        raise scene.fail(f"the plane of '{card.name}' cuts no element", "cuts")
    return is_front


def sorted_mesh(mesh: Any, cut: bool) -> Any:
    """The mesh with its triangles last, a corner named twice at their end; or cut into triangles.

    A quadrilateral is cut along the shorter diagonal.
    """
    quads = mesh.quads.copy()
    for k in range(3):
        same = quads[:, k] == quads[:, (k + 1) % 4]
        quads[same] = np.roll(quads[same], 2 - k, axis=1)
    same = (quads[:, 3] == quads[:, 0]) & (quads[:, 2] != quads[:, 3])
    quads[same] = np.roll(quads[same], -1, axis=1)
    whole, thirds = quads[quads[:, 2] != quads[:, 3]], quads[quads[:, 2] == quads[:, 3]]
    if cut:
        x = mesh.points[whole]
        diagonals = np.linalg.norm([x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]], axis=2)
        turned = np.where((diagonals[1] < diagonals[0])[:, None], np.roll(whole, -1, 1), whole)
        halves = turned[:, [[0, 1, 2, 2], [0, 2, 3, 3]]].reshape(-1, 4)
        whole, thirds = whole[:0], np.concatenate([halves, thirds])
    return replace(mesh, quads=np.concatenate([whole, thirds]).astype(np.int32))


def blocks_of(own: slice) -> int:
    """Blocks that hold these elements."""
    return -(-(own.stop - own.start) // LANES)


def in_lanes(values: np.ndarray) -> np.ndarray:
    """(blocks, lanes); the last element stands for those that are missing."""
    missing = -len(values) % LANES
    filled = np.append(values, np.repeat(values[-1:], missing, axis=0))
    return filled.reshape(-1, LANES)


class Laid:
    """A shell part in place: its mesh, with the masses of its nodes."""

    def __init__(self, card: Shell, scene: Any) -> None:
        _, self.material = scene.law("materials", card.material)
        self.card = card
        self.layer_rows = PLASTIC_ROWS if hasattr(self.material, "yield_stress") else 3
        self.follows_curve = getattr(self.material, "curve", None) is not None
        if getattr(self.material, "kinematic", 0.0) * getattr(self.material, "hardening", 0.0):
            self.layer_rows += BACK_ROWS
        self.layer_rows += LINE_ROWS * self.follows_curve
        self.is_hyper = hasattr(self.material, "LARGE_STRAIN")
        if self.is_hyper:
            self.layer_rows = HYPER_ROWS
            if not card.thinning:
                raise scene.fail("a neo-Hookean shell needs true: it gets thinner", "thinning")
        self.layer_rows += getattr(self.material, "melting_heat", None) is not None
        self.can_fail = getattr(self.material, "failure_strain", None) is not None
        self._refuse_explicit(scene)
        self.rule = rule(card, scene)
        self.points = POINTS[card.element]
        self.mesh = sorted_mesh(scene.mesh(card), card.element == "triangles")
        self.quad_count = int((self.mesh.quads[:, 2] != self.mesh.quads[:, 3]).sum())
        x = self.mesh.points[self.mesh.quads]
        normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
        self.area = 0.5 * np.linalg.norm(normal, axis=1)
        self._refuse_bad(x, normal, scene)
        n = len(self.mesh.points)
        corners = self.mesh.quads.ravel()
        self.slows = bool(card.damping or card.viscosity or card.mass_scaling)
        self.heavier = self._heavier(scene)
        share = np.full(x.shape[:2], 0.25)
        share[self.quad_count :] = [1 / 3, 1 / 3, 1 / 3, 0]
        mass = share * (self.heavier * self.weight)[:, None]
        self.mass = np.bincount(corners, mass.ravel(), n)
        self.J = np.bincount(corners, (mass * self.radius_2[:, None]).ravel(), n)
        self.named = [nearest(self.mesh.points, node) for node in card.nodes]
        self.traced = [nearest(self.mesh.points, node) for node in card.traces]
        self.gauged = [nearest(x.mean(axis=1), place) for place in card.gauges]
        self.cuts = [sides(x, cut, scene) for cut in card.cuts]
        self.held = self._held(scene)
        self.velocity, self.spin = self._motion(scene)
        self.blown = self._blown(x, normal, share, scene)

    @property
    def weight(self) -> np.ndarray:
        """Masses of the elements [kg]."""
        mass: np.ndarray = self.material.density * self.card.thickness * self.area
        return mass

    @property
    def radius_2(self) -> np.ndarray:
        """Squared radii of gyration of what the nodes have of the elements [m^2]."""
        squared: np.ndarray = (self.area + self.card.thickness**2) / 12.0
        return squared

    def _refuse_explicit(self, scene: Any) -> None:
        """What only explicit steps can do yet."""
        control = scene.deck.control
        method = f"integrator {control.integrator}"
        if control.solution == "quasi_static":
            method = "solution quasi_static"
        elif control.integrator not in IMPLICIT:
            return
        given = {
            "drag": (self.card.drag > 0.0, "drag on shells"),
            "mass_scaling": (self.card.mass_scaling is not None, "added mass"),
            "material": (self.can_fail, "a material with a failure_strain"),
        }
        for field, (is_given, words) in given.items():
            if is_given:
                message = f"{words} is for explicit steps, and {method} takes none"
                raise scene.fail(f"{message}; say integrator: rattle", field)

    def _refuse_bad(self, x: np.ndarray, normal: np.ndarray, scene: Any) -> None:
        """Every corner of an element must turn the same way."""
        for k in range(4):
            here = np.cross(x[:, (k + 1) % 4] - x[:, k], x[:, (k + 3) % 4] - x[:, k])
            turns = (here * normal).sum(1) > 1e-6 * (normal**2).sum(1)
            # the third side of a triangle has no length
            turns[self.quad_count :] |= k > 1
            bad = np.flatnonzero(~turns)
            if len(bad):
                where = ", ".join(f"{value:.4g}" for value in x[bad[0], k])
                message = (
                    f"element {bad[0] + 1} is degenerate or folded over at its corner ({where}) m; "
                    "its corners must go round a convex quadrilateral"
                )
                raise scene.fail(message, "mesh")

    def _heavier(self, scene: Any) -> np.ndarray:
        """Factors of the masses of the elements."""
        if self.card.mass_scaling is None:
            return np.broadcast_to(1.0, self.area.shape)
        flat = diagonals(self.mesh.points[self.mesh.quads]).transpose(0, 2, 1).reshape(-1, 4)
        squares = np.array([self._square(k, tuple(sides)) for k, sides in enumerate(flat)])
        factors: np.ndarray = heavier(self.card, squares, scene)
        report_added(self.card, self.weight, factors, scene)
        return factors

    def _square(self, element: int, flat: tuple[float, ...]) -> float:
        """Bound of the largest squared frequency of an element with these diagonals [1/s^2]."""
        law, t = self.material, self.card.thickness
        area = self.area[element]
        size, light = (area, t, (area + t * t) / 12.0), law.young / law.density
        if element >= self.quad_count:
            # that file builds on this one
            bound = import_module("crashsolve.parts._triangle").rate_bound
            return float(bound(flat, *size, light, law.poisson))
        x = self.mesh.points[self.mesh.quads[element]]
        axes = np.column_stack([x[2] - x[0], x[3] - x[1]]) @ np.linalg.inv(
            np.reshape(flat, (2, 2)).T
        )
        odd = x[0] - x[1] + x[2] - x[3]
        skew = odd @ axes
        z = 0.25 * np.sqrt(max(odd @ odd - skew @ skew, 0.0))
        light /= 1.0 - law.poisson**2
        hourglass = (float(skew[0]), float(skew[1]))
        return float(quad_bound(flat, hourglass, float(z), *size, light, law.poisson))

    def _held(self, scene: Any) -> np.ndarray:
        """Bits of the motions that every node does not make."""
        held = np.zeros(len(self.mesh.points), np.uint8)
        for k, hold in enumerate(self.card.hold):
            own = self.set_of(hold.nodes, f"hold.{k}.nodes", scene)
            for motion in hold.motions:
                held[own] |= 1 << MOTIONS.index(motion)
        for node, index in zip(self.card.nodes, self.named, strict=True):
            if held[index]:
                message = (
                    f"node '{node.name}' is held; say traces if you only want its history, and "
                    "load it in its other directions by a nodal_force on a set of nodes"
                )
                raise scene.fail(message, "nodes")
        held[self.named] = RIDES
        for k, weld in enumerate(self.card.welded):
            own = self.set_of(weld.nodes, f"welded.{k}.nodes", scene)
            if held[own].any():
                message = "some of these nodes are held, welded or named otherwise already"
                raise scene.fail(message, f"welded.{k}.nodes")
            held[own] = RIDES
        return held

    def set_of(self, name: str, field: str, scene: Any) -> np.ndarray:
        """Numbers of a set of nodes."""
        if name not in self.mesh.sets:
            known = ", ".join(sorted(self.mesh.sets)) or "none"
            raise scene.fail(f"the mesh has no set of nodes '{name}' (sets: {known})", field)
        own: np.ndarray = self.mesh.sets[name]
        if not len(own):
            message = f"set '{name}' has no node of these elements"
            raise scene.fail(f"{message}; name another, or leave it out", field)
        return own

    def _first_line(self, scene: Any) -> tuple[float, float, float]:
        """Yield stress of a curve at no plastic strain [Pa], its slope [Pa], and to what strain."""
        start = scene.curve(self.material.curve)
        return curve_line(scene.curve_points.view(np.recarray), start, 0.0)

    def _motion(self, scene: Any) -> tuple[np.ndarray, np.ndarray]:
        """Velocities [m/s] and angular velocities [rad/s] of the nodes before any blow."""
        way = self.mesh.points - self.mesh.points[0]
        velocity = np.asarray(self.card.velocity) + np.cross(self.card.angular_velocity, way)
        spin = np.tile(np.asarray(self.card.angular_velocity, float), (len(way), 1))
        given = np.zeros(len(way), int)
        for k, some in enumerate(self.card.velocities):
            own = self.set_of(some.nodes, f"velocities.{k}.nodes", scene)
            for other in set(given[own][given[own] > 0]):
                before = self.card.velocities[other - 1]
                if some.model_copy(update={"nodes": before.nodes}) != before:
                    message = f"set '{before.nodes}' gives some of these nodes another velocity"
                    raise scene.fail(message, f"velocities.{k}.nodes")
            given[own] = k + 1
            velocity[own], spin[own] = some.velocity, some.angular_velocity
        return velocity, spin

    def velocities(self) -> np.ndarray:
        """Velocities at the start [m/s], those of blows among them."""
        return self.velocity + self.blown

    def _blown(
        self, x: np.ndarray, normal: np.ndarray, share: np.ndarray, scene: Any
    ) -> np.ndarray:
        """Velocities of the nodes from the momentum of the elements that are hit [m/s]."""
        if not self.card.blows:
            return np.zeros(3)
        blown = np.zeros_like(self.mesh.points)
        middle = (x * share[:, :, None]).sum(axis=1)
        way = normal / np.linalg.norm(normal, axis=1)[:, None]
        for k, blow in enumerate(self.card.blows):
            hit = ((middle > blow.low) & (middle < blow.high)).all(axis=1)
            if not hit.any():
                raise scene.fail("no element has its middle in the box", f"blows.{k}")
            momentum = (blow.speed * self.weight * hit)[:, None] * way
            for corner, part in zip(self.mesh.quads.T, share.T, strict=True):
                np.add.at(blown, corner, part[:, None] * momentum)
        return blown / self.mass[:, None]

    def write_points(self, table: np.ndarray) -> None:
        """Rows of POINT at the start. Writes: table."""
        table["r"], table["v"] = self.mesh.points, self.velocities()
        table["w"] = self.spin
        table["mass_inv"], table["J_inv"] = 1.0 / self.mass, 1.0 / self.J
        table["held"] = self.held
        for k in range(3):
            table["v"][self.held >> k & 1 == 1, k] = 0.0
            table["w"][self.held >> (3 + k) & 1 == 1, k] = 0.0

    def sections(self) -> list[tuple[slice, int]]:
        """Elements of a kind, and the points in the plane of each, as blocks hold them."""
        n, m = self.quad_count, len(self.area)
        both = [(slice(0, n), self.points), (slice(n, m), 1)]
        return [(own, points) for own, points in both if own.stop > own.start]

    def write_blocks(self, numbers: np.ndarray, scene: Any) -> None:
        """Numbers of the elements, block by block; the last is filled up. Writes: numbers."""
        start = 0
        values = [np.full(len(self.area), self.card.thickness), *self._shape().T]
        for own, points in self.sections():
            size = blocks_of(own) * self.stride_of(points)
            table = numbers[start : start + size].reshape(blocks_of(own), -1, LANES)
            for row, column in (
                (THICKNESS, values[0]),
                (RADIUS_2, self.radius_2),
                (WEIGHT, self.weight),
                *((SHAPE + k, column) for k, column in enumerate(values[1:])),
            ):
                table[:, row] = in_lanes(column[own])
            if self.follows_curve:
                end = LAYERS + points * self.card.layers * self.layer_rows
                for k, value in enumerate(self._first_line(scene)):
                    row = LAYERS + self.layer_rows - LINE_ROWS + k
                    table[:, row : end : self.layer_rows] = value
            if self.slows:
                row = table.shape[1] - FAILED_ROWS * self.can_fail - SLOW_ROWS
                table[:, row + HEAVIER] = in_lanes(self.heavier[own])
            start += size

    def corners(self) -> np.ndarray:
        """Points of the corners, (blocks, 4, lanes)."""
        quads = [self.mesh.quads[own] for own, _ in self.sections()]
        return np.concatenate([np.stack([in_lanes(c) for c in q.T], axis=1) for q in quads])

    def seat(self, element: int) -> tuple[int, int, int, int]:
        """Kind of an element in KINDS, where the numbers and corners of its block begin, lane."""
        numbers = corners = 0
        for own, points in self.sections():
            if element < own.stop:
                break
            numbers += blocks_of(own) * self.stride_of(points)
            corners += blocks_of(own) * 4 * LANES
        block, lane = divmod(element - own.start, LANES)
        kind = 2 if own.start >= self.quad_count else list(POINTS.values()).index(points)
        return kind, numbers + block * self.stride_of(points), corners + block * 4 * LANES, lane

    def stride_of(self, points: int) -> int:
        """Numbers of a block of elements with so many points in their plane."""
        rows = LAYERS + points * self.layer_rows * self.card.layers
        return LANES * (rows + SLOW_ROWS * self.slows + FAILED_ROWS * self.can_fail)

    @property
    def stride(self) -> int:
        """Numbers of a block of quadrilaterals."""
        return self.stride_of(self.points)

    @property
    def size(self) -> int:
        """Numbers of all blocks."""
        return sum(blocks_of(own) * self.stride_of(points) for own, points in self.sections())

    def gauge_values(self, blocks: np.ndarray, row: Any) -> np.ndarray:
        """Values of FIELDS of the gauged elements, side by side."""
        found = self.values_of(blocks, row, np.array(self.gauged))
        return np.column_stack([found[name] for name in FIELDS])

    def all_fields(self, blocks: np.ndarray, row: Any) -> dict[str, np.ndarray]:
        """Values of FIELDS of all elements, in single precision."""
        return self.values_of(blocks, row, np.arange(len(self.area)), np.float32)

    def values_of(
        self, blocks: np.ndarray, row: Any, wanted: np.ndarray, kind: Any = float
    ) -> dict[str, np.ndarray]:
        """Values of FIELDS of some elements, from what those of all parts keep."""
        start = int(row["first"])
        shapes = {name: (len(wanted), n)[: 1 + (n > 1)] for name, (_, n) in FIELDS.items()}
        found = {name: np.zeros(shape, kind) for name, shape in shapes.items()}
        for own, points in self.sections():
            count, stride = blocks_of(own), self.stride_of(points)
            table = blocks[start : start + count * stride].reshape(count, stride // LANES, LANES)
            met = np.flatnonzero((wanted >= own.start) & (wanted < own.stop))
            for some in (met[k : k + PIECE] for k in range(0, len(met), PIECE)):
                place = wanted[some] - own.start
                for name, values in self.fields(table[place // LANES, :, place % LANES]).items():
                    found[name][some] = values
            start += count * stride
        return found

    def fields(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        """Values of FIELDS from what elements keep (m, rows): means of the points of a plane."""
        count = self.card.layers
        end = rows.shape[1] - SLOW_ROWS * self.slows - FAILED_ROWS * self.can_fail
        layers = rows[:, LAYERS:end].reshape(len(rows), -1, count, self.layer_rows)
        t, shear = rows[:, THICKNESS], rows[:, SHEAR : SHEAR + 2]
        mean = layers.mean(axis=1)
        zeta, weight = self.rule
        share = 0.5 * t[:, None] * weight
        arm = 0.5 * t[:, None] * zeta
        x, y, s = np.moveaxis(layers[..., :3], 3, 0)
        has_plastic = self.layer_rows > STRAIN and not self.is_hyper
        plastic = mean[:, :, STRAIN] if has_plastic else np.zeros((len(rows), count))
        E, nu = self.material.young, self.material.poisson
        elastic = (x * x + y * y - 2.0 * nu * x * y + 2.0 * (1.0 + nu) * s * s) / (2.0 * E)
        if self.is_hyper:
            elastic = self.material.energy(*np.moveaxis(layers[..., METRIC:], 3, 0))
        density = 0.5 * elastic.mean(axis=1) @ weight + 1.2 * (1.0 + nu) / E * (shear**2).sum(1)
        return {
            "thickness": t,
            "membrane_force": np.einsum("ek,ekc->ec", share, mean[:, :, :3]),
            "moment": np.einsum("ek,ekc->ec", share * arm, mean[:, :, :3]),
            "shear_force_xz": shear[:, 0] * t,
            "shear_force_yz": shear[:, 1] * t,
            "von_mises": np.sqrt(x * x + y * y - x * y + 3.0 * s * s).max(axis=(1, 2)),
            "elastic_energy_density": density,
            "plastic_energy_density": rows[:, LOSS] / (rows[:, WEIGHT] / self.material.density),
            "plastic_strain_top": plastic[:, -1],
            "plastic_strain_mid": plastic[:, (count - 1) // 2],
            "plastic_strain_bottom": plastic[:, 0],
        }

    def _shape(self) -> np.ndarray:
        """Inverse of the diagonals in axes between them, by rows (m, 4)."""
        found = np.empty((len(self.area), 4))
        # blocks are there already: what is needed besides is what memory peaks at
        for start in range(0, len(found), PIECE):
            x = self.mesh.points[self.mesh.quads[start : start + PIECE]]
            found[start : start + PIECE] = np.linalg.inv(diagonals(x)).reshape(-1, 4)
        return found


def diagonals(x: np.ndarray) -> np.ndarray:
    """Diagonals of quadrilaterals (m, 4, 3) in axes between them, as columns (m, 2, 2)."""
    d, e = x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]
    d_length, e_length = np.linalg.norm(d, axis=1), np.linalg.norm(e, axis=1)
    # both axes are as far from one diagonal as from the other
    half = 0.5 * np.arccos(np.clip((d * e).sum(1) / (d_length * e_length), -1.0, 1.0))
    s, c = np.sin(half), np.cos(half)
    return np.array([[d_length * s, -e_length * s], [d_length * c, e_length * c]]).transpose(
        2, 0, 1
    )


@kernel
def quad_bound(flat, hourglass, z, area, thickness, radius_2, light, nu):
    """Bound of the largest squared frequency of a quadrilateral [1/s^2], for Python to call."""
    return rate_bound(flat, hourglass, z, area, thickness, radius_2, light, nu)


def lay(card: Shell, scene: Any) -> Laid:
    """The part in place."""
    return Laid(card, scene)


def build(card: Shell, scene: Any) -> list[dict[str, Any]]:
    """The nodes that are bodies."""
    laid = scene.laid(card)
    speed = laid.velocities()
    return [
        {
            "mass": laid.mass[i],
            "inertia": laid.J[i] * np.eye(3),
            "mass_centre": ZERO,
            "position": laid.mesh.points[i],
            "quaternion": (1.0, 0.0, 0.0, 0.0),
            "velocity": speed[i],
            "angular_velocity": laid.spin[i],
        }
        for i in laid.named
    ]


def parameters(card: Shell, scene: Any) -> dict[str, Any]:
    """Columns of PARAMETERS but for the places in the tables."""
    laid = scene.laid(card)
    zeta, weight = laid.rule
    room = np.zeros(MOST_LAYERS - card.layers)
    law, material_card = scene.law("materials", card.material)
    count = laid.quad_count
    return {
        "thins": card.thinning,
        "layer_rows": laid.layer_rows,
        "layers": card.layers,
        "one_point": count if laid.points == 1 else 0,
        "four_points": count if laid.points == 4 else 0,
        "triangles": len(laid.area) - count,
        "zeta": np.append(zeta, room),
        "weight": np.append(weight, room),
        "drag": card.drag,
        "damping": card.damping,
        "linear": coefficients(card, scene)[0],
        "quadratic": coefficients(card, scene)[1],
        "slows": laid.slows,
    } | quotients(law.build(material_card, scene))


def quotients(words: dict[str, Any]) -> dict[str, Any]:
    """Columns of the material, and what layers need of them."""
    E, nu, moves = words["young"], words["poisson"], 2.0 / 3.0 * words.get("kinematic", 0.0)
    return words | {
        "plane": E / (1.0 - nu * nu),
        "across": nu / (1.0 - nu),
        "softness": nu / E,
        "falls_1": E / (3.0 - 3.0 * nu) + moves,
        "falls_2": 2.0 * words["shear"] + moves,
    }


@kernel
def deform(p, clock, h, scene):
    """Strains, stresses and forces of the one-point elements of a part after a step of h.

    Writes: scene.points, lanes, work, clock.
    """
    done = 0
    clear_weak(scene.work)
    while done < p.one_point:
        first, corner = p.first + done // LANES * p.stride, p.first_corner + 4 * done
        live = min(LANES, p.one_point - done)
        respond(p, h, first, corner, scene)
        if p.failure > 0.0:
            erode(p, scene, first, corner, live)
        note_rate(clock, p.first_element + done, scene, first, live, 4)
        if p.slows == 1:
            slow_corners(scene, corner, live, 4)
        scatter(scene.points, scene.corners, corner, live, scene.work, 4)
        done += LANES


@kernel
def respond(p, h, first, corner, scene):
    """Forces and torques of a block on its corners after a step of h. Writes: scene.lanes, work."""
    blocks, work = scene.lanes, scene.work
    gather(scene.points, scene.corners, corner, work)
    strain(blocks, first, work, h, p)
    if p.failure > 0.0:
        mute_strains(blocks, first, work)
    if p.plastic == 1:
        see_shear(blocks, first, work)
        see_modes(blocks, first, work)
    if layers(blocks, first, p.stride, work, h, p, scene.curves) > 0:
        relax_modes(blocks, first, work)
        relax_shear(blocks, first, work, p)
    if p.slows == 1:
        damp(blocks, first, p.stride, work, h, p)
    push(blocks, first, work, p)
    if p.hyper == 1:
        grow_rate(work)
    if p.slows == 1:
        allow(blocks, first, p.stride, work, h, p)
    if p.failure > 0.0:
        mute_forces(blocks, first, work)


@kernel
def erode(p, scene, first, corner, live):
    """Delete the elements of a block that have failed. Writes: scene.lanes."""
    for e in range(live):
        if has_failed(scene.lanes, first + e, p, 1):
            d, c = diagonal(scene, corner + e, 2), diagonal(scene, corner + LANES + e, 2)
            stored, held, drilling = element_energy(p, scene.lanes, first + e, d, c)
            delete(scene, first, p.stride, corner, e, 4, stored + held + drilling)


@kernel
def energies(p, new, out, scene):
    """Energies of a part but for its elements. Writes: out."""
    out.kinetic = moving(p, scene.points)
    out.strain = out.hourglass = out.drilling = out.plastic = out.damping = 0.0
    out.eroded = out.eroded_kinetic = out.eroded_mass = out.deleted = 0.0
    out.drag = new.damped


@kernel
def add_energies(p, out, scene):
    """Energies of the one-point elements. Writes: out."""
    for i in range(p.one_point):
        lane = i % LANES
        at = p.first + i // LANES * p.stride + lane
        corner = p.first_corner + 4 * (i - lane) + lane
        add_losses(p, scene.lanes, at, p.stride, out)
        if scene.lanes[at + LANES * THICKNESS] == 0.0:
            continue
        d, e = diagonal(scene, corner, 2), diagonal(scene, corner + LANES, 2)
        stretched, hourglass, drilling = element_energy(p, scene.lanes, at, d, e)
        out.strain += stretched
        out.hourglass += hourglass
        out.drilling += drilling


@kernel
def moving(p, points):
    """Kinetic energy of the nodes of a part that are no bodies of the deck [J]."""
    total = 0.0
    for i in range(p.first_point, p.first_point + p.point_count):
        b = points[i]
        if b.held < RIDES or b.held >= OWN:
            v, w = vec(b.v), vec(b.w)
            total += 0.5 * dot(v, v) / b.mass_inv + 0.5 * dot(w, w) / b.J_inv
    return total


@kernel
def element_energy(p, blocks, at, d, e):
    """Elastic energy of the layers and shear, of the hourglass stresses, of drilling [J]."""
    t, _, area = in_plane(blocks, at, d, e)
    total = layer_energy(p, blocks, at + LANES * LAYERS) + shear_energy(p, blocks, at)
    # what yields gives its work back in part only: that done on the hourglass is told
    held = blocks[at + LANES * HOURGLASS]
    return area * t * total, held, drilling_energy(p, blocks, at, t, area)


@kernel
def in_plane(blocks, at, d, e):
    """Thickness of an element, its diagonals in its axes, its area."""
    shape = at + LANES * SHAPE
    G = (blocks[shape], blocks[shape + LANES], blocks[shape + 2 * LANES], blocks[shape + 3 * LANES])
    _, flat, area = plane_axes(d, e, G)
    return blocks[at + LANES * THICKNESS], flat, area


@kernel
def twist_energy(p, blocks, at, t, flat, area):
    """Energy of the change of transverse shear across the element [J]."""
    _, k = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
    q = at + LANES * (PLANE_Q + 4)
    x, y = blocks[q], blocks[q + LANES]
    return 0.5 * x * x / k[0] + 0.5 * y * y / k[1]


@kernel
def drilling_energy(p, blocks, at, t, area):
    """Energy of the spins about the normal against the turn of the plane [J]."""
    x = blocks[at + LANES * DRILL]
    return 0.5 * x * x / (DRILLING * p.shear * t * area)


@kernel
def layer_energy(p, blocks, at):
    """Elastic energy per volume of the layers at a point of the plane [J/m^3]."""
    total = 0.0
    for k in range(p.layers):
        row = at + LANES * p.layer_rows * k
        if p.hyper == 1:
            total += 0.5 * p.weight[k] * hyper_energy(p, blocks, row)
            continue
        x, y, s = blocks[row], blocks[row + LANES], blocks[row + 2 * LANES]
        density = x * x + y * y - 2.0 * p.poisson * x * y + 2.0 * (1.0 + p.poisson) * s * s
        total += 0.25 * p.weight[k] * density / p.young
    return total


@kernel
def hyper_energy(p, blocks, at):
    """Energy per volume of a neo-Hookean layer [J/m^3]."""
    C, across = at + LANES * METRIC, blocks[at + LANES * ACROSS]
    x, y, s = blocks[C], blocks[C + LANES], blocks[C + 2 * LANES]
    volume = 0.5 * log1p(x + y + x * y - s * s) + across
    trace = x + y + expm1(2.0 * across) - 2.0 * volume
    return exp(-volume) * 0.5 * (p.shear * trace + p.volumetric * volume * volume)


@kernel
def shear_energy(p, blocks, at):
    """Energy per volume of the transverse shear in the middle [J/m^3]."""
    x, y = blocks[at + LANES * SHEAR], blocks[at + LANES * (SHEAR + 1)]
    return 0.6 * (x * x + y * y) / p.shear
