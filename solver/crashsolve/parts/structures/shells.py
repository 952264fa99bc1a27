"""Shells: a tube of shells for each thin-walled member, whose ends are part of rigid joints.

The middle of the walls is meshed. Sections keep their shape at the joints, and walls that meet
there do not bend: the joint is as stiff as a box with bulkheads. A round tube has flat facets; its
mass is less than the circle's by the share (pi / n)^2 / 6, n around.
"""

import numpy as np

from crashsolve.deck.expansion import Fields, Made, Problem
from crashsolve.parts.structures.cards import plain
from crashsolve.parts.structures.plan import Member, Plan

# of the card of the structure
WORDS = ("across", "damping", "self_contact")


def stub(member: Member) -> float:
    """Length of a member, besides the joint, that belongs to the body at its end [m]."""
    return 0.0


def cards(member: Member, whole: Plan) -> list[Made]:
    """The part NAME. Raises Problem for a section that is no closed thin wall."""
    start = member.at(0.0)
    fields = {
        "type": "shell",
        "mesh": mesh(member, whole),
        "thickness": member.section.card.thickness,
        "material": member.material.name,
        "damping": whole.card.damping,
        "welded": [
            {"nodes": nodes, "to": whole.body(point)}
            for nodes, point in zip(("v0", "v1"), member.ends, strict=True)
        ],
        "velocity": whole.velocity(start + outward(member)),
        "angular_velocity": plain(whole.card.angular_velocity),
    }
    part = Made("parts", member.name, fields, member.path)
    return [part, *_own_contact(member)] if whole.card.self_contact else [part]


def _own_contact(member: Member) -> list[Made]:
    """Contact of the walls of a member with each other, half a thickness before their middles meet.

    Those of two members begin in touch at their joint, and do not see each other.
    """
    name, thickness = member.name, member.section.card.thickness
    nodes = {"type": "nodes", "part": name, "radius": 0.5 * thickness}
    fields_of = {
        ("surfaces", f"{name}_nodes"): nodes,
        ("surfaces", f"{name}_walls"): {"type": "faces", "part": name},
        ("contacts", f"{name}_folds"): {
            "a": [f"{name}_nodes"],
            "b": [f"{name}_walls"],
            "normal": {"type": "penalty"},
        },
    }
    return [Made(*key, fields, member.path) for key, fields in fields_of.items()]


def mesh(member: Member, whole: Plan) -> Fields:
    """The middle surface of the walls, in squares along the member."""
    section, across = member.section, whole.card.across
    common = {"at": plain(member.at(0.0)), "axis": plain(member.along), "length": member.length}
    if section.type == "rectangular_tube":
        t = section.card.thickness
        width, height = section.card.width - t, section.card.height - t
        size = min(width, height) / across
        along = max(1, round(member.length / size))
        return common | {
            "type": "tube",
            "side": plain(member.T[:, 1]),
            "width": width,
            "height": height,
            "elements": [max(1, round(width / size)), max(1, round(height / size)), along],
        }
    if section.type == "tube":
        radius = section.card.radius - 0.5 * section.card.thickness
        around = 4 * across
        along = max(1, round(member.length * around / (6.283185307179586 * radius)))
        return common | {
            "type": "cylinder",
            "start": plain(member.T[:, 1]),
            "radius": radius,
            "elements": [around, along],
        }
    message = f"section '{section.name}' is no closed thin wall, of which shells could be made"
    raise Problem(member.path, message, "take rectangular_tube or tube, or another deformation")


def outward(member: Member) -> np.ndarray:
    """Vector from the middle of the first end to the mesh's first node [m]."""
    card = member.section.card
    if member.section.type == "tube":
        return (card.radius - 0.5 * card.thickness) * member.T[:, 1]
    width, height = card.width - card.thickness, card.height - card.thickness
    return -0.5 * width * member.T[:, 1] - 0.5 * height * member.T[:, 2]
