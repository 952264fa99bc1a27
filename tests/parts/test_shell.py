"""What a shell element promises: patches, rigid motions, balance, energy, modes, honest step."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import yaml
from shells import KINDS, ODD, PATCH, SQUARE, STEEL, Elements, any_rotation

from crashsolve.deck.reading.deck import read_deck
from crashsolve.elements.shells.records import BLOCK
from crashsolve.model.build import build
from crashsolve.system.points import bound_rate

E, NU = STEEL["young"], STEEL["poisson"]
PLANE = E / (1 - NU**2) * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]])
MESHES = {"square": SQUARE, "odd": ODD, "patch": PATCH}
# out of its plane by a tenth of its side
WARPED = ([[0, 0, 0.1], [0.9, 0.1, -0.1], [1.2, 0.8, 0.1], [-0.2, 1.1, -0.1]], [[1, 2, 3, 4]])


@pytest.fixture(params=range(2))
def seed(request: pytest.FixtureRequest) -> int:
    return int(request.param)


@pytest.fixture(params=KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def inner(mesh: list, elements: Elements) -> list[int]:
    return [4, 5, 6, 7] if mesh is PATCH else []


def placed(mesh: tuple, rotation: np.ndarray) -> tuple:
    """The mesh somewhere else in space."""
    nodes = np.asarray(mesh[0], float)
    nodes = np.hstack([nodes, np.zeros((len(nodes), 3 - nodes.shape[1]))])
    return ((nodes @ rotation.T + [0.3, -0.2, 0.5]).tolist(), mesh[1])


def test_a_patch_holds_constant_strain_of_its_plane(tmp_path: Path, kind: str) -> None:
    patch = Elements(tmp_path, PATCH, 0.001, element=kind)
    x, y = patch.points.r[:, 0].copy(), patch.points.r[:, 1].copy()
    motion = np.zeros((8, 6))
    motion[:, 0], motion[:, 1] = 1e-6 * (x + y / 2), 1e-6 * (y + x / 2)
    force = patch.move(motion)
    normal, shear = (PLANE @ [1e-6, 1e-6, 1e-6])[1:]
    # whatever the axes of an element: mean stress, and radius of Mohr's circle
    for element in range(5):
        xx, yy, xy = patch.layers(element).T
        # strains are those of the middle of a step: relative 1e-6
        np.testing.assert_allclose(0.5 * (xx + yy), normal, rtol=2e-6)
        np.testing.assert_allclose(np.hypot(0.5 * (xx - yy), xy), shear, rtol=2e-6)
    np.testing.assert_allclose(force[4:], 0.0, atol=1e-5 * np.abs(force).max())


def test_a_patch_holds_constant_curvature_and_twist(tmp_path: Path, kind: str) -> None:
    patch = Elements(tmp_path, PATCH, 0.001, element=kind)
    x, y = patch.points.r[:, 0].copy(), patch.points.r[:, 1].copy()
    motion = np.zeros((8, 6))
    motion[:, 2] = 1e-6 * 0.5 * (x**2 + x * y + y**2)
    motion[:, 3], motion[:, 4] = 1e-6 * (y + x / 2), -1e-6 * (x + y / 2)
    force = patch.move(motion)
    edge = 0.12 * 0.001**3 / 12 * np.abs(PLANE @ [1e-6, 1e-6, 1e-6]).max()
    # slopes of 1e-7 stretch and turn the plane by their squares; what is left is round-off
    assert np.abs(force[4:, 2:5]).max() < 1e-6 * edge
    assert np.abs(force[:4, 3:]).max() > 0.1 * edge
    # the shear of a wrong slope would be 1e-7
    assert np.abs(patch.rows(BLOCK.shear, 2)).max() < 1e-12 * E


def test_rigid_motions_strain_nothing(tmp_path: Path, kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    shell = Elements(tmp_path, WARPED, element=kind)
    rest = shell.state.blocks.copy()
    for _ in range(3):
        shell.rotation(rng.normal(size=3), rng.normal(size=3), rng.normal(size=3))
    change = (shell.state.blocks - rest).reshape(-1, int(shell.p.stride) // 16, 16)[0, 6:, 0]
    # round-off of strains is 1e-16; a strain of 1 gives stresses of E
    assert np.abs(change).max() < 1e-13 * E


def test_a_strained_element_turns_its_forces_with_it(tmp_path: Path, kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    shell = Elements(tmp_path, WARPED, element=kind)
    before = shell.move(1e-2 * rng.normal(size=(4, 6)))
    R = shell.rotation(rng.normal(size=3), rng.normal(size=3), rng.normal(size=3))
    after = np.hstack([shell.points.force, shell.points.torque])
    expected = np.hstack([before[:, :3] @ R.T, before[:, 3:] @ R.T])
    np.testing.assert_allclose(after, expected, atol=1e-12 * np.abs(before).max())


def test_forces_and_moments_balance_also_when_warped(tmp_path: Path, kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    shell = Elements(tmp_path, placed(WARPED, any_rotation(seed)), element=kind)
    force = shell.move(0.05 * rng.normal(size=(4, 6)))
    size = np.abs(force).max()
    np.testing.assert_allclose(force[:, :3].sum(0), 0.0, atol=1e-14 * size)
    moment = np.cross(shell.points.r, force[:, :3]) + force[:, 3:]
    np.testing.assert_allclose(moment.sum(0), 0.0, atol=1e-14 * size)


@pytest.mark.parametrize("mesh", [SQUARE, ODD, WARPED], ids=["square", "odd", "warped"])
def test_only_rigid_and_some_drilling_motions_cost_nothing(
    tmp_path: Path, kind: str, mesh: tuple
) -> None:
    K = Elements(tmp_path, mesh, element=kind).stiffness()
    # steps of 1e-7: asymmetry of that order
    np.testing.assert_allclose(K, K.T, atol=1e-5 * np.abs(K).max())
    values = np.linalg.eigvalsh(0.5 * (K + K.T))
    softest = 0.05**3 * E * 0.002
    # six rigid ones, and spins of four nodes, of which every element ties the mean; of two
    # triangles with a fold between them, one bends where the other only spins
    free = 9 if kind != "triangles" else 6 if mesh is WARPED else 8
    # differences over 1e-7 of a length of 1
    assert (np.abs(values[:free]) < 1e-7 * values[-1]).all()
    assert (values[free:] > softest).all()


def test_the_work_of_the_nodes_is_stored(tmp_path: Path, kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    shell = Elements(tmp_path, ODD, element=kind)
    direction, work = rng.normal(size=(4, 6)), 0.0
    last = np.zeros((4, 6))
    for _ in range(20):
        force = shell.move(1e-5 * direction)
        work -= 0.5 * 1e-5 * (direction * (force + last)).sum()
        last = force
    out = shell.energies()
    # two by two points leave nothing to a stiffness of its own
    assert (out.hourglass > 0.0) == (kind == "reduced")
    # strains of 2e-4: energy of second order in them, error of third
    assert out.strain + out.hourglass + out.drilling == pytest.approx(work, rel=1e-3)


@pytest.mark.parametrize("thickness", [0.001, 0.05, 0.5])
def test_the_step_bounds_the_highest_frequency(
    tmp_path: Path, kind: str, seed: int, thickness: float
) -> None:
    rng = np.random.default_rng(seed)
    nodes = np.array(SQUARE[0]) * rng.uniform(0.2, 1.0, 2) + rng.uniform(-0.08, 0.08, (4, 2))
    if kind != "triangles":
        # warped by up to half its side
        nodes = np.column_stack([nodes, rng.uniform(-0.12, 0.12, 4)])
    shell = Elements(tmp_path, (nodes.tolist(), SQUARE[1]), thickness, element=kind)
    highest = highest_rate(shell)
    reported = float(shell.clock.element_rate)
    # that of a triangle is a sum: row sums of bending, and the trace of shear
    share = 0.4 if kind == "triangles" else 0.5
    assert share * reported < highest <= reported


def highest_rate(shell: Elements) -> float:
    """Largest squared frequency of free elements [1/s^2]."""
    K, points = shell.stiffness(), shell.points
    M = np.sqrt(np.column_stack([points.mass_inv] * 3 + [points.J_inv] * 3)).ravel()
    return float(np.linalg.eigvalsh(M[:, None] * 0.5 * (K + K.T) * M)[-1])


@pytest.mark.parametrize("thickness", [0.0005, 0.01])
def test_the_step_of_a_mesh_is_bounded_by_the_masses_of_its_nodes(
    tmp_path: Path, kind: str, thickness: float
) -> None:
    shell = Elements(tmp_path, PATCH, thickness, element=kind)
    highest = highest_rate(shell)
    shell.move(np.zeros((8, 6)))
    worst = float(shell.clock.element_rate)
    reported = 0.0
    for b in shell.points:
        reported = bound_rate(reported, b)
    # the element in the middle is the smallest; two of its nodes have more of others
    assert highest <= reported < 0.9 * worst


def test_turning_corners_of_a_warped_element_do_not_stretch_its_middle(
    tmp_path: Path, seed: int
) -> None:
    shell = Elements(tmp_path, WARPED, layers=2)
    spins = np.zeros((4, 6))
    spins[:, 3:] = 1e-3 * np.random.default_rng(seed).normal(size=(4, 3))
    shell.move(spins)
    stress = shell.layers()[:, :3]
    # bent about the middle: round-off is left of the mean
    assert np.abs(stress.mean(axis=0)).max() < 1e-12 * np.abs(stress).max()


def test_elastic_elements_of_one_and_of_four_points_are_the_same(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    one, four = (Elements(tmp_path, WARPED, element=kind) for kind in KINDS[:2])
    motion = 1e-7 * rng.normal(size=(4, 6))
    expected = one.move(motion)
    # the geometry of the end of the step and of its middle differ by 1e-7
    np.testing.assert_allclose(four.move(motion), expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("material", ["elastic", "elastoplastic"])
def test_a_shell_is_built_in_little_memory(tmp_path: Path, material: str) -> None:
    """Beside 42 numbers in blocks at most: corners twice, a point, and what pictures need."""
    card = {"type": material, "young": 2e11, "poisson": 0.3, "density": 8e3}
    card |= {"yield_stress": 2e8, "hardening": 1e9} if material == "elastoplastic" else {}
    part = {"type": "shell", "thickness": 1e-3, "material": "steel"}
    part["mesh"] = {"type": "grid", "along": [1, 0, 0], "across": [0, 1, 0], "elements": [160, 160]}
    deck = {"control": {"end_time": 1}, "materials": {"steel": card}, "parts": {"s": part}}
    path = tmp_path / "plate.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    read = read_deck(path)
    tracemalloc.start()
    model, _ = build(read)
    kept, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert model.elements is not None
    numbers = 42 if material == "elastoplastic" else 37
    # a tenth for the rows of the mesh's edge and the code of modules
    assert kept / 160**2 < 1.1 * (8 * numbers + 2 * 32 + 144 + 120)
    # of the way there remains little more than the end
    assert most < 1.2 * kept
