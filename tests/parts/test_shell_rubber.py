"""What neo-Hookean layers promise: the stress and the energy of their formula at any strain."""

from pathlib import Path

import numpy as np
import pytest
from quick import first_quick
from shells import SQUARE, Elements

from crashsolve.foundation.errors import DeckErrors

E, NU = 3.0, 0.4
G, L = E / (2 + 2 * NU), E * NU / ((1 + NU) * (1 - 2 * NU))
RUBBER = {"type": "neo_hookean", "young": E, "poisson": NU, "density": 1.0}
# where the deformation gradient of the plane goes: pulled, pressed, sheared, turned
F_END = {
    "pulled": [[2.0, 0.0], [0.0, 0.8]],
    "pressed": [[0.6, 0.0], [0.0, 0.9]],
    "sheared": [[1.0, 0.8], [0.0, 1.0]],
    "both": [[1.3, 0.5], [-0.4, 1.6]],
}


def cauchy(F: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Stress of the plane, energy per volume at the start, stretch across."""
    area, b = np.linalg.det(F), F @ F.T
    low, high = 1e-3, 1e3
    while high - low > 1e-15 * high:
        across = 0.5 * (low + high)
        if across in (low, high):
            break
        if G * (across**2 - 1) + L * np.log(area * across) > 0.0:
            high = across
        else:
            low = across
    J = area * across
    W = G / 2 * (np.trace(b) + across**2 - 3 - 2 * np.log(J)) + L / 2 * np.log(J) ** 2
    return G * (b - across**2 * np.eye(2)) / J, W, across


KINDS = pytest.mark.parametrize("kind", first_quick(["reduced", "fully_integrated", "triangles"]))


def sheet(folder: Path, kind: str) -> Elements:
    """A unit square, a quadrilateral or two triangles."""
    words = {"layers": 2, "thinning": True, "element": kind}
    return Elements(folder, SQUARE, 0.01, RUBBER, **words)


def taken(shell: Elements, F: np.ndarray, steps: int) -> np.ndarray:
    """Forces of the last step on a straight way of the nodes from the unit square to F."""
    start, step = np.array(SQUARE[0], float), (F - np.eye(2)) / steps
    motion = np.zeros((4, 6))
    motion[:, :2] = start @ step.T
    for k in range(steps):
        # nodes turn with the plane, or drilling would push as well
        rate = step @ np.linalg.inv(np.eye(2) + (k + 0.5) * step)
        motion[:, 5] = 0.5 * (rate[1, 0] - rate[0, 1])
        force = shell.move(motion)
    return force


@KINDS
@pytest.mark.parametrize("case", F_END)
def test_stress_and_energy_are_those_of_the_formula(tmp_path: Path, case: str, kind: str) -> None:
    F = np.array(F_END[case])
    shell = sheet(tmp_path, kind)
    force = taken(shell, F, 100)
    stress, energy, across = cauchy(F)
    t = 0.01 * across
    out = shell.energies()
    # strains of a step are up to 0.01, and their squares count
    assert out.strain == pytest.approx(0.01 * energy, rel=5e-4)
    assert shell.rows(0, 1)[0, 0] == pytest.approx(t, rel=5e-4)
    # nominal stress: columns are forces on the sides that were x = 1 and y = 1; the thickness that
    # they have is that before the step, up to 0.006 different
    P = t * np.linalg.det(F) * stress @ np.linalg.inv(F).T
    np.testing.assert_allclose(-force[[1, 2], :2].sum(0), P[:, 0], atol=1e-2 * np.abs(P).max())
    np.testing.assert_allclose(-force[[2, 3], :2].sum(0), P[:, 1], atol=1e-2 * np.abs(P).max())


@KINDS
def test_a_closed_path_costs_nothing(tmp_path: Path, kind: str) -> None:
    shell = sheet(tmp_path, kind)
    F = np.array(F_END["both"])
    there = np.zeros((4, 6))
    there[:, :2] = np.array(SQUARE[0], float) @ (F - np.eye(2)).T / 50
    for _ in range(50):
        most = np.abs(shell.move(there)).max()
    for _ in range(50):
        force = shell.move(-there)
    # strains of a step are 0.02: their squares
    assert np.abs(force).max() < 4e-4 * most


@KINDS
@pytest.mark.parametrize("case", ["stretched", "pulled", "both"])
def test_a_stretched_sheet_does_not_flutter(tmp_path: Path, case: str, kind: str) -> None:
    """Frequencies about a large strain are real, and below the bound."""
    shell = sheet(tmp_path, kind)
    taken(shell, np.array((F_END | {"stretched": [[1.6, 0.0], [0.0, 1.0]]})[case]), 50)
    reported, start, rest = float(shell.clock.element_rate), shell.points.copy(), shell.state.blocks
    rest, columns = rest.copy(), []
    for direction in np.eye(24):
        ends = []
        for size in (1e-8, -1e-8):
            ends.append(shell.move(size * direction.reshape(4, 6)).ravel())
            shell.points[:], shell.state.blocks[:] = start, rest
        columns.append((ends[1] - ends[0]) / 2e-8)
    K = np.array(columns).T
    inverse = np.repeat(np.stack([start.mass_inv, start.J_inv], axis=1), 3, axis=1).ravel()
    squared = np.linalg.eigvals(inverse[:, None] * K)
    assert np.abs(squared.imag).max() < 1e-4 * squared.real.max()
    assert squared.real.min() > -1e-4 * squared.real.max()
    assert squared.real.max() <= reported


def test_without_thinning_it_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors, match="must be true at large strain"):
        Elements(tmp_path, SQUARE, 0.01, RUBBER)
