"""When the iteration for the unknowns of an implicit step is near enough.

    left = share / (1 - share) |last correction|,   share: what a pass leaves of the error

A step chosen by its error asks for CARE of `tolerance`; where a sample or step_max makes it
shorter, for BESIDE of its own error. So does a step of stated length, which may be as short as one
likes. Consequence to test: the order holds for every stated step, and more samples make nothing
worse.

Reference: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8 (Eq. 8.10).
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import norm, vec

PASSES = 20
PATIENCE = 4  # passes in which the correction may grow
CARE = 0.03  # of the tolerance
BESIDE = 0.01  # of the error of a step that its error has not chosen
FAR_BELOW = 0.1  # of the tolerance: a step with less of an error is not chosen by it
ROUND_OFF = 1e-12  # of the displacement in the step
# of the displacement: a smaller correction that no longer shrinks is round-off, or slow, and left
FLOOR = 1e-8


@kernel
def is_near(count, share, worst, previous, enough, control, stages, speed):
    """Whether no pass is needed after pass number `count`, from 0 on.

    `worst` and `previous` are the last two corrections, `enough` what may be left, all in the
    model's size and speed.
    """
    left = worst * share / (1.0 - share)
    displacement = size_of_step(stages, control.length, speed)
    # as good as it gets: what is left is about as much as the last correction
    stalls = worst >= previous and (count > PATIENCE or worst <= FLOOR * displacement)
    if stalls:
        left = worst
    if not left <= CARE * control.tolerance:
        return False
    if stalls or left <= max(enough, ROUND_OFF * displacement):
        return True
    return count == PASSES - 1 and (control.fixed_step == 0.0 or left <= FLOOR * displacement)


@kernel
def note_pass(clock, count, worst, previous, least):
    """Count a pass; the share of the error that it leaves, taken as `least` or more."""
    clock.iterations += 1
    clock.last_iterations = count + 1
    return min(max(worst / previous, least), 0.9)


@kernel
def diverges_early(count, worst, previous):
    """Whether corrections grow so that further iterations are useless."""
    return not worst < 10.0 * previous or (count > PATIENCE and not worst < previous)


@kernel
def enough_beside(h, clock, control, order, power):
    """Tolerance of the equations of a step of h beside its own error.

    That is predicted by the estimate of the last step, which falls with a `power` of the step where
    the error of the method falls with order + 1. Nothing is known after a kink.
    """
    is_stated = control.fixed_step > 0.0
    if clock.step <= 0.0 or clock.kinked != 0 or clock.error <= 0.0:
        return 0.0 if is_stated else 1.0
    estimate = min(clock.error * (h / clock.step) ** power, 1.0)
    if is_stated:
        return BESIDE * estimate ** ((order + 1.0) / power)
    return BESIDE * estimate if estimate < FAR_BELOW * control.tolerance else 1.0


@kernel
def size_of_step(stages, size, speed):
    """Largest change of any body in the step, in the model's size and speed."""
    last, farthest = stages.shape[0] - 1, 0.0
    for n in range(1, stages.shape[1]):
        s = stages[last, n]
        displacement = norm(vec(s.displacement_r)) / size + 2.0 * norm(vec(s.rotation))
        displacement += (norm(vec(s.change_v)) + size * norm(vec(s.change_w))) / speed
        farthest = max(farthest, displacement)
    return farthest
