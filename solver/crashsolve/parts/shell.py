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

from typing import Any, Literal

import numpy as np

from crashsolve.deck.card import BodyName, Card, Law, MaterialName, Vec3, quantity, word
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.point import LANES, RIDES
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import cross, dot, norm, sub, vec
from crashsolve.parts._layers import (
    ALL_ROWS,
    CURVE_ROWS,
    FLOW,
    PLASTIC_ROWS,
    STRAIN,
    layers,
)
from crashsolve.parts._quad_block import (
    DRILL,
    DRILLING,
    HOURGLASS,
    LAYERS,
    LOSS,
    RADIUS_2,
    RATE,
    SHAPE,
    SHEAR,
    SOFT_PLANE,
    THICKNESS,
    WEIGHT,
    gather,
    push,
    scatter,
    strain,
)

STEPWISE = True
ROWS = ALL_ROWS
FAMILY = "matsum"
ZERO = (0.0, 0.0, 0.0)
MOTIONS = ("x", "y", "z", "turn_x", "turn_y", "turn_z")
Motion = Literal["x", "y", "z", "turn_x", "turn_y", "turn_z"]
MOST_LAYERS = 10


class NamedNode(Card):
    """A node that is a body of the deck, for joints, loads, contacts, sensors and channels."""

    name: str = word("the body is called P_name in part P")
    at: Vec3 = quantity("m", "place; the nearest node is meant")


class Trace(Card):
    """A place whose history is written."""

    name: str = word("in channels P_name, for part P")
    at: Vec3 = quantity("m", "place; the nearest node or element is meant")


class Hold(Card):
    """Motions that the nodes of a set do not make."""

    nodes: str = word("set of nodes of the mesh")
    motions: tuple[Motion, ...] = word("along and about world axes", default=MOTIONS)


class Weld(Card):
    """Nodes of a set that are part of a rigid body."""

    nodes: str = word("set of nodes of the mesh")
    body: BodyName = word("what they are part of; their mass and inertia add to its own")


class Shell(Card):
    """Thin shell of quadrilaterals."""

    mesh: Card = Law("meshes", "places of the nodes, elements, sets of nodes")
    thickness: float = quantity("m", "t", gt=0)
    material: MaterialName = word("what it is made of")
    layers: int = word("points through the thickness", default=5, ge=1, le=MOST_LAYERS)
    rule: Literal["gauss", "lobatto"] = word("where they lie; lobatto: at the faces too", "gauss")
    thinning: bool = word("the thickness follows the strain", default=False)
    nodes: tuple[NamedNode, ...] = word("nodes that are bodies", default=())
    hold: tuple[Hold, ...] = word("supports", default=())
    welded: tuple[Weld, ...] = word("sets of nodes on rigid bodies", default=())
    traces: tuple[Trace, ...] = word("nodes with a history: nodout.P_name", default=())
    gauges: tuple[Trace, ...] = word("elements with a history: elout.P_name", default=())
    drag: float = quantity("1/s", "alpha, damping force over momentum", default=0.0, ge=0)
    velocity: Vec3 = quantity("m/s", "at the start, of the mesh's first node", default=ZERO)
    angular_velocity: Vec3 = quantity("rad/s", "of the whole, world axes", default=ZERO)

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
    first_element=("index", "number of the part's first element among all"),
    layers=("count", "points through the thickness"),
    zeta=("1", MOST_LAYERS, "places of the layers, -1 to 1"),
    weight=("1", MOST_LAYERS, "weights of the layers, sum 2"),
    young=("Pa", "E"),
    shear=("Pa", "G"),
    poisson=("1", "nu"),
    density=("kg/m^3", "rho"),
    drag=("1/s", "alpha"),
    layer_rows=("count", "numbers of a layer"),
    thins=("flag", "whether the thickness follows the strain"),
    plastic=("flag", "whether the material yields"),
    yield_stress=("Pa", "Y_0"),
    isotropic=("Pa", "(1 - beta) H"),
    kinematic=("Pa", "beta H"),
    curve=("index", "Y over plastic strain; 0 for none"),
    rate_D=("1/s", "D of Cowper and Symonds; 0 for none"),
    rate_q=("1", "q of Cowper and Symonds"),
)
HISTORY = Record(damped=("J", "energy lost by drag"))
OUTPUT = Record(
    kinetic=("J", "of the nodes that are no bodies"),
    strain=("J", "elastic energy of the layers and of transverse shear"),
    hourglass=("J", "of what one point does not see"),
    drilling=("J", "of spins of the nodes about the normal against the turn of the plane"),
    plastic=("J", "plastic work"),
    drag=("J", "energy lost by drag"),
)

