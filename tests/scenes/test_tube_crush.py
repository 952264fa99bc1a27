"""Claims of the crushed tube: it meets its expectations, and no node comes near another wall."""

from itertools import combinations
from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from crashpost.cli import main as crashpost

DECK = Path(__file__).parents[2] / "decks" / "benchmark" / "tube_crush.yaml"
GAP = 1.5e-3
# a node meets no face with a corner nearer than so many gaps along the mesh (theory/contact.md)
OWN = 2.5
pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def folded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tube")
    # an estimate of errors would take two runs
    done = crashsolve(DECK, "-o", folder, "--set", "control.estimate=off")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "stable step of elements over that with contact" in done.stdout
    return folder


def test_the_tube_meets_its_expectations(folded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = crashpost(["expect", str(folded)])
    assert code == 0, capsys.readouterr().out


def test_every_node_keeps_its_distance_from_walls_not_its_own(folded: Path) -> None:
    with h5py.File(folded / "mesh.h5") as file:
        start, quads = file["part_tube/points"][:], file["part_tube/cells"][:]
    own, least = own_corners(start, quads), []
    for path in sorted((folded / "states").glob("*.h5"))[::4]:
        with h5py.File(path) as file:
            least.append(nearest(start + file["part_tube/displacement"][:], quads, own))
    # walls have met, and pressed by at most a twentieth of their thickness
    assert 0.95 * GAP < min(least) < GAP


def own_corners(x: np.ndarray, quads: np.ndarray) -> list[list[int]]:
    """The nodes near each node along sides and diagonals of the mesh, and the node itself."""
    ends = np.concatenate([quads[:, [a, b]] for a, b in combinations(range(4), 2)])
    lengths = np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1)
    # a side of two faces comes twice, once either way round
    sides = {(int(a), int(b)): s for (a, b), s in zip(np.sort(ends), lengths, strict=True)}
    graph = csr_array((list(sides.values()), np.array(list(sides)).T), shape=(len(x), len(x)))
    far = OWN * GAP
    return [
        np.flatnonzero(dijkstra(graph, directed=False, indices=n, limit=far) < far).tolist()
        for n in range(len(x))
    ]


def nearest(x: np.ndarray, quads: np.ndarray, own: list[list[int]]) -> float:
    """Least distance of a node from a face that is not its own, by numpy alone [m]."""
    middle = x[quads].mean(axis=1)
    reach = 2.0 * GAP + np.linalg.norm(x[quads] - middle[:, None], axis=2).max()
    least = np.inf
    for node, position in enumerate(x):
        near = np.linalg.norm(middle - position, axis=1) < reach
        near[near] = ~np.isin(quads[near], own[node]).any(axis=1)
        for k in range(4):
            ends = (x[quads[near, k]], x[quads[near, (k + 1) % 4]], middle[near])
            least = min(least, to_triangles(position, *ends).min(initial=np.inf))
    return float(least)


def to_triangles(x: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Distances of a position from triangles: of their planes inside, of their sides elsewhere."""
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    inside, sides = np.ones(len(a), bool), []
    for p, q in ((a, b), (b, c), (c, a)):
        along = q - p
        inside &= (np.cross(along, x - p) * normal).sum(axis=1) >= 0.0
        share = np.clip(((x - p) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
        sides.append(np.linalg.norm(x - p - share[:, None] * along, axis=1))
    height = np.abs(((x - a) * normal).sum(axis=1))
    return np.where(inside, height, np.min(sides, axis=0))
