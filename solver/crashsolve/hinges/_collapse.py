"""Collapse of thin-walled rectangular tubes: in bending by a kinematic fold, in axial crush.

Bending (Kecman 1983): a the width of the compressed flange, b the depth, t the wall, Y the yield
stress

    s_cr = pi^2 E / 12 (1 - nu^2) (t / a)^2 (5.23 + 0.16 a / b),   a_e = a (0.7 s_cr / Y + 0.3)
    M_max = Y t b^2 (2 a + b + a_e (3 a / b + 2)) / 3 (a + b)                   s_cr < Y
            M_e + (M_p - M_e) (s_cr - Y) / Y,   M_e = Y t b (a + b / 3)          Y < s_cr < 2 Y
            M_p = Y t (a (b - t) + (b - 2 t)^2 / 2)                              2 Y < s_cr

The first two agree at s_cr = Y. Then a fold of the half length h = min(a, b) / 2 forms, whose hinge
lines have m = S t^2 / 4 per length, S the flow stress. With rho = theta / 2, in the plane of a web

    C = (h cos rho - b sin rho, b cos rho + h sin rho)    end of the fold on the compressed edge
    B = (0, y_B),   |BC| = h                              middle of the compressed flange
    A = (0, y_A, z),   from |GA| = g, |AB| = b - g, |AC|  crest of the bulge; G the tension edge

The web does not stretch: g = (b^2 - y_B^2) / 2 b (1 - y_B / C_y), and A travels from B downwards
and the lines AC sweep h (b - g) of each web, bent and straightened at the radius
r = (0.07 - theta / 70) h.
M(theta) is the slope of the energy of all lines, at most M_max; the fold closes where C_x = t / 2.
The positions of the lines follow here from the lengths of the walls, in closed form; the radius,
the length of the fold and M_max are Kecman's.

Axial crush of a square tube of width c (Abramowicz and Jones 1984):

    P_m = 52.22 M_0 (c / t)^(1/3),   M_0 = S t^2 / 4

Consequence to test: a wall twice as thick has more than twice the force; forces of scaled tubes
scale.

References: Kecman (1983), Int. J. Mech. Sci. 25, 623-636; Wierzbicki and Abramowicz (1983),
J. Appl. Mech. 50, 727-734; Abramowicz and Jones (1984), Int. J. Impact Engng 2, 179-208.
"""

from math import acos, atan2, cos, pi, sin, sqrt
from typing import Any

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.foundation.curve import REFUSE

POISSON = 0.3
# points of the falling curve
POINTS = 60
# width over wall of the tubes that Kecman bent, and of those that Abramowicz and Jones crushed
BENT, CRUSHED = (9.14, 128.0), (10.0, 100.0)
# Kecman's tubes had flanges of a third to three times the depth
ASPECT = 3.0


def largest_moment(a: float, b: float, t: float, young: float, stress: float) -> float:
    """M_max [N m]."""
    buckling = pi**2 * young / (12.0 * (1.0 - POISSON**2)) * (t / a) ** 2 * (5.23 + 0.16 * a / b)
    if buckling < stress:
        width = a * (0.7 * buckling / stress + 0.3)
        return stress * t * b**2 * (2.0 * a + b + width * (3.0 * a / b + 2.0)) / (3.0 * (a + b))
    elastic = stress * t * b * (a + b / 3.0)
    plastic = stress * t * (a * (b - t) + 0.5 * (b - 2.0 * t) ** 2)
    return elastic + (plastic - elastic) * min((buckling - stress) / stress, 1.0)


def closing_angle(a: float, b: float, t: float) -> float:
    """theta at which the two halves of the compressed flange meet [rad]."""
    h = 0.5 * min(a, b)
    # h cos rho - b sin rho = t / 2
    return 2.0 * (acos(0.5 * t / sqrt(h * h + b * b)) - atan2(b, h))


