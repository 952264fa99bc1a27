"""Closed forms of motions, each a function of the times (n,) of the samples."""

from collections.abc import Callable

import numpy as np

Motion = Callable[[np.ndarray], np.ndarray]


def oscillator(mass: float, damping: float, stiffness: float, x: float, v: float) -> Motion:
    """Displacement of an under-damped oscillator from x [m] with v [m/s]."""
    sigma = damping / (2.0 * mass)
    omega = np.sqrt(stiffness / mass - sigma**2)

    def motion(t: np.ndarray) -> np.ndarray:
        swing = x * np.cos(omega * t) + (v + sigma * x) / omega * np.sin(omega * t)
        return np.exp(-sigma * t) * swing

    return motion


def chain(count: int, mass: float, stiffness: float, speed: float, at: int) -> Motion:
    """Displacement of mass `at` of equal masses between walls, of which the first has `speed`."""
    matrix = stiffness / mass * (2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1))
    squares, modes = np.linalg.eigh(matrix)
    omega, share = np.sqrt(squares), modes[at] * modes[0] * speed
    return lambda t: np.sin(np.outer(t, omega)) @ (share / omega)


def amplitude(u: np.ndarray, m: float) -> np.ndarray:
    """Jacobi's amplitude am(u | m) by the arithmetic-geometric mean (Abramowitz, 16.4)."""
    a, b, c = [1.0], np.sqrt(1.0 - m), [np.sqrt(m)]
    while c[-1] > 1e-16:
        a_new = 0.5 * (a[-1] + b)
        c.append(0.5 * (a[-1] - b))
        b = np.sqrt(a[-1] * b)
        a.append(a_new)
    phi = 2.0 ** (len(a) - 1) * a[-1] * u
    for i in range(len(a) - 1, 0, -1):
        phi = 0.5 * (phi + np.arcsin(np.clip(c[i] / a[i] * np.sin(phi), -1.0, 1.0)))
    return phi


def pendulum(speed: float, omega: float) -> Motion:
    """Angle of a pendulum from its lowest point with `speed` [rad/s], sin(a/2) = k sn(omega t)."""
    k = speed / (2.0 * omega)
    assert k < 1.0
    return lambda t: 2.0 * np.arcsin(k * np.sin(amplitude(omega * t, k * k)))


def bounces(depth_speed: float, stiffness: float, mass: float, gap: float) -> Motion:
    """Distance from where touch begins, of a mass that flies to and fro between two springs.

    It begins half way between the walls, `gap` [m] from touching either, towards the lower one.
    """
    omega, v = np.sqrt(stiffness / mass), depth_speed
    flight, touch = gap / v, np.pi / omega

    def motion(t: np.ndarray) -> np.ndarray:
        half = 2.0 * flight + touch
        number, s = np.divmod(t + flight, half)
        # from the middle of the upper contact's end: fly down for 2 gaps, touch
        x = np.where(
            s < 2.0 * flight, gap - v * s, -gap - v / omega * np.sin(omega * (s - 2.0 * flight))
        )
        return x * (-1.0) ** number

    return motion


def triangle(force: float, ramp: float, mass: float) -> Motion:
    """Displacement by a force that rises over `ramp` [s], falls as fast, and ends."""

    def part(t: np.ndarray) -> np.ndarray:
        return np.where(t > 0.0, t, 0.0) ** 3 / 6.0

    return lambda t: force / mass / ramp * (part(t) - 2.0 * part(t - ramp) + part(t - 2 * ramp))


def returned(chi: float) -> float:
    """Speed ratio x of an impact with K d^n (1 + chi v/v_0): chi (1+x) = ln((1+chi)/(1-chi x))."""
    low, high = 0.0, min(1.0, 1.0 / chi)
    for _ in range(200):
        x = 0.5 * (low + high)
        left = chi * (1.0 + x) - np.log((1.0 + chi) / max(1.0 - chi * x, 1e-300))
        low, high = (x, high) if left > 0.0 else (low, x)
    return x


def deepest(chi: float, mass: float, stiffness: float, v: float) -> float:
    """Depth of the same impact with n = 3/2 [m]."""
    part = 0.5 if chi == 0.0 else (1.0 / chi - np.log(1.0 + chi) / chi**2)
    return float((2.5 * mass * v * v / stiffness * part) ** 0.4)
