"""Build of contact of shell nodes with shapes, and of nodes and balls with the faces of shells.

One group for each pair of surfaces of a card. Its arrays go to the compiled step under the group's
word; see node_contact.py and projection.py in system/contact/ for their equations.
"""

from __future__ import annotations

from importlib import import_module
from math import inf, isfinite
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from crashsolve.contact.cells import CELL, WALLS
from crashsolve.deck.building import Columns
from crashsolve.deck.roles import NormalLaw, StepFriction, StepGap
from crashsolve.foundation.point import LANES
from crashsolve.foundation.record import Record
from crashsolve.model.attachments import IMPLICIT
from crashsolve.model.contact import records
from crashsolve.model.contact.floor import speed_floor
from crashsolve.model.contact.groups import NodalGroup
from crashsolve.model.contact.near_faces import (
    adjacent_faces,
    chosen,
    excluded_faces,
    faces_around,
    faces_at_start,
    faces_within_reach,
    merged,
    nothing,
)
from crashsolve.model.contact.sides import Probes, SurfaceOfProbes, Touching
from crashsolve.model.nodes import NODE
from crashsolve.model.partition import PIECES

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

    from crashsolve.deck.reading.items import Entry
    from crashsolve.elements.shells.layout import DiscretisedShell
    from crashsolve.model.contact.sides import Shaped, Surface
    from crashsolve.model.scene import Scene

    # finds the gap routine of two surfaces, and whether it takes them in reverse order
    GapRoutines = Callable[[Shaped, Shaped, Scene], tuple[ModuleType, bool]]
    # gap routine of a shape, tables of a group with `values` of its parameters, records of a probe
    Sided = tuple[ModuleType | None, dict[str, Any], int]

# lists of near faces: their margin over the mean radius of a face, and the initial room for the
# faces of a probe
MARGIN, ROOM = 1.0, 24
# a node meets no faces of its own surface within so many gaps along it: a surface bent as tightly
# as its thickness allows touches itself after pi/2 gaps, and in its plane it would have to be
# crushed to 0.4 of its length
FOLDED = 2.5
# gaps of a surface with itself over the width of its faces: beyond this no shell could fold
THICKEST = 6.0
# share of the gap by which a step may reduce the distance of two sides
REACH = 0.5
# shapes that press on shapes, and on faces
PRESSING = (("points", "sphere"), ("points", "sphere", "ellipsoid"))

