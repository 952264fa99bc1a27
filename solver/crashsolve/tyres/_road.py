"""Roads under a wheel: the nearest point of a plane, a box, a mesh of triangles or a profile.

    distance d of the wheel's centre, unit normal n from the nearest point to the centre

A profile is a height z = y(s) over the distance s along a road: on a smooth piece s_0 of the
nearest point solves (s_0 - s) + (y - z) y' = 0. Consequence to test: the distance from every road
against a brute-force search, and a rigid disc that crosses a step of height h lifts when it is
sqrt(2 R h - h^2) away.
"""

from collections.abc import Sequence
from importlib import import_module
from math import sqrt
from typing import Protocol

import numpy as np

from crashsolve.contact.narrow import _tree
from crashsolve.contact.narrow.sphere_box import from_box
from crashsolve.contact.narrow.sphere_mesh import nearest, outward
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, Vec3, quantity, word
from crashsolve.foundation.columns import matvec, matvec_t
from crashsolve.foundation.curve import curve_value, segment
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, norm, scale, sub

MAX_ROADS = 6  # roads of one tyre
# cosine between normals of two roads above which they press a wheel from one side
ONE_SIDE = 0.99
# difference by which the turning of a normal is found, over R
NEAR = 1e-4
STARTS = 3  # of the search on a curved piece of a profile
PLANE, BOX, MESH, PROFILE = range(4)
KINDS = {"plane": PLANE, "box": BOX, "mesh": MESH}

ROADS = Record(f"""
    roads      count        how many
    kind       flag   {MAX_ROADS}  PLANE, BOX, MESH or PROFILE
    road_node  index  {MAX_ROADS}  body of each
    road_at    m      {3 * MAX_ROADS}  point or centre of each from its mass centre, body axes
    road_axes  1      {9 * MAX_ROADS}  axes in the body, by rows; the third is the normal of a plane
    road_half  m      {3 * MAX_ROADS}  half edges of a box
    road_root  index  {MAX_ROADS}  first box of the tree of a mesh, or curve of a profile
    thickness  m      {MAX_ROADS}  of a mesh; infinite for a closed one
""")


class Profile(Card):
    """Height of a road over the distance along it, fixed in the ground."""

    curve: CurveName = word("height over the distance")
    at: Vec3 = quantity("m", "point where distance and height are zero", (0.0, 0.0, 0.0))
    along: Vec3 = word("direction of the distance, horizontal; any length", (1.0, 0.0, 0.0))
    up: Vec3 = word("direction of the height; any length", (0.0, 0.0, 1.0))


