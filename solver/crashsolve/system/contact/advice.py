"""Advice on contacts whose energy is not balanced, or whose points are deep."""

from crashsolve.model.model import Model

# of the distance from a surface to its middle: a point is deep, which is lost beyond the middle
HALFWAY = 0.5
# the best remedy where a shell folds on itself: a node meets the nearer of two walls alone
OWN_FACES = "where a shell folds on itself take smaller elements, or ring: 1 of its faces"
# a ball meets the nearest of many faces that are about as near, and few others, whatever the step
HOLLOW = (
    "where a ball lies in a hollow of faces that fits it, name the nodes of the shell on one side "
    "and the ball on the other, in place of faces"
)


def advice_on_gain(model: Model, card: int) -> str:
    """What to know of a contact card that creates energy, where steps help little; or nothing."""
    groups = [g for g in model.nodal_groups if int(g.arrays["p"]["card"][0]) == card]
    return OWN_FACES if any(group.is_self_contact for group in groups) else ""


def advice_on_hollow(model: Model, card: int) -> str:
    """What to do about a ball that now lies between three faces or more; or nothing."""
    groups = [g for g in model.nodal_groups if int(g.arrays["p"]["card"][0]) == card]
    return HOLLOW if any(group.balls_between_faces() for group in groups) else ""


def advice_on_depth(model: Model, card: int) -> str:
    """What to do about points of a contact card that penetrated deeply; or nothing."""
    depths = [g.depth_and_middle for g in model.nodal_groups if g.arrays["p"]["card"][0] == card]
    depth, thick = max(depths, key=lambda one: one[0] / one[1], default=(0.0, 1.0))
    if depth <= HALFWAY * thick:
        return ""
    return (
        f"make contact '{model.contacts[card]}' stiffer: its points penetrated {depth:.3g} m of "
        f"the {thick:.3g} m from the surface of what they struck to its middle"
    )
