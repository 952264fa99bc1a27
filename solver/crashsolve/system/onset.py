"""Search for the end of a step at which something begins: a contact, or another branch of a law.

    gap(h) <= 0 at the start of the step,   end it where 0 < gap(h) <= allowed

A bracket is (early, late, gap early, gap late, allowed, trials): step lengths before and after the
onset, their gaps, the tolerance, and the number of trials. Consequence to test: an
impact latches the speed of its onset, for any step.
"""

from crashsolve.foundation.kernels import kernel

# of the model's size: an impact at 1e-6 m/s is some 1e-10 m deep, and an onset of 1e-12 of a
# metre within it changes its speed by less than the step does
PASSED = 1e-12


@kernel
def new_bracket(h):
    """Bracket between no step and the longest [s]."""
    return 0.0, h, 0.0, 0.0, 0.0, 0


@kernel
def first_gap(bracket, before, gap, control, share):
    """Enter the gaps at both ends of the full step; a share of their difference may be passed.

    A long free flight must not spoil the impact at its end: never more than PASSED of the model.
    """
    early, late, _, gap_late, _, count = bracket
    allowed = max(control.onset_tolerance, min(share * (gap - before), PASSED * control.length))
    return early, late, before, gap_late, allowed, count


@kernel
def narrow_bracket(bracket, h, trial, gap):
    """Enter the gap after `trial`. Returns the bracket, the next trial, whether `trial` is the end.

    h is the length of the full step.
    """
    early, late, gap_early, gap_late, allowed, count = bracket
    # surfaces at a gap of exactly 0 are not yet in contact: 0 is before the onset
    if gap > 0.0 or count == 0:
        late, gap_late = trial, gap
    else:
        early, gap_early = trial, gap
    is_narrow = gap_late <= allowed or late - early <= 1e-13 * h
    if trial == late and is_narrow:
        return (early, late, gap_early, gap_late, allowed, count), trial, True
    following = between(count, early, gap_early, late, gap_late, allowed)
    if is_narrow:
        following = late
    return (early, late, gap_early, gap_late, allowed, count + 1), following, False


@kernel
def between(count, early, gap_early, late, gap_late, allowed):
    """Next trial: false position, with bisection every third time."""
    if count % 3 == 2:
        return 0.5 * (early + late)
    share = (0.5 * allowed - gap_early) / (gap_late - gap_early)
    return early + min(max(share, 1e-6), 1.0 - 1e-6) * (late - early)
