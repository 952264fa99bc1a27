"""Whether a load step has passed a limit point, and found an equilibrium far beyond it.

Along a path of equilibria the change of configuration lies between what the tangents at both ends
give for the change of the load, in steps that are short enough. An equilibrium beyond a limit point
is farther away than both say. Consequence to test: Williams' toggle stops at its limit load, with
any number of load steps.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures 1, ch. 9.
"""

from typing import Any

import numpy as np

# over what both tangents give, beyond which a change of configuration has left the path; and share
# of what the first of them gives, below which the load step is looked at in halves
FAR, APART = 1.1, 1.5
# a change that is nothing but round-off, in the model's size or rad
NOWHERE = 1e-12


def passes_limit_point(engine: Any, start: np.ndarray, start_time: float, target: float) -> bool:
    """Whether the equilibria at both moments [s] are no neighbours; `start` are the nodes at first.

    Of laws that yield nothing is said: a tangent that loads is not one that unloads.
    """
    if engine.yielding.groups or engine.plastic_flow.groups or start_time < engine.loading.start:
        return False
    change, forward = engine.size_of(engine.change_from(start)), engine.first
    if forward > APART * change + NOWHERE and target - start_time > 2.0 * engine.least:
        # near a limit point the tangent of the lower equilibrium overestimates the change
        return True
    if change <= FAR * forward + NOWHERE:
        return False
    tangent = engine.tangent
    backward = engine.size_of(engine.correction(start_time))
    # as it was: loads of the target, and its tangent
    engine.imbalance(target)
    engine.tangent = tangent
    return bool(change > FAR * max(forward, backward))
