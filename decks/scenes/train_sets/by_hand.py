"""What pitch moment the gaps of Fig. 13 need, by hand, for the deck's numbers and for middle ones.

A car whose ends push with a net force F slows by a = F / m. About the mass centre of its
compartment F acts h_b - h_e below, and its bogies, each s of its mass, pull with s F each at
h_b - h_p below:

    M = F e,   e = (h_b - h_e) - 2 s (h_b - h_p)

Its springs, k at each pivot b from the middle, resist with K = 2 k b^2, so that its end at L / 2
settles by z = M L / (2 K). Where plates do not slip, they hold an end that would set off with
M L / (2 I): with the mass that the end of a free car moves, m' = 1 / (1 / m + L^2 / (4 I)), this
takes T = m' M L / (2 I) at once, whatever the springs.
"""

from typing import NamedTuple

import sweeps


class Numbers(NamedTuple):
    """What is assumed of the motor car that strikes, by the names of shared/rail_numbers.yaml."""

    body_height: float  # h_b [m]
    buffer_height: float  # h_e [m]
    pivot_height: float  # h_p [m]
    bogie_share: float  # of one bogie in the car's mass
    k_secondary: float  # per bogie of a car of 34 t [N/m]
    k_primary: float  # per axle of a car of 34 t [N/m]
    plateau_HE: float  # force of the high-energy end [N]
    plateau_LE: float  # force of the low-energy end [N]


MASS, LENGTH, OVERHANG = 68e3, 20.0, 3.75


def estimate(n: Numbers) -> tuple[float, float, float, float, float]:
    """Lever e [m], moment M [N m], stiffness K [N m/rad], end's deflection z [m], force T [N]."""
    lever = n.body_height - n.buffer_height
    lever -= 2.0 * n.bogie_share * (n.body_height - n.pivot_height)
    moment = (n.plateau_HE - n.plateau_LE) * lever
    spring = MASS / 34e3 / (1.0 / n.k_secondary + 0.5 / n.k_primary)
    stiffness = 2.0 * spring * (0.5 * LENGTH - OVERHANG) ** 2
    mass = MASS * (1.0 - 2.0 * n.bogie_share)
    inertia = mass * ((LENGTH - 2.0) ** 2 + 2.7**2) / 12.0
    half = 0.5 * LENGTH
    force = moment * half / inertia / (1.0 / mass + half**2 / inertia)
    return lever, moment, stiffness, moment / stiffness * half, force


def table() -> str:
    lines = ["|numbers|e [m]|F [MN]|M [MN m]|K [MN m/rad]|z [mm]|T [kN]|", "|---" * 7 + "|"]
    ranges = {one.name: one for one in sweeps.assumptions()}
    middle = (0.5 * (float(ranges[x].low) + float(ranges[x].high)) for x in Numbers._fields)
    deck = (float(sweeps.deck_value(x)) for x in Numbers._fields)
    for name, n in (("middle of the ranges", Numbers(*middle)), ("the deck's", Numbers(*deck))):
        lever, moment, stiffness, z, force = estimate(n)
        lines.append(
            f"| {name} | {lever:.2f} | {1e-6 * (n.plateau_HE - n.plateau_LE):.1f} | "
            f"{1e-6 * moment:.2f} | {1e-6 * stiffness:.0f} | {1e3 * z:.0f} | {1e-3 * force:.0f} |"
        )
    return "\n".join(lines)
