"""Claim: the direct linear transformation gives published points and the covariance of errors."""

import numpy as np
import pytest
from quick import first_quick

from crashsolve.photogrammetry import dlt

# six points and their images in two cameras [mm, pixels]: notebook DLT.ipynb of demotu/BMC (dltx)
WORLD = [[0, 0, 2550], [0, 0, 0], [0, 2632, 0], [4500, 0, 2550], [5000, 0, 0], [5660, 2620, 0]]
FIRST = [[1810, 885], [1353, 786], [1362, 301], [455, 1010], [329, 832], [183, 180]]
SECOND = [[1734, 952], [1528, 768], [1546, 135], [115, 834], [459, 719], [358, 202]]
NORMALISED = [-0.131704156, 0.871539661, 2549.75288]
PLAIN = [-0.134202713, 0.868980291, 2549.74826]


def published(method: dlt.Method) -> tuple[np.ndarray, list[dlt.Camera]]:
    x = np.array(WORLD, float)
    images = np.array([FIRST, SECOND], float)
    cameras = [dlt.calibrate(x, u, method) for u in images]
    L = np.array([camera.L for camera in cameras])
    return np.array([dlt.reconstruct(L, images[:, i]) for i in range(6)]), cameras


def null_vector(L: np.ndarray, u: np.ndarray) -> np.ndarray:
    """A point (3,) as dltx finds it: the null vector of the homogeneous equations, in mm."""
    H = np.column_stack([L, np.ones(len(L))]).reshape(-1, 3, 4)
    rows = (H[:, :2] - u[:, :, None] * H[:, 2:]).reshape(-1, 4)
    x = np.linalg.svd(rows)[2][-1]
    position: np.ndarray = x[:3] / x[3]
    return position


def test_the_published_points_are_found() -> None:
    plain, _ = published("least_squares")
    L = np.array([camera.L for camera in published("normalised")[1]])
    normalised = null_vector(L, np.array([FIRST[0], SECOND[0]], float))
    # half a unit of the last digit that is published
    assert np.all(np.abs(plain[0] - PLAIN) <= [5.1e-10, 5.1e-10, 5.1e-6])
    assert np.all(np.abs(normalised - NORMALISED) <= [5.1e-10, 5.1e-10, 5.1e-6])


def test_the_published_residual_is_found() -> None:
    points, _ = published("least_squares")
    rms = np.sqrt(np.mean(np.sum((points - WORLD) ** 2, axis=1)))
    assert rms == pytest.approx(0.836626, abs=6e-7)  # half a unit of its last digit


def transformation(eye: np.ndarray, at: np.ndarray, focal: float) -> np.ndarray:
    """L (11,) of a pinhole at `eye` that looks at a point, its image centred at (960, 540)."""
    ahead = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    R = np.array([right, np.cross(ahead, right), ahead])
    K = np.array([[focal, 0.0, 960.0], [0.0, focal, 540.0], [0.0, 0.0, 1.0]])
    H = K @ np.column_stack([R, -R @ eye])
    parameters: np.ndarray = (H / H[2, 3]).ravel()[:11]
    return parameters


EYES = ([-2.5, -3, 1.8], [2.6, -2.8, 1.2], [3, 3, 2.4], [-2.8, 3.1, 1])
TRUE = [transformation(np.array(eye), np.array([0.1, 0.0, 0.5]), 1500.0) for eye in EYES]
CORNERS = np.array(
    [[x, y, z] for x in (-1, 0, 1) for y in (-1, 1) for z in (-0.4, 0.5, 1.7)], float
)
POINT = np.array([0.3, -0.2, 0.9])