# of the elements in pictures: unit and components; resultants along the element's axes
FIELDS = {
    "thickness": ("m", 1),
    "membrane_force": ("N/m", 3),  # xx, yy, xy
    "moment": ("N", 3),  # xx, yy, xy
    "shear_force_xz": ("N/m", 1),
    "shear_force_yz": ("N/m", 1),
    "von_mises": ("Pa", 1),  # largest of the layers
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


class Laid:
    """A shell part in place: its mesh, with the masses of its nodes."""

    def __init__(self, card: Shell, scene: Any) -> None:
        _, self.material = scene.law("materials", card.material)
        self.card = card
        self.layer_rows = 3
        if hasattr(self.material, "yield_stress"):
            self.layer_rows = PLASTIC_ROWS if self.material.curve is None else CURVE_ROWS
        self.rule = rule(card, scene)
        self.mesh = scene.mesh(card)
        x = self.mesh.points[self.mesh.quads]
        normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
        self.area = 0.5 * np.linalg.norm(normal, axis=1)
        self._refuse_bad(x, normal, scene)
        n, t = len(self.mesh.points), card.thickness
        self.weight = self.material.density * t * self.area
        self.radius_2 = (self.area + t * t) / 12.0
        corners = self.mesh.quads.ravel()
        self.mass = np.bincount(corners, np.repeat(self.weight / 4, 4), n)
        self.J = np.bincount(corners, np.repeat(self.weight / 4 * self.radius_2, 4), n)
        self.named = [nearest(self.mesh.points, node) for node in card.nodes]
        self.traced = [nearest(self.mesh.points, node) for node in card.traces]
        self.gauged = [nearest(x.mean(axis=1), place) for place in card.gauges]
        self.held = self._held(scene)
        self.welded = self._welded(scene)

    def _refuse_bad(self, x: np.ndarray, normal: np.ndarray, scene: Any) -> None:
        """Every corner of an element must turn the same way."""
        for k in range(4):
            here = np.cross(x[:, (k + 1) % 4] - x[:, k], x[:, (k + 3) % 4] - x[:, k])
            bad = np.flatnonzero(~((here * normal).sum(1) > 1e-6 * (normal**2).sum(1)))
            if len(bad):
                where = ", ".join(f"{value:.4g}" for value in x[bad[0], k])
                message = (
                    f"element {bad[0] + 1} is degenerate or folded over at its corner ({where}) m; "
                    "its corners must go round a convex quadrilateral"
                )
                raise scene.fail(message, "mesh")

    def _held(self, scene: Any) -> np.ndarray:
        """Bits of the motions that every node does not make."""
        held = np.zeros(len(self.mesh.points), np.int64)
        for k, hold in enumerate(self.card.hold):
            nodes = self._set(hold.nodes, f"hold.{k}.nodes", scene)
            for motion in hold.motions:
                held[nodes] |= 1 << MOTIONS.index(motion)
        for node, index in zip(self.card.nodes, self.named, strict=True):
            if held[index]:
                message = f"node '{node.name}' is held; say traces if you only want its history"
                raise scene.fail(message, "nodes")
        held[self.named] = RIDES
        return held

    def _set(self, name: str, field: str, scene: Any) -> np.ndarray:
        """Nodes of a set of the mesh."""
        if name not in self.mesh.sets:
            known = ", ".join(sorted(self.mesh.sets)) or "none"
            raise scene.fail(f"the mesh has no set of nodes '{name}' (sets: {known})", field)
        return self.mesh.sets[name]

    def _welded(self, scene: Any) -> dict[str, np.ndarray]:
        """Nodes on each rigid body. Writes: held."""
        found: dict[str, list[int]] = {}
        for k, weld in enumerate(self.card.welded):
            nodes = self._set(weld.nodes, f"welded.{k}.nodes", scene)
            taken = self.held[nodes] != 0
            if taken.any():
                message = f"node {nodes[taken][0] + 1} of it is held, named or welded already"
                raise scene.fail(message, f"welded.{k}.nodes")
            self.held[nodes] = RIDES
            found.setdefault(weld.body, []).extend(nodes.tolist())
        return {body: np.array(nodes) for body, nodes in found.items()}

    def _first_flow(self, scene: Any) -> float:
        """Yield stress of a curve at no plastic strain [Pa]."""
        start = scene.curve(self.material.curve)
        flow, _, _ = curve_value(scene.curve_points.view(np.recarray), start, 0.0)
        return float(flow)

    @property
    def riding(self) -> np.ndarray:
        """Nodes whose mass is that of a body."""
        return np.concatenate([np.array(self.named, int), *self.welded.values()])

    def velocities(self) -> np.ndarray:
        """Velocities at the start [m/s], of held nodes without what they do not make."""
        way = self.mesh.points - self.mesh.points[0]
        return np.asarray(self.card.velocity) + np.cross(self.card.angular_velocity, way)

    def write_points(self, table: np.ndarray) -> None:
        """Rows of POINT at the start. Writes: table."""
        table["r"], table["v"] = self.mesh.points, self.velocities()
        table["w"] = self.card.angular_velocity
        table["mass_inv"], table["J_inv"] = 1.0 / self.mass, 1.0 / self.J
        table["held"] = self.held
        for k in range(3):
            table["v"][self.held >> k & 1 == 1, k] = 0.0
            table["w"][self.held >> (3 + k) & 1 == 1, k] = 0.0

    def write_blocks(self, numbers: np.ndarray, scene: Any) -> None:
        """Numbers of the elements, block by block; the last is filled up. Writes: numbers."""
        table = numbers.reshape(-1, self.stride // LANES, LANES)
        for row, values in (
            (THICKNESS, np.full(len(self.area), self.card.thickness)),
            (RADIUS_2, self.radius_2),
            (WEIGHT, self.weight),
            *((SOFT_PLANE + k, np.ones(len(self.area))) for k in range(4)),
            *((SHAPE + k, column) for k, column in enumerate(self._shape().T)),
        ):
            table[:, row] = self._in_lanes(values)
        if self.layer_rows == CURVE_ROWS:
            table[:, LAYERS + FLOW :: CURVE_ROWS] = self._first_flow(scene)

    def corners(self) -> np.ndarray:
        """Points of the corners, (blocks, 4, lanes)."""
        return np.stack([self._in_lanes(column) for column in self.mesh.quads.T], axis=1)

    @property
    def stride(self) -> int:
        """Numbers of a block."""
        return LANES * (LAYERS + self.layer_rows * self.card.layers)

    def padded(self) -> int:
        """Elements with those that fill the last block."""
        return -(-len(self.area) // LANES) * LANES

    def _in_lanes(self, values: np.ndarray) -> np.ndarray:
        """(blocks, lanes); the last element stands for those that are missing."""
        filled = np.append(values, np.repeat(values[-1:], self.padded() - len(values), axis=0))
        return filled.reshape(-1, LANES)

    def own_rows(self, blocks: np.ndarray, row: Any) -> np.ndarray:
        """What the elements keep (m, rows), from what those of all parts keep."""
        first, stride = int(row["first"]), int(row["stride"])
        own = blocks[first : first + self.padded() // LANES * stride]
        return own.reshape(-1, stride // LANES, LANES).transpose(0, 2, 1).reshape(self.padded(), -1)

    def gauge_values(self, blocks: np.ndarray, row: Any) -> np.ndarray:
        """Values of FIELDS of the gauged elements, side by side."""
        found = self.fields(self.own_rows(blocks, row)[self.gauged])
        return np.column_stack([found[name] for name in FIELDS])

    def all_fields(self, blocks: np.ndarray, row: Any) -> dict[str, np.ndarray]:
        """Values of FIELDS of all elements."""
        return self.fields(self.own_rows(blocks, row)[: len(self.area)])

    def fields(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        """Values of FIELDS from what elements keep (m, rows)."""
        layers = rows[:, LAYERS:].reshape(len(rows), self.card.layers, -1)
        t, stress = rows[:, THICKNESS], layers[:, :, :3]
        zeta, weight = self.rule
        share = 0.5 * t[:, None] * weight
        arm = 0.5 * t[:, None] * zeta
        x, y, s = np.moveaxis(stress, 2, 0)
        plastic = layers[:, :, STRAIN] if self.layer_rows > STRAIN else np.zeros(x.shape)
        E, nu = self.material.young, self.material.poisson
        elastic = (x * x + y * y - 2.0 * nu * x * y + 2.0 * (1.0 + nu) * s * s) / (2.0 * E)
        shear = rows[:, SHEAR : SHEAR + 2]
        density = 0.5 * elastic @ weight + 1.2 * (1.0 + nu) / E * (shear**2).sum(1)
        return {
            "thickness": t,
            "membrane_force": np.einsum("ek,ekc->ec", share, stress),
            "moment": np.einsum("ek,ekc->ec", share * arm, stress),
            "shear_force_xz": shear[:, 0] * t,
            "shear_force_yz": shear[:, 1] * t,
            "von_mises": np.sqrt(x * x + y * y - x * y + 3.0 * s * s).max(axis=1),
            "elastic_energy_density": density,
            "plastic_energy_density": rows[:, LOSS] / (rows[:, WEIGHT] / self.material.density),
            "plastic_strain_top": plastic[:, -1],
            "plastic_strain_mid": plastic[:, (self.card.layers - 1) // 2],
            "plastic_strain_bottom": plastic[:, 0],
        }

    def _shape(self) -> np.ndarray:
        """Inverse of the diagonals in axes between them, by rows (m, 4)."""
        x = self.mesh.points[self.mesh.quads]
        d, e = x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]
        d_length, e_length = np.linalg.norm(d, axis=1), np.linalg.norm(e, axis=1)
        # both axes are as far from one diagonal as from the other
        half = 0.5 * np.arccos(np.clip((d * e).sum(1) / (d_length * e_length), -1.0, 1.0))
        x, y = np.sin(half), np.cos(half)
        diagonals = np.array([[d_length * x, -e_length * x], [d_length * y, e_length * y]])
        return np.linalg.inv(diagonals.transpose(2, 0, 1)).reshape(-1, 4)


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
            "angular_velocity": card.angular_velocity,
        }
        for i in laid.named
    ]


def parameters(card: Shell, scene: Any) -> dict[str, Any]:
    """Columns of PARAMETERS but for the places in the tables."""
    laid = scene.laid(card)
    zeta, weight = laid.rule
    room = np.zeros(MOST_LAYERS - card.layers)
    law, material_card = scene.law("materials", card.material)
    return {
        "thins": card.thinning,
        "layer_rows": laid.layer_rows,
        "layers": card.layers,
        "zeta": np.append(zeta, room),
        "weight": np.append(weight, room),
        "drag": card.drag,
    } | law.build(material_card, scene)


@kernel
def deform(p, clock, h, scene):
    """Strains, stresses and forces of all elements of a part after a step of h.

    Writes: scene.points, lanes, work, clock.
    """
    points, corners, blocks, work = scene.points, scene.corners, scene.lanes, scene.work
    done = 0
    while done < p.element_count:
        number = done // LANES
        first, corner = p.first + number * p.stride, p.first_corner + 4 * done
        live = min(LANES, p.element_count - done)
        gather(points, corners, corner, work)
        strain(blocks, first, work, h, p)
        layers(blocks, first, work, h, p, scene.curves)
        push(blocks, first, work, p)
        scatter(points, corners, corner, live, work)
        for e in range(live):
            if work[LANES * RATE + e] > clock.element_rate:
                clock.element_rate = work[LANES * RATE + e]
                clock.limit_element = p.first_element + done + e
        done += LANES


@kernel
def energies(p, new, out, scene):
    """Energies of a part. Writes: out."""
    out.kinetic = moving(p, scene.points)
    out.strain = out.hourglass = out.drilling = out.plastic = 0.0
    for i in range(p.element_count):
        lane = i % LANES
        at = p.first + i // LANES * p.stride + lane
        corner = p.first_corner + 4 * (i - lane) + lane
        d, e = diagonal(scene, corner, 2), diagonal(scene, corner + LANES, 2)
        stretched, hourglass, drilling = element_energy(p, scene.lanes, at, d, e)
        out.strain += stretched
        out.hourglass += hourglass
        out.drilling += drilling
        out.plastic += scene.lanes[at + LANES * LOSS]
    out.drag = new.damped


@kernel
def moving(p, points):
    """Kinetic energy of the nodes of a part that are no bodies [J]."""
    total = 0.0
    for i in range(p.first_point, p.first_point + p.point_count):
        b = points[i]
        if b.held < RIDES:
            v, w = vec(b.v), vec(b.w)
            total += 0.5 * dot(v, v) / b.mass_inv + 0.5 * dot(w, w) / b.J_inv
    return total


@kernel
def diagonal(scene, corner, ahead):
    """From a corner to the one `ahead` of it."""
    a, b = scene.corners[corner], scene.corners[corner + ahead * LANES]
    return sub(vec(scene.points[b].r), vec(scene.points[a].r))


@kernel
def element_energy(p, blocks, at, d, e):
    """Elastic energy of the layers and shear, of the hourglass stresses, of drilling [J]."""
    t, nu = blocks[at + LANES * THICKNESS], p.poisson
    volume, total = 0.5 * norm(cross(d, e)) * t, 0.0
    for k in range(p.layers):
        row = at + LANES * (LAYERS + p.layer_rows * k)
        x, y, s = blocks[row], blocks[row + LANES], blocks[row + 2 * LANES]
        density = x * x + y * y - 2.0 * nu * x * y + 2.0 * (1.0 + nu) * s * s
        total += 0.25 * p.weight[k] * density / p.young
    x, y = blocks[at + LANES * SHEAR], blocks[at + LANES * (SHEAR + 1)]
    total += 0.6 * (x * x + y * y) / p.shear
    x = blocks[at + LANES * DRILL]
    drilling = 0.5 * x * x / (DRILLING * p.shear * volume)
    return volume * total, blocks[at + LANES * HOURGLASS], drilling
