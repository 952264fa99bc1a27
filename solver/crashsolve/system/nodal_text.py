"""Composed text of nodal contact: the loop over the probes of one group, with its own laws."""

from typing import Any

FACES = """\
@kernel
def {word}(clock, h, nodes, curves, groups):
    p, tally, probes = groups.{word}_p[0], groups.{word}_tally[0], groups.{word}_probes
    slots, turns, found = groups.{word}_slots, groups.{word}_turns, groups.{word}_found
    points, corners, due = groups.points, groups.corners, groups.{word}_due
    card, counts = groups.cards[p.card], groups.card_history[1 - clock.current]
    lists = (groups.{word}_first, groups.{word}_near, groups.{word}_wait, due)
    grid = (groups.{word}_cells, groups.{word}_starts, groups.{word}_sorted)
    around = (groups.{word}_around_first, groups.{word}_around)
    mesh = (points, corners, groups.{word}_beside, around[0], around[1])
    spared = (groups.{word}_spared_first, groups.{word}_spared)
    faces.open_faces(h, p, tally, probes, nodes, points, corners, grid, lists, spared)
    for i in range(probes.shape[0]):
        if due[i] > tally.way:
            continue
        x, v = nodal.where(probes[i], h, nodes, points)
        faces.look(i, x, p, tally, slots, turns, mesh, lists, found)
{field}        for s in range(2):
            j = 2 * i + s
            hit, old, new = found[s], slots[turns[j], j], slots[1 - turns[j], j]
            if hit.depth <= 0.0:
                if old.active == 1:
                    nodal.leave(clock, h, tally, turns, j, old, new)
                    {law}.release(p, old, new)
                continue
            mob = nodal.mobility_of(probes[i], hit, nodes, points)
            mob_face = faces.face_mobility(p, hit, points, corners)
            mass = 1.0 / (mob + mob_face)
            u = faces.face_velocity(p, hit, h, points, corners)
            rate = nodal.closing(v, u, hit, h, old, nodal.of_point(probes[i], mob) + mob_face)
            contacts.latch(p, old, new, hit.depth, rate, counts)
            f, stored, power, loss, k, c = {law}.normal_force(
                p, old, new, h, hit.depth, rate, mass, curves
            )
            nodal.push_probe(probes[i], f, k, c, hit, nodes, groups)
            faces.push_face(p, hit, f, k, c, groups)
            nodal.note(clock, h, p, tally, card, f, stored, power, loss, old, new, hit)
            nodal.take_turn(h, turns, j)
    nodal.close_pass(tally, card)
"""
FIELD = "        normals.smoothen(i, x, p, mesh, spared, found)\n"
SHAPE = """\
@kernel
def {word}(clock, h, nodes, curves, groups):
    p, tally, probes = groups.{word}_p[0], groups.{word}_tally[0], groups.{word}_probes
    slots, turns, hit = groups.{word}_slots, groups.{word}_turns, groups.{word}_found[0]
    points, shapes, due = groups.points, groups.{word}_b, groups.{word}_due
    card, counts = groups.cards[p.card], groups.card_history[1 - clock.current]
    frames, home = groups.{word}_frames, groups.{word}_home
    nodal.open_shapes(h, p, tally, probes, nodes, points, frames, home)
    for i in range(probes.shape[0]):
        if due[i] > tally.way:
            continue
        x, v = nodal.where(probes[i], h, nodes, points)
        nodal.pose(frames, x, hit)
        for e in range(shapes.shape[0]):
            depth, n, _ = {narrow}.gap(groups.{word}_a[0], shapes[e], frames, {data})
            nodal.deeper(hit, e, depth, n)
        now = nodal.settle(turns, i)
        old, new = slots[now, i], slots[1 - now, i]
        nodal.wait_for(i, hit, tally, due)
        if hit.depth <= 0.0:
            if old.active == 1:
                nodal.leave(clock, h, tally, turns, i, old, new)
                {law}.release(p, old, new)
            continue
        body = nodes[home[shapes[hit.face].node]]
        mob, own = nodal.body_mobility(body, x, hit), points[probes[i].point].mass_inv
        mass = 1.0 / (mob + own)
        rate = nodal.closing(v, nodal.body_velocity(body, x), hit, h, old, own)
        contacts.latch(p, old, new, hit.depth, rate, counts)
        f, stored, power, loss, k, c = {law}.normal_force(
            p, old, new, h, hit.depth, rate, mass, curves
        )
        nodal.push_probe(probes[i], f, k, c, hit, nodes, groups)
        nodal.push_body(body, x, f, k, c, hit, mob)
        nodal.note(clock, h, p, tally, card, f, stored, power, loss, old, new, hit)
        nodal.take_turn(h, turns, i)
    nodal.close_pass(tally, card)
"""


def nodal_function(group: Any) -> str:
    """Text of the function of one group."""
    words = {"word": group.word, "law": f"normal_{group.normal.__name__.rpartition('.')[2]}"}
    if group.narrow is None:
        return FACES.format(**words, field=FIELD if group.is_smooth else "")
    names = [f"groups.{group.word}_{name}" for name in group.arrays if name.startswith("data_")]
    data = "(" + "".join(f"{name}, " for name in names).rstrip(" ") + ")"
    narrow = f"narrow_{group.narrow.__name__.rpartition('.')[2]}"
    return SHAPE.format(**words, narrow=narrow, data=data)
