"""A structure written out in ordinary cards: bodies at its points, and the cards of each member.

The file of a description has `stub`, the length of a member that belongs to the body at its end,
beside the rigid joint, `cards` of a member, whose names begin with that of the member, and WORDS,
those of the structure's card that it follows and others may not.
"""

from collections.abc import Iterable, Iterator
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from crashsolve.deck.expansion import Fields, Law, Made, Steps
from crashsolve.parts.structures.plan import Member, Plan, plan

DESCRIPTIONS = ("rigid", "hinges", "segments", "beams", "shells")
# methods in whose steps nodes of beams may be part of a rigid body
EXPLICIT = ("default", "rattle", "dormand_prince_5", "dormand_prince_8")


def expand(name: str, card: object, laws: dict[str, dict[str, Law]], control: Fields) -> list[Made]:
    """The cards of a structure.

    `laws` are sections and materials of the deck, `control` the words of its control. Raises
    Problem.
    """
    whole = plan(name, card, laws)
    is_explicit = control.get("solution") != "quasi_static"
    is_explicit &= control.get("integrator", "default") in EXPLICIT
    cards = list(_members(whole))
    bodies = [_body(whole, k, point) for k, point in enumerate(whole.points)]
    if is_explicit:
        cards = _part_of_bodies(cards, bodies)
    mounts = list(_mounts(whole, bodies, is_explicit))
    return bodies + cards + mounts + list(_clusters(whole))


def _members(whole: Plan) -> Iterator[Made]:
    """Cards of all members; a card that several need once."""
    cards = set()
    for member in whole.members:
        for card in description(member).cards(member, whole):
            if (card.keyword, card.name) not in cards:
                yield card
            cards.add((card.keyword, card.name))


def description(member: Member) -> ModuleType:
    """The module of how a member deforms."""
    return _description(member.deformation)


def _description(word: str) -> ModuleType:
    return import_module(f"{__package__}.{word}")


def unused(card: Any) -> dict[Steps, str]:
    """Paths of a structure's card that none of its members follows, and why."""
    chosen = [member.deformation or card.deformation for member in card.members]
    reason = f"its members are {' and '.join(dict.fromkeys(chosen))}"
    followed = {word for name in chosen for word in _description(name).WORDS}
    words = {word for name in DESCRIPTIONS for word in _description(name).WORDS}
    reasons: dict[Steps, str] = {(word,): reason for word in sorted(words - followed)}
    for word in ("deformation", "divisions", "material", "section", "side"):
        if all(getattr(member, word) is not None for member in card.members):
            reasons.setdefault((word,), "all members have their own")
    for k, name in enumerate(chosen):
        if "divisions" not in _description(name).WORDS:
            reasons["members", k, "divisions"] = f"the member is {name}"
    return reasons


def _body(whole: Plan, k: int, point: str) -> Made:
    """The rigid body at a point: its joint, and the mass that members add to it."""
    rods, drawn, position = [], [], whole.points[point]
    for member in (m for m in whole.members if point in m.ends):
        stub = description(member).stub(member)
        first = member.ends[0] == point
        start, end = (-member.joints[0], stub) if first else (-stub, member.joints[1])
        shift = 0.0 if first else member.length
        rods.append(member.rod(start + shift, end + shift))
        begin, finish = (member.at(x + shift) - position for x in (start, end))
        drawn.append(length_of(member, begin, finish, member.T[:, 1]))
    mass, centre, J = together(rods)
    fields = body_fields(whole, mass, J, position)
    fields["mass_centre"] = plain(centre - position)
    fields["drawn"] = drawn
    return Made("bodies", whole.body(point), fields, ("points", k))