@pytest.mark.parametrize("method", ["normalised", "least_squares"])
def test_without_noise_all_is_found(method: dlt.Method) -> None:
    L = [dlt.calibrate(CORNERS, dlt.image_of(one, CORNERS), method).L for one in TRUE]
    images = np.array([dlt.image_of(one, POINT) for one in TRUE])
    # round-off of images of a thousand units, enlarged by the condition of the equations
    np.testing.assert_allclose(L, TRUE, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(dlt.reconstruct(np.array(L), images), POINT, atol=1e-11)


@pytest.mark.parametrize("method", first_quick(["normalised", "least_squares"]))
@pytest.mark.parametrize("cameras", first_quick([2, 4]))
def test_errors_have_the_covariance_that_is_stated(method: dlt.Method, cameras: int) -> None:
    rng = np.random.default_rng(7)
    draws, error = 1000, 0.7
    squares, closures = np.zeros(draws), np.zeros(draws)
    for i in range(draws):
        seen = []
        for one in TRUE[:cameras]:
            noise = error * rng.standard_normal((len(CORNERS), 2))
            seen.append(dlt.calibrate(CORNERS, dlt.image_of(one, CORNERS) + noise, method))
        L = np.array([camera.L for camera in seen])
        u = np.array([dlt.image_of(one, POINT) for one in TRUE[:cameras]])
        u += error * rng.standard_normal(u.shape)
        x = dlt.reconstruct(L, u)
        by_images, by_cameras = dlt.sensitivities(L, x)
        spread = np.zeros((11 * cameras,) * 2)
        for k, camera in enumerate(seen):
            spread[11 * k : 11 * k + 11, 11 * k : 11 * k + 11] = camera.spread
        S = error**2 * (by_images @ by_images.T + by_cameras @ spread @ by_cameras.T)
        squares[i] = (x - POINT) @ np.linalg.solve(S, x - POINT)
        closures[i] = dlt.closure_of_point(L, u, x, spread) / error**2
    # means of chi-squared of n over the draws: n +- sqrt(2 n / draws), four of these and 3 % for
    # the second order in the noise, which the covariance leaves out
    for squares_of, n in ((squares, 3), (closures, 2 * cameras - 3)):
        assert abs(squares_of.mean() - n) < 4 * np.sqrt(2 * n / draws) + 0.03 * n
    # one in twenty is beyond the 95 % value of chi-squared of 3, within four standard deviations
    assert abs(np.mean(squares > 7.815) - 0.05) < 4 * np.sqrt(0.05 * 0.95 / draws)


def flattened(share: float) -> np.ndarray:
    """Targets of which a share of the extent along x is left."""
    x = CORNERS.copy()
    x[:, 0] *= share
    return x


NEAR = [EYES[0], [-2.5, -2.98, 1.8]]
# targets and positions of two cameras
DOUBTFUL = {
    "two metres deep": (CORNERS, EYES[:2]),
    "flat": (flattened(0.005), EYES[:2]),
    "flatter": (flattened(0.002), EYES[:2]),
    "cameras side by side": (CORNERS, NEAR),
}


@pytest.mark.parametrize("name", DOUBTFUL)
def test_errors_beyond_the_first_order_are_known_by_the_nonlinearity(name: str) -> None:
    """Where it is below a tenth the errors have the covariance stated, elsewhere perhaps not."""
    targets, eyes = DOUBTFUL[name]
    rng = np.random.default_rng(5)
    error, draws = 0.5, 100
    true = [transformation(np.array(eye), np.array([0.1, 0.0, 0.5]), 1500.0) for eye in eyes]
    squares, changes = np.zeros(draws), np.zeros(draws)
    for i in range(draws):
        cameras = [
            dlt.calibrate(targets, dlt.image_of(one, targets)
                          + error * rng.standard_normal((len(targets), 2)), "normalised")
            for one in true
        ]  # fmt: skip
        L = np.array([camera.L for camera in cameras])
        u = np.array([dlt.image_of(one, POINT) for one in true])
        x = dlt.reconstruct(L, u + error * rng.standard_normal(u.shape))
        spread = np.zeros((22, 22))
        spread[:11, :11], spread[11:, 11:] = cameras[0].spread, cameras[1].spread
        by_images, by_cameras = dlt.sensitivities(L, x)
        S = error**2 * (by_images @ by_images.T + by_cameras @ spread @ by_cameras.T)
        squares[i] = (x - POINT) @ np.linalg.solve(S, x - POINT)
        changes[i] = error * dlt.nonlinearity(L, x, spread)
    if name == "two metres deep":
        # chi-squared of 3 over the draws, within four standard deviations
        assert changes.max() < 0.1 and abs(squares.mean() - 3.0) < 4.0 * np.sqrt(6.0 / draws)
    else:
        assert changes.min() > 0.1
    if name == "flatter":
        # here the errors are more than twice those stated
        assert squares.mean() > 4 * 3.0


def test_the_nonlinearity_does_not_depend_on_the_origin_of_the_world() -> None:
    """Next to the plane of a camera all its L are large and uncertain, by a common factor."""
    eye = np.array(EYES[0])
    ahead = np.array([0.1, 0.0, 0.5]) - eye
    ahead /= np.linalg.norm(ahead)
    values = []
    for distance in (1.0, 1e-6):
        shift = (-eye @ ahead - distance) * ahead
        cameras = []
        for k, one in enumerate(TRUE[:2]):
            rng = np.random.default_rng(k)
            u = dlt.image_of(one, CORNERS) + 0.5 * rng.standard_normal((len(CORNERS), 2))
            cameras.append(dlt.calibrate(CORNERS + shift, u, "normalised"))
        spread = np.zeros((22, 22))
        spread[:11, :11], spread[11:, 11:] = cameras[0].spread, cameras[1].spread
        L = np.array([camera.L for camera in cameras])
        values.append(dlt.nonlinearity(L, POINT + shift, spread))
    # its covariance is of the first order, errors of images change w by some thousandths
    assert values[1] == pytest.approx(values[0], rel=0.01)


def test_coplanar_points_have_no_camera() -> None:
    flat = np.column_stack([CORNERS[:, :2], 0.2 + 0.3 * CORNERS[:, 0]])
    with pytest.raises(np.linalg.LinAlgError):
        dlt.calibrate(flat, dlt.image_of(TRUE[0], flat), "least_squares")
