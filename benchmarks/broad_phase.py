"""Cost of finding the near pairs among N spheres, against N log N.

    python benchmarks/broad_phase.py [N ...]

Spheres of 50 mm lie at random where a share of 0.3 of the space is filled. Median CPU time of 9
searches; "growth" is the time over N log2 N, relative to the first line: budget 2.
"""

import sys
import time
from math import log2, pi
from statistics import median

import numpy as np

from crashsolve.contact.broad import near_pairs

RADIUS, MARGIN, FILLED, SEARCHES = 0.05, 0.025, 0.3, 9


def measure(count: int) -> tuple[int, float]:
    """Number of near pairs, and seconds of CPU time to find them."""
    side = (count * 4 / 3 * pi * RADIUS**3 / FILLED) ** (1 / 3)
    centres = np.random.default_rng(1).uniform(0.0, side, (count, 3))
    radii = np.full(count, RADIUS)
    near_pairs(centres, radii, MARGIN)
    costs = []
    for _ in range(SEARCHES):
        begun = time.process_time()
        pairs = near_pairs(centres, radii, MARGIN)
        costs.append(time.process_time() - begun)
    return len(pairs), median(costs)


def main() -> None:
    first = 0.0
    print(f"{'N':>7}{'pairs':>9}{'ms':>10}{'ns/N':>8}{'growth':>8}")
    for count in [int(word) for word in sys.argv[1:]] or [100, 1000, 10000]:
        pairs, cost = measure(count)
        share = cost / (count * log2(count))
        first = first or share
        row = f"{count:7d}{pairs:9d}{1e3 * cost:10.3f}{1e9 * cost / count:8.0f}{share / first:8.2f}"
        print(row, flush=True)


if __name__ == "__main__":
    main()
