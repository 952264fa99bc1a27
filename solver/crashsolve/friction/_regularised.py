"""Friction that depends on the sliding speed alone: applied against the slip, all work is lost.

Near rest such a law is a damper, and a stiff one would reverse the slip within a step. So the
friction of an explicit step is that at the slip which it leaves,

    f = F(v),   v = v_free - e f,   e F'(v) <= 1

v_free is the slip without it, and e the slip that it takes per newton in half a step [s/kg]: its
impulse over a step stops a slip and never reverses it. The speeds over which F rises are widened to
that end, by no more than the speed that friction can take in half a step. Consequence to test:
friction sets no step, and for a step short enough F is that of the law.

Reference: Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto (2005), Fixed-step friction simulation,
IEEE/RSJ International Conference on Intelligent Robots and Systems.
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, dot, scale


@kernel
def speed(slip):
    """Sliding speed [m/s]."""
    return sqrt(dot(slip, slip))


@kernel
def without_friction(slide, friction_force):
    """Slip [m/s] as without friction, where it counts on that of the last step, `friction_force`
    [N].
    """
    if slide.compliance == 0.0:
        return slide.slip
    free = add_scaled(slide.slip, -slide.compliance, friction_force)
    return add_scaled(free, -dot(free, slide.n), slide.n)


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
