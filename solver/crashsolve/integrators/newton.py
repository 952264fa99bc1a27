"""Newton's method for equilibria of what strains on its way: a step from rest (system/rest.py).

No deck names it: `control.solution: quasi_static` does, where a part remembers its way.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, 9.
"""

import numpy as np

STEPPER = "_implicit"
STAGE = "_rest_stage"
ORDER = 2
ESTIMATE = 3
STAGES = 2  # start and end

# weights of both ends in what is summed over a step
A = np.array([[0.0, 0.0], [0.5, 0.5]])
T = A
"""Implicit: tangents of springs are asked for."""
