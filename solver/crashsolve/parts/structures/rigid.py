"""Rigid members: half of each belongs to the body at either end, and welds join these bodies.

Each body is welded to the first one that it hangs together with by rigid members, so that none of
these welds is redundant; those of several of its points to a body that they are part of are.
Consequence to test: a structure in free flight has the inertia of its members.
"""

from crashsolve.deck.expansion import Made
from crashsolve.parts.structures.plan import Member, Plan

# of the card of the structure
WORDS: tuple[str, ...] = ()


def stub(member: Member) -> float:
    """Length of a member, besides the joint, that belongs to the body at its end [m]."""
    return 0.5 * member.length


def cards(member: Member, whole: Plan) -> list[Made]:
    """No cards: rigid members belong to the points."""
    return []
