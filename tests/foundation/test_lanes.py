"""Claim: compiled, points go to lanes and back as one number at a time does it in plain Python."""

from pathlib import Path

import numpy as np

from crashsolve.compiler.machine import machine_code
from crashsolve.compiler.table import Tables
from crashsolve.foundation.kernels import entry
from crashsolve.foundation.lanes import add_forces, gather_motion
from crashsolve.foundation.point import LANES, POINT


@entry
def there_and_back(number, flag, scene):
    """All corners of a block of 13 elements, which share points."""
    for c in range(4):
        for e in range(0, 16, 8):
            at = LANES * 3 * c + e
            gather_motion(scene.points, scene.corners, LANES * c + e, scene.lanes, at)
    for c in range(4):
        for e in range(0, 16, 8):
            at = LANES * 3 * c + e
            loads = LANES * 38 + e
            add_forces(scene.points, scene.corners, LANES * c + e, scene.lanes, at, loads, 13 - e)


def arrays() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(2)
    points = np.zeros(20, POINT.dtype)
    for name in ("r", "v", "w", "force", "torque"):
        points[name] = rng.normal(size=(20, 3))
    points["load"], points["spin_load"] = rng.normal(size=(2, 20))
    corners, lanes = rng.integers(0, 20, 4 * LANES).astype(np.int32), np.zeros(40 * LANES)
    lanes[38 * LANES :] = rng.normal(size=2 * LANES)
    return {"points": points, "corners": corners, "lanes": lanes}


def test_points_go_to_lanes_and_back() -> None:
    compiled, plain, before = arrays(), arrays(), arrays()
    tables = Tables(compiled)
    machine_code(Path(__file__), "there_and_back", tables)(0.0, False, tables)
    there_and_back(0.0, False, Tables(plain))
    for name in plain:
        assert compiled[name].tobytes() == plain[name].tobytes(), name
    # place, velocity and spin of the last corner of the tenth element, and two rows left alone
    point = plain["points"][plain["corners"][3 * LANES + 9]]
    rows = plain["lanes"].reshape(-1, LANES)[:, 9]
    for row, name in ((9, "r"), (21, "v"), (33, "w")):
        assert (rows[row : row + 3] == point[name]).all()
    assert (rows[36:38] == 0.0).all()
    # what 13 elements share out
    for name, row in (("load", 38), ("spin_load", 39)):
        shares = before["lanes"].reshape(-1, LANES)[row, :13]
        total = before["points"][name].sum() + 4.0 * shares.sum()
        assert abs(plain["points"][name].sum() - total) < 1e-13 * LANES
