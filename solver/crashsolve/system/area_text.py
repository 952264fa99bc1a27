"""Text of the loop over contact pairs where a force has shares, an area, or friction of a spin.

Which of them a group of pairs has is said by its columns and its gap routine: `share` of elements
on side a, `torsion_radius` of pairs, and `patch` beside `gap`. See system/areas.py.
"""

from typing import Any

SCALED = ("f", "out.stored", "power", "loss", "k", "c")


def imports(groups: list[Any]) -> list[str]:
    """Imports of the composed module for these groups."""
    if not any(c.is_flat or c.resists_spin for c in groups):
        return []
    return ["from crashsolve.system import areas"]


def share_calls(c: Any) -> list[str]:
    """The share of an element in what its law has returned."""
    scaled = ", ".join(f"a.share * {name}" for name in SCALED)
    return [f"{', '.join(SCALED)} = {scaled}"] * c.has_shares


def radius_calls(c: Any, narrow: str, data: str) -> list[str]:
    """Radius with which friction resists a spin; of an area, its points as well."""
    lines = [f"count, radius = {narrow}.patch(a, b, nodes, {data}, n, x)"] * c.is_flat
    if c.has_radius:
        lines.append(f"radius = {'max(radius, p.torsion_radius)' if lines else 'p.torsion_radius'}")
    return lines


def gap_calls(c: Any, narrow: str, data: str) -> list[str]:
    """The gap of a pair; where another of its card is deeper anyway, what it does not exceed."""
    call = f"depth, n, x = {narrow}.gap(a, b, nodes, {data})"
    if not hasattr(c.narrow, "bound"):
        return [call]
    return [
        f"depth, n, x = {narrow}.bound(a, b, nodes, {data}), areas.NO_TURN, areas.NO_TURN",
        "if depth > min(0.0, groups.cards[p.card].depth):",
        f"    {call}",
    ]


def end_calls(c: Any, felt: str) -> list[str]:
    """What is left to give to the two bodies: all of a point, of an area friction alone."""
    lines = [] if c.is_flat else [f"felt = contacts.{felt}"]
    lines.append(
        f"contacts.touch(m, w, d_a, d_b, felt, {'0.0' if c.is_flat else 'f'}, t, n, x, out)"
    )
    lines += ["areas.add_pressure(f, n, out)"] * c.is_flat
    lines += ["areas.twist(m, w, rub, n, radius, felt)"] * c.resists_spin
    lines += ["contacts.count_stiffness(m, w, mob_a, mob_b, k, c)"] * (not c.is_flat)
    return lines


def press_calls(c: Any, normal: str, felt: str) -> list[str]:
    """The normal force: in one point, or in those of an area with the closing speed of each."""
    force = [
        f"f, out.stored, power, loss, k, c = {normal}.normal_force(",
        "    p, old, new, h, depth, rate, mass, curves",
        ")",
    ]
    if not c.is_flat:
        return [*force, *share_calls(c)]
    return [
        f"felt = contacts.{felt}",
        *force,
        f"_, c_now = {normal}.normal_tangent(p, new, depth, rate, mass, curves)",
        f"spots = groups.{c.word}_data_0",
        "f, more, x = areas.press(m, w, spots, count, n, x, felt, f, rate, c_now, k, c)",
        "power += more",
        "_, slip, d_a, d_b = contacts.closing(m, w, x, n)",
    ]


def rub_calls(friction: str, is_whole: bool, is_eased: bool) -> list[str]:
    """Friction of the slip and of the spin together.

    `is_whole`: its work is that of whole steps; `is_eased`: it stops a slip and sets no step.
    """
    mobilities = "mob_t, mob_u = areas.rubbing_mobility(m, w, d_a, d_b, u, n, radius)"
    lines = ["slip = areas.sliding(m, w, slip, n, radius)", "glide, ease = None, 0.0"]
    if is_whole:
        lines[1] = "glide, ease = areas.way_of_sliding(motion, way, n, radius), 0.0"
    if is_eased:
        lines += ["u = contacts.ahead(old, slip, n)", mobilities]
        lines.append("ease = contacts.ease_of_pair(clock, h, m, w, mob_t, mob_u, f)")
    lines += [
        f"rub, out.friction_stored, t_power, t_loss, t_k, t_c = {friction}.friction_force(",
        "    p, old, new, f, slip, glide, areas.NO_TURN, mass, ease, curves",
        ")",
        "t = areas.along_surface(rub, n)",
    ]
    if not is_eased:
        lines += ["u = contacts.along(rub, slip, n)", mobilities]
        lines.append("contacts.count_stiffness(m, w, mob_t, mob_u, t_k, t_c)")
    return lines


def first_half_calls(c: Any) -> list[str]:
    """Motion over the step, and what the forces at its start do in it."""
    motion, given = "motion = work.motion_over(h, old, depth, m, w, b.node)", "h, old, motion, m"
    if not c.friction:
        return [motion, f"work.end_push({given}, counts[p.card])"]
    home = "areas" if c.resists_spin else "work"
    return [motion, f"rubbed = {home}.end_first_half({given}, counts[p.card])"]


def work_calls(c: Any) -> list[str]:
    """What the forces at the end of a step do in it, kept for the next."""
    if not c.resists_spin:
        if not c.friction:
            return ["work.begin_push(felt, way, f, n, x, out, new, card_new)"]
        return ["work.begin_second_half(felt, way, f, t, n, x, out, new, card_new)"]
    given = "felt, way, glide, f, rub, n, x, radius, out, new, card_new"
    return [f"areas.begin_second_half({given})"]


def tilt_calls(c: Any) -> list[str]:
    """What tilting of one side on the other changes, in the two rows after that of the force."""
    call = f"groups.{c.word}_data_0, count, n, x, f, c, a.edge + b.edge"
    return [f"areas.tilt_tangents(compliant[at + 1], compliant[at + 2], {call})"] * c.is_flat


def rub_tangent_calls(c: Any, friction: str) -> list[str]:
    """Rows of friction that resists a spin: along the sliding, and two across it."""
    first = 3 if c.is_flat else 1
    lines = [
        "slip = areas.sliding(m, w, slip, n, radius)",
        f"c, c_across = {friction}.friction_tangent(p, f, slip)",
        "u = contacts.along((0.0, 0.0, 0.0), slip, n)",
        "u_1, u_2 = areas.tangents(u)",
    ]
    for k, (u, damping) in enumerate((("u", "c"), ("u_1", "c_across"), ("u_2", "c_across"))):
        row = f"compliant[at + {first + k}]"
        lines.append(f"areas.rub_tangent({row}, {u}, n, radius, d_a, d_b, {damping})")
    return lines
