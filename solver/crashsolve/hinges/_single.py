"""One motion of a hinge: its resistance in a step, the slopes of that, and the corners of its law.

`x` is the angle or the stroke from the undeformed hinge [rad or m], `rate` its rate, and `speed`
that of the rate factor (_law.py).
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.hinges import _joint, _law


@kernel
def response(p, old, new, out, x, speed, curves):
    """Moment or force [N m or N], 0 after failure, and phi. Writes: new, out."""
    _joint.copy_history(old, new)
    share = _law.overshoot(p, old, 0, x, curves) if p.latched == 1 else 2.0
    phi = _law.factor(p, old, new, speed, share)
    new.failed = 1 if _joint.fails(p, old, x, 0.0) else 0
    moment, stored, loss = 0.0, 0.0, 0.0
    if old.failed == 0:
        moment, stored, loss = _law.advance_motion(p, old, new, 0, x, phi, curves)
    if new.failed == 1:
        moment = 0.0
    new.x[0] = x
    _joint.write_energies(p, old, new, out, stored, loss)
    return moment, phi


@kernel
def slopes(p, state, x, rate, speed, curves):
    """Slopes of the resistance over x [N m/rad or N/m] and over the speed, at a state."""
    if state.failed == 1:
        return 0.0, 0.0
    phi, slope = _law.step_factor(p, state, speed), _law.growth_slope(p, speed)
    stiffness, damping, side = _law.motion_tangent(p, state, 0, x, rate, phi, slope, curves)
    return stiffness, damping if side * rate > 0.0 else 0.0


@kernel
def beyond(p, old, h, x, rate, speed, curves):
    """Distance beyond the branch of the law on which the step began [rad or m]."""
    if old.failed == 1:
        return -1e300
    phi = _law.step_factor(p, old, speed)
    return max(_law.beyond_motion(p, old, h, 0, x, rate, phi, curves), abs(x) - p.failure[0])
