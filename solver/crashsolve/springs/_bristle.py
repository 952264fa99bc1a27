"""A bristle on a slider, which holds up to a limit and slides at it: brakes, friction of joints.

    f = K z + c z_dot,   |f| <= F;   beyond F / K the stretch z is cut and the slider follows

The energy lost in a step is the work of f, by the trapezoid of f over the displacement, less the
change of K z^2 / 2. The integrator takes this energy from the bodies, to its own order, also when
the bristle is stretched to its limit within one step.
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, dot, sub

BRISTLE = Record("""
    level                 N or N m            constant part of the limit
    friction_coefficient  1 or m              mu, times the pin radius: limit per pressing force
    first_row             index               first row of the joint
    pressing              count               rows whose reactions press the joint
    stiffness             N/m or N m/rad      K
    damping               N s/m or N m s/rad  c
""")

PRESSING = Record("""
    pressing  N         force that pressed the joint at the start of the step
    limit     N or N m  at which it slides
    step      s         length of the step; 0 before the first
""")
TREND = 0.1  # largest change of the force that presses a joint, by its trend, in one step


@kernel
def friction_limit(p, level, old, new, h, rows):
    """Level, and coefficient times the force that presses the joint [N or N m]. Writes: new.

    The lambdas of closing and opening kick at one moment err by opposite amounts, in proportion to
    their steps. The force at the end of the step is on the line through the last two moments; one
    that jumps has no trend.
    """
    share = old.step / (old.step + h) if h > 0.0 else 0.0
    square = 0.0
    for k in range(p.first_row, p.first_row + p.pressing):
        reaction = share * rows[k].multiplier + (1.0 - share) * rows[k].reaction
        square += reaction * reaction
    force = sqrt(square)
    new.pressing, new.step = force, h
    if h > 0.0 and old.step > 0.0:
        force += (force - old.pressing) * h / old.step
        force = min(max(force, (1.0 - TREND) * new.pressing), (1.0 + TREND) * new.pressing)
    new.limit = level + p.friction_coefficient * force
    if h == 0.0 and old.step > 0.0:
        # a sample repeats the last step
        new.pressing, new.step, new.limit = old.pressing, old.step, old.limit
    return new.limit


@kernel
def retained_share(stiffness, stretch, limit):
    """Share [1] of its stretch that a bristle keeps: 1 while it holds, less when it slides."""
    return 1.0 if stiffness * stretch <= limit else limit / (stiffness * stretch)


@kernel
def lost(stiffness, z_old, z, f_old, f, displacement):
    """Energy lost over a displacement of the step: work of the force less the energy stored in the
    bristle [J].
    """
    taken = 0.5 * dot(add(f_old, f), displacement)
    return taken - 0.5 * stiffness * dot(add(z_old, z), sub(z, z_old))
