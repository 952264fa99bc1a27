"""Elastic contact of Hertz.

    f = K delta^n,   n = 3/2

Consequence to test: a free impact of mass m at v_0 lasts 3.21807 (m^2 / (K^2 v_0))^(1/5), goes (5 m
v_0^2 / (4 K))^(2/5) deep and returns all its energy.

References: Ambrosio (2003), Eq. 19; Hertz (1881), J. reine angew. Math. 92, 156-171.
"""

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, normal_force, normal_tangent, release = (
    shared.ELASTIC
)


class Hertz(shared.PowerCard):
    """Elastic force of Hertz from the materials and radii of both sides, or from K."""
