"""Length of the next step of a scene with elements: as for bodies, and stable in every element.

    h <= 2 safety / omega,   omega^2 the largest squared frequency of the mesh

It is not above the sum of the shares of its free elements at any point (`points.bound_rate`).
Consequence to test: a plate is stable for safety < 1, and not above its highest frequency.

Reference: Belytschko, Liu, Moran and Elkhodary (2014), Nonlinear Finite Elements, 6.2.
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.system.timestep import count_rotations, fit  # noqa: F401  (the loops take them here)
from crashsolve.system.timestep import wanted_step as step_of_bodies


@kernel
def wanted_step(clock, control, nodes):
    """Next step [s]. Writes: clock.limit_node, below 0 for elements."""
    h = step_of_bodies(clock, control, nodes)
    if control.fixed_step > 0.0:
        return h
    fastest = sqrt(clock.element_rate)
    if fastest * h > 2.0 * control.safety:
        h = 2.0 * control.safety / fastest
        clock.limit_node = -1 - clock.limit_element
    return h