PROBE = Record("""
    point  index     point of a shell; -1 for one on a body
    node   index     the body, if it is on one
    at     m      3  from the mass centre, body axes
""")
PARAMETERS = Record("""
    card          index  contact card
    order         count  +1 when probes are on side a of the card, -1 when on side b
    speed_floor   m/s    closing speed below which a touch counts as resting
    gap           m      of probe and mid-surface, below which they touch
    over          m      reach of an ellipsoid beyond its ball; 0 of others
    share         1      of what is left of the gap between both, on the side of the probe
    reach         m      by which a step may bring both nearer
    margin        m      beyond the gap, of the lists of near faces
    extent        m      the model's size, for the speed of shapes that turn
    thick         m      of rigid shapes, from the surface of a probe that touches to both middles
    first_point   index  of the part whose speed counts
    point_count   count  its points
    is_self_contact  flag   whether the probes are among them
    first_corner  index  of the faces
    face_count    count  faces
    quads         count  of them, quadrilaterals; triangles come after them
    empty         count  lanes that the last block of quadrilaterals leaves empty
    first_number  index  in blocks, of quadrilaterals
    stride        count  numbers of a block of them
    first_third   index  in blocks, of triangles
    stride_third  count  numbers of a block of triangles
    first_own     index  first point of the part with the faces
    bucket_count  count  buckets of cubes, a power of two
    room          count  of the lists of near faces
    first_other_wall  index  of records of walls beside the nearest
""")
TOTALS = Record("""
    fastest         m/s    largest closing speed that there can be
    travel          m      sum of that over the steps
    listed          m      the same when lists were made
    pairs           count  in the lists
    searches        count  lists made
    stored          J      recoverable energy
    dissipated      J      lost by the normal force
    bristle_energy  J      recoverable energy of friction
    friction_loss   J      lost by friction
    depth           m      deepest touch
    deepest         m      the same of all steps
    pass_time       s      time at which a probe has passed through faces; 0: none has
""")
PROBE_STATE = Record("""
    active        flag      touching
    depth         m         penetration
    impact_speed  m/s       closing speed at the onset
    power         W         dissipated
    force         N         on the probe
    stored        J         recoverable energy
    face          index     that is touched
    normal        1      3  towards the probe
    N             1      4  weights of the corners
""")
FRICTION_STATE = Record("""
    friction_force  N  3  friction on the probe
    bristle_energy  J     recoverable energy of friction
""")
# of probes on faces, in the record of the nearest wall on a side
OTHER_WALLS = Record("other_walls  count  other walls touched on this side, while it is active")
HIT = Record("""
    depth     m         penetration; 0: no touch
    distance  m         to the face
    face      index     the nearest
    crossed   flag      whether it has been passed
    weight    1         share of its force; less than 1 where it is one wall with a nearer one
    other_walls  count  other walls found on this side, in that of the nearest
    group     index     of the walls that are joined: the first of them
    joined    m         depth of all of these as one
    partner   index     which of the walls touched before it is; -1: none
    normal    1      3  towards the side where the probe belongs
    N         1      4  weights of the corners
""")
# of the probes that a piece has searched
SEARCH_RANGE = Record("""
    first  index  of those that touch, or have touched
    count  count  of these
""")
TOUCHING_PROBE = Record("probe  index  that touches, or has touched")
# of a point that is touched
STIFFNESS_BOUND = Record("""
    stiffness    1/s^2  sum of k N / m
    damping      1/s    sum of c N / m
    listed       flag   whether the point is among those that are touched
    pressed      m/s^2  sum of normal force times N / m, where friction acts
    was_pressed  m/s^2  the same in the last step
""")
TOTALS_OF_STEP = Record("""
    count       count  points that are touched
    rate        1/s^2  largest bound of squared frequency of these
    damping     1/s    largest sum of c N / m
    shortened   1      largest factor by which contact has shortened the stable step
    first_point  index  first of the points whose speeds were read last
    point_count  count  number of these points
    speed       m/s    largest of their speeds
""")


