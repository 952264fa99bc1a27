"""Beams: a part of beam elements for each member, of fibres where its material yields.

Its ends are part of the bodies at the points: as nodes welded to them in explicit steps, by welds
with other methods.
"""

from crashsolve.deck.expansion import Made
from crashsolve.parts.structures.cards import plain, welds
from crashsolve.parts.structures.plan import Member, Plan, euler_load

# of the card of the structure
WORDS = ("divisions", "damping", "fibres")


def stub(member: Member) -> float:
    """Length of a member, besides the joint, that belongs to the body at its end [m]."""
    return 0.0


def cards(member: Member, whole: Plan) -> list[Made]:
    """The part NAME, and its welds NAME_start and NAME_end."""
    start, end = member.at(0.0), member.at(member.length)
    yields = member.material.type != "elastic"
    fields = {
        "type": "fibre_beam" if yields else "beam",
        "mesh": {
            "shape": "line",
            "from": plain(start),
            "to": plain(end),
            "elements": member.divisions,
        },
        "section": member.section.name,
        "material": member.material.name,
        "side": plain(member.T[:, 1]),
        "damping": whole.card.damping,
        "velocity": whole.velocity(start),
        "angular_velocity": plain(whole.card.angular_velocity),
        "buckling_load": euler_load(member),
    }
    if yields:
        fields["fibres"] = list(whole.card.fibres)
    return [Made("parts", member.name, fields, member.path), *welds(whole, member)]
