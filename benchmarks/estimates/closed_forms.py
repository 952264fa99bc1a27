"""Closed forms of motions, each a function of the times (n,) of the samples."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

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


def quarter(m: float) -> float:
    """Complete elliptic integral K(m)."""
    a, b = 1.0, np.sqrt(1.0 - m)
    while abs(a - b) > 1e-15 * a:
        a, b = 0.5 * (a + b), np.sqrt(a * b)
    return float(0.5 * np.pi / a)


def swing(most: float, omega: float) -> Motion:
    """Angle of a pendulum that is let go at `most` [rad]."""
    k = np.sin(0.5 * most)
    return lambda t: 2.0 * np.arcsin(k * np.sin(amplitude(omega * t + quarter(k * k), k * k)))


def drawn(travel: np.poly1d, bend: np.poly1d, omega: float) -> Motion:
    """Mass on a spring whose other end makes a `travel` of third degree; `bend` = travel''."""
    p, q = bend(0.0) / omega**2, bend.deriv()(0.0) / omega**3
    return lambda t: travel(t) - bend(t) / omega**2 + p * np.cos(omega * t) + q * np.sin(omega * t)


def top(
    across: float, along: float, spin: float, precession: float, weight: float, arm: float
) -> Motion:
    """Position (3, n) of the mass centre of a symmetric top that begins along y, its tip held.

    u = z / arm = u1 + (u2 - u1) sn^2, and it goes round with (a - b u) / (1 - u^2); both inertias
    are about the tip, `precession` [rad/s] is about the vertical (Goldstein, Classical Mechanics,
    5.7).
    """
    b, beta = along * spin / across, 2.0 * weight * arm / across
    a = precession
    roots = np.sort(np.roots([beta, -(a * a + b * b), 2.0 * a * b - beta, 0.0]).real)
    low, high, beyond = roots
    m = (high - low) / (beyond - low)
    rate, first = np.sqrt(0.25 * beta * (beyond - low)), 0.0 if low == 0.0 else quarter(m)

    def height(t: np.ndarray) -> np.ndarray:
        return low + (high - low) * np.sin(amplitude(rate * t + first, m)) ** 2

    def gone(start: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Angle about the vertical from `start` to t by Gauss' rule [rad]."""
        x, w = np.polynomial.legendre.leggauss(12)
        u = height(start + 0.5 * (t - start) * (1.0 + x[:, None]))
        return 0.5 * (t - start) * (w @ ((a - b * u) / (1.0 - u * u)))

    def motion(t: np.ndarray) -> np.ndarray:
        grid = np.linspace(0.0, max(t.max(), 1e-3), 201)
        rotated = np.concatenate([[0.0], np.cumsum(gone(grid[:-1], grid[1:]))])
        panel = np.minimum(np.searchsorted(grid, t, side="right") - 1, 199)
        angle, u = rotated[panel] + gone(grid[panel], t), height(t)
        out = np.sqrt(1.0 - u * u)
        return arm * np.array([-out * np.sin(angle), out * np.cos(angle), u])

    return motion


