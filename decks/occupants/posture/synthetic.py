"""Synthetic pictures of the occupant of shared/true.yaml: targets, calibration, frames.

python synthetic.py FOLDER     writes the three tables; the errors of images are drawn with seed 11
"""

import sys
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.scene import Scene
from crashsolve.photogrammetry.chain_fit import rotation, rotation_vector
from crashsolve.photogrammetry.tables import LANDMARKS, read_table

HERE = Path(__file__).resolve().parent
EYES = ([3.5, -3, 1.8], [3.6, 2.8, 1.2], [-2.6, 3, 2.4], [-2.8, -3.1, 1])
AT = np.array([0.2, 0.0, 0.6])
FOCAL = 1500.0  # pixels
START = 0.02  # [s] of shared/true.yaml
TIMES = (0.0, 0.02, 0.04)
# what two of the cameras do not see
HIDDEN = {("hand_left", 0), ("hand_left", 3), ("toe_right", 2), ("toe_right", 3)}

Array = np.ndarray


def image(eye: Any, x: Array) -> Array:
    """Images (n, 2) of points (n, 3) in a pinhole camera that looks at the occupant."""
    ahead = (AT - np.array(eye)) / np.linalg.norm(AT - np.array(eye))
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    in_camera = (x - np.array(eye)) @ np.array([right, np.cross(ahead, right), ahead]).T
    pixels: Array = FOCAL * in_camera[:, :2] / in_camera[:, 2:] + [960.0, 540.0]
    return pixels


def posture_at(time: float) -> dict[str, object]:
    """The card of shared/true.yaml, moved on to a time with constant rates."""
    card: dict[str, Any] = yaml.safe_load((HERE / "shared" / "true.yaml").read_text("utf-8"))
    card, dt = card["postures"]["posture"], time - START
    card["position"] = [x + dt * v for x, v in zip(card["position"], card["velocity"], strict=True)]
    card["rotation"] = _moved(card["rotation"], card["angular_velocity"], dt)
    for joint in card["joints"]:
        if "angle" in joint:
            joint["angle"] += dt * joint["rate"]
        else:
            joint["rotation"] = _moved(joint["rotation"], joint["angular_velocity"], dt)
    return card


def scene_at(time: float) -> Scene:
    """The occupant's bodies at a time, placed by the posture card of a deck."""
    deck = yaml.safe_load((HERE / "occupant.yaml").read_text("utf-8"))
    deck["postures"] = {"posture": posture_at(time)}
    path = HERE / f"posed_{time:g}.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    try:
        scene = Scene(read_deck(path))
        scene.raise_errors()
    finally:
        path.unlink()
    return scene


def landmarks_at(time: float) -> dict[str, Array]:
    """Positions of all landmarks in the world."""
    scene, positions = scene_at(time), {}
    for row in read_table(str(HERE / "landmarks.csv"), LANDMARKS):
        node = scene.node(row.names["body"].replace("<who>", "driver"))
        at = [row.numbers[axis] for axis in "xyz"]
        positions[row.names["point"]] = np.array(scene.world_point(node, at))
    return positions


def grid() -> Array:
    """Targets (18, 3) about the occupant."""
    return np.array(list(product((-0.9, 0.3, 1.3), (-0.8, 0.8), (0.0, 0.7, 1.6))))


def write(
    folder: Path, error: float, seed: int, points: dict[float, dict[str, Array]], targets: Array
) -> None:
    """Write the tables, with errors of images of that standard deviation [pixels]."""
    rng = np.random.default_rng(seed)
    digits = 2 if error else 12

    def pictures(x: Array, camera: int) -> list[str]:
        u = image(EYES[camera], x)
        u += error * rng.standard_normal(u.shape)
        return [f"{one[0]:.{digits}f},{one[1]:.{digits}f}" for one in u]

    lines = [f"t{i},{x:g},{y:g},{z:g}" for i, (x, y, z) in enumerate(targets)]
    _write(folder / "targets.csv", "target,x [m],y [m],z [m]", lines)
    lines = [f"{k},t{i},{u}" for k in range(len(EYES)) for i, u in enumerate(pictures(targets, k))]
    _write(folder / "calibration.csv", "camera,target,u,v", lines)
    lines = []
    for time, marks in points.items():
        for k in range(len(EYES)):
            image_points = zip(marks, pictures(np.array(list(marks.values())), k), strict=True)
            lines += [f"{time:g},{k},{p},{u}" for p, u in image_points if (p, k) not in HIDDEN]
    _write(folder / "frames.csv", "time [s],camera,point,u,v", lines)


def _write(path: Path, head: str, lines: list[str]) -> None:
    text = "\n".join(["# SYNTHETIC, by synthetic.py", head, *lines]) + "\n"
    path.write_text(text, "utf-8")


def _moved(card: dict[str, object], w: list[float], dt: float) -> dict[str, object]:
    """A rotation after a time at an angular velocity, in the axes in which it is given."""
    axis = np.array(card["axis"], float)
    old = rotation(axis / np.linalg.norm(axis) * card["angle"])
    vector = rotation_vector(rotation(np.array(w) * dt) @ old)
    angle = float(np.linalg.norm(vector))
    return {"axis": [float(value) for value in vector / angle], "angle": angle}


if __name__ == "__main__":
    write(Path(sys.argv[1]), 0.5, 11, {time: landmarks_at(time) for time in TIMES}, grid())
