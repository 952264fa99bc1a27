"""Route of a belt: the fittings in bodies that it runs through, and where its segments lie.

Segment i runs from fitting i to fitting i + 1. At a ring the belt turns by beta, the angle between
its directions before and behind it.
"""

from importlib import import_module
from math import atan2, pi

import numpy as np
from pydantic import model_validator

from crashsolve.belts._angle import angle_between
from crashsolve.belts._arc import straight_arc
from crashsolve.belts._carry import divide_arc
from crashsolve.belts._ellipsoid import over_ellipsoid
from crashsolve.belts._spool import Retractor
from crashsolve.belts._wrap import over_cylinder, over_sphere
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, SurfaceName, Vec3, quantity, word
from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_stiffness_bound,
    arm,
    mobility,
    point_at,
)
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import (
    ZERO,
    add,
    cross,
    dot,
    norm,
    put_triple,
    scale,
    sub,
    triple,
    vec,
)

FITTINGS = 10  # fittings of one belt
SEGMENTS = FITTINGS - 1
SURFACES = SEGMENTS // 2  # of one belt: not at its ends, and no two side by side
SPHERE, CYLINDER, ELLIPSOID = 1, 2, 3
SHAPES = {"sphere": SPHERE, "cylinder": CYLINDER, "ellipsoid": ELLIPSOID}
# of the route: a segment shorter than this is taken as this long, where it pulls
SHORT = 1e-3
# [rad] from opposite, and of a radius from an axis: it has no side
SAME_SIDE = 1e-9
# cosine of the angle between segments beyond which a route doubles back
BACK = -0.9999


class Anchor(Card):
    """Point of a body that holds an end of the belt."""

    body: BodyName = word("body that it is fixed to", default="ground")
    at: Vec3 = quantity("m", "point in the frame of the body", default=(0.0, 0.0, 0.0))


class Ring(Card):
    """Slip ring, D-ring or buckle: the webbing runs through a point of a body."""

    body: BodyName = word("body of the ring", default="ground")
    at: Vec3 = quantity("m", "point in the frame of the body", default=(0.0, 0.0, 0.0))
    friction_coefficient: float = quantity(
        "1", "mu between webbing and ring", default=0.0, ge=0, le=5
    )


class Wrap(Card):
    """Surface of a body that the belt wraps where it meets it."""

    surface: SurfaceName = word("sphere, cylinder or ellipsoid")
    friction_coefficient: float = quantity(
        "1", "mu between webbing and surface", default=0.0, ge=0, le=5
    )
    over: Vec3 | None = quantity(
        "m",
        "point on the side of a cylinder on which the belt lies, body axes; the nearer side when "
        "absent",
        None,
    )


class Fitting(Card):
    """One point of the route, or a surface that the belt wraps."""

    anchor: Anchor | None = word("end of the belt", default=None)
    retractor: Retractor | None = word("spool at the beginning of the belt", default=None)
    ring: Ring | None = word("slip ring through which the belt runs", default=None)
    wrap: Wrap | None = word("surface of a body around which the belt lies", default=None)

    @model_validator(mode="after")
    def _one(self) -> "Fitting":
        known = (self.anchor, self.retractor, self.ring, self.wrap)
        if sum(x is not None for x in known) != 1:
            raise ValueError("needs one of anchor, retractor, ring and wrap")
        return self

    @property
    def kind(self) -> str:
        words = ("anchor", "retractor", "ring", "wrap")
        return next(name for name in words if getattr(self, name) is not None)


