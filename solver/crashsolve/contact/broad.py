"""Broad phase: the few pairs of spheres that are near, out of very many.

Space is cut into cubes as wide as the largest distance at which two spheres count as near. Spheres
are sorted by cube; partners lie in the same cube or in one of its 26 neighbours. The cost is that
of the sort, n log n, as long as the largest sphere is not many times the common one.
Consequence to test: the same pairs as comparing all with all.
"""

from typing import Any

import numpy as np

from crashsolve.foundation.compile import entry, kernel

# cubes along one axis at most, so that the three numbers of a cube fit one integer
WIDEST = 2_000_000


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
    width = max(reach, float(spread.max()) / WIDEST)
    cubes, other_cubes = (_cubes(x, low, width) for x in (centres, others))
    order = np.argsort(_keys(other_cubes), kind="stable")
    keys = _keys(other_cubes)[order]
    arrays = (centres, radii, cubes, others, other_radii, order, keys)
    pairs = np.zeros((_visit(*arrays, margin, same, np.zeros((0, 2), np.int64)), 2), np.int64)
    _visit(*arrays, margin, same, pairs)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def _cubes(centres: np.ndarray, low: np.ndarray, width: float) -> np.ndarray:
    """Cube of each centre; counting starts at 1, so that every neighbour is above 0."""
    return np.asarray((centres - low) / width, np.int64) + 1


def _keys(cubes: np.ndarray) -> Any:
    """One number per cube; neighbours along the last axis are consecutive."""
    return (cubes[:, 0] << 42) + (cubes[:, 1] << 21) + cubes[:, 2]


@entry
def _visit(centres, radii, cubes, others, other_radii, order, keys, margin, same, pairs):
    """Count the near pairs; note them while there is room. Writes: pairs."""
    count = 0
    for i in range(centres.shape[0]):
        for column in range(9):
            x, y, z = cubes[i, 0] + column // 3 - 1, cubes[i, 1] + column % 3 - 1, cubes[i, 2]
            # three cubes above one another are one run of keys
            first = (x << 42) + (y << 21) + z - 1
            k = _first_at(keys, first)
            while k < keys.shape[0] and keys[k] <= first + 2:
                j = order[k]
                k += 1
                if same and j <= i:
                    continue
                near = radii[i] + other_radii[j] + margin
                square = 0.0
                for axis in range(3):
                    square += (centres[i, axis] - others[j, axis]) ** 2
                if square < near * near:
                    if count < pairs.shape[0]:
                        pairs[count, 0] = i
                        pairs[count, 1] = j
                    count += 1
    return count


@kernel
def _first_at(keys, value):
    """First position whose key is not below `value`, by bisection."""
    low, high = 0, keys.shape[0]
    while low < high:
        middle = (low + high) // 2
        if keys[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low
