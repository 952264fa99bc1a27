"""Friction that depends on the sliding speed alone: applied against the slip, all work is lost.

Near rest such a law is a damper, and a stiff one would reverse the slip within a step. So the
friction of an explicit step is that at the slip which it leaves,

    f = F(v),   v = v_free - g e f,   g = max(1, 2 - 1 / (2 e F'))

e is the slip that it takes per newton in half a step [s/kg], v_free the slip without it, g half
steps after the middle of the step: at its end, or up to the middle of the next where F is steep.
Its impulse over a step, 2 e f, then stops a slip and never reverses it. At the nodes of shells,
which vibrate near the stable step, g is 1, and the speeds over which F rises are widened to
e F' <= 1 instead. Consequence to test: what is pushed at rest creeps as the law says.

Where a slip reverses, friction does within the time that the slip takes from v_1 to -v_1, F rising
up to v_1. Steps that do not resolve this reverse it at the wrong time, and its impulse is wrong by
up to 2 F times the step. So steps between rigid bodies are of a share `safety` of

    (max(v, v_1) - v_0) / |dv/dt|

in which the slip v changes by as much as that by which it differs from v_0, where F begins to rise.
Consequence to test: errors of an impact in which a slip reverses are of second order in the step;
the steepness of F, and a slip that rests, set no step.

Reference: Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto (2005), Fixed-step friction simulation,
IEEE/RSJ International Conference on Intelligent Robots and Systems.
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, dot, scale, sub


@kernel
def speed(slip):
    """Sliding speed [m/s]."""
    return sqrt(dot(slip, slip))


@kernel
def half_steps_ahead(slide, slope):
    """Where friction of this slope over the speed [N s/m] acts, in half steps from the middle of
    the step: 1 at its end, 2 in the middle of the next.
    """
    if slide.middle is None or slide.compliance * slope <= 0.5:
        return 1.0
    return 2.0 - 0.5 / (slide.compliance * slope)


@kernel
def slip_rate(slide, h, low, high):
    """Relative change of the slip per time [1/s]: friction rises between the speeds low and high
    [m/s].
    """
    if h == 0.0:
        return 0.0
    # the step has reached the slip from that of its middle
    change = speed(sub(slide.slip, slide.middle))
    return change / (0.5 * h * (max(speed(slide.slip), high) - low))


@kernel
def without_friction(slide, ahead, friction_force):
    """Slip [m/s] so many half steps ahead as without friction, where it counts on that of the last
    step, `friction_force` [N].
    """
    if slide.compliance == 0.0:
        return slide.slip
    slip = slide.slip
    if slide.middle is not None:
        slip = add_scaled(slip, ahead - 1.0, sub(slip, slide.middle))
    free = add_scaled(slip, -ahead * slide.compliance, friction_force)
    return add_scaled(free, -dot(free, slide.n), slide.n)


@kernel
def least_rise(slide, friction):
    """Least speed over which so much friction rises at the nodes of shells [m/s]."""
    return slide.compliance * friction if slide.middle is None else 0.0


@kernel
def against(slip, v, friction, slope, friction_force, displacement):
    """Friction on side a and its record, for a friction force at sliding speed v.

    Returns force, stored energy, dissipated power, loss, stiffness, damping; slope bounds the
    rise of the friction force over the sliding speed [N s/m]. With `displacement`, the slip over a
    whole step, its loss is its work, `friction_force` being the friction at the start, and it sets
    no step.
    """
    share = -friction / v if v > 0.0 else 0.0
    force = scale(share, slip)
    if displacement is None:
        return force, 0.0, friction * v, 0.0, 0.0, slope
    return force, 0.0, 0.0, -0.5 * dot(add(friction_force, force), displacement), 0.0, 0.0