@dataclass(frozen=True)
class Rod:
    """A round rod of a material of Poisson's ratio 0.3, clamped at one end, of equal elements.

    Each method gives masses and stiffness of the motions of all nodes but the first.
    """

    length: float
    radius: float
    density: float
    young: float

    @property
    def area(self) -> float:
        return float(np.pi * self.radius**2)

    @property
    def second(self) -> float:
        return float(np.pi * self.radius**4 / 4.0)

    def bar(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Stretching."""
        return _line(n, self.density * self.area, self.young * self.area, self.length)

    def shaft(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Twisting."""
        polar = 2.0 * self.second
        return _line(n, self.density * polar, self.young / 2.6 * polar, self.length)

    def beam(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Bending with shear: deflection and rotation of each node in turn."""
        part, kappa = self.length / n, 6.0 * 1.3 / (7.0 + 6.0 * 0.3)
        bend, shear = self.young * self.second, kappa * self.young / 2.6 * self.area
        give = part**3 / (12.0 * bend) + part / shear
        slide, precession = np.array([-1, -part / 2, 1, -part / 2]), np.array([0, -1, 0, 1])
        element = np.outer(slide, slide) / give + np.outer(precession, precession) * bend / part
        K = np.zeros((2 * n + 2, 2 * n + 2))
        for i in range(n):
            K[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += element
        share = np.repeat(np.r_[np.ones(n - 1), 0.5], 2) * self.density * part
        return share * np.tile([self.area, self.second], n), K[2:, 2:]


def _line(n: int, mass: float, stiffness: float, length: float) -> tuple[np.ndarray, np.ndarray]:
    K = stiffness * n / length * (2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    K[-1, -1] /= 2.0
    return np.r_[np.ones(n - 1), 0.5] * mass * length / n, K


def chain_of_elements(
    mass: np.ndarray, stiffness: np.ndarray, damping: float, load: float
) -> tuple[Motion, Motion]:
    """Displacements and their rates (n, times) under a sudden load at the end, from rest.

    M q'' + K (q + damping q') = f by modes; a beam's load acts on the deflection of its last node.
    """
    scale = np.sqrt(mass)
    squares, modes = np.linalg.eigh(stiffness / np.outer(scale, scale))
    at = -1 if np.isclose(mass[-1], 0.5 * mass[0]) else -2
    shapes = modes / scale[:, None]
    pushed = shapes[at] * load
    sigma = 0.5 * damping * squares
    omega = np.sqrt(squares - sigma**2)

    def positions(t: np.ndarray) -> np.ndarray:
        left = np.cos(np.outer(omega, t)) + (sigma / omega)[:, None] * np.sin(np.outer(omega, t))
        left *= np.exp(-np.outer(sigma, t))
        return shapes @ ((pushed / squares)[:, None] * (1.0 - left))

    def rates(t: np.ndarray) -> np.ndarray:
        moves = np.exp(-np.outer(sigma, t)) * np.sin(np.outer(omega, t))
        return shapes @ ((pushed / omega)[:, None] * moves)

    return positions, rates


def rigid_bar(
    mass: float, length: float, speed: float, angle: float, stiffness: float, end: float
) -> list[tuple[str, str, float]]:
    """Channels, statistics and values of a bar that strikes a wall 1 m away with both its ends.

    Flights are exact; contacts by the classical Runge-Kutta method, whose steps leave 1e-11.
    """
    inertia, half = mass * length**2 / 12.0, 0.5 * length

    def depth(q: np.ndarray, end_of: float) -> float:
        return float(q[0] + end_of * half * np.cos(q[1]) - 1.0)

    def rates(y: np.ndarray, end_of: float) -> np.ndarray:
        push = stiffness * max(depth(y, end_of), 0.0) ** 1.5
        spin_rate = push * end_of * half * np.sin(y[1]) / inertia
        return np.array([y[2], y[3], -push / mass, spin_rate, push])

    # x, angle, their rates, and the impulse of the contact
    y, t, channels = np.array([-half * np.cos(angle), -angle, speed, 0.0, 0.0]), 0.0, []
    for name, side in (("node_1", 1.0), ("node_2", -1.0)):
        y[4] = 0.0
        fly = partial(_flown, y)
        h = _first(lambda s, fly=fly, side=side: depth(fly(s), side), end - t)
        y, gone, most = _touch(fly(h), partial(rates, end_of=side), partial(depth, end_of=side))
        t += h + gone
        channels += [
            (f"rcforc.{name}.peak_depth", "final", most),
            (f"rcforc.{name}.impulse.x", "final", -float(y[4])),
        ]
        if side > 0.0:
            channels.append(("rbdout.bar.velocity.x", "at:0.7", float(y[2])))
            channels.append(("rbdout.bar.angular_velocity.z", "at:0.7", float(y[3])))
    return [
        *channels,
        ("rbdout.bar.position.x", "final", float(y[0] + (end - t) * y[2])),
        ("rbdout.bar.velocity.x", "final", float(y[2])),
        ("rbdout.bar.angular_velocity.z", "final", float(y[3])),
    ]


def _flown(y: np.ndarray, h: float) -> np.ndarray:
    return np.concatenate([y[:2] + h * y[2:4], y[2:]])


def _first(f: Callable[[float], float], end: float) -> float:
    """The first time after which f is positive, to round-off."""
    grid = np.linspace(0.0, end, 4001)[1:]
    high = next(t for t in grid if f(t) > 0.0)
    low = high - grid[0]
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if f(middle) > 0.0 else (middle, high)
    return low


def _touch(
    y: np.ndarray,
    rates: Callable[[np.ndarray], np.ndarray],
    depth: Callable[[np.ndarray], float],
    steps: int = 4000,
) -> tuple[np.ndarray, float, float]:
    """State after a contact, its duration [s], and the largest depth [m]."""

    def step(y: np.ndarray, h: float) -> np.ndarray:
        a = rates(y)
        b = rates(y + 0.5 * h * a)
        c = rates(y + 0.5 * h * b)
        return y + h / 6.0 * (a + 2.0 * b + 2.0 * c + rates(y + h * c))

    def sinks(y: np.ndarray) -> float:
        return depth(y + 1e-9 * rates(y)) - depth(y - 1e-9 * rates(y))

    # contacts last a few milliseconds
    h, gone, most = 5e-3 / steps, 0.0, 0.0
    while True:
        new = step(y, h)
        if sinks(y) > 0.0 >= sinks(new):
            part = _first(lambda s, y=y: -sinks(step(y, s)), h)
            most = depth(step(y, part))
        if depth(new) < 0.0 < gone:
            part = _first(lambda s, y=y: -depth(step(y, s)), h)
            return step(y, part), gone + part, most
        y, gone = new, gone + h


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
