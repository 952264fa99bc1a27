"""Newton's method for equilibria of path-dependent laws, a step from rest at a time.

See statics/pseudo_transient.py.

No deck names it: `control.solution: quasi_static` does, where a part is path-dependent.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, 9.
"""

import numpy as np

IN_DECKS = False
STEPPER = "_implicit"
STAGE = "_rest_stage"
ORDER = 2
ESTIMATE = 3
STAGES = 2  # start and end

# weights of both ends in sums over a step
A = np.array([[0.0, 0.0], [0.5, 0.5]])
T = A
"""Implicit: tangents of springs are needed."""
