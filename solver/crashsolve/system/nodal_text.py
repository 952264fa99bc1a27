"""Composed text of nodal contact: the loop over the probes of one group, with its own laws."""

from typing import Any

FACES = """\
@kernel
def {word}(clock, h, nodes, curves, groups):
    p, tally, probes = groups.{word}_p[0], groups.{word}_tally[0], groups.{word}_probes
    slots, turns, found = groups.{word}_slots, groups.{word}_turns, groups.{word}_found
    points, corners, due = groups.points, groups.corners, groups.{word}_due
    card, counts = groups.cards[p.card], groups.card_history[1 - clock.current]
    count = counts[p.card]
    lists = (groups.{word}_first, groups.{word}_near, groups.{word}_wait, due)
    grid = (groups.{word}_cells, groups.{word}_starts, groups.{word}_sorted)
    around = (groups.{word}_around_first, groups.{word}_around)
    gone = groups.{word}_gone
    mesh = (points, corners, groups.{word}_beside, around[0], around[1], gone)
    spared = (groups.{word}_spared_first, groups.{word}_spared)
    faces.open_faces(h, p, tally, probes, nodes, groups, grid, lists, spared)
{bury}    for i in range(probes.shape[0]):
        if due[i] > tally.way:
            continue
{look}        for s in range(2):
            j = 2 * i + s
            hit, old, new = found[s], slots[turns[j], j], slots[1 - turns[j], j]
            past = (0.0, 0.0, 0.0)
            if old.active == 1:
                past = work.way_over_face(p, {probe}, old, True, h, nodes, points, corners)
                work.push_along(old, past, count)
            if hit.depth <= 0.0:
                if old.active == 1:
{lose}                    faces.note_lost(clock, h, p, tally, old, mesh)
                    nodal.leave(clock, h, tally, turns, j, old, new)
                    {law}.release(p, old, new)
{end}                continue
{roll}            mob = nodal.mobility_of({probe}, hit, nodes, points)
            mob_face, w = faces.face_mobility(p, hit, points, corners)
            w += nodal.probe_foretells({probe}, hit, points)
            mass = 1.0 / max(mob + mob_face, nodal.STUCK)
            u = faces.face_velocity(p, hit, h, points, corners)
            rate = nodal.closing(v, u, hit, h, old, w)
            contacts.latch(p, old, new, hit.depth, rate, counts)
            f, stored, power, loss, k, c = {law}.normal_force(
                p, old, new, h, hit.depth, rate, mass, curves
            )
            way = work.way_over_face(p, {probe}, hit, False, h, nodes, points, corners)
{jump}{rub}            nodal.push_probe({probe}, f, k, c, hit, nodes, groups)
            faces.push_face(p, hit, f, k, c, groups)
            nodal.note(clock, h, p, tally, card, f, stored, power, loss, old, new, hit)
            work.push_along(new, way, count)
            nodal.take_turn(h, turns, j)
    nodal.close_pass(tally, card, count)
"""
PROBE = """\
        x, v = nodal.where(probes[i], h, nodes, points)
        faces.look(i, x, p, tally, slots, turns, mesh, lists, found)
"""
ELLIPSOID = """\
        ellipsoid, ball = groups.{word}_ellipsoids[i], groups.{word}_balls[i]
        ellipsoids.look(i, p, tally, ellipsoid, nodes, slots, turns, mesh, lists, found)
"""
ROLL = "            v = ellipsoids.roll(ball, p, hit, nodes, points, corners)\n"
PEN = "        x, pen = ellipsoids.pen_of(ellipsoid, nodes)\n"
FIELD = "        normals.smoothen(i, x, {pen}, p, mesh, spared, found)\n"
# of parts that may fail
BURY = "    faces.bury(p, groups.lanes, gone)\n"
LOSE = "                    faces.let_go(h, tally, old, 0.0, gone)\n"
JUMP = "            faces.let_go(h, tally, old, stored, gone)\n"
FAILING = (("", "", ""), (BURY, LOSE, JUMP))
SHAPE = """\
@kernel
def {word}(clock, h, nodes, curves, groups):
    p, tally, probes = groups.{word}_p[0], groups.{word}_tally[0], groups.{word}_probes
    slots, turns, hit = groups.{word}_slots, groups.{word}_turns, groups.{word}_found[0]
    points, shapes, due = groups.points, groups.{word}_b, groups.{word}_due
    card, counts = groups.cards[p.card], groups.card_history[1 - clock.current]
    count = counts[p.card]
    frames, home = groups.{word}_frames, groups.{word}_home
    nodal.open_shapes(h, p, tally, probes, nodes, groups, frames, home)
    for i in range(probes.shape[0]):
        if due[i] > tally.way:
            continue
        x, v = nodal.where(probes[i], h, nodes, points)
        nodal.pose(frames, x, hit)
        now = nodal.settle(turns, i)
        old, new = slots[now, i], slots[1 - now, i]
{own}        for e in range(shapes.shape[0]):
            depth, n, _ = {narrow}.gap(groups.{word}_a[0], shapes[e], frames, {data})
{keep}            nodal.deeper(hit, e, depth, n)
        nodal.wait_for(i, hit, tally, due)
        past = (0.0, 0.0, 0.0)
        if old.active == 1:
            home_before = nodes[home[shapes[old.face].node]]
            past = work.way_over_body(p, probes[i], old, True, x, home_before, h, nodes, points)
            work.push_along(old, past, count)
        if hit.depth <= 0.0:
            if old.active == 1:
                nodal.leave(clock, h, tally, turns, i, old, new)
                {law}.release(p, old, new)
{left}{end}            continue
        body = nodes[home[shapes[hit.face].node]]
        mob = nodal.body_mobility(body, x, hit)
        mass = 1.0 / max(mob + nodal.mobility_of(probes[i], hit, nodes, points), nodal.STUCK)
        w = nodal.probe_foretells(probes[i], hit, points)
        rate = nodal.closing(v, nodal.body_velocity(body, x), hit, h, old, w)
        contacts.latch(p, old, new, hit.depth, rate, counts)
{way}        f, stored, power, loss, k, c = {law}.normal_force(
            p, old, new, h, hit.depth, rate, mass, curves
        )
        way = work.way_over_body(p, probes[i], hit, False, x, body, h, nodes, points)
{rub}        nodal.push_probe(probes[i], f, k, c, hit, nodes, groups)
        nodal.push_body(body, x, f, k, c, hit, mob)
        nodal.note(clock, h, p, tally, card, f, stored, power, loss, old, new, hit)
        work.push_along(new, way, count)
        nodal.take_turn(h, turns, i)
    nodal.close_pass(tally, card, count)
"""


