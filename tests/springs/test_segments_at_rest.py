"""Claims of segments in quasi-static solutions: whole tangents, limit loads, Euler, elastica."""

from pathlib import Path

import numpy as np
import pytest
from bench import Bench, Law
from test_contract import ALL, CURVES

CASES = ("segment", "segment that yields")


def law_of(folder: Path, case: str) -> Law:
    law = Bench(folder, f"{CURVES}springs:\n  s: {ALL[case]}\n").law("springs", "s")
    law.p.at_rest = 1
    return law


def load(law: Law) -> np.ndarray:
    """Forces and torques on both bodies (12,)."""
    law.force(0.0)
    n = law.bench.nodes
    return np.concatenate([n.force[1], n.torque[1], n.force[2], n.torque[2]])


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("seed", range(3))
def test_forces_by_motions_are_their_derivatives(tmp_path: Path, case: str, seed: int) -> None:
    law = law_of(tmp_path, case)
    law.bench.shake(seed, speed=0.0)
    law.force(0.0)
    assert (law.new.strain > 0.0) == (case != "segment")
    args = (law.p.reshape(1), law.old.reshape(1), law.bench.nodes, law.bench.curves)
    forces = law.module.forces_by_motions(*args)[0]
    start, wanted, step = law.bench.state(), np.zeros((12, 12)), 1e-5
    for k, way_of in enumerate(np.eye(12)):
        for side in (1, -1):
            law.bench.nodes[:] = start
            for node in (1, 2):
                part = side * step * way_of[6 * node - 6 : 6 * node]
                law.bench.rotation(node, part[3:])
                law.bench.move(node, r=law.bench.nodes[node].r + part[:3])
            wanted[:, k] += side * load(law) / (2.0 * step)
    # third derivatives of some times the stiffness over the step, and round-off over it
    np.testing.assert_allclose(forces, wanted, rtol=0, atol=1e-7 * np.abs(wanted).max())