def fold_energy(angle: float, a: float, b: float) -> float:
    """Energy of all hinge lines over their m, of a fold by an angle [m rad]."""
    rho, h = 0.5 * angle, 0.5 * min(a, b)
    x, y = h * cos(rho) - b * sin(rho), b * cos(rho) + h * sin(rho)
    drop = sqrt(h * h - x * x)
    low = y - drop
    g = (b * b - low * low) / (2.0 * b * (1.0 - low / y))
    crest = b * g / y
    bulge = sqrt(max(g * g - crest * crest, 0.0))
    # B and A of the web on the right of the observer; G is the origin
    G, A, B = np.zeros(3), np.array([0.0, crest, bulge]), np.array([0.0, low, 0.0])
    C, D = np.array([x, y, 0.0]), np.array([-x, y, 0.0])
    tilt = acos(x / h)
    flanges = a * (2.0 * tilt + 2.0 * (tilt - rho) + 2.0 * rho)
    lower, upper = normal(G, C, A), normal(A, C, B)
    web = 2.0 * sqrt(h * h + b * b) * between(lower, np.array([0.0, 0.0, 1.0]))
    web += g * between(lower, normal(G, A, D))
    web += (b - g) * between(upper, normal(A, B, D))
    web += 2.0 * float(np.linalg.norm(C - A)) * between(lower, upper)
    # the corner was square: the flange's normal lies in the plane of the web
    across = np.array([drop, -x, 0.0]) / h
    web += 2.0 * h * abs(0.5 * pi - between(upper, across))
    radius = (0.07 - angle / 70.0) * h
    return flanges + 2.0 * (web + 2.0 * h * (b - g) / radius)


def normal(p: np.ndarray, q: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Unit normal (3,) of a triangle."""
    n = np.cross(q - p, s - p)
    return np.asarray(n / np.linalg.norm(n))


def between(m: np.ndarray, n: np.ndarray) -> float:
    """Angle between two unit vectors [rad]."""
    return float(np.arctan2(np.linalg.norm(np.cross(m, n)), m @ n))


def fold_moment(angle: float, a: float, b: float) -> float:
    """Moment over m of a fold at an angle: the slope of its energy [m]."""
    step = 1e-5 * angle
    return (fold_energy(angle + step, a, b) - fold_energy(angle - step, a, b)) / (2.0 * step)


def curve(
    card: Any, section: Any, constants: tuple[float, float, float], field: str, scene: Scene
) -> Any:
    """M over theta: elastic, M_max, the fold until it closes; no answer beyond."""
    young, stress, stiffness = constants
    a, b, t = sides(section, card.about, field, scene)
    if not BENT[0] <= a / t <= BENT[1] or not 1.0 / ASPECT <= a / b <= ASPECT:
        raise scene.fail(
            f"a / t = {a / t:.4g} and a / b = {a / b:.4g}; the tests behind this model have a / t "
            f"from {BENT[0]:g} to {BENT[1]:g} and a / b from 1/3 to 3",
            field,
        )
    top = largest_moment(a, b, t, young, stress)
    line = 0.25 * (card.flow_stress or stress) * t * t
    closed = closing_angle(a, b, t)
    # the fold begins where its moment, which falls from infinity, has come down to M_max
    if card.until is not None and card.until > closed:
        raise scene.fail(
            f"until: {card.until:.4g} rad is beyond {closed:.4g}, where the fold closes", field
        )
    low, high = 1e-9, closed
    if line * fold_moment(0.999 * closed, a, b) > top:
        raise scene.fail("the fold bears more than the section at every angle", field)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if line * fold_moment(middle, a, b) > top else (low, middle)
    start, end = high, min(card.until or closed, closed)
    angles = np.linspace(start, 0.999 * end, POINTS) if end > 1.001 * start else np.array([end])
    moments = np.array([min(line * fold_moment(angle, a, b), top) for angle in angles])
    plastic = np.concatenate([[0.0, 0.0], angles])
    y = np.concatenate([[0.0, top], moments])
    x = plastic + y / stiffness
    c = np.zeros((len(x) - 1, 4))
    c[:, 0], c[:, 1] = y[:-1], np.diff(y) / np.diff(x)
    return x, c, REFUSE


def crush_force(section: Columns, stress: float, field: str, scene: Scene) -> float:
    """P_m of a square tube [N]."""
    a, b, t = sides(section, "y", field, scene)
    if abs(a - b) > 1e-3 * a:
        raise scene.fail(f"the mean crush force is that of square tubes, not {a:g} x {b:g}", field)
    width = a - t
    if not CRUSHED[0] <= width / t <= CRUSHED[1]:
        raise scene.fail(
            f"c / t = {width / t:.4g}; the formula is for {CRUSHED[0]:g} to {CRUSHED[1]:g}", field
        )
    return 52.22 * 0.25 * stress * t * t * (width / t) ** (1.0 / 3.0)


def sides(section: Any, about: str, field: str, scene: Scene) -> tuple[float, float, float]:
    """Compressed flange, depth and wall of a rectangular tube [m]."""
    if type(section).__name__ != "RectangularTube":
        raise scene.fail("collapse by folding is that of a rectangular_tube; name one", field)
    a, b = section.width, section.height
    return (a, b, section.thickness) if about == "y" else (b, a, section.thickness)
