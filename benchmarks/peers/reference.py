"""References to more digits than are published: each problem in its least coordinates.

    python benchmarks/peers/reference.py

Gauss collocation of six stages, order 12, with as many steps as leave twelve digits; where forces
have kinks, the classical Runge-Kutta method at a step that leaves ten. Nothing here knows any of
the codes. The problems hold the numbers that this prints, and name the published digits.
"""

from collections.abc import Callable
from math import cos, pi, radians, sin

import numpy as np
from numba import njit

Vector = np.ndarray
STAGES = 6


def collocation(stages: int) -> tuple[Vector, Vector]:
    """Matrix and weights of the Gauss method, from the integrals of the Lagrange polynomials."""
    nodes = (np.polynomial.legendre.leggauss(stages)[0] + 1.0) / 2.0
    inverse = np.linalg.inv(np.vander(nodes, increasing=True))
    powers = np.arange(1, stages + 1)
    return (nodes[:, None] ** powers / powers) @ inverse, (1.0 / powers) @ inverse


def jacobian(f: Callable[[Vector], Vector], y: Vector) -> Vector:
    columns = []
    for k in range(len(y)):
        small = np.zeros(len(y))
        small[k] = 1e-6 * max(1.0, abs(y[k]))
        columns.append((f(y + small) - f(y - small)) / (2.0 * small[k]))
    return np.array(columns).T


def gauss(f: Callable[[Vector], Vector], y: Vector, times: Vector) -> Vector:
    """State at the last of `times`, one step between each two."""
    matrix, weights = collocation(STAGES)
    n = len(y)
    for h in np.diff(times):
        slope = np.tile(f(y), (STAGES, 1))
        newton = np.linalg.inv(np.eye(STAGES * n) - h * np.kron(matrix, jacobian(f, y)))
        for _ in range(60):
            now = np.array([f(y + h * row @ slope) for row in matrix])
            change = (newton @ (now - slope).ravel()).reshape(STAGES, n)
            slope = slope + change
            if np.abs(change).max() <= 1e-15 * max(1.0, np.abs(slope).max()):
                break
        y = y + h * weights @ slope
    return y


def pendulum() -> Vector:
    """A1: (x, y) of the bob at 10 s; angle from the start, its inertia beside m L^2."""

    def f(y: Vector) -> Vector:
        return np.array([y[1], 9.81 * cos(y[0]) / (1.0 + 1e-9)])

    rotated = gauss(f, np.zeros(2), np.linspace(0.0, 10.0, 2001))[0]
    return np.array([-cos(rotated), -sin(rotated)])


def four_bar() -> Vector:
    """A2: (x, y) of the tip of the first crank at 10 s."""
    inertia = 3 / 4 + 3 * 0.0833333333333333 + 2

    def f(y: Vector) -> Vector:
        return np.array([y[1], -3.5 * 9.81 * cos(y[0]) / inertia])

    angle = gauss(f, np.array([pi / 2, -1.0]), np.linspace(0.0, 10.0, 4001))[0]
    return np.array([cos(angle), sin(angle)])


def governor() -> Vector:
    """A5 at 1 s: rotation of the shaft, angle of a rod below horizontal, height of the slider."""
    rod, ball, slider, k, c, g = 0.3, 5.0, 3.0, 8e5, 4e4, 9.81
    mass = rod + ball
    d = (0.5 * rod + ball) / mass
    across = rod * (1 + 0.01**2) / 12 + rod * (d - 0.5) ** 2 + ball * (1 - d) ** 2
    along = rod * 2 * 0.01**2 / 12
    about_axis = 0.3 * 2 * 0.01**2 / 12 + slider * 2 * 0.1**2 / 12

    def inertia(b: float) -> float:
        swing = mass * (0.05 + d * cos(b)) ** 2 + across * cos(b) ** 2 + along * sin(b) ** 2
        return about_axis + 2.0 * swing

    def slope(b: float) -> float:
        swing = -mass * (0.05 + d * cos(b)) * d * sin(b) + (along - across) * sin(b) * cos(b)
        return 4.0 * swing

    momentum = inertia(radians(30)) * 2 * pi

    def f(y: Vector) -> Vector:
        _, b, z, db, dz = y
        spin = momentum / inertia(b)
        across_gap, up = 0.5 * cos(b), 1.0 - 0.5 * sin(b) - z
        length = np.hypot(across_gap, up)
        by_b = (-across_gap * 0.5 * sin(b) - up * 0.5 * cos(b)) / length
        by_z = -up / length
        force = k * (length - 0.5) + c * (by_b * db + by_z * dz)
        torque = 0.5 * slope(b) * spin**2 + 2 * mass * g * d * cos(b) - 2 * force * by_b
        return np.array(
            [spin, db, dz, torque / (2 * (across + mass * d * d)), -g - 2 * force * by_z / slider]
        )

    # short steps at first: the dampers settle within 1e-4 s
    times = np.concatenate([[0.0], np.geomspace(1e-6, 1e-3, 60), np.linspace(1e-3, 1.0, 2001)[1:]])
    return gauss(f, np.array([0.0, radians(30), 0.5, 0.0, 0.0]), times)[:3]