# of shapes whose faces are kept, and of others with a middle that may be passed
NOTE_FACE = "passing.note_probe(clock, h, p, old, new, hit, held, over)\n"
NOTE_WAY = "passing.note_round_probe(clock, h, p, old, new, hit)\n"
OWN = "        held, over = False, -1.0\n"
KEEP = """\
            if old.face == e and passing.is_another_face(old, depth, n, p.gap):
                u = nodal.body_velocity(nodes[home[shapes[e].node]], x)
                kept = {narrow}.gap_by(groups.{word}_a[0], shapes[e], frames, {data}, old.normal)
                if passing.keeps_face(old, v, u, n, kept):
                    held = True
                    depth, n, _, over = kept
"""
MIDDLE = """\
            if old.face == e and depth > p.gap:
                past = depth - {narrow}.middle(groups.{word}_a[0], shapes[e], frames, n)
                over = max(over, past)
"""
ON_FACES = """\
            d, e = work.arms(p, hit)
            a = rubbing.probe_foretells({probe}, d, old, points)
            v_a = rubbing.probe_velocity({probe}, v, d, h, nodes, points)
            a = rubbing.face_foretells(p, hit, e, old, a, points, corners)
            v_b = rubbing.face_velocity(p, hit, e, h, points, corners)
"""
ON_SHAPE = """\
            d, y = rubbing.on_shape(p, hit, x)
            a = rubbing.probe_foretells({probe}, d, old, points)
            v_a = rubbing.probe_velocity({probe}, v, d, h, nodes, points)
            v_b = nodal.body_velocity(body, y)
"""
RUB = """\
            slip, n = rubbing.slipping(v_a, v_b, hit, h, a)
{ease}            t, t_stored, _, t_loss, t_k, t_c = {friction}.friction_force(
                p, old, new, f, slip, work.along_plane(way, n), n, mass, ease, curves
            )
            ahead = contacts.along(t, slip, n)
            rubbing.rub_probe({probe}, t, ahead, d, t_k, t_c, nodes, groups)
            {other}
            rubbing.note(h, p, tally, card, t, t_stored, t_loss, new)
            if old.active == 1:
                work.rub_along(old, past, count)
            work.rub_along(new, way, count)
"""
END = """\
                    rubbing.leave(h, tally, past, old, new, count)
                    {friction}.release(p, old, new)
"""
OTHER = (
    "rubbing.rub_face(p, hit, t, e, t_k, t_c, groups)",
    "rubbing.rub_body(body, y, t, ahead, t_k, t_c)",
)