class NodalBuilder:
    """The groups of all cards."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.groups: list[NodalGroup] = []

    def add(self, index: int, entry: Entry, a: Surface, b: Surface, routine: GapRoutines) -> None:
        """A group for two surfaces of a card. `routine(a, b, scene)` finds a gap routine."""
        self._refuse_implicit()
        law = self._law(entry)
        order = 1
        if a.shape == "faces" or (a.shape != "points" and b.shape == "points"):
            a, b, order = b, a, -1
        if a.shape not in PRESSING[b.shape == "faces"]:
            who = ("nodes and balls", "nodes, balls and ellipsoids")[b.shape == "faces"]
            message = f"'{a.entry.name}' cannot press on '{b.entry.name}': only {who} can"
            raise self.scene.fail(f"{message}; name a surface of type nodes", "b")
        probes = self._probes(a)
        values = {"card": index, "order": order, "speed_floor": speed_floor(entry.card, self.scene)}
        values["extent"] = self.scene.size
        pair = Touching(entry.name, a, b, self.scene)
        values |= law.build(entry.card.normal, self.scene, pair)
        friction = self._friction(entry)
        if friction is not None:
            values |= friction.build(entry.card.friction, self.scene)
        make = self._on_faces if b.shape == "faces" else self._on_shape
        narrow, own, probe_states = make(probes, a, b, routine)
        arrays = self._common(probes, values | own.pop("values"), probe_states, law, friction) | own
        word = f"nodal_{len(self.groups)}"
        is_smooth = getattr(b.entry.card, "normals", None) == "continuous"
        can_fail = b.shape == "faces" and self.scene.can_fail(b.entry.card.part)
        laws = cast(NormalLaw, law), cast(StepFriction | None, friction)
        gap = cast(StepGap | None, narrow)
        group = NodalGroup(word, entry.name, gap, *laws, arrays, is_smooth, can_fail)
        self.groups.append(group)

    def _refuse_implicit(self) -> None:
        method = self.scene.deck.control.integrator
        if method in IMPLICIT:
            message = (
                f"contact of shell nodes and faces needs explicit steps, and {method} has none"
            )
            advice = "name the node that is hit, and use a point_set; or integrator: rattle"
            raise self.scene.fail(f"{message}; {advice}", "a")

    def _law(self, entry: Entry) -> ModuleType:
        """Module of the normal law; laws that nodal contact does not support are refused."""
        if not hasattr(entry.card, "normal"):
            message = "holds nodes that are bodies; shell nodes and faces need a law of force"
            raise self.scene.fail(f"{message}: type: force, normal: {{type: penalty}}")
        return import_module(type(entry.card.normal).__module__)

    def _friction(self, entry: Entry) -> ModuleType | None:
        """Module of the friction law, if there is one."""
        card = entry.card.friction
        return None if card is None else import_module(type(card).__module__)

    def _probes(self, surface: Surface) -> Probes:
        card = surface.entry.card
        if surface.shape == "points":
            meshed, _, first = self.scene.skin(card.part, "part")
            rows = np.zeros(len(meshed.used), PROBE.dtype)
            rows["point"] = first + meshed.used
            return Probes(rows, card.radius, card.part, meshed, first)
        rows = np.zeros(len(surface.elements), PROBE.dtype)
        rows["point"] = -1
        for row, element in zip(rows, surface.elements, strict=True):
            row["node"], row["at"] = element["node"], element["point"]
        element = surface.elements[0]
        radius = element["radius"] if surface.shape == "sphere" else min(element["semi"])
        return Probes(rows, float(radius), None, None, 0)

    def _common(
        self,
        probes: Probes,
        values: Columns,
        probe_states: int,
        law: ModuleType,
        friction: ModuleType | None,
    ) -> dict[str, np.ndarray]:
        """Arrays of every group."""
        record, probe_state = PARAMETERS + law.PARAMETERS, PROBE_STATE + law.HISTORY
        n = len(probes.rows)
        if isfinite(values.get("thick", inf)):
            probe_state = probe_state + records.FACE
        rows = probe_states * n
        if probe_states == 2:
            # an empty record, and one for contacts that end
            probe_state, rows = probe_state + OTHER_WALLS, WALLS * rows + 1
        if friction is not None:
            record = record + friction.PARAMETERS
            probe_state = probe_state + FRICTION_STATE + friction.HISTORY
        p = np.zeros(1, record.dtype)
        for name, value in values.items():
            p[name] = value
        totals = np.zeros(1, TOTALS.dtype)
        totals["listed"] = -inf
        threads = self.scene.threads
        shared = {}
        if threads > 1:
            ends = len(probes.rows) * np.arange(PIECES * threads) // (PIECES * threads)
            shared = {
                "search_ranges": np.zeros(len(ends), SEARCH_RANGE.dtype),
                "touching_probes": np.zeros(n, TOUCHING_PROBE.dtype),
            }
            shared["search_ranges"]["first"] = ends
        return {
            "p": p,
            "totals": totals,
            "probes": probes.rows,
            "probe_states": np.zeros((2, rows), probe_state.dtype),
            "slot_in_use": np.zeros(probe_states * n, np.int64),
            "due": np.zeros(n),
            # threads search before the first one computes forces
            "hits": np.zeros((n if threads > 1 else 1, 2 * WALLS), HIT.dtype),
        } | shared

    def _on_shape(self, probes: Probes, a: Surface, b: Surface, routine: GapRoutines) -> Sided:
        """Points against a rigid shape: its own gap routine, with copies of its bodies."""
        substitute = SurfaceOfProbes("sphere", a.entry)
        narrow, swapped = routine(substitute, b, self.scene)
        if swapped or hasattr(narrow, "expand_a"):
            message = f"nodes of shells cannot press on a {b.entry.type}; give it another shape"
            raise self.scene.fail(message, "b")
        bodies = sorted({int(element["node"]) for element in b.elements})
        # a probe stands for a body; for each thread there is one
        first_body = self.scene.threads
        frames = np.zeros(first_body + len(bodies), NODE.dtype)
        frames["A"][:] = np.eye(3).ravel()
        frame_bodies = np.array([0] * first_body + bodies)
        expand = getattr(narrow, "expand_b", lambda elements: elements)
        elements = [part for e in b.elements for part in expand([e])]
        probe_element = {"node": 0, "point": (0.0, 0.0, 0.0), "radius": probes.radius}
        balls = [probe_element | {"node": k} for k in range(first_body)]
        data = getattr(narrow, "data", lambda *_: ())([probe_element], elements)
        shape = import_module(f"crashsolve.contact.shape.{b.shape}")
        record = getattr(narrow, "PARAMETERS_B", shape.PARAMETERS)
        own = {
            "a": table_of(balls, import_module("crashsolve.contact.shape.sphere").PARAMETERS),
            "b": table_of(elements, record),
            "frames": frames,
            "frame_bodies": frame_bodies,
            **{f"data_{k}": array for k, array in enumerate(data)},
        }
        own["b"]["node"] = [first_body + bodies.index(int(e["node"])) for e in elements]
        thick = min(
            (b.module.half_thickness(e) for e in b.elements if hasattr(b.module, "half_thickness")),
            default=inf,
        )
        values = {"gap": probes.radius, "share": 1.0, "thick": probes.radius + thick}
        values |= {"reach": REACH * thick, "first_point": probes.first_point, "is_self_contact": 1}
        count = len(probes.rows) if probes.meshed is None else len(probes.meshed.mass)
        values |= {"point_count": count, "extent": self.scene.size}
        return narrow, own | {"values": values}, 1

    def _on_faces(self, probes: Probes, a: Surface, b: Surface, routine: object) -> Sided:
        """Probes against the faces of a shell."""
        card = b.entry.card
        meshed, corner, first = self.scene.skin(card.part, "part")
        round_ones = self._ellipsoids(a, probes) if a.shape == "ellipsoid" else {}
        # of one part, or of parts that share a mesh
        is_own = probes.meshed is not None and probes.first_point == first
        if is_own and probes.radius == 0.0:
            t = card.thickness or meshed.card.thickness
            message = f"the nodes of '{probes.part}' have no thickness of their own, and its walls "
            message += "would meet half a thickness deep"
            raise self.scene.fail(f"{message}; set radius: {0.5 * t:g} in '{a.entry.name}'", "a")
        quads, count = meshed.mesh.quads, len(meshed.area)
        corners = meshed.mesh.points[quads]
        radius = np.linalg.norm(corners - corners.mean(axis=1)[:, None], axis=2).max(axis=1)
        gap = probes.radius + 0.5 * (card.thickness or meshed.card.thickness)
        around = faces_around(quads, len(meshed.mass))
        excluded = nothing(len(probes.rows))
        if is_own:
            self._refuse_too_thick(gap, meshed, card.part)
            assert probes.meshed is not None
            excluded = self._excluded_faces(meshed, probes.meshed.used, card.ring, FOLDED * gap)
        room = ROOM * len(probes.rows)
        buckets = 1 << int(2 * count - 1).bit_length()
        margin = MARGIN * float(radius.mean())
        values = {
            **{"gap": gap, "share": probes.radius / gap, "reach": REACH * gap, "margin": margin},
            **{"first_point": first, "point_count": len(meshed.mass), "is_self_contact": is_own},
            **{"first_corner": corner, "face_count": count, "first_own": first},
            **self._positions(card.part, meshed),
            **{"bucket_count": buckets, "room": room},
            "first_other_wall": 2 * len(probes.rows),
        }
        own = {
            "first": np.zeros(len(probes.rows) + 1, np.int64),
            "near": np.zeros(room, np.int64),
            "wait": np.zeros(room),
            "cells": np.zeros(count, CELL.dtype),
            "starts": np.zeros(buckets + 1, np.int64),
            "sorted": np.zeros(count, np.int64),
            "adjacent": adjacent_faces(quads),
            "deleted": np.zeros(count, np.int64),
            "initial": faces_at_start(corners[: count * (a.shape == "sphere")]),
            "around_first": around[0],
            "around": around[1],
            "excluded_first": excluded[0],
            "excluded": excluded[1],
            **round_ones,
        }
        if round_ones:
            values["over"] = max(a.elements[0]["semi"]) - probes.radius
        return None, own | {"values": values}, 2

    def _excluded_faces(
        self, meshed: DiscretisedShell, nodes: np.ndarray, ring: int, reach: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Faces of a part that some nodes of its mesh never meet, by these nodes."""
        others = [own.mesh.quads for own in self.scene.on_mesh_of(meshed) if own is not meshed]
        quads, points = np.concatenate([meshed.mesh.quads, *others]), meshed.mesh.points
        around = faces_around(quads, len(points))
        near = excluded_faces(quads, around, ring)
        excluded = merged(near, faces_within_reach(points, quads, around, reach))
        return excluded if not others else chosen(*excluded, nodes, len(meshed.mesh.quads))

    def _refuse_too_thick(self, gap: float, meshed: DiscretisedShell, part: str) -> None:
        """Refuse a surface that could touch itself only far from where a shell describes it."""
        width = float(np.sqrt(meshed.area.mean()))
        if gap <= THICKEST * width:
            return
        message = (
            f"the walls of '{part}' would touch each other {gap:.4g} m apart, {gap / width:.0f} "
            f"times as far as its elements are wide ({width:.4g} m): a shell cannot fold so tightly"
        )
        advice = f"take elements of {gap / THICKEST:.3g} m or wider, thinner walls, or no contact"
        raise self.scene.fail(f"{message}; {advice} of '{part}' with itself", "a")

    def _ellipsoids(self, a: Surface, probes: Probes) -> dict[str, np.ndarray]:
        """Ellipsoids, and the ball that rolls in each."""
        record = import_module("crashsolve.contact.shape.ellipsoid").PARAMETERS
        return {"ellipsoids": table_of(a.elements, record), "balls": probes.rows.copy()}

    def _positions(self, part: str, meshed: DiscretisedShell) -> dict[str, int]:
        """Positions of quadrilaterals and triangles in the tables."""
        filled, first = -(-meshed.quad_count // LANES), self.scene.first_number(part)
        stride = meshed.stride_of(meshed.points)
        return {
            **{"quads": meshed.quad_count, "empty": filled * LANES - meshed.quad_count},
            **{"first_number": first, "stride": stride},
            **{"first_third": first + filled * stride, "stride_third": meshed.stride_of(1)},
        }


def table_of(rows: list[Columns], record: Record) -> np.ndarray:
    table = np.zeros(len(rows), record.dtype)
    for row, values in zip(table, rows, strict=True):
        for column in record.columns:
            row[column.name] = values[column.name]
    return table


def loads_of_points(count: int) -> dict[str, np.ndarray]:
    """Stiffness that all groups together add to points."""
    return {
        "touched": np.zeros(1, TOTALS_OF_STEP.dtype),
        "stiffened": np.zeros(count, STIFFNESS_BOUND.dtype),
        "touched_points": np.zeros(count, np.int64),
    }


def make_room(groups: list[NodalGroup]) -> None:
    """Enlarge lists that are more than half full to twice their need. Writes: groups."""
    for group in groups:
        if group.narrow is not None:
            continue
        p, totals = group.arrays["p"], group.arrays["totals"]
        if 2 * totals["pairs"][0] > p["room"][0]:
            p["room"] = room = 4 * int(totals["pairs"][0])
            group.arrays |= {"near": np.zeros(room, np.int64), "wait": np.zeros(room)}
            totals["listed"] = -inf
            group.arrays["due"][:] = 0.0
            group.arrays["first"][:] = 0
