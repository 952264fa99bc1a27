"""A soft layer on a stiff core, as flesh on bone, with the given restitution.

    F(delta) = K delta^n + K_c <delta - d>^n,   f = F(delta) (1 + chi delta_dot / v_0)
    V(delta) = stored = (K delta^(n+1) + K_c <delta - d>^(n+1)) / (n + 1),   <x> = max(x, 0)

chi (1 + e) = ln[(1 + chi) / (1 - chi e)] as in `exact_restitution`: with v dv / (1 + chi v / v_0) =
-F(delta) d(delta) / m the restitution depends on no shape of F. v_0 is the impact speed
(`_damped_power.py`). Consequences to test: a free central impact returns e at any speed, and its
deepest penetration obeys V = m v_0^2 G(1).

References: Gonthier, McPhee, Lange and Piedboeuf (2004), Multibody Syst. Dyn. 11, 209-233, the
implicit form before its approximation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.contact.normal import _damped_power as shared
from crashsolve.contact.normal._damped_power import (
    damping_speed,
    energy_to_come,
    power,
    power_below,
)
from crashsolve.contact.normal.exact_restitution import ExactRestitution
from crashsolve.deck.building import Columns, Pair, Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.contact.normal._rows.layered import History, Parameters

HISTORY, WARNINGS, REMARKS = shared.HISTORY, shared.WARNINGS, shared.REMARKS
release = shared.release
# iterations of Newton's method for a depth: from above, of a convex function, it needs at most ten
ITERATIONS = 20
# relative change of the depth at which they end: the step control needs no more digits
RESOLVED = 1e-6

PARAMETERS = Record("""
    stiffness       N/m^n  K
    exponent        1      n
    layer           m      d
    core_stiffness  N/m^n  K_c
    chi             1      damping factor of the law
    returned        1      restitution x of a free impact
    spent           1      G(1): share of m v_0^2 that drives a free impact to its deepest
    speed_limit     m/s    impact speed beyond which the law is outside its range
""")


class Layered(ExactRestitution):
    """A soft layer on a stiff core, as flesh on bone, that returns the given restitution."""

    layer: float = quantity("m", "d, penetration at which the core begins to resist", gt=0)
    core_stiffness: float = quantity("N/m^{exponent}", "K_c of the penetration beyond it", gt=0)


def build(card: Layered, scene: Scene, pair: Pair) -> Columns:
    columns = shared.build(card, scene, pair)
    return columns | {"layer": card.layer, "core_stiffness": card.core_stiffness}


@kernel
def normal_force(p: Parameters, old: History, new: History, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping. Writes: new."""
    spring, stored = elastic_force(p, depth), elastic_energy(p, depth)
    v = damping_speed(p, old, new, h, stored / mass, rate)
    new.damping_speed = v
    new.too_fast = 1 if v > p.speed_limit else old.too_fast
    factor = max(0.0, 1.0 + p.chi * rate / v)
    reach = depth_of_energy(p, energy_to_come(p, stored, rate, mass, v))
    stiffness = slope(p, reach) * max(1.0, factor)
    damping = p.chi * elastic_force(p, reach) / v
    return spring * factor, stored, spring * (factor - 1.0) * rate, 0.0, stiffness, damping


@kernel
def elastic_force(p: Parameters, depth):
    """F [N]."""
    below = max(depth - p.layer, 0.0)
    return p.stiffness * power(depth, p.exponent) + p.core_stiffness * power(below, p.exponent)


@kernel
def elastic_energy(p: Parameters, depth):
    """V [J]."""
    n, below = p.exponent, max(depth - p.layer, 0.0)
    core = p.core_stiffness * power(below, n) * below
    return (p.stiffness * power(depth, n) * depth + core) / (n + 1.0)


@kernel
def slope(p: Parameters, depth):
    """dF/d(delta) [N/m]."""
    n, rise = p.exponent, p.exponent * p.stiffness * power_below(depth, p.exponent)
    if depth > p.layer:
        rise += n * p.core_stiffness * power_below(depth - p.layer, n)
    return rise


@kernel
def depth_of_energy(p: Parameters, energy):
    """Depth at which this energy is stored [m]."""
    n = p.exponent
    # that of the layer alone, and of the core alone, are not below it
    depth = ((n + 1.0) * energy / p.stiffness) ** (1.0 / (n + 1.0))
    if depth <= p.layer:
        return depth
    depth = min(depth, p.layer + ((n + 1.0) * energy / p.core_stiffness) ** (1.0 / (n + 1.0)))
    for _ in range(ITERATIONS):
        excess = elastic_energy(p, depth) - energy
        if excess <= RESOLVED * energy:
            break
        depth -= excess / elastic_force(p, depth)
    return depth


@kernel
def rate_slope(p: Parameters, old: History, new: History, h, depth, mass):
    """Damping c: rise of the force over a closing speed that does not raise v_0 [N s/m]."""
    v = damping_speed(p, old, new, h, elastic_energy(p, depth) / mass, 0.0)
    return p.chi * elastic_force(p, depth) / v


@kernel
def implicit_rate(p: Parameters, slope, depth, free, compliance):
    """Closing speed u = free - compliance f(u) [m/s], with the slope of rate_slope."""
    return shared.rate_of_force(p, elastic_force(p, depth), slope, free, compliance)


@kernel
def resolved_slopes(p: Parameters, new: History, rate, mass, stored, stiffness, damping):
    """Stiffness and damping that steps must resolve, of those of normal_force [N/m, N s/m].

    As of a power law (`_damped_power.py`), with the forces at the depths of both energies; c at
    least times (rate / v_0)^2, its share of the power at v_0: a limb that is pinched as fast as
    it was struck loses as much as in the impact.
    """
    v = new.damping_speed
    free = 0.5 * mass * v * v
    if stored <= free:
        return stiffness, damping
    reach = elastic_force(p, depth_of_energy(p, free))
    part = reach / elastic_force(p, depth_of_energy(p, stored))
    return stiffness, damping * max(part * free / stored, (rate / v) ** 2)


@kernel
def normal_tangent(p: Parameters, state: History, depth, rate, mass, curves):
    """Rise of the force over the depth and over its rate; none where v_0 grows with the rate."""
    kept = max(state.impact_speed, state.damping_speed)
    v = max(kept, rate, -rate / p.returned)
    factor = 1.0 + p.chi * rate / v
    if factor <= 0.0:
        return 0.0, 0.0
    damping = p.chi * elastic_force(p, depth) / v if v == kept else 0.0
    return slope(p, depth) * factor, damping
