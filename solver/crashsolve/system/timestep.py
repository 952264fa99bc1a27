"""Length of the next step: stability of the stiffest node, sliding, rotation, deck.

    h_crit = 2 / ( sqrt(omega^2 + (gamma/2)^2) + gamma/2 ),
    omega^2 = 2 max_i sum k w_i,   gamma = 2 max_i sum c w_i

w_i is the mobility (inverse effective mass) of node i where each spring or contact acts, so omega
bounds the highest frequency from above (Gershgorin). Slips of contacts with friction are resolved
where they reverse (friction/_regularised.py). Consequence to test: an undamped spring on a
wall is stable for safety < 1 and unstable for a fixed step above 2 / omega.

Reference: Belytschko, Liu, Moran and Elkhodary (2014), Nonlinear Finite Elements, 6.2.
"""

from math import ceil, pi, sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.model.clock import ROTATED
from crashsolve.system.kinetics import fastest_rotation
from crashsolve.system.placeholders import PAIR_DAMPERS

# rotation of a body in a step, beyond which angles between two are not counted; and the rest of
# it to a step chosen by its error, as bodies may spin up in it [rad]
QUARTER, MAX_ROTATION = 0.5 * pi, 1.0
# frequency times a stated step that is resolved well
SLOW = 1.0


@kernel
def wanted_step(clock, control, nodes):
    """Next step [s]. Writes: clock.limit_node."""
    if control.fixed_step > 0.0:
        record_frequency(clock, nodes)
        return control.fixed_step
    fastest, at = 0.0, 0
    for i in range(1, nodes.shape[0]):
        body = nodes[i]
        # most bodies carry no spring: no root for them
        if body.stiffness > 0.0 or body.damping > 0.0:
            half_gamma = body.damping
            speed = sqrt(2.0 * body.stiffness + half_gamma * half_gamma) + half_gamma
            if PAIR_DAMPERS:
                # a slip changes by `safety` of itself, not by a period
                speed = max(speed, 2.0 * body.slip_rate)
            if speed > fastest:
                fastest, at = speed, i
    h = min(control.step_max, control.curve_step)
    clock.limit_node = 0
    if fastest * h > 2.0 * control.safety:
        h = 2.0 * control.safety / fastest
        clock.limit_node = at
    rotation = fastest_rotation(nodes)
    if rotation * h > control.rotation:
        h = control.rotation / rotation
    return h


@kernel
def record_frequency(clock, nodes):
    """The body that springs and dampers move fastest for the step just taken. Writes: clock.

    (sqrt(omega^2 + (gamma/2)^2) + gamma/2) h reaches 2 where one spring and one damper on a body
    become unstable; below SLOW nothing is recorded. It is above r h where omega^2 > r (r - gamma),
    which needs no root.
    """
    if clock.step > 0.0:
        for i in range(1, nodes.shape[0]):
            body, rate = nodes[i], max(clock.swing, SLOW) / clock.step
            if body.stiffness > rate * (rate - body.damping):
                half = 0.5 * body.damping
                clock.swing = clock.step * (sqrt(body.stiffness + half * half) + half)
                clock.swing_square, clock.swing_damping = body.stiffness, body.damping
                clock.swing_node = i


@kernel
def count_rotations(h, clock, control, nodes):
    """Steps in which angles can be counted: less than half a rotation of two bodies. Writes:
    clock.
    """
    rotation = fastest_rotation(nodes)
    if control.fixed_step > 0.0 and rotation * h > QUARTER:
        clock.status, clock.value = ROTATED, rotation
    elif control.fixed_step == 0.0 and rotation * clock.next_step > MAX_ROTATION:
        clock.next_step = MAX_ROTATION / rotation


@kernel
def fit(h, remaining):
    """Equal steps no longer than h that end on the target: (step, whether it is the last)."""
    # the clock is a sum: its round-off must not cost a further step
    count = ceil(remaining / h * (1.0 - 1e-9))
    if count <= 1:
        return remaining, True
    return remaining / count, False
