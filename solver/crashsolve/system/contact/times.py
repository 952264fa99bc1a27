"""Times of onset and release of each contact card, and its duration of contact.

    t = t_1 - h d_1 / (d_1 - d_0)     d: depth of the deepest pair at both ends of the step

An onset is the end of a step, and so is a release where the method controls its steps: there t is
exact to the tolerance of those searches. The explicit steps of rattle pass a release, whose error
is then a (t_1 - t) (t - t_0) / 2 v, a the relative acceleration, v the relative speed; where
several pairs touch in turn, it is a step. Nodes of shells have no gap, and the times of steps.
Consequence to test: half a vibration on a linear spring.
"""

from crashsolve.foundation.kernels import kernel


@kernel
def time_cards(time, h, clock, cards, history):
    """Times of all cards after a step of h that ends at `time`. Writes: history."""
    for k in range(cards.shape[0]):
        c, old, new = cards[k], history[clock.current, k], history[1 - clock.current, k]
        new.in_touch = 1 if c.touching > 0.0 else 0
        new.deepest = c.depth
        new.touches, new.begun, new.lasted = old.touches, old.begun, old.lasted
        new.first_touch, new.last_release = old.first_touch, old.last_release
        if new.in_touch == 1 and old.in_touch == 0:
            new.begun = crossing(time, h, old.deepest, c.depth)
            new.touches += 1
            if old.touches == 0:
                new.first_touch = new.begun
        elif new.in_touch == 0 and old.in_touch == 1:
            new.last_release = crossing(time, h, old.deepest, c.depth)
            new.lasted += new.last_release - old.begun
        new.duration = new.lasted + (time - new.begun if new.in_touch == 1 else 0.0)


@kernel
def crossing(time, h, before, now):
    """Time [s] at which the depth was zero in a step of h that ends at `time`; its end if it never
    was.
    """
    if h <= 0.0 or not before * now < 0.0:
        return time
    return time - h * now / (now - before)