def heavy_top() -> Vector:
    """A6: rotation matrix at 2 s, by rows; its second column is where the mass centre is."""
    inertia = np.array([15.234375, 0.46875, 15.234375])

    def matrix(q: Vector) -> Vector:
        w, x, y, z = q
        return np.array(
            [
                [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
            ]
        )

    def f(s: Vector) -> Vector:
        q, v = s[:4], s[4:]
        w, (x, y, z) = q[0], q[1:]
        weight = matrix(q).T @ np.array([0.0, 0.0, -15 * 9.81])
        torque = np.array([weight[2], 0.0, -weight[0]])
        rotation = np.array(
            [
                -x * v[0] - y * v[1] - z * v[2],
                w * v[0] + y * v[2] - z * v[1],
                w * v[1] + z * v[0] - x * v[2],
                w * v[2] + x * v[1] - y * v[0],
            ]
        )
        return np.concatenate([rotation / 2, (torque - np.cross(v, inertia * v)) / inertia])

    start = np.array([1.0, 0, 0, 0, 0, 150.0, -4.61538])
    q = gauss(f, start, np.linspace(0.0, 2.0, 4001))[:4]
    return matrix(q / np.linalg.norm(q)).ravel()


@njit
def runge_kutta(force, commit, mass, q, v, history, h, steps):
    """Classical method for M q'' = f(q, history); the history moves on after each step."""
    n, f = len(q), np.zeros(len(q))
    k = np.zeros((4, 2, n))
    for _ in range(steps):
        for stage, share in enumerate((0.0, 0.5, 0.5, 1.0)):
            before = k[stage - 1] if stage else k[0]
            f[:] = 0.0
            force(q + share * h * before[0], history, f)
            k[stage, 0] = v + share * h * before[1] if stage else v
            k[stage, 1] = f / mass
        q += h / 6 * (k[0, 0] + 2 * k[1, 0] + 2 * k[2, 0] + k[3, 0])
        v += h / 6 * (k[0, 1] + 2 * k[1, 1] + 2 * k[2, 1] + k[3, 1])
        commit(q, history)


def rigid_bar(steps: int = 6_000_000) -> Vector:
    """Centre's x, cosine and sine of the bar's angle at 1.2 s."""

    @njit
    def force(q, history, f):
        for side in (0.5, -0.5):
            depth = max(q[0] + side * cos(q[1]) - 1.0, 0.0)
            push = 1.2e8 * depth**1.5
            f[0] -= push
            f[1] += push * side * sin(q[1])

    @njit
    def commit(q, history):
        pass

    angle = radians(35.2)
    q, v = np.array([-0.5 * cos(angle), -angle]), np.array([2.0, 0.0])
    mass = np.array([20.0, 20.0 / 12])
    runge_kutta(force, commit, mass, q, v, np.zeros(1), 1.2 / steps, steps)
    return np.array([q[0], cos(q[1]), sin(q[1])])


def train(steps: int = 5_000_000) -> Vector:
    """Displacements of the sixteen cars at 1 s; the law is that of train_16.py."""
    from train_16 import CARS, END, MASS, START, commit, forces

    x, v, kept = np.zeros(CARS), START.copy(), np.zeros(CARS - 1)
    runge_kutta(forces, commit, MASS, x, v, kept, END / steps, steps)
    return x


if __name__ == "__main__":
    np.set_printoptions(precision=14, floatmode="fixed", suppress=True)
    for problem in (pendulum, four_bar, governor, heavy_top, rigid_bar, train):
        print(problem.__name__, problem(), sep="\n", flush=True)
