"""Mass, inertia, place and configuration of a rigid body, from the words of its card."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.orientation import matrix
from crashsolve.model.build import build

# half sizes of a box around each solid, and which of its points are inside
SOLIDS: dict[str, Any] = {
    "{shape: sphere, radius: 0.3, density: 1}": (
        [0.3, 0.3, 0.3],
        lambda x, y, z: x**2 + y**2 + z**2 < 0.09,
    ),
    "{shape: box, size: [0.2, 0.4, 0.6], density: 1}": ([0.1, 0.2, 0.3], lambda x, y, z: x == x),
    "{shape: cylinder, radius: 0.2, length: 0.8, density: 1}": (
        [0.2, 0.2, 0.4],
        lambda x, y, z: x**2 + y**2 < 0.04,
    ),
}
CELLS = 100


def node(folder: Path, card: str) -> Any:
    """Row of the only body in the node table, at the start."""
    path = folder / "deck.yaml"
    path.write_text(f"control: {{end_time: 1}}\nbodies:\n  b: {{{card}}}\n", "utf-8")
    _, state = build(read_deck(path))
    return state.nodes.view(np.recarray)[1]


@pytest.mark.parametrize("solid", SOLIDS)
def test_mass_and_inertia_of_a_solid_are_its_integrals(tmp_path: Path, solid: str) -> None:
    half, inside = SOLIDS[solid]
    middle = (np.arange(CELLS) + 0.5) / CELLS * 2.0 - 1.0
    points = np.stack(np.meshgrid(*(h * middle for h in half), indexing="ij")).reshape(3, -1)
    points = points[:, inside(*points)]
    volume = points.shape[1] * np.prod(np.array(half) * 2.0 / CELLS)
    square = (points**2).mean(axis=1)
    moments = square.sum() - square
    b = node(tmp_path, f"primitive: {solid}")
    # cells cut by the surface: one in a hundred along each axis, half of them inside
    assert 1.0 / b.mass_inv == pytest.approx(volume, rel=2e-3)
    np.testing.assert_allclose(np.diag(b.J.reshape(3, 3)) * b.mass_inv, moments, rtol=2e-3)


def test_a_rod_rotates_about_its_middle_and_hardly_about_itself(tmp_path: Path) -> None:
    b = node(tmp_path, "mass: 3, primitive: {shape: rod, length: 2}")
    np.testing.assert_allclose(np.diag(b.J.reshape(3, 3)), [1.0, 1.0, 1e-6])


def test_products_are_elements_of_the_tensor(tmp_path: Path) -> None:
    b = node(tmp_path, "mass: 1, inertia: [5, 6, 7], products: [0.1, -0.2, 0.3]")
    expected = [[5, 0.1, -0.2], [0.1, 6, 0.3], [-0.2, 0.3, 7]]
    np.testing.assert_array_equal(b.J.reshape(3, 3), expected)


@pytest.mark.parametrize("inertia", ["[1, 1, 3]", "[0, 1, 1]", "[1, 1, -1]"])
def test_moments_of_no_solid_are_refused(tmp_path: Path, inertia: str) -> None:
    with pytest.raises(DeckErrors, match="no solid has these moments of inertia"):
        node(tmp_path, f"mass: 1, inertia: {inertia}")


def test_position_and_velocity_are_those_of_the_origin(tmp_path: Path) -> None:
    rotation = "rotation: {axis: [0, 0, 1], angle: 90 deg}, angular_velocity: [0, 0, 2]"
    start = "position: [1, 2, 3], velocity: [4, 5, 6], mass_centre: [0.5, 0, 0]"
    b = node(tmp_path, f"mass: 1, inertia: [1, 1, 1], {start}, {rotation}")
    np.testing.assert_allclose(b.r, [1.0, 2.5, 3.0], atol=1e-15)
    np.testing.assert_allclose(b.v, [4.0 - 2.0 * 0.5, 5.0, 6.0], atol=1e-15)


def test_spin_may_be_given_in_body_axes(tmp_path: Path) -> None:
    rotation = "rotation: {axis: [0, 0, 1], angle: 90 deg}, angular_velocity_axes: body"
    b = node(tmp_path, f"mass: 1, inertia: [1, 2, 3], {rotation}, angular_velocity: [1, 0, 0]")
    np.testing.assert_allclose(b.w, [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(b.L, [0, 1, 0], atol=1e-15)


@pytest.mark.parametrize("sequence", ["xyz", "zxz", "yzx"])
def test_euler_angles_turn_about_the_bodys_own_axes_in_order(tmp_path: Path, sequence: str) -> None:
    angles = [0.3, -1.1, 2.0]
    card = f"rotation: {{euler: {angles}, sequence: {sequence}}}"
    b = node(tmp_path, f"mass: 1, inertia: [1, 1, 1], {card}")
    expected = np.eye(3)
    for letter, angle in zip(sequence, angles, strict=True):
        axis = np.array([float(letter == name) for name in "xyz"])
        quaternion = np.array([np.cos(angle / 2), *(np.sin(angle / 2) * axis)])
        expected = expected @ matrix(quaternion)
    np.testing.assert_allclose(b.A.reshape(3, 3), expected, atol=1e-15)
