"""Explicit Runge-Kutta method of order 5, six stages, with an estimate of order 4.

For smooth motion to moderate accuracy: the error of a step falls with its sixth power.

References: Dormand and Prince (1980), J. Comput. Appl. Math. 6, 19-26; Hairer, Norsett and Wanner
(1993), Solving Ordinary Differential Equations I, II.6.
"""

import numpy as np

STEPPER = "_runge_kutta"
ORDER = 5
STAGES = 7  # the last is at the end of the step, and the first of the next
EXTRA = 0  # further stages of the dense output

# row i: weights of the rates before stage i; row STAGES - 1, of the step
A = np.zeros((STAGES + EXTRA, STAGES + EXTRA))
A[1, :1] = [1 / 5]
A[2, :2] = [3 / 40, 9 / 40]
A[3, :3] = [44 / 45, -56 / 15, 32 / 9]
A[4, :4] = [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729]
A[5, :5] = [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656]
A[6, :6] = [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84]
C = A.sum(axis=1)

# dense output of order 4, as in the code DOPRI5: weights of theta^2 (1 - theta)^2
DENSE = np.array(
    [
        [
            -12715105075 / 11282082432,
            0,
            87487479700 / 32700410799,
            -10690763975 / 1880347072,
            701980252875 / 199316789632,
            -1453857185 / 822651844,
            69997945 / 29380423,
        ]
    ]
)

# difference of the step from the embedded method of order 4
E = np.array([[71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40]])
TERMS = len(DENSE)
ESTIMATES = 1
