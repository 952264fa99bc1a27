"""The force that most laws of restitution share; they differ only in chi(e).

    f = K delta^n (1 + chi delta_dot / v_0),   never tensile

v_0 is the impact speed: the least with which a free impact could show the speeds of this touch. It
closes no faster than v_0 and opens no faster than x v_0, x the restitution returned, so

    v_0 = max over the touch of (delta_dot, -delta_dot / x),   not below the speed floor

In a free impact that is the closing speed at the onset. A touch that is driven by others has the
speed at which it is driven, and one that begins compressed that of the free impact which passes
its state (`_restitution.py`). The stiffness reported to the step control is that at the depth a
free impact of speed v_0 will reach, so the first step is already short.
"""

from math import inf, sqrt
from typing import Any

from crashsolve.contact.normal._restitution import returned, speed_through
from crashsolve.contact.normal._stiffness import SOURCES, Materials, hertz_stiffness
from crashsolve.deck.building import Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

# how far, in shares of the restitution asked for, the one returned may be off without a warning
SILENT = 0.02

PARAMETERS = Record("""
    stiffness    N/m^n  K
    exponent     1      n
    chi          1      damping factor of the law
    returned     1      restitution x of a free impact
    speed_limit  m/s    impact speed beyond which the law is outside its range
""")
HISTORY = Record("""
    damping_speed  m/s   v_0
    too_fast       flag  an impact was faster than speed_limit
""")
# flags of HISTORY that the log reports at the end of a run, with the words for it
WARNINGS = {"too_fast": "impact faster than 1e-5 sqrt(E/rho): outside the law's range of validity"}


class PowerCard(Materials):
    """Stiffness, given or from the materials by Eq. 19."""

    exponent: float = quantity("1", "n of the penetration; 1.5 for Hertz", 1.5, ge=1)
    stiffness: float | None = quantity("N/m^{exponent}", "K; or give the materials", None, gt=0)

    def chi(self) -> float:
        """Damping factor [1] of the law for its restitution; infinite where it has none."""
        return 0.0


class DampedPowerCard(PowerCard):
    """Stiffness and coefficient of restitution; the file of the law adds chi(e)."""

    restitution: float = quantity("1", "coefficient of restitution e", ge=0, le=1)


def build(card: PowerCard, scene: Scene, pair: Any) -> dict[str, Any]:
    """Parameters of the force; warns where it returns another restitution than asked.

    Refuses two sources of stiffness.
    """
    chi = card.chi()
    if isinstance(card, DampedPowerCard):
        _check_restitution(card, scene, pair, chi)
    given = card.stiffness is not None
    if given and (card.compliance() > 0.0 or card.radius is not None):
        raise scene.fail(f"stiffness is given twice: give {SOURCES}", "normal.stiffness")
    if not given and card.exponent != 1.5:
        raise scene.fail("materials give the stiffness of exponent 1.5 only", "normal.exponent")
    return {
        "stiffness": card.stiffness if given else hertz_stiffness(card, scene, pair),
        "exponent": card.exponent,
        "chi": chi,
        "returned": returned(chi),
        "speed_limit": card.speed_limit(),
    }


def _check_restitution(card: DampedPowerCard, scene: Scene, pair: Any, chi: float) -> None:
    if chi == inf:
        raise scene.fail(
            "this law needs a restitution above 0: its damping grows without bound; give 0.01, "
            "or a crush_curve for an impact without rebound",
            "normal.restitution",
        )
    x = returned(chi)
    if abs(x - card.restitution) > SILENT * card.restitution:
        law = type(card).__module__.rpartition(".")[2]
        scene.warn(
            f"contact '{pair.contact}': {law} with restitution {card.restitution:g} returns "
            f"{x:.3f} in a free impact; exact_restitution returns what is asked"
        )


@kernel
def normal_force(p, old, new, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping. Writes: new."""
    v = damping_speed(p, old, new, h, depth, rate, mass)
    new.damping_speed = v
    new.too_fast = 1 if v > p.speed_limit else old.too_fast
    n = p.exponent
    spring = p.stiffness * power(depth, n)
    factor = max(0.0, 1.0 + p.chi * rate / v)
    stored = spring * depth / (n + 1.0)
    # energy that a free impact puts into the spring gives the depth to come
    reach = (0.5 * (n + 1.0) * mass * v**2 / p.stiffness) ** (1.0 / (n + 1.0))
    slope = p.stiffness * power_below(max(depth, reach), n)
    stiffness = n * slope * max(1.0 + p.chi, factor)
    damping = p.chi * slope * max(depth, reach) / v
    return spring * factor, stored, spring * (factor - 1.0) * rate, 0.0, stiffness, damping


@kernel
def power(depth, n):
    """depth^n; that of Hertz, n = 3/2, costs a root alone."""
    return depth * sqrt(depth) if n == 1.5 else depth**n


@kernel
def power_below(depth, n):
    """depth^(n-1)."""
    return sqrt(depth) if n == 1.5 else depth ** (n - 1.0)


@kernel
def damping_speed(p, old, new, h, depth, rate, mass):
    """v_0 of this touch so far [m/s]."""
    v = max(new.impact_speed, p.speed_floor, rate, -rate / p.returned)
    if old.active == 1:
        return max(v, old.damping_speed)
    if h == 0.0:
        # the run begins with it
        n = p.exponent
        energy = p.stiffness * depth ** (n + 1.0) / ((n + 1.0) * mass)
        v = max(v, speed_through(p.chi, p.returned, energy, rate))
    return v


@kernel
def release(p, old, new):
    """Writes: new."""
    new.damping_speed = 0.0
    new.too_fast = old.too_fast


@kernel
def normal_tangent(p, state, depth, rate, mass, curves):
    """Rise of the force over the depth and over its rate; none where v_0 grows with the rate."""
    n = p.exponent
    kept = max(state.impact_speed, state.damping_speed)
    v = max(kept, rate, -rate / p.returned)
    factor = 1.0 + p.chi * rate / v
    if factor <= 0.0:
        return 0.0, 0.0
    slope = p.stiffness * power_below(depth, n)
    damping = p.chi * slope * depth / v if v == kept else 0.0
    return n * slope * factor, damping


# what the file of such a law is made of, beside its card
LAW = PARAMETERS, HISTORY, WARNINGS, build, normal_force, normal_tangent, release
