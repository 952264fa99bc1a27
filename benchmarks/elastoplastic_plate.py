"""A thin elastoplastic plate under a step of pressure, by a sine series: no finite elements.

    python benchmarks/elastoplastic_plate.py [terms along a side]

    w = sum A_mn(t) sin(m pi x / a) sin(n pi y / a),   eps = -z grad grad w,   m, n odd
    rho t a^2 / 16 A_mn_ddot = load - int M : grad grad (sin sin)

Kirchhoff's plate without membrane forces, after Belytschko, Lin and Tsay (1984), in inches, pounds
and seconds; Gauss points in the plane and through the thickness; von Mises without hardening.
decks/verification/parts/shell_panel.yaml expects the plastic peak of small deflections.
"""

import sys

import numpy as np

E, NU, RHO, YIELD = 1e7, 0.3, 2.588e-4, 3e4
SIDE, THICKNESS, PRESSURE, END = 10.0, 0.5, 300.0, 1.2e-3
LAYERS = 8


def returned(s: np.ndarray) -> np.ndarray:
    """Stresses xx, yy, xy on or within the yield surface, by Newton's method for one number."""
    p, d, r = 0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1]), s[2]
    a, b = p * p, 3.0 * (d * d + r * r)
    c1, c2 = E / (3.0 - 3.0 * NU), E / (1.0 + NU)
    g = np.zeros_like(p)
    beyond = a + b > YIELD**2
    for _ in range(30):
        k1, k2 = 1.0 / (1.0 + c1 * g), 1.0 / (1.0 + c2 * g)
        gap = a * k1**2 + b * k2**2 - YIELD**2
        steep = 2.0 * c1 * a * k1**3 + 2.0 * c2 * b * k2**3
        g = np.where(beyond, g + gap / np.where(beyond, steep, 1.0), 0.0)
    p, d, r = p / (1.0 + c1 * g), d / (1.0 + c2 * g), r / (1.0 + c2 * g)
    return np.array([p + d, p - d, r])


def deflection(terms: int, is_plastic: bool) -> np.ndarray:
    """Deflection of the middle over time [in]."""
    k = np.arange(1, 2 * terms, 2) * np.pi / SIDE
    gauss, weight = np.polynomial.legendre.leggauss(terms + 6)
    x = np.concatenate([(gauss + 1.0) * SIDE / 8, (gauss + 3.0) * SIDE / 8])
    share = np.tile(weight * SIDE / 8, 2)
    sine, cosine = np.sin(np.outer(x, k)), np.cos(np.outer(x, k))
    z, depth = (0.5 * THICKNESS * values for values in np.polynomial.legendre.leggauss(LAYERS))
    bending = E * THICKNESS**3 / (12.0 - 12.0 * NU**2)
    mass = RHO * THICKNESS * SIDE**2 / 16.0
    load = PRESSURE * np.outer(share @ sine, share @ sine)
    fastest = 2.0 * k[-1] ** 2 * np.sqrt(bending / (RHO * THICKNESS))
    steps = int(END * fastest / 0.8) + 1
    h = END / steps
    A, speed, force = np.zeros((terms, terms)), np.zeros((terms, terms)), 0.5 * load
    s, deflections = np.zeros((3, len(x), len(x), LAYERS)), []
    xx, xy = np.broadcast_to(k[:, None] ** 2, A.shape), np.outer(k, k)
    for _ in range(steps):
        speed = speed + h / mass * force
        A = A + h * speed
        dA = h * speed
        e_x = (sine @ (dA * xx) @ sine.T)[..., None] * z
        e_y = (sine @ (dA * xx.T) @ sine.T)[..., None] * z
        e_xy = -2.0 * (cosine @ (dA * xy) @ cosine.T)[..., None] * z
        s[0] += E / (1.0 - NU**2) * (e_x + NU * e_y)
        s[1] += E / (1.0 - NU**2) * (e_y + NU * e_x)
        s[2] += E / (2.0 + 2.0 * NU) * e_xy
        if is_plastic:
            s = returned(s)
        M = np.outer(share, share) * (s @ (depth * z))
        held = sine.T @ M[0] @ sine * xx + sine.T @ M[1] @ sine * xx.T
        force = load - held + 2.0 * xy * (cosine.T @ M[2] @ cosine)
        middle = np.sin(0.5 * k * SIDE)
        deflections.append(middle @ A @ middle)
    return np.array(deflections)


def main(terms: int) -> None:
    """Print peaks and the residual."""
    for name in ("elastic", "plastic"):
        w = deflection(terms, name == "plastic")
        print(f"{name}: {terms} terms, peak {w.max():.4f} in, at 1.2 ms {w[-1]:.4f} in")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 6)
