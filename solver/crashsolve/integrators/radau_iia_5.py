"""Implicit Runge-Kutta method of order 5, three stages: collocation in the nodes of Radau.

For stiff springs, dampers and bushings: the step follows the motion, not the fastest vibration,
which dies away in a step as it does in nature. The estimate of the error is of order 3.

References: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8; the
triangular factor of A: van der Houwen and de Swart (1997), SIAM J. Sci. Comput. 18, 41-55.
"""

from math import sqrt

import numpy as np

STEPPER = "_implicit"
STAGE = "_collocation"
ORDER = 5
ESTIMATE = 4  # power of the step with which the estimated error falls
STAGES = 4  # the first is the start of the step, the last its end

S6 = sqrt(6.0)

# row i: weights of the rates of all stages before stage i; the last row, of the step
A = np.zeros((STAGES, STAGES))
A[1, 1:] = [(88 - 7 * S6) / 360, (296 - 169 * S6) / 1800, (-2 + 3 * S6) / 225]
A[2, 1:] = [(296 + 169 * S6) / 1800, (88 + 7 * S6) / 360, (-2 - 3 * S6) / 225]
A[3, 1:] = [(16 - S6) / 36, (16 + S6) / 36, 1 / 9]
C = A.sum(axis=1)

# A = T U with U unit upper triangular: the stages are solved one after the other
T, U = np.zeros((STAGES, STAGES)), np.eye(STAGES)
for j in range(1, STAGES):
    T[j:, j] = A[j:, j] - T[j:, :j] @ U[:j, j]
    U[j, j:] = (A[j, j:] - T[j, :j] @ U[:j, j:]) / T[j, j]

# the embedded method of order 3 less the step: it has the rate at the start, with weight t_33, so
# that the factor of the last stage serves for the estimate
E = np.zeros(STAGES)
E[0] = T[3, 3]
E[1:] = np.linalg.solve(np.vander(C[1:], 3, increasing=True).T, [1 - E[0], 1 / 2, 1 / 3]) - A[3, 1:]
