"""Plastic hinges: two rigid bars between hinges at the ends and in the middle of each member.

    f = L / 6 E I + 2 / (kappa G A L),   g = L / E I - 2 f

are the flexibilities of the hinges at the ends and of that in the middle: with them any forces at
the ends turn and move these as those of Timoshenko's beam (Simpson's rule is exact for the product
of two linear moments). The hinges bend about both axes; members do not stretch and do not twist. A
hinge yields where frames do: at its joints, and in the middle of a member that is struck there or
buckles. Consequence to test: the elastic stiffness of a member; M_p / L at the end of a cantilever.

References: Ambrosio (2003), Eq. 6-7 and Fig. 3. Nikravesh, Chung and Benedict (1983), Computers
and Structures 16, 395-400.
"""

from crashsolve.deck.expansion import Fields, Made, Problem
from crashsolve.parts.structures.cards import bar, plain
from crashsolve.parts.structures.plan import Member, Plan, euler_load

# of the card of the structure
WORDS = ("collapse", "collapse_curve", "hinge_stress", "hinge_arm")


def stub(member: Member) -> float:
    """Length of a member, besides the joint, that belongs to the body at its end [m]."""
    return 0.0


def cards(member: Member, whole: Plan) -> list[Made]:
    """Bodies NAME_1 and NAME_2, hinges NAME_start, NAME_middle and NAME_end."""
    material, extra = material_of(member, whole)
    name, L = member.name, member.length
    halves = [
        bar(whole, member, f"{name}_1", 0.0, 0.5 * L),
        bar(whole, member, f"{name}_2", 0.5 * L, L),
    ]
    first, last = (whole.body(point) for point in member.ends)
    ends, middle = lengths(member)
    hinges = [
        hinge(member, whole, material, "start", first, f"{name}_1", 0.0, ends),
        hinge(member, whole, material, "middle", f"{name}_1", f"{name}_2", 0.5 * L, middle),
        hinge(member, whole, material, "end", f"{name}_2", last, L, ends),
    ]
    return extra + halves + hinges


def material_of(member: Member, whole: Plan) -> tuple[str, list[Made]]:
    """Name of the material of hinges, and its card where it is another than the member's.

    Raises Problem for properties that hinges do not follow.
    """
    law, card = member.material, member.material.card
    if law.type != "elastoplastic":
        message = f"material '{law.name}' is {law.type}: hinges need one of type elastoplastic"
        raise Problem(member.path, message, "or take another deformation")
    if card.rate_D and whole.card.hinge_arm is None:
        message = f"material '{law.name}' has rate_D, and hinges follow no strain rate"
        raise Problem(
            member.path, message, "give hinge_arm, the distance at which Eq. 7 has its speed"
        )
    for word in ("failure_strain", "kinematic"):
        if getattr(card, word):
            message = f"material '{law.name}' has {word}, which hinges do not follow"
            raise Problem(member.path, message, "take segments, beams or shells for it")
    stress = whole.card.hinge_stress
    if stress is None:
        if card.hardening or card.curve is not None:
            message = f"material '{law.name}' hardens, and hinges do not"
            raise Problem(member.path, message, "give hinge_stress, the stress at which they yield")
        if not card.rate_D:
            return law.name, []
        stress = card.yield_stress
    name = f"{whole.name}_hinges_of_{law.name}"
    fields = {
        "type": "elastoplastic",
        "young": card.young,
        "poisson": card.poisson,
        "density": card.density,
        "yield_stress": stress,
    }
    return name, [Made("materials", name, fields, member.path)]


def lengths(member: Member) -> tuple[list[float], list[float]]:
    """Lengths under constant moment with the flexibility of a hinge at an end, and in the middle.

    For bending about y and z [m]. Raises Problem where shear leaves nothing for the middle.
    """
    E, L = member.material.card.young, member.length
    G = E / (2.0 + 2.0 * member.material.card.poisson)
    ends, middle = [], []
    # bending about y goes with shear along z
    for second, share in zip(
        member.constants["second"], reversed(member.constants["shear"]), strict=True
    ):
        end = L / 6.0 + 2.0 * E * second / (share * G * member.constants["area"] * L)
        if not end < 0.5 * L:
            message = f"is too short for hinges: it shears more than it bends over {L:.4g} m"
            raise Problem(member.path, message, "take another deformation for it")
        ends.append(end)
        middle.append(L - 2.0 * end)
    return ends, middle


def hinge(
    member: Member,
    whole: Plan,
    material: str,
    side: str,
    a: str,
    b: str,
    x: float,
    equivalent_lengths: list[float],
) -> Made:
    """The hinge between a and b at a length from where the member begins to deform."""
    curves = [
        curve(member, whole, material, about, length)
        for about, length in zip("yz", equivalent_lengths, strict=True)
    ]
    fields: Fields = {
        "type": "biaxial",
        "a": a,
        "b": b,
        "at": plain(member.at(x)),
        "axis": plain(member.along),
        "side": plain(member.T[:, 1]),
        "curve": curves[0],
        "second_curve": curves[1],
    }
    fields["buckling_load"] = euler_load(member)
    if whole.card.hinge_arm is not None:
        fields["rate"] = {"arm": whole.card.hinge_arm}
    return Made("hinges", f"{member.name}_{side}", fields, member.path)


def curve(member: Member, whole: Plan, material: str, about: str, length: float) -> Fields:
    """Moment [N m] over angle [rad] of a hinge about an axis of the section."""
    fields = {
        "section": member.section.name,
        "material": material,
        "about": about,
        "model": whole.card.collapse,
        "length": length,
    }
    given = whole.card.collapse_curve
    return fields if given is None else fields | {"plastic_curve": given}