def road_columns(names: Sequence[str], profile: Profile | None, scene: Scene) -> Columns:
    """Columns of ROADS of some surfaces and a profile."""
    if len(names) + (profile is not None) > MAX_ROADS:
        raise scene.fail(
            f"at most {MAX_ROADS} roads; join meshes, or give other tyres theirs", "road"
        )
    shapes: Columns = {
        column.name: np.zeros((MAX_ROADS, max(column.size // MAX_ROADS, 1)))
        for column in ROADS.columns[1:]
    }
    for i, name in enumerate(names):
        module, card = scene.law("surfaces", name)
        shape = module.__name__.rpartition(".")[2]
        if shape not in KINDS:
            raise scene.fail(
                f"'{name}' is of type {shape}; a road is one of {', '.join(KINDS)}", "road"
            )
        element = _shape(name, card, scene)
        shapes["kind"][i], shapes["road_node"][i] = KINDS[shape], element["node"]
        shapes["road_at"][i] = element["point"]
        if shape == "plane":
            shapes["road_axes"][i] = np.concatenate([np.zeros(6), element["normal"]])
        else:
            shapes["road_axes"][i] = element["axes"]
            shapes["road_half"][i] = element.get("half", 0.0)
            shapes["thickness"][i] = element.get("thickness", 0.0)
    if profile is not None:
        _place_profile(profile, len(names), shapes, scene)
    flat = {name: table.ravel() for name, table in shapes.items()}
    return flat | {"roads": len(names) + (profile is not None)}


def _place_profile(profile: Profile, i: int, shapes: Columns, scene: Scene) -> None:
    """Writes: row i of shapes."""
    along, up = scene.unit(profile.along, "profile.along"), scene.unit(profile.up, "profile.up")
    if abs(along @ up) > 1e-6:
        raise scene.fail("along and up must be at right angles", "profile.along")
    shapes["kind"][i], shapes["road_at"][i] = PROFILE, profile.at
    shapes["road_axes"][i] = np.concatenate([along, np.cross(up, along), up])
    shapes["road_root"][i] = scene.curve(profile.curve)


def _shape(name: str, card: Card, scene: Scene) -> Columns:
    """The one element of a surface."""
    elements = import_module(type(card).__module__).build(card, scene)
    if len(elements) != 1:
        raise scene.fail(f"'{name}' has several parts; a road has one", "road")
    return elements[0]


class Rolling(Protocol):
    """A card of a tyre, by the names of its roads."""

    @property
    def road(self) -> Sequence[str]: ...


def mesh_tables(
    cards: Sequence[Rolling], table: np.ndarray, scene: Scene
) -> tuple[np.ndarray, ...]:
    """Boxes and triangles of all meshes of some tyres; () without any. Writes: table.road_root."""
    solids, positions = [], []
    for row, card in zip(table, cards, strict=True):
        for i, name in enumerate(card.road):
            if row["kind"][i] == MESH:
                solids.append(_shape(name, scene.law("surfaces", name)[1], scene))
                positions.append((row, i))
    if not solids:
        return ()
    tables = _tree.data(None, solids)
    for solid, (row, i) in zip(solids, positions, strict=True):
        row["road_root"][i] = solid["root"]
    return tables


@kernel
def road_distance(p, i, nodes, x, curves, data):
    """Distance of a world point x from road i [m], negative below, the unit normal to x, and
    whether that is known to be the same beside it.
    """
    body = nodes[p.road_node[i]]
    at = (p.road_at[3 * i], p.road_at[3 * i + 1], p.road_at[3 * i + 2])
    displacement = sub(x, world_position(body, at))
    if p.kind[i] == PLANE:
        n = arm(body, (p.road_axes[9 * i + 6], p.road_axes[9 * i + 7], p.road_axes[9 * i + 8]))
        return dot(displacement, n), n, True
    axes = road_axes(p, i)
    if p.kind[i] == PROFILE:
        # its axes are rows of the ground
        y = matvec(axes, displacement)
        distance, m, is_even = profile_distance(curves, p.road_root[i], p.radius, y)
        return distance, matvec_t(axes, m), is_even
    y = matvec_t(axes, matvec_t(body.A, displacement))
    if p.kind[i] == BOX:
        distance, m = from_box(
            (p.road_half[3 * i], p.road_half[3 * i + 1], p.road_half[3 * i + 2]), y
        )
    else:
        distance, m = 1e300, (0.0, 0.0, 1.0)
        if data is not None:
            distance, m = mesh_distance(p.road_root[i], p.thickness[i], y, data)
    return distance, matvec(body.A, matvec(axes, m)), False


@kernel
def record_double(new, n, before):
    """Normals of a road that presses the wheel and of the one before it. Writes: new."""
    if dot(n, before) > ONE_SIDE:
        new.roads_overlap = 1


@kernel
def road_axes(p, i):
    """Rotation matrix of road i, by rows."""
    k = 9 * i
    return (
        p.road_axes[k],
        p.road_axes[k + 1],
        p.road_axes[k + 2],
        p.road_axes[k + 3],
        p.road_axes[k + 4],
        p.road_axes[k + 5],
        p.road_axes[k + 6],
        p.road_axes[k + 7],
        p.road_axes[k + 8],
    )


@kernel
def profile_distance(curves, curve, radius, y):
    """Distance of (s, across, z) from a profile, and the normal in its axes; exact up to `radius`.
    Last, whether the nearest point lies within a straight piece.

    All pieces that may be nearer than the road straight below are searched, so that corners, steps
    and troughs narrower than the wheel have their true distance, which has no jumps.
    """
    last = curves[curve].last
    k = segment(curves, curve, last, y[0])
    below = curves[k]
    if is_straight(below.c):
        slope = below.c[1]
        over = y[2] - (below.c[0] + slope * (y[0] - below.x))
        # what may be nearer than the road below, and the points beside it of normal_gradient
        reach = min(abs(over), radius) + 2.0 * NEAR * radius
        if below.x + reach <= y[0] and y[0] + reach <= curves[k + 1].x:
            cosine = 1.0 / sqrt(1.0 + slope * slope)
            return cosine * over, (-slope * cosine, 0.0, cosine), True
    height, slope, _ = curve_value(curves, curve, y[0])
    at, z = y[0], height
    if y[0] < curves[curve].x or y[0] > curves[last].x:
        # straight on beyond an end
        at += (y[2] - height) * slope / (1.0 + slope * slope)
        z += slope * (at - y[0])
    least = (at - y[0]) ** 2 + (z - y[2]) ** 2
    reach, is_even = min(sqrt(least), radius), False
    i = segment(curves, curve, last, max(y[0] - reach, curves[curve].x))
    while i < last and curves[i].x <= y[0] + reach:
        start, end = curves[i].x, curves[i + 1].x
        is_line = is_straight(curves[i].c)
        # a cubic has up to three nearest points: one from each third is found
        for j in range(1 if is_line else STARTS):
            begin = (j + 0.5) / STARTS * (end - start)
            if is_line:
                s = nearest_on_line(curves[i].c, end - start, y, start)
            else:
                s = nearest_on_piece(curves[i].c, begin, end - start, y, start)
            h = piece_height(curves[i].c, s)
            square = (start + s - y[0]) ** 2 + (h - y[2]) ** 2
            if square <= least:
                is_even = is_line and min(s, end - start - s) > 2.0 * NEAR * radius
            if square < least:
                at, z, least = start + s, h, square
        i += 1
    distance = sqrt(least)
    if distance <= 1e-12:
        length = sqrt(1.0 + slope * slope)
        return y[2] - height, (-slope / length, 0.0, 1.0 / length), False
    sign = -1.0 if y[2] < height else 1.0
    by_distance = sign / distance
    normal = (by_distance * (y[0] - at), 0.0, by_distance * (y[2] - z))
    return sign * distance, normal, is_even


@kernel
def is_straight(c):
    """Whether a piece is a straight line."""
    return c[2] == 0.0 and c[3] == 0.0


@kernel
def piece_height(c, s):
    """Height of a piece at s from its start [m]."""
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]))


