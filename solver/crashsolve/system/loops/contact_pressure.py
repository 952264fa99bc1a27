"""Pressure of two sides over an area: normal forces in its points, by their closing speeds.

    f_k = s_k max(0, f + c g . d_k)

f is the force of the law at the closing speed in the middle x, g the rise of that speed along the
surface, d_k the position of a point from x and s_k its share: laws are linear in the speed where
they press. With implicit damping (system/contact/damping.py) f is that of the speed to which it
leads, and so is the rise,

    (c g . d_k + eta r_k) / (1 + eta),   r_k that of the last step at the same place

Consequence to test: a box that tilts while it is pressed flat is damped as by any other step.
"""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.foundation.motion import add_deferred, apply_force
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, put, scale, sub, vec
from crashsolve.system.contact.areas import NO_ROTATION
from crashsolve.system.loops.mobilities import pair_mobility
from crashsolve.system.placeholders import KICK_DRIFT_KICK


@kernel
def mean_mobility(pair, spots, count, n):
    """Mobilities of both sides along the normal, in the mean over an area [1/kg]."""
    mean_a, mean_b = 0.0, 0.0
    for k in range(count):
        y, share = vec(spots[k].point), spots[k].share
        mob_a, mob_b = pair_mobility(
            pair.a, pair.b, sub(y, vec(pair.a.r)), sub(y, vec(pair.b.r)), n
        )
        mean_a, mean_b = mean_a + share * mob_a, mean_b + share * mob_b
    return mean_a, mean_b


@stage
def distribute_pressure(group, pair, totals, count, n, x, applied, push, scene):
    """Normal forces at the `count` points of an area, and their record.

    Returns the force [N], the power that the differences dissipate [W] and the point of the line on
    which all of it acts. Writes: totals, new.
    """
    spots, (f, rate, damping, weight) = group.data[0], push
    gradient = cross(sub(vec(pair.a.w), vec(pair.b.w)), n)
    if KICK_DRIFT_KICK and group.resolves_damping:
        record_pressure(pair.old, pair.new, f, scale(damping, gradient), weight)
    total, power, moment = 0.0, -f * rate, NO_ROTATION
    for k in range(count):
        y, share = vec(spots[k].point), spots[k].share
        rise = damping * dot(gradient, sub(y, x))
        if KICK_DRIFT_KICK and group.resolves_damping:
            rise = implicit_rise(pair.old, sub(y, x), rise, damping, weight)
        f_k = share * max(0.0, f + rise)
        press(pair, totals, scale(f_k, n), y, applied)
        total += f_k
        # where it presses, its closing speed is that of the law
        power += f_k * (rate + rise / damping if damping > 0.0 else rate)
        moment = add_scaled(moment, f_k, y)
    return total, power, scale(1.0 / total, moment) if total > 0.0 else x


@kernel
def press(pair, totals, force, y, applied):
    """Apply a force to a, and its opposite to b, at the position y. Writes: totals."""
    d_a, d_b = sub(y, vec(pair.a.r)), sub(y, vec(pair.b.r))
    apply_force(totals.on_a, force, d_a)
    apply_force(totals.on_b, scale(-1.0, force), d_b)
    if applied < 1.0:
        add_deferred(totals.on_a, scale(1.0 - applied, force), d_a)
        add_deferred(totals.on_b, scale(applied - 1.0, force), d_b)


@kernel
def record_pressure(old, new, f, rise, weight):
    """Record the force of an even pressure, and how it rises along the surface. Writes: new."""
    before = vec(old.gradient) if old.active == 1 else NO_ROTATION
    new.even_force = f
    put(new.gradient, scale(1.0 / (1.0 + weight), add(rise, scale(weight, before))))


@kernel
def implicit_rise(old, d, rise, damping, weight):
    """Rise of the pressure at d from the middle [N], by the closing speed to which it leads."""
    if weight == 0.0 or damping == 0.0:
        return rise
    # a pressure did not pull
    before = max(-old.even_force, dot(vec(old.gradient), d)) if old.active == 1 else 0.0
    return (rise + weight * before) / (1.0 + weight)
