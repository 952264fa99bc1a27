"""Close-ups below the pictures of a strip: details of a large scene, at the same moments.

`buffers` is a contact, body or part; `buffers:1 m` is as wide a window around it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from crashpost.errors import PostError, unknown
from crashpost.renders.camera import Camera
from crashpost.renders.drawing import Scene
from crashsolve.channels.display import factor, is_convertible

# width of a window, of the height of the model or of the picture's width, whichever is less
OF_HEIGHT, OF_WIDTH = 1.2, 0.25
ASPECT = 1.4


@dataclass(frozen=True)
class CloseUp:
    """Windows of one width around something, one for each picture."""

    name: str
    cameras: tuple[Camera, ...]
    # of the pictures in which the windows lie
    around: tuple[Camera, ...]

    @property
    def width(self) -> float:
        """Width of a window [m]."""
        return self.cameras[0].width

    def frame(self, picture: int) -> tuple[float, float, float, float]:
        """Left, bottom, width and height of a window, of the width and height of its picture."""
        around, own = self.around[picture], self.cameras[picture]
        x, y, _ = around.flat(own.middle[None])[0]
        width = own.width / around.width
        height = own.half_height / around.half_height
        left = 0.5 + x / around.width - 0.5 * width
        return left, 0.5 + 0.5 * y / around.half_height - 0.5 * height, width, height


def read(text: str) -> tuple[str, float]:
    """Object of a close-up, and the width of its window [m], 0 for a fitting one; or PostError."""
    name, colon, width = text.partition(":")
    if not colon:
        return name.strip(), 0.0
    digits, _, unit = width.strip().partition(" ")
    try:
        size = float(digits) * factor(unit.strip(), "m")
    except (ValueError, PostError):
        size = 0.0
    if not (is_convertible(unit.strip(), "m") and 0 < size < np.inf):
        raise PostError(f"close-up '{text}': write NAME or NAME:WIDTH, such as 'buffers:1 m'")
    return name.strip(), size


def close_up(
    scene: Scene, text: str, numbers: Sequence[float], around: Sequence[Camera]
) -> CloseUp:
    """The windows at some states; raises PostError for a name that does not exist."""
    name, width = read(text)
    fitted_camera = around[0]
    height = float(np.ptp(fitted_camera.flat(scene.extent(numbers[0]))[:, 1]))
    width = width or min(OF_HEIGHT * height or np.inf, OF_WIDTH * fitted_camera.width)
    middles = _positions(scene, name, numbers)
    half = 0.5 * width / ASPECT
    own = [
        replace(camera, middle=middle, half_height=half, aspect=ASPECT)
        for camera, middle in zip(around, middles, strict=True)
    ]
    return CloseUp(name, tuple(own), tuple(around))


def _positions(scene: Scene, name: str, numbers: Sequence[float]) -> list[np.ndarray]:
    """Positions of a contact, body or part at states; raises PostError."""
    states = scene.states
    contacts = states.names["contacts"]
    if name not in contacts:
        known = [*contacts, *states.names["bodies"][1:], *states.names["parts"]]
        if name not in known:
            raise unknown("contact, body or part", name, known)
        return [scene.position(number, name) for number in numbers]
    middles = [_acts_at(scene, contacts.index(name), int(number)) for number in numbers]
    touching = [k for k, middle in enumerate(middles) if middle is not None]
    if not touching:
        raise PostError(f"close-up '{name}': this contact touches at none of these moments")
    positions = []
    for k, number in enumerate(numbers):
        # before and after a touch the window moves with the body nearest to it
        at = min(touching, key=lambda t: abs(t - k))
        middle = middles[at]
        assert middle is not None
        positions.append(middle + _moved(scene, middle, (numbers[at], number)))
    return positions


def _moved(scene: Scene, point: np.ndarray, between: tuple[float, float]) -> np.ndarray:
    """Displacement of the mass centre nearest to a point, from the first state to the second
    [m].
    """
    if "mass_centres" not in scene.states.blocks:
        return np.zeros(3)
    before, after = (scene.positions(number, "mass_centres") for number in between)
    nearest = int(np.argmin(np.linalg.norm(before - point, axis=1)))
    moved: np.ndarray = after[nearest] - before[nearest]
    return moved


def _acts_at(scene: Scene, contact: int, number: int) -> np.ndarray | None:
    """The mean of a contact's points, by their forces; None where it has no force."""
    if "contacts" not in scene.states.blocks:
        return None
    read = scene.states.read(number, "contacts", "force", "contact")
    sizes = np.linalg.norm(read["force"].astype(float), axis=1)
    if "contact" in read:
        sizes[read["contact"].astype(int) != contact] = 0.0
    if not sizes.sum() > 0:
        return None
    points = scene.states.positions(number, "contacts")
    middle: np.ndarray = sizes @ points / sizes.sum()
    return middle