def together(
    rods: list[tuple[float, np.ndarray, np.ndarray]],
) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass [kg], mass centre (3,) [m] and inertia about it (3, 3) [kg m^2] of several."""
    mass = sum(m for m, _, _ in rods)
    centre = sum((m * x for m, x, _ in rods), np.zeros(3)) / mass
    J = np.zeros((3, 3))
    for m, x, own in rods:
        s = x - centre
        J += own + m * (s @ s * np.eye(3) - np.outer(s, s))
    return mass, centre, J


def body_fields(whole: Plan, mass: float, J: np.ndarray, position: np.ndarray) -> Fields:
    """Words of a rigid body with this inertia in its own axes, those of the world if it is given
    no rotation, that moves with the structure."""
    return {
        "mass": float(mass),
        "inertia": plain(np.diag(J)),
        "products": plain([J[0, 1], J[0, 2], J[1, 2]]),
        "position": plain(position),
        "velocity": whole.velocity(position),
        "angular_velocity": plain(whole.card.angular_velocity),
    }


def bar(whole: Plan, member: Member, name: str, start: float, end: float) -> Made:
    """A length of a member as a rigid body; its axes are those of the member."""
    mass, centre, J = member.rod(start, end)
    fields = body_fields(whole, mass, member.T.T @ J @ member.T, centre)
    fields["rotation"] = {"quaternion": member.quaternion}
    half = np.array([0.5 * (end - start), 0.0, 0.0])
    fields["drawn"] = [length_of(member, -half, half, np.array([0.0, 1.0, 0.0]))]
    return Made("bodies", name, fields, member.path)


def length_of(member: Member, start: np.ndarray, end: np.ndarray, side: np.ndarray) -> Fields:
    """A length of a member, as its body is drawn; positions (3,) [m] in the frame of the body."""
    words = {"from": plain(start), "to": plain(end), "side": plain(side)}
    return words | {"section": member.section.name}


def welds(whole: Plan, member: Member) -> list[Made]:
    """Joints that fix both ends of a part of beams to the bodies at its points."""
    return [
        weld(f"{member.name}_{side}", whole.body(point), f"{member.name}_{side}", position, member)
        for side, point, position in zip(
            ("start", "end"), member.ends, (member.at(0.0), member.at(member.length)), strict=True
        )
    ]


def weld(name: str, a: str, b: str, position: np.ndarray, member: Member) -> Made:
    """A joint that fixes b to a."""
    fields = {"type": "weld", "a": a, "b": b, "at": plain(position)}
    return Made("joints", name, fields, member.path)


def _part_of_bodies(cards: list[Made], bodies: list[Made]) -> list[Made]:
    """Ends of beams are part of the bodies in place of being welded to them. Writes: bodies."""
    by_name = {body.name: body for body in bodies}
    for card in cards:
        if card.keyword == "joints":
            by_name[card.fields["a"]].fields.setdefault("welded", []).append(card.fields["b"])
    return [card for card in cards if card.keyword != "joints"]


def _mounts(whole: Plan, bodies: list[Made], is_explicit: bool) -> Iterator[Made]:
    """Welds of points to the bodies that they belong to, where they are not part of these.

    Writes: bodies.
    """
    for k, (point, body) in enumerate(zip(whole.card.points, bodies, strict=True)):
        if point.part_of is None:
            continue
        members = [member for member in whole.members if point.name in member.ends]
        if is_explicit and all(member.deformation == "beams" for member in members):
            body.fields["part_of"] = point.part_of
        else:
            fields = {"type": "weld", "a": point.part_of, "b": body.name, "at": plain(point.at)}
            yield Made("joints", f"{body.name}_mount", fields, ("points", k))


def _clusters(whole: Plan) -> Iterator[Made]:
    """Welds of points that rigid members join, each to the first of its cluster."""
    group = {point: point for point in whole.points}
    order = list(whole.points)
    for member in (m for m in whole.members if m.deformation == "rigid"):
        one, other = sorted((group[end] for end in member.ends), key=order.index)
        for point, first in group.items():
            if first == other:
                group[point] = one
    for k, (point, first) in enumerate(group.items()):
        if point != first:
            fields = {
                "type": "weld",
                "a": whole.body(first),
                "b": whole.body(point),
                "at": plain(whole.points[point]),
            }
            yield Made("joints", whole.body(point), fields, ("points", k))


def plain(values: Iterable[float]) -> list[float]:
    """Numbers as a deck has them."""
    return [float(x) for x in values]
