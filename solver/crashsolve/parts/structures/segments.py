"""Finite segments: n springs of the length l = L / n, each in the middle of its length.

    |--|----|----|--|     n - 1 rigid segments of the length l, and a half at either end

The halves belong to the bodies at the points. Each spring has the stiffness of its length of the
beam (springs/segment.py), so a straight member has the beam's elastic stiffness with any n, and
mass, mass centre and inertia of the whole are exact. Frequencies and large deflections converge
with l^2, collapse loads with l, as hinges form in the middle of l. Consequence to test: these.

Reference: Huston (1981), Computers and Structures 14, 443-451.
"""

from crashsolve.deck.expansion import Made
from crashsolve.parts.structures.cards import bar, plain
from crashsolve.parts.structures.plan import Member, Plan, euler_load

# of the card of the structure
WORDS = ("divisions", "damping")


def stub(member: Member) -> float:
    """Length of a member, besides the joint, that belongs to the body at its end [m]."""
    return 0.5 * member.length / member.divisions


def cards(member: Member, whole: Plan) -> list[Made]:
    """Bodies NAME_1 ... and springs NAME_1 ..., from the first end of the member on."""
    n = member.divisions
    piece = member.length / n
    bodies = [
        bar(whole, member, f"{member.name}_{k}", (k - 0.5) * piece, (k + 0.5) * piece)
        for k in range(1, n)
    ]
    chain = [whole.body(member.ends[0]), *(b.name for b in bodies), whole.body(member.ends[1])]
    springs = []
    for k, (a, b) in enumerate(zip(chain[:-1], chain[1:], strict=True)):
        cut = member.at((k + 0.5) * piece)
        is_first, is_last = k == 0, k == n - 1
        fields = {
            "type": "segment",
            "a": a,
            "b": b,
            "at_a": plain(cut - whole.points[member.ends[0]]) if is_first else [piece / 2, 0, 0],
            "at_b": plain(cut - whole.points[member.ends[1]]) if is_last else [-piece / 2, 0, 0],
            "axis": plain(member.along) if is_first else [1, 0, 0],
            "side": plain(member.T[:, 1]) if is_first else [0, 1, 0],
            "length": piece,
            "section": member.section.name,
            "material": member.material.name,
            "damping": whole.card.damping,
            "buckling_load": euler_load(member),
        }
        springs.append(Made("springs", f"{member.name}_{k + 1}", fields, member.path))
    return bodies + springs