# of laws that are dampers near rest, on faces and on shapes
EASE = (
    "rubbing.ease_on_face(clock, h, p, {probe}, hit, d, e, ahead, f, nodes, groups)",
    "rubbing.ease_on_shape(clock, h, {probe}, body, d, y, ahead, f, nodes, groups)",
)
DAMPED = """\
            ahead = contacts.ahead(old, slip, n)
            ease = {ease}
"""


def nodal_function(group: Any) -> str:
    """Text of the function of one group."""
    is_shape = group.narrow is not None
    probe = "ball" if group.is_round else "probes[i]"
    words = {"word": group.word, "law": f"normal_{_leaf(group.normal)}", "rub": "", "end": ""}
    if group.friction is not None:
        friction = f"friction_{_leaf(group.friction)}"
        rub = (ON_SHAPE if is_shape else ON_FACES) + RUB
        ease = "            ease = 0.0\n"
        if is_damper(group.friction):
            ease = DAMPED.format(ease=EASE[is_shape].format(probe=probe))
        rub = rub.format(friction=friction, other=OTHER[is_shape], probe=probe, ease=ease)
        deep = 4 * is_shape
        end = END.format(friction=friction)
        words |= {"rub": _outdented(rub, deep), "end": _outdented(end, deep)}
    if not is_shape:
        look = ELLIPSOID.format(**words) if group.is_round else PROBE
        if group.is_smooth:
            look += PEN * group.is_round + FIELD.format(pen="pen" if group.is_round else "None")
        words |= {"look": look, "roll": ROLL * group.is_round, "probe": probe}
        words |= dict(zip(("bury", "lose", "jump"), FAILING[group.can_fail], strict=True))
        return FACES.format(**words)
    names = [f"groups.{group.word}_{name}" for name in group.arrays if name.startswith("data_")]
    data = "(" + "".join(f"{name}, " for name in names).rstrip(" ") + ")"
    words |= {"narrow": f"narrow_{_leaf(group.narrow)}", "data": data}
    return SHAPE.format(**words, **_ways(group, words))


def _ways(group: Any, words: dict[str, str]) -> dict[str, str]:
    """Text by which probes keep the face of a shape, and notice that they pass its middle."""
    keeps = group.has_ends and hasattr(group.narrow, "gap_by")
    note = NOTE_FACE if keeps else NOTE_WAY
    found = {"left": " " * 16 + note, "way": " " * 8 + note}
    found = found if group.has_ends else dict.fromkeys(found, "")
    keep = KEEP + MIDDLE * hasattr(group.narrow, "middle")
    return found | {"own": OWN * keeps, "keep": keep.format(**words) * keeps}


def is_damper(friction: Any) -> bool:
    """Whether friction depends on the sliding speed alone, so that a step can reverse it."""
    return friction is not None and not getattr(friction, "STEPWISE", False)


def _leaf(module: Any) -> str:
    return str(module.__name__.rpartition(".")[2])


def _outdented(text: str, spaces: int) -> str:
    """Lines so many spaces farther to the left."""
    return "".join(line[spaces:] for line in text.splitlines(keepends=True))