@kernel
def nearest_on_line(c, end, y, start):
    """Position on a straight piece of that length nearest to y, from its start [m]."""
    s = (y[0] - start + (y[2] - c[0]) * c[1]) / (1.0 + c[1] * c[1])
    return min(max(s, 0.0), end)


@kernel
def nearest_on_piece(c, s, end, y, start):
    """Position on a cubic of that length nearest to y, from its start [m]; Newton from s."""
    for _ in range(12):
        rise = piece_height(c, s) - y[2]
        slope = c[1] + s * (2.0 * c[2] + 3.0 * s * c[3])
        bend = 2.0 * c[2] + 6.0 * s * c[3]
        curvature = 1.0 + slope * slope + rise * bend
        # where the distance has no minimum nearby: downhill at least
        flat = 1.0 + slope * slope
        step = (start + s - y[0] + rise * slope) / (curvature if curvature > 0.2 else flat)
        s = min(max(s - step, 0.0), end)
        if abs(step) <= 1e-14 * flat:
            break
    return s


@kernel
def mesh_distance(root, thickness, y, data):
    """Distance of y from a mesh and the normal, in the axes of the mesh."""
    foot, index, at = nearest(data[0], data[1], root, y)
    displacement = sub(y, foot)
    distance = norm(displacement)
    m, is_open = outward(data[1][index], at)
    inside = not is_open and dot(displacement, m) < 0.0
    if inside and distance > thickness:
        # beneath the solid: not on this road
        return 1e300, m
    if distance > 0.0:
        m = scale(-1.0 / distance if inside else 1.0 / distance, displacement)
    return (-distance if inside else distance), m
