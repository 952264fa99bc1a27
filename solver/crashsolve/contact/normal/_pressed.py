"""Requirements on a curve of force over penetration with a separate curve of unloading."""

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.foundation.distinct import distinct


def check_pressed(curve: int, name: str, stiffness: float, scene: Scene) -> None:
    """Refuse a curve that does not start at (0, 0), pulls, or rises faster than it unloads."""
    points = scene.curve_points[curve : scene.curve_points[curve]["last"] + 1]
    if points["x"][0] != 0.0 or points["c"][0, 0] != 0.0:
        raise scene.fail(f"curve '{name}' must start at (0, 0)", "normal.curve")
    s = np.diff(points["x"])[:, None] * np.linspace(0.0, 1.0, 33)
    c0, c1, c2, c3 = points["c"][:-1].T[:, :, None]
    force, slope = c0 + s * (c1 + s * (c2 + s * c3)), c1 + s * (2.0 * c2 + 3.0 * s * c3)
    if force.min() < 0.0:
        raise scene.fail(
            f"curve '{name}' must not be negative: contact cannot pull", "normal.curve"
        )
    if slope.max() > stiffness * (1.0 + 1e-9):
        raise scene.fail(
            f"curve '{name}' rises by {slope.max():.6g} N/m, faster than it unloads; raise "
            "unloading_stiffness to that or more",
            "normal.unloading_stiffness",
        )


def check_below(lower: int, upper: int, name: str, scene: Scene) -> None:
    """Refuse an unloading curve that is not between 0 and the curve of loading, or ends early."""
    points = scene.curve_points
    parts = [points[k : points[k]["last"] + 1] for k in (lower, upper)]
    (x_u, u), (x_y, y) = (_samples(part) for part in parts)
    if x_u[-1] < x_y[-1]:
        raise scene.fail(
            f"curve '{name}' ends at {x_u[-1]:.6g} m, before that of loading at {x_y[-1]:.6g} m",
            "normal.unloading_curve",
        )
    x = distinct(np.concatenate([x_u, x_y[x_y <= x_u[-1]]]))
    x = x[x <= x_y[-1]]
    if (np.interp(x, x_u, u) > np.interp(x, x_y, y) * (1.0 + 1e-9)).any():
        raise scene.fail(
            f"curve '{name}' must stay below that of loading, or the contact gives energy",
            "normal.unloading_curve",
        )


def _samples(part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Abscissae and values of a curve, 33 to a segment."""
    s = np.diff(part["x"])[:, None] * np.linspace(0.0, 1.0, 33)
    c0, c1, c2, c3 = part["c"][:-1].T[:, :, None]
    return (part["x"][:-1, None] + s).ravel(), (c0 + s * (c1 + s * (c2 + s * c3))).ravel()
