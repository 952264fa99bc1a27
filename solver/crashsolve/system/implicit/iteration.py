"""When the iteration for the unknowns of an implicit step has converged.

    remaining error = theta / (1 - theta) |last correction|,   theta: contraction per iteration

The remaining error is at most SHARE_OF_TOLERANCE of `tolerance` in a step chosen by its error;
where a sample or step_max makes the step shorter, or its length is prescribed, also
SHARE_OF_ERROR of its own error. Consequence to test: the order holds for every stated step, and
more samples make nothing worse.

Reference: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8 (Eq. 8.10).
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import norm, vec

MAX_ITERATIONS = 20
GROWING_ITERATIONS = 4  # iterations in which the correction may grow
SHARE_OF_TOLERANCE = 0.03
SHARE_OF_ERROR = 0.01  # of the error of a step whose length its error has not determined
FAR_BELOW = 0.1  # of the tolerance: a step with a smaller error was limited by something else
ROUND_OFF = 1e-12  # of the displacement in the step
# of the displacement: a smaller correction that no longer shrinks is round-off
FLOOR = 1e-8


@kernel
def has_converged(count, contraction, worst, previous, allowed, control, stages, speed):
    """Whether iteration number `count`, from 0 on, is the last.

    `worst` and `previous` are the last two corrections, `allowed` the error that may remain, all in
    the model's size and speed.
    """
    remaining = worst * contraction / (1.0 - contraction)
    displacement = largest_change(stages, control.length, speed)
    # at round-off the remaining error is about as large as the last correction
    stagnates = worst >= previous and (count > GROWING_ITERATIONS or worst <= FLOOR * displacement)
    if stagnates:
        remaining = worst
    if not remaining <= SHARE_OF_TOLERANCE * control.tolerance:
        return False
    if stagnates or remaining <= max(allowed, ROUND_OFF * displacement):
        return True
    return count == MAX_ITERATIONS - 1 and (
        control.fixed_step == 0.0 or remaining <= FLOOR * displacement
    )


@kernel
def count_iteration(clock, count, worst, previous, least):
    """Count an iteration; returns its contraction of the error, taken as `least` or more."""
    clock.iterations += 1
    clock.last_iterations = count + 1
    return min(max(worst / previous, least), 0.9)


@kernel
def diverges_early(count, worst, previous):
    """Whether corrections grow so that further iterations are useless."""
    return not worst < 10.0 * previous or (count > GROWING_ITERATIONS and not worst < previous)


@kernel
def iteration_tolerance(h, clock, control, order, power):
    """Tolerance of the equations of a step of h beside its own error.

    That is predicted by the estimate of the last step, which falls with a `power` of the step where
    the error of the method falls with order + 1. Nothing is known after a kink.
    """
    is_stated = control.fixed_step > 0.0
    if clock.step <= 0.0 or clock.kinked != 0 or clock.error <= 0.0:
        return 0.0 if is_stated else 1.0
    estimate = min(clock.error * (h / clock.step) ** power, 1.0)
    if is_stated:
        return SHARE_OF_ERROR * estimate ** ((order + 1.0) / power)
    return SHARE_OF_ERROR * estimate if estimate < FAR_BELOW * control.tolerance else 1.0


@kernel
def largest_change(stages, size, speed):
    """Largest change of any body in the step, in the model's size and speed."""
    last, farthest = stages.shape[0] - 1, 0.0
    for n in range(1, stages.shape[1]):
        s = stages[last, n]
        displacement = norm(vec(s.displacement_r)) / size + 2.0 * norm(vec(s.rotation))
        displacement += (norm(vec(s.change_v)) + size * norm(vec(s.change_w))) / speed
        farthest = max(farthest, displacement)
    return farthest