ROUTE = Record(f"""
    segments              count              how many
    node                  index  {FITTINGS}      body of each fitting; the last is repeated
    point                 m      {3 * FITTINGS}  fitting, or middle of its surface, from mass centre
    friction_coefficient  1      {FITTINGS}      mu of rings and surfaces
    surface               flag   {FITTINGS}      0 for a point, else SPHERE, CYLINDER or ELLIPSOID
    axes                  1      {9 * FITTINGS}  axes of each surface in its body, by rows
    semi                  m      {3 * FITTINGS}  semi-axes; radius first, half length of cylinder
    sense                 1      {FITTINGS}      1 or -1: how the belt turns about a cylinder
    turned                rad    {FITTINGS}      angle about it between its neighbours at the start
    shortest              m                  length below which a segment is taken as that long
""")
ROUTE_HISTORY = Record(f"""
    along     1      {3 * SEGMENTS}  directions of the segments
    arrive    m      {3 * FITTINGS}  where the belt reaches each fitting, world axes
    leave     m      {3 * FITTINGS}  where it leaves
    half      m      {SURFACES}  half the arc on each surface
    split     m      {SURFACES}  middle of the arc from the point of its body that divides it
    excess    m      {SURFACES}  by which that point would be beyond an end of the arc in the step
    carried   m      {FITTINGS}  webbing that goes with it past the end, and slack that is taken up,
                                 onwards
    middle    m      {3 * SURFACES}  middle of the arc from the mass centre, body axes
    lies      1      {3 * SURFACES}  direction of the belt there, body axes
    turned    rad    {SURFACES}  angle about a cylinder between its neighbours; tau of an ellipsoid
    begun     m      {3 * SURFACES}  where the belt reaches an ellipsoid, its axes
    touches   flag   {SURFACES}  1 where the belt lies on a surface; until clear of it -1
                                 where a fitting was within it, -2 where it has slipped off
    has_lain  flag   {SURFACES}  1 once the belt has lain on a surface
    slipped   flag           the belt has slipped off a surface
    lateral   rad    {SURFACES}  by which it slid across its direction, over a ball or an ellipsoid
    crossed   flag           it slid so by more than a right angle
    inside    flag           a fitting was within a surface
    beyond    flag           the belt lay on a cylinder beyond its ends
""")


def check_route(route: tuple[Fitting, ...]) -> None:
    """Raises ValueError for fittings that make no belt."""
    if len(route) > FITTINGS:
        raise ValueError(f"route: has {len(route)} fittings, and may have {FITTINGS}")
    if len(route) < 2 or not (route[0].anchor or route[0].retractor) or not route[-1].anchor:
        raise ValueError(
            "route: must begin with an anchor or a retractor, and end with an anchor; a ring needs "
            "webbing on both sides"
        )
    for i, fitting in enumerate(route[1:-1], start=2):
        if fitting.anchor is not None or fitting.retractor is not None:
            raise ValueError(f"route: fitting {i} holds the belt in its middle; make it a ring")
        if fitting.wrap is not None and route[i].wrap is not None:
            raise ValueError(
                f"route: fittings {i} and {i + 1} are surfaces one after the other; put a ring "
                "between them"
            )


