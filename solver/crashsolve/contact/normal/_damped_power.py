"""The force that most laws of restitution share; they differ only in chi(e).

    f = K delta^n (1 + chi delta_dot / v_0),   never tensile

v_0 is the impact speed: the least with which a free impact could show the speeds of this touch. It
closes no faster than v_0 and opens no faster than x v_0, x the restitution returned, so

    v_0 = max over the touch of (delta_dot, -delta_dot / x, min(v_f, v_d))
    v_d^2 G(1) = K delta^(n+1) / ((n+1) m)

v_f is the speed floor and v_d the speed of a free impact that goes as deep as the touch is now. In
a free impact v_d is below the closing speed at the onset, which v_0 then is, however slow. A
contact that other forces press deeper counts as resting, with v_0 up to the floor: its damping
stays finite. One that is driven by others has the speed at which it is driven, and one that begins
compressed that of the free impact which passes its state (`_restitution.py`). The stiffness
reported to the step control is that at the depth which the energy of the touch allows, so the
first step is already short, and steps are longer once it rests.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import TYPE_CHECKING

from crashsolve.contact.normal._restitution import returned, speed_through, spent
from crashsolve.contact.normal._stiffness import SOURCES, Materials, hertz_stiffness
from crashsolve.deck.building import Columns, Pair, Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.contact.normal._rows._damped_power import History, Parameters

# error of the returned restitution, over the given one, without a warning
SILENT = 0.02
# how far the floor may be above the speeds of a touch without a remark, and the share of it that
# v_0 has where a touch begins without any depth or speed
PRESSED, LEAST = 1.02, 1e-9

PARAMETERS = Record("""
    stiffness    N/m^n  K
    exponent     1      n
    chi          1      damping factor of the law
    returned     1      restitution x of a free impact
    spent        1      G(1): share of m v_0^2 that drives a free impact to its deepest
    speed_limit  m/s    impact speed beyond which the law is outside its range
""")
HISTORY = Record("""
    damping_speed  m/s   v_0
    too_fast       flag  an impact was faster than speed_limit
    pressed        flag  v_0 was that of the speed floor
""")
# flags of HISTORY that the log reports at the end of a run, with the words for it
WARNINGS = {"too_fast": "impact faster than 1e-5 sqrt(E/rho): outside the law's range of validity"}
# the same flags where they are remarks, no warnings
REMARKS = {"pressed": "deeper than a free impact of its closing speed, and damped as at rest"}


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


def build(card: PowerCard, scene: Scene, pair: Pair) -> Columns:
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
        "spent": float(spent(chi, 1.0)),
        "speed_limit": card.speed_limit(),
    }


def _check_restitution(card: DampedPowerCard, scene: Scene, pair: Pair, chi: float) -> None:
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
            f"contact '{pair.contact}': {law} with restitution {card.restitution:g} gives a "
            f"restitution of {x:.3f} in a free impact; type: exact_restitution gives the one asked "
            "for"
        )


@kernel
def normal_force(p: Parameters, old: History, new: History, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping. Writes: new."""
    n = p.exponent
    spring = p.stiffness * power(depth, n)
    stored = spring * depth / (n + 1.0)
    v = damping_speed(p, old, new, h, stored / mass, rate)
    new.damping_speed = v
    new.too_fast = 1 if v > p.speed_limit else old.too_fast
    factor = max(0.0, 1.0 + p.chi * rate / v)
    energy = energy_to_come(p, stored, rate, mass, v)
    reach = ((n + 1.0) * energy / p.stiffness) ** (1.0 / (n + 1.0))
    slope = p.stiffness * power_below(reach, n)
    stiffness = n * slope * max(1.0, factor)
    damping = p.chi * slope * reach / v
    return spring * factor, stored, spring * (factor - 1.0) * rate, 0.0, stiffness, damping


@kernel
def energy_to_come(p, stored, rate, mass, v):
    """Energy at the depth to come, at most: all that the touch has now [J]."""
    speed = max(abs(rate), LEAST * p.speed_floor)
    return max(stored, min(stored + 0.5 * mass * speed * speed, 0.5 * mass * v * v))


@kernel
def rate_slope(p: Parameters, old: History, new: History, h, depth, mass):
    """Damping c: rise of the force over a closing speed that does not raise v_0 [N s/m]."""
    spring = p.stiffness * power(depth, p.exponent)
    energy = spring * depth / ((p.exponent + 1.0) * mass)
    return p.chi * spring / damping_speed(p, old, new, h, energy, 0.0)


@kernel
def implicit_rate(p: Parameters, slope, depth, free, compliance):
    """Closing speed u = free - compliance f(u) [m/s], with the slope of rate_slope."""
    return rate_of_force(p, p.stiffness * power(depth, p.exponent), slope, free, compliance)


@kernel
def rate_of_force(p, spring, slope, free, compliance):
    """The same of an elastic force [N]."""
    v = p.chi * spring / slope
    u = (free - compliance * spring) / (1.0 + compliance * slope)
    # v_0 grows with speeds beyond those of the touch so far, and the force stays
    if u > v:
        u = free - compliance * spring * (1.0 + p.chi)
    elif u < -p.returned * v:
        u = free - compliance * spring * (1.0 - p.chi * p.returned)
    return u


@kernel
def resolved_slopes(p: Parameters, new: History, rate, mass, stored, stiffness, damping):
    """Stiffness and damping that steps must resolve, of those of normal_force [N/m, N s/m].

    A touch that others press deeper than an elastic free impact of v_0 goes has come to rest there,
    and creeps on slowly: c counts as at the depth of that impact, times its share of the energy
    stored. The stiffness is that of the present speed already.
    """
    v = new.damping_speed
    free = 0.5 * mass * v * v
    if stored <= free:
        return stiffness, damping
    part = (free / stored) ** (p.exponent / (p.exponent + 1.0))
    return stiffness, damping * part * free / stored


@kernel
def power(depth, n):
    """depth^n; that of Hertz, n = 3/2, costs a root alone."""
    return depth * sqrt(depth) if n == 1.5 else depth**n


@kernel
def power_below(depth, n):
    """depth^(n-1)."""
    return sqrt(depth) if n == 1.5 else depth ** (n - 1.0)


@kernel
def damping_speed(p, old, new, h, energy, rate):
    """v_0 of this touch so far [m/s]; the energy is that of the spring over the mass [m^2/s^2].

    Writes: new.
    """
    v = max(new.impact_speed, rate, -rate / p.returned)
    if old.active == 1:
        v = max(v, old.damping_speed)
    elif h == 0.0:
        # the run begins with it
        v = max(v, speed_through(p.chi, p.returned, energy, rate))
    new.pressed = old.pressed
    if v < p.speed_floor:
        deep = min(sqrt(energy / p.spent), p.speed_floor)
        if deep > PRESSED * v and p.chi > 0.0:
            new.pressed = 1
        v = max(v, deep, LEAST * p.speed_floor)
    return v


@kernel
def release(p: Parameters, old: History, new: History):
    """Writes: new."""
    new.damping_speed = 0.0
    new.too_fast = old.too_fast
    new.pressed = old.pressed


@kernel
def normal_tangent(p: Parameters, state: History, depth, rate, mass, curves):
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


# functions of the file of such a law, beside its card
ELASTIC = PARAMETERS, HISTORY, WARNINGS, REMARKS, build, normal_force, normal_tangent, release
LAW = *ELASTIC, rate_slope, implicit_rate, resolved_slopes
