"""Explicit second-order method for constrained bodies: kick, drift, kick, projections onto joints.

The method for all models; the stiffest spring or contact limits its step. The step is in
`_kick_drift_kick`.

References: Andersen (1983), J. Comput. Phys. 52, 24-34; Hairer, Lubich and Wanner (2006),
Geometric Numerical Integration, VII.1.4.
"""

STEPPER = "_kick_drift_kick"
ORDER = 2
# one evaluation of forces a step, at its end: the impulse is the mean of both ends
KICK_DRIFT_KICK = True