def route_columns(route: tuple[Fitting, ...], scene: Scene) -> Columns:
    """Columns of ROUTE, except those that depend on lengths."""
    columns: Columns = {c.name: np.zeros((FITTINGS, max(c.size // FITTINGS, 1))) for c in TABLES}
    for i, fitting in enumerate(route):
        if fitting.wrap is not None:
            _place_surface(columns, i, fitting.wrap, scene)
            continue
        held = fitting.anchor or fitting.retractor or fitting.ring
        assert held is not None
        node = scene.node(held.body)
        columns["node"][i], columns["point"][i] = node, scene.from_mass_centre(node, held.at)
        columns["friction_coefficient"][i] = (
            fitting.ring.friction_coefficient if fitting.ring else 0.0
        )
    columns["node"][len(route) :] = columns["node"][len(route) - 1]
    if len(set(columns["node"].ravel())) == 1:
        raise scene.fail("all fittings are on one body; a belt needs two or more", "route")
    _set_rotation_about_cylinders(columns, route, scene)
    flat = {name: table.ravel() for name, table in columns.items()}
    return flat | {"segments": len(route) - 1, "shortest": 0.0}


TABLES = [c for c in ROUTE.columns if c.name not in ("segments", "shortest")]


def _place_surface(columns: Columns, i: int, wrap: Wrap, scene: Scene) -> None:
    """Writes: row i of columns."""
    module, card = scene.law("surfaces", wrap.surface)
    shape, field = module.__name__.rpartition(".")[2], f"route.{i}.wrap.surface"
    if shape not in SHAPES:
        message = f"'{wrap.surface}' is of type {shape}; a belt lies on one of "
        raise scene.fail(message + ", ".join(SHAPES), field)
    element = import_module(module.__name__).build(card, scene)[0]
    columns["surface"][i], columns["node"][i] = SHAPES[shape], element["node"]
    columns["point"][i], columns["friction_coefficient"][i] = (
        element["point"],
        wrap.friction_coefficient,
    )
    columns["axes"][i] = np.ravel(element.get("axes", np.eye(3)))
    columns["semi"][i] = element.get("semi", element.get("radius"))
    columns["semi"][i, 2] = element.get("half_length", columns["semi"][i, 2])
    if wrap.over is not None and shape != "cylinder":
        message = "over: is for cylinders alone; on other surfaces the belt takes the shortest path"
        raise scene.fail(message, f"{field}")


def _set_rotation_about_cylinders(
    columns: Columns, route: tuple[Fitting, ...], scene: Scene
) -> None:
    """Writes: sense and turned of columns."""
    for i in np.flatnonzero(columns["surface"].ravel() == CYLINDER):
        node, wrap = int(columns["node"][i, 0]), route[i].wrap
        assert wrap is not None
        axes, centre = columns["axes"][i].reshape(3, 3), columns["point"][i]
        angles = []
        for j in (i - 1, i + 1):
            other = int(columns["node"][j, 0])
            x = scene.r[other] + scene.matrix(other) @ columns["point"][j]
            y = axes.T @ (scene.to_body(node, x) - centre)
            angles.append(float(np.arctan2(y[1], y[0])))
        onwards = (angles[1] - angles[0]) % (2.0 * pi)
        sense = 1.0 if onwards <= pi else -1.0
        if wrap.over is None and abs(onwards - pi) < SAME_SIDE:
            message = "the fittings beside it are opposite each other: give over, a point on the "
            raise scene.fail(message + "side of the belt", f"route.{i}.wrap.surface")
        if wrap.over is not None:
            y = axes.T @ (scene.from_mass_centre(node, wrap.over) - centre)
            if np.hypot(y[0], y[1]) <= SAME_SIDE * columns["semi"][i, 0]:
                message = "is on the axis of the cylinder: give a point on the side of the belt"
                raise scene.fail(message, f"route.{i}.wrap.over")
            sense = 1.0 if (np.arctan2(y[1], y[0]) - angles[0]) % (2.0 * pi) < onwards else -1.0
        columns["sense"][i] = sense
        columns["turned"][i] = onwards if sense > 0.0 else 2.0 * pi - onwards


def refuse_route(
    route: tuple[Fitting, ...], initial: np.void, lengths: np.ndarray, scene: Scene
) -> None:
    """Refuse fittings that make no route at the start; `initial` has the columns ROUTE_HISTORY."""
    for i, fitting in enumerate(route):
        touches = initial["touches"][surface_row(i)] if fitting.wrap else 0
        if touches == -1:
            message = "contains the fitting before or behind it (a cylinder is taken as endless); "
            raise scene.fail(f"{message}move them", f"route.{i}.wrap.surface")
        if touches == -2:
            message = "there is no shortest line over it from the fitting before it to that behind "
            message += "it: they are opposite each other; move one of them"
            raise scene.fail(message, f"route.{i}.wrap.surface")
    for i, length in enumerate(lengths):
        if not length > 2.0 * SHORT * lengths.sum():
            message = f"is {length:.3g} m from the fitting before it, on a route of "
            message += f"{lengths.sum():.3g} m; a segment needs more than {2 * SHORT:g} of it"
            field = "surface" if route[i + 1].wrap else "at"
            raise scene.fail(message, f"route.{i + 1}.{route[i + 1].kind}.{field}")
    units = initial["along"].reshape(-1, 3)
    for i in range(1, len(route) - 1):
        if route[i].ring and units[i - 1] @ units[i] < BACK:
            message = "the belt doubles back on itself in it; move it, or leave it out"
            raise scene.fail(message, f"route.{i}.ring.at")


@kernel
def axes_of(p, j):
    """Axes of a surface in its body, by rows."""
    k, a = 9 * j, p.axes
    return (
        a[k],
        a[k + 1],
        a[k + 2],
        a[k + 3],
        a[k + 4],
        a[k + 5],
        a[k + 6],
        a[k + 7],
        a[k + 8],
    )


@kernel
def position_of(p, j, nodes):
    """World position of a fitting that is a point, or of the middle of its surface."""
    body = nodes[p.node[j]]
    return point_at(body, arm(body, triple(p.point, j)))


@kernel
def surface_row(j):
    """Row of fitting j in the columns of surfaces, of which two are never side by side."""
    return (j - 1) // 2


@kernel
def arc_on(p, j, old, y_a, y_b):
    """The Arc on surface j between two points in its axes."""
    semi, k = triple(p.semi, j), surface_row(j)
    if p.surface[j] == SPHERE:
        return over_sphere(semi[0], y_a, y_b)
    if p.surface[j] == CYLINDER:
        # a belt that was within the cylinder, or has slipped off it, has not gone round it
        before = old.turned[k] if old.touches[k] >= 0 else 0.0
        return over_cylinder(semi[0], y_a, y_b, p.sense[j], before)
    middle = matvec_t(axes_of(p, j), sub(triple(old.middle, k), triple(p.point, j)))
    before = old.touches[k], triple(old.begun, k), middle, old.turned[k]
    return over_ellipsoid(semi, y_a, y_b, before)


@kernel
def wrap_surface(p, j, old, new, nodes):
    """The belt on surface j, from the fitting before it to that behind it. Writes: new."""
    body, axes, k = nodes[p.node[j]], axes_of(p, j), surface_row(j)
    centre = position_of(p, j, nodes)
    from_a, from_b = triple(new.leave, j - 1), position_of(p, j + 1, nodes)
    y_a = matvec_t(axes, matvec_t(body.A, sub(from_a, centre)))
    y_b = matvec_t(axes, matvec_t(body.A, sub(from_b, centre)))
    arc = arc_on(p, j, old, y_a, y_b)
    if arc.touches == -2:
        new.slipped = 1
    if arc.touches == 1 and old.touches[k] < 0:
        # straight until it is clear of the surface, as it has slipped off it or was within it
        arc = straight_arc(old.touches[k], y_a, y_b, 0.5, 0.0)
    put_triple(new.arrive, j, add(centre, matvec(body.A, matvec(axes, arc.first))))
    put_triple(new.leave, j, add(centre, matvec(body.A, matvec(axes, arc.last))))
    middle = add(triple(p.point, j), matvec(axes, arc.middle))
    lies = matvec(axes, arc.along)
    new.lateral[k] = 0.0
    if p.surface[j] != CYLINDER and arc.touches == 1 and old.touches[k] == 1:
        new.lateral[k] = old.lateral[k] + lateral_slip(p, j, old, middle)
        if abs(new.lateral[k]) > 0.5 * pi:
            new.crossed = 1
    put_triple(new.middle, k, middle)
    put_triple(new.lies, k, lies)
    new.half[k], new.turned[k] = 0.5 * arc.length, arc.turned
    put_triple(new.begun, k, arc.first)
    divide_arc(k, j, arc, middle, lies, old, new)
    new.touches[k] = arc.touches
    new.has_lain[k] = 1 if arc.touches == 1 else old.has_lain[k]
    if arc.touches == -1:
        new.inside = 1
    farthest = max(abs(arc.first[2]), abs(arc.last[2]))
    if p.surface[j] == CYLINDER and arc.touches == 1 and farthest > p.semi[3 * j + 2]:
        new.beyond = 1
    return arc.bend


@kernel
def lateral_slip(p, j, old, middle):
    """Angle [rad] by which a belt slid across its direction over a round surface in the step."""
    k = surface_row(j)
    before, after = sub(triple(old.middle, k), triple(p.point, j)), sub(middle, triple(p.point, j))
    across = cross(before, triple(old.lies, k))
    return atan2(dot(after, across), dot(after, before))


@kernel
def update_route(p, old, new, out, nodes):
    """Lengths and directions of the segments, and angles at the fittings. Writes: new, out."""
    new.inside, new.beyond = old.inside, old.beyond
    new.slipped, new.crossed = old.slipped, old.crossed
    for j in range(p.segments + 1):
        out.angle[j] = new.carried[j] = 0.0
        if p.surface[j] > 0:
            out.angle[j] = wrap_surface(p, j, old, new, nodes)
        else:
            at = position_of(p, j, nodes)
            put_triple(new.arrive, j, at)
            put_triple(new.leave, j, at)
    before = ZERO
    for i in range(p.segments):
        leg = sub(triple(new.arrive, i + 1), triple(new.leave, i))
        straight = norm(leg)
        u = scale(1.0 / straight, leg) if straight > 1e-12 else (1.0, 0.0, 0.0)
        put_triple(new.along, i, u)
        out.length[i] = straight
        if p.surface[i] > 0:
            out.length[i] += new.half[surface_row(i)] + new.split[surface_row(i)]
        if p.surface[i + 1] > 0:
            out.length[i] += new.half[surface_row(i + 1)] - new.split[surface_row(i + 1)]
        if i > 0 and p.surface[i] == 0:
            out.angle[i] = angle_between(before, u)
        before = u


@kernel
def clear_surfaces(p, new):
    """Rows of the columns of surfaces that there are not. Writes: new."""
    for k in range(SURFACES):
        if p.surface[2 * k + 1] == 0 and p.surface[2 * k + 2] == 0:
            clear_surface(new, k)


@kernel
def clear_surface(new, k):
    """Row k of the columns of surfaces, which has none. Writes: new."""
    new.half[k] = new.split[k] = new.turned[k] = new.lateral[k] = new.excess[k] = 0.0
    put_triple(new.begun, k, (0.0, 0.0, 0.0))
    put_triple(new.middle, k, (0.0, 0.0, 0.0))
    put_triple(new.lies, k, (0.0, 0.0, 0.0))
    new.touches[k] = new.has_lain[k] = 0


@kernel
def pull_segments(p, new, out, nodes):
    """Forces of all segments on the bodies of their fittings. Writes: nodes.

    Those on fittings of one body that follow each other are summed before they are applied.
    """
    before, u_before = ZERO, ZERO
    force, torque = ZERO, ZERO
    for j in range(p.segments + 1):
        behind, u = ZERO, ZERO
        if j < p.segments:
            u = triple(new.along, j)
            behind = scale(out.force[j], u)
        body = nodes[p.node[j]]
        d = sub(triple(new.arrive, j), vec(body.r))
        here = sub(behind, before) if p.surface[j] == 0 else scale(-1.0, before)
        force, torque = add(force, here), add(torque, cross(d, here))
        if j > 0 and body.mass_inv > 0.0:
            k = p.steepest / new.webbing[j - 1]
            add_stiffness_bound(body, mobility(body, d, u_before), k, 0.0)
        if p.surface[j] != 0:
            d = sub(triple(new.leave, j), vec(body.r))
            force, torque = add(force, behind), add(torque, cross(d, behind))
        if j < p.segments and body.mass_inv > 0.0:
            k = p.steepest / new.webbing[j]
            add_stiffness_bound(body, mobility(body, d, u), k, 0.0)
        if j == p.segments or p.node[j + 1] != p.node[j]:
            add_to(body.force, force)
            add_to(body.torque, torque)
            force, torque = ZERO, ZERO
        before, u_before = behind, u
