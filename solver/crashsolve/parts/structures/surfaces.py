"""Surfaces of a structure, for all its members, where a contact names the structure.

    rigid, hinges, segments   the outline of the section over each rigid length: a cylinder if it is
                              round, else a box
    beams                     the same about each node, half an element to either side
    shells                    nodes, half a thickness from the middle of the walls; faces where the
                              others are balls, which would pass between nodes
    joints at points          outlines, in every description

Consequence to test: a bar that strikes between points is stopped in every description.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from crashsolve.deck.expansion import Fields, Law, Made, Steps
from crashsolve.foundation.orientation import quaternion_of
from crashsolve.parts.structures.cards import expand, plain
from crashsolve.parts.structures.plan import Member, Plan, outline_of, plan


class Length(NamedTuple):
    """A length of a member on a body or node; positions (3,) [m] and y axis in its frame."""

    name: str
    body: str
    member: Member
    start: np.ndarray
    end: np.ndarray
    side: np.ndarray
    path: Steps


def surfaces(
    name: str, card: object, laws: dict[str, dict[str, Law]], control: Fields, faces_balls: bool
) -> list[Made]:
    """The surfaces of all members, with balls on the other side of the contact or not.

    Raises Problem.
    """
    whole = plan(name, card, laws)
    cards = expand(name, card, laws, control)
    rigid = [_outline(length) for length in (*_of_bodies(whole, cards), *_of_beams(whole))]
    tubes = [member for member in whole.members if member.deformation == "shells"]
    return rigid + [_walls(member, faces_balls) for member in tubes]


def _of_bodies(whole: Plan, cards: list[Made]) -> Iterator[Length]:
    """The lengths that rigid bodies are drawn by."""
    with_section = {member.section.name: member for member in whole.members}
    for card in cards:
        for k, bar in enumerate(card.fields.get("drawn", []), 1):
            start, end, side = (np.asarray(bar[word]) for word in ("from", "to", "side"))
            member, name = with_section[bar["section"]], f"{card.name}_outline_{k}"
            yield Length(name, card.name, member, start, end, side, card.path)


def _of_beams(whole: Plan) -> Iterator[Length]:
    """An element about each node of beams; the halves at the ends are on the bodies at points."""
    for member in (m for m in whole.members if m.deformation == "beams"):
        name, path, L = member.name, member.path, member.length
        half, side = 0.5 * L / member.divisions, np.array([0.0, 1.0, 0.0])
        for k in range(1, member.divisions):
            reach = np.array([half, 0.0, 0.0])
            node = f"{name}_{k}"
            yield Length(f"{node}_outline", node, member, -reach, reach, side, path)
        for end, point, x in zip(("start", "end"), member.ends, (0.0, L - half), strict=True):
            first, last = (member.at(s) - whole.points[point] for s in (x, x + half))
            word, body, side = f"{name}_{end}_outline", whole.body(point), member.T[:, 1]
            yield Length(word, body, member, first, last, side, path)


def _outline(length: Length) -> Made:
    """A cylinder where the section is round, else a box around it."""
    reach = float(np.linalg.norm(length.end - length.start))
    along = (length.end - length.start) / reach
    fields: Fields = {"body": length.body, "at": plain(0.5 * (length.start + length.end))}
    section = length.member.section.card
    if hasattr(section, "radius"):
        fields |= {"type": "cylinder", "axis": plain(along), "length": reach}
        fields["radius"] = section.radius
    else:
        axes = np.column_stack([along, length.side, np.cross(along, length.side)])
        lacks = "has no shape that could touch"
        across = np.ptp(outline_of(length.member, lacks, "take one with a shape"), axis=0)
        fields |= {"type": "box", "size": [reach, *plain(across)]}
        fields["rotation"] = {"quaternion": plain(quaternion_of(axes))}
    return Made("surfaces", length.name, fields, length.path)


def _walls(member: Member, faces_balls: bool) -> Made:
    """Nodes of a tube of shells, or its faces."""
    if faces_balls:
        fields: Fields = {"type": "faces", "part": member.name}
        return Made("surfaces", f"{member.name}_outline_faces", fields, member.path)
    fields = {"type": "nodes", "part": member.name, "radius": 0.5 * member.section.card.thickness}
    return Made("surfaces", f"{member.name}_outline_nodes", fields, member.path)
