"""Generalized-alpha on the rotation group: implicit, of order 2, with Phi = 0 as an equation.

For stiff springs at moderate accuracy and for long contacts: one system of one stage a step, and
`control.spectral_radius` is the share of an unresolved vibration that remains after a step.

Reference: Bruels, Cardona and Arnold (2012), Mechanism and Machine Theory 48, 121-137.
"""

import numpy as np

STEPPER = "_implicit"
STAGE = "_alpha_stage"
ORDER = 2
ESTIMATE = 3  # power of the step with which the estimated error falls
STAGES = 2  # start and end

# weights of both ends in sums over a step
A = np.array([[0.0, 0.0], [0.5, 0.5]])
T = A
"""Implicit: tangents of springs and contacts are needed."""
