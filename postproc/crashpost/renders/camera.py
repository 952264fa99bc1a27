"""Where one looks from: parallel views, so that lengths in a picture are true across it."""

from dataclasses import dataclass, replace

import numpy as np

from crashpost.errors import PostError, unknown

VIEWS = ("auto", "side", "front", "rear", "top", "bottom", "iso")
# a model this much thinner in one direction is viewed along it
THIN = 0.3
MARGIN = 0.04
# of a window on a single point [m]
LEAST = 1e-6
# radius of a mass centre, of half the height of the picture, less where that is narrow
DOT, SLIM = 0.026, 1.4


@dataclass(frozen=True)
class Camera:
    """Axes of the picture in space: right, up and towards the eye; its middle and half height."""

    right: np.ndarray
    up: np.ndarray
    towards: np.ndarray
    middle: np.ndarray
    half_height: float = 1.0
    aspect: float = 1.6  # width over height

    def flat(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 3) in the picture: right and up [m] from its middle, and towards the eye."""
        flattened: np.ndarray = (points - self.middle) @ np.column_stack(
            [self.right, self.up, self.towards]
        )
        return flattened

    @property
    def dot(self) -> float:
        """Radius of a ball that stands for a mass centre [m]."""
        return DOT * self.half_height * min(1.0, SLIM * self.aspect)

    @property
    def width(self) -> float:
        """Width of the picture [m]."""
        return 2.0 * self.half_height * self.aspect


def camera(view: str, world_up: np.ndarray, low: np.ndarray, high: np.ndarray) -> Camera:
    """A camera for a view by name, or from a direction such as `1,-1,0.5`; raises PostError."""
    up = world_up / np.linalg.norm(world_up)
    ahead = np.eye(3)[0] if abs(up[0]) < 0.7 else np.eye(3)[2]
    ahead = _unit(ahead - up * (ahead @ up))
    near = np.cross(ahead, up)
    if view == "auto":
        view = _thinnest(np.abs(np.array([near, up, ahead])) @ (high - low))
    eyes = {
        "side": near,
        "front": ahead,
        "rear": -ahead,
        "top": up,
        "bottom": -up,
        "iso": _unit(0.55 * ahead + near + 0.5 * up),
    }
    towards = eyes[view] if view in eyes else _direction(view)
    # looking along the vertical, forward is to the right
    vertical = up if abs(towards @ up) < 0.999 else np.sign(towards @ up) * -near
    right = _unit(np.cross(vertical, towards))
    return Camera(right, np.cross(towards, right), towards, 0.5 * (low + high))


def fitted(fitted_camera: Camera, points: np.ndarray, narrow: float, wide: float) -> Camera:
    """The camera with all points (n, 3) in its picture, as wide as they ask within limits."""
    flat = fitted_camera.flat(points)
    low, high = flat.min(axis=0), flat.max(axis=0)
    size = np.maximum((high - low)[:2], LEAST)
    width, height = (1.0 + 2.0 * MARGIN) * size + MARGIN * float(size.max())
    aspect = float(np.clip(width / height, narrow, wide))
    middle = fitted_camera.middle + np.array(
        [fitted_camera.right, fitted_camera.up, fitted_camera.towards]
    ).T @ (0.5 * (low + high))
    half = 0.5 * max(height, width / aspect)
    return replace(fitted_camera, middle=middle, half_height=float(half), aspect=aspect)


def _thinnest(depths: np.ndarray) -> str:
    """The view along the direction in which a model is thin; from above a corner without one."""
    order = np.argsort(depths, kind="stable")
    if depths[order[0]] <= THIN * depths[order[2]]:
        return ("side", "top", "front")[int(order[0])]
    return "iso"


def _direction(view: str) -> np.ndarray:
    try:
        towards = np.array([float(part) for part in view.split(",")])
    except ValueError:
        raise unknown("view", view, [*VIEWS, "1,-1,0.5"]) from None
    if towards.shape != (3,) or not np.all(np.isfinite(towards)) or not np.any(towards):
        raise PostError(f"view '{view}' must be three numbers, the direction towards the eye")
    return _unit(towards)


def _unit(vector: np.ndarray) -> np.ndarray:
    unit_vector: np.ndarray = vector / np.linalg.norm(vector)
    return unit_vector


def round_length(width: float) -> float:
    """A round length of 1, 2 or 5 times a power of ten, at most a third of a width [m]."""
    power = 10.0 ** np.floor(np.log10(width / 3.0))
    return float(max(s * power for s in (1.0, 2.0, 5.0) if s * power <= width / 3.0))


def outermost(points: np.ndarray) -> np.ndarray:
    """The points that reach furthest in 26 directions: enough to fit a picture around them."""
    steps = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)], float)
    steps = steps[np.any(steps, axis=1)]
    extreme_points: np.ndarray = points[np.unique((points @ steps.T).argmax(axis=0))]
    return extreme_points
