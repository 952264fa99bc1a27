"""Broad phase: the few pairs of spheres that are near, out of very many.

Space is cut into cubes as wide as the largest distance at which two spheres count as near. Spheres
are sorted by cube; partners lie in the same cube or in one of its 26 neighbours. The cost is that
of the sort, n log n, as long as the largest sphere is not many times the common one.
Consequence to test: the same pairs as comparing all with all.
"""

from pathlib import Path

import numpy as np

from crashsolve.compiler.machine import machine_code
from crashsolve.compiler.table import Tables
from crashsolve.foundation.kernels import entry, kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, sub, vec

SPHERE = Record("""
    centre  m      3  of the sphere
    radius  m         of the sphere
    cube    count  3  cube in which its centre lies
""")
KEY = Record("""
    key     count  number of a cube
    sphere  index  a sphere in it
""")
PAIR = Record("""
    first   index  sphere
    second  index  sphere
""")
# cubes along one axis at most, so that the three numbers of a cube fit one integer
MAX_CUBES = 2_000_000
# number of the middle one of the 3 x 3 columns of cubes about a sphere
CENTRE_COLUMN = 4
# initial room for the pairs of a sphere
PAIRS_PER_SPHERE = 8


def near_pairs(
    centres: np.ndarray,
    radii: np.ndarray,
    margin: float,
    centres_b: np.ndarray | None = None,
    radii_b: np.ndarray | None = None,
) -> np.ndarray:
    """Pairs (m, 2) of spheres whose gap is below `margin` [m], in ascending order.

    Within one set each pair comes once, the lower index first; with a second set the pairs are
    (index in the first, index in the second).
    """
    same = centres_b is None or radii_b is None
    others = centres if centres_b is None else centres_b
    other_radii = radii if radii_b is None else radii_b
    if len(centres) == 0 or len(others) == 0:
        return np.zeros((0, 2), np.int64)
    low = np.minimum(centres.min(axis=0), others.min(axis=0))
    spread = np.maximum(centres.max(axis=0), others.max(axis=0)) - low
    reach = float(radii.max() + other_radii.max() + margin)
    width = max(reach, float(spread.max()) / MAX_CUBES)
    first, second = (
        _spheres(x, r, low, width) for x, r in ((centres, radii), (others, other_radii))
    )
    keys = np.zeros(len(second), KEY.dtype)
    keys["key"], keys["sphere"] = _keys(second["cube"]), np.arange(len(second))
    keys = keys[np.argsort(keys["key"], kind="stable")]
    tables = {"spheres": first, "others": second, "keys": keys, "count": np.zeros(1, np.int64)}
    pairs = _collect_pairs(tables, PAIRS_PER_SPHERE * len(first), margin, same)
    # one number per pair, which is sorted faster than two
    number = pairs["first"] * len(others) + pairs["second"]
    number.sort()
    return np.stack(np.divmod(number, len(others)), axis=1)


def _collect_pairs(
    tables: dict[str, np.ndarray], room: int, margin: float, same: bool
) -> np.ndarray:
    """Near pairs, in any order; repeated with more room where `room` is too small."""
    pairs = np.zeros(room, PAIR.dtype)
    all_tables = Tables(tables | {"pairs": pairs})
    machine_code(Path(__file__), "collect_pairs", all_tables)(margin, same, all_tables)
    count = int(tables["count"][0])
    return pairs[:count] if count <= room else _collect_pairs(tables, count, margin, same)


def _spheres(centres: np.ndarray, radii: np.ndarray, low: np.ndarray, width: float) -> np.ndarray:
    """Table of spheres; cubes count from 1, so that every neighbour is above 0."""
    spheres = np.zeros(len(centres), SPHERE.dtype)
    spheres["centre"], spheres["radius"] = centres, radii
    spheres["cube"] = np.asarray((centres - low) / width, np.int64) + 1
    return spheres


def _keys(cubes: np.ndarray) -> np.ndarray:
    """One number per cube; neighbours along the last axis are consecutive."""
    return (cubes[:, 0] << 42) + (cubes[:, 1] << 21) + cubes[:, 2]


@entry
def collect_pairs(margin, same, tables):
    """Count the near pairs; store them while there is room. Writes: count, pairs.

    Within one set, the spheres of a cube are compared with those of the cubes behind it.
    """
    spheres, others, keys, pairs = tables.spheres, tables.others, tables.keys, tables.pairs
    count = 0
    for i in range(spheres.shape[0]):
        s = spheres[i]
        for column in range(CENTRE_COLUMN if same else 0, 9):
            x, y, z = s.cube[0] + column // 3 - 1, s.cube[1] + column % 3 - 1, s.cube[2]
            # three cubes above one another are one run of keys
            middle = (x << 42) + (y << 21) + z
            is_own = same and column == CENTRE_COLUMN
            k = _first_at(keys, middle if is_own else middle - 1)
            while k < keys.shape[0] and keys[k].key <= middle + 1:
                j = keys[k].sphere
                k += 1
                if is_own and keys[k - 1].key == middle and j <= i:
                    continue
                near = s.radius + others[j].radius + margin
                offset = sub(vec(s.centre), vec(others[j].centre))
                if dot(offset, offset) < near * near:
                    if count < pairs.shape[0]:
                        pairs[count].first = min(i, j) if same else i
                        pairs[count].second = max(i, j) if same else j
                    count += 1
    tables.count[0] = count


@kernel
def _first_at(keys, value):
    """First position whose key is not below `value`, by bisection."""
    low, high = 0, keys.shape[0]
    while low < high:
        middle = (low + high) // 2
        if keys[middle].key < value:
            low = middle + 1
        else:
            high = middle
    return low
