"""Points of every frame from their images, with residuals and one covariance for all of a frame.

Images have errors of one variance s^2, the same for targets and points. Of a point seen by k
cameras 2k - 3 of its equations are left over: their misclosure c, with the covariance S that images
and cameras give it, shows by c S^-1 c, chi-squared of 2k - 3, whether the images are consistent.
All of them, and those of the targets, estimate s where it is not given.
"""

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.photogrammetry import dlt
from crashsolve.photogrammetry.request import Requested
from crashsolve.photogrammetry.tables import CALIBRATION, FRAMES, TARGETS, Row, read_table

Array = np.ndarray
# as flat as this, targets lie in a plane
FLAT = 1e-3
# [image units] less than any reading of a picture
EXACT = 1e-9
DIRECTIONS = "two cameras must see it from different directions"
# points of a body are read less exactly than targets, by several times and not by this
COARSER = 10.0
# relative change of the equations of a point by errors of images up to which its covariance, of
# first order, is that of its errors: at 0.1 their squares are at most a third larger than stated,
# at 0.3 ten times (near-planar targets, cameras in nearly one position, noise)
LINEAR = 0.1
# images that belong together do so but once in a million times
IMPROBABLE = 1e-6


@dataclass(frozen=True)
class Point:
    """A reconstructed point. `noise` and `by_cameras` are for images of unit variance."""

    name: str
    x: Array  # (3,)
    noise: Array  # (3, 3) covariance by its own images
    by_cameras: Array  # (3, 11 n) how it moves with the L of all n cameras
    residuals: Array  # (k, 2) in the images
    closure: float  # chi-squared of 2k - 3
    nonlinearity: float  # for images of unit standard deviation
    rows: tuple[Row, ...]

    @property
    def freedom(self) -> int:
        """Equations left over."""
        return 2 * len(self.rows) - 3


@dataclass(frozen=True)
class Frame:
    """The points of a moment, in their order, with their covariance (3n, 3n)."""

    time: float
    points: tuple[Point, ...]
    covariance: Array

    def deviations(self) -> Array:
        """Standard deviations (n, 3)."""
        sigma: Array = np.sqrt(np.diag(self.covariance)).reshape(-1, 3)
        return sigma


@dataclass(frozen=True)
class Measured:
    """Cameras, frames, and the standard deviation of images with the equations it rests on."""

    cameras: dict[str, dlt.Camera]
    frames: tuple[Frame, ...]
    image_error: float
    freedom: int


def measured(requested: Requested) -> Measured:
    """All that the pictures say. Raises DeckErrors."""
    cameras, closures = _cameras(requested)
    spread = _all_spreads(cameras)
    times: dict[float, dict[str, list[Row]]] = defaultdict(lambda: defaultdict(list))
    for row in _rows_of_frames(requested, cameras):
        times[row.numbers["time"]][row.names["point"]].append(row)
    volume = _extent(read_table(requested.card.targets, TARGETS))
    points_of = {
        time: [_point(requested, name, rows, cameras, spread) for name, rows in points.items()]
        for time, points in sorted(times.items())
    }
    closures += [(p.closure, p.freedom) for points in points_of.values() for p in points]
    freedom = sum(count for _, count in closures)
    error = requested.card.image_error
    if error is None:
        error = float(np.sqrt(sum(chi for chi, _ in closures) / freedom))
        if error < EXACT:
            message = "images without errors do not say how large their errors are"
            raise DeckErrors([requested.error((), message, "give image_error")])
    _check_cameras(requested, cameras, closures)
    _check_pictures(requested, closures[: len(cameras)], closures[len(cameras) :])
    frames = tuple(_frame(t, tuple(points), spread, error) for t, points in points_of.items())
    _check(requested, frames, error, volume)
    return Measured(cameras, frames, error, freedom)


def _cameras(requested: Requested) -> tuple[dict[str, dlt.Camera], list[tuple[float, int]]]:
    """Calibrated cameras, and for each the chi-squared of its targets and their freedom."""
    path = requested.card.calibration
    targets = {row.names["target"]: row for row in read_table(requested.card.targets, TARGETS)}
    rows_of: dict[str, list[Row]] = defaultdict(list)
    errors: list[DeckError] = []
    for row in read_table(path, CALIBRATION):
        if row.names["target"] not in targets:
            message = f"there is no target '{row.names['target']}' in {requested.card.targets}"
            errors.append(DeckError(path, row.line, None, row.names["camera"], message))
        rows_of[row.names["camera"]].append(row)
    if errors:
        raise DeckErrors(errors)
    cameras, closures = {}, []
    for name, rows in rows_of.items():
        x = np.array([_numbers(targets[row.names["target"]], "xyz") for row in rows])
        u = np.array([_numbers(row, "uv") for row in rows])
        try:
            cameras[name] = _calibrated(x, u, requested)
            closures.append((cameras[name].closure, 2 * len(x) - dlt.UNKNOWNS))
        except np.linalg.LinAlgError as error:
            errors.append(DeckError(path, rows[0].line, None, f"camera '{name}'", str(error)))
    if errors:
        raise DeckErrors(errors)
    return cameras, closures


def _calibrated(x: Array, u: Array, requested: Requested) -> dlt.Camera:
    count = len(np.unique(x, axis=0))
    if count < dlt.FEWEST:
        message = f"sees {count} targets; {dlt.FEWEST} that are not in one plane are needed"
        raise np.linalg.LinAlgError(message)
    if dlt.flatness(x) < FLAT:
        message = (
            f"its {len(x)} targets lie in a plane within {dlt.flatness(x):.1g} of their extent; "
            f"{dlt.FEWEST} that are not in one plane are needed"
        )
        raise np.linalg.LinAlgError(message)
    return dlt.calibrate(x, u, requested.card.method)


def _rows_of_frames(requested: Requested, cameras: dict[str, dlt.Camera]) -> list[Row]:
    """Rows of the digitised points. Raises DeckErrors for unknown cameras and lonely points."""
    path = requested.card.frames
    rows = read_table(path, FRAMES)
    rows_of: dict[tuple[float, str], list[Row]] = defaultdict(list)
    errors = []
    for row in rows:
        rows_of[row.numbers["time"], row.names["point"]].append(row)
        if row.names["camera"] not in cameras:
            message = f"camera '{row.names['camera']}' is not calibrated"
            advice = f"there are {', '.join(cameras)}"
            errors.append(DeckError(path, row.line, None, row.names["point"], message, advice))
    for (time, name), own in rows_of.items():
        if len(own) < 2:
            message = f"is seen by one camera, '{own[0].names['camera']}', at {time:.6g} s; "
            message += "2 are needed"
            advice = "leave the row out where the point is hidden"
            errors.append(DeckError(path, own[0].line, None, f"point '{name}'", message, advice))
    if errors:
        raise DeckErrors(sorted(errors, key=lambda error: error.line or 0))
    return rows


def _point(
    requested: Requested, name: str, rows: list[Row], cameras: dict[str, dlt.Camera], spread: Array
) -> Point:
    order = list(cameras)
    at = [order.index(row.names["camera"]) for row in rows]
    L = np.array([cameras[order[i]].L for i in at])
    u = np.array([_numbers(row, "uv") for row in rows])
    try:
        x = dlt.reconstruct(L, u)
    except np.linalg.LinAlgError as error:
        what = f"point '{name}' at {rows[0].numbers['time']:.6g} s"
        path, line = requested.card.frames, rows[0].line
        raise DeckErrors([DeckError(path, line, None, what, str(error), DIRECTIONS)]) from None
    images = np.array([dlt.image_of(one, x) for one in L])
    by_images, by_own = dlt.sensitivities(L, x)
    by_cameras = np.zeros((3, dlt.UNKNOWNS * len(order)))
    columns = np.concatenate([dlt.UNKNOWNS * i + np.arange(dlt.UNKNOWNS) for i in at])
    by_cameras[:, columns] = by_own
    own = spread[np.ix_(columns, columns)]
    closure, nonlinearity = dlt.closure_of_point(L, u, x, own), dlt.nonlinearity(L, x, own)
    noise = by_images @ by_images.T
    return Point(name, x, noise, by_cameras, u - images, closure, nonlinearity, tuple(rows))


def _frame(time: float, points: tuple[Point, ...], spread: Array, error: float) -> Frame:
    by_cameras = np.concatenate([point.by_cameras for point in points])
    covariance = by_cameras @ spread @ by_cameras.T
    for i, point in enumerate(points):
        covariance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] += point.noise
    return Frame(time, points, error**2 * covariance)


def _check_cameras(
    requested: Requested, cameras: dict[str, dlt.Camera], closures: list[tuple[float, int]]
) -> None:
    """Refuse cameras whose targets contradict each other. Raises DeckErrors.

    `closures` begins with those of the cameras.
    """
    path, errors = requested.card.calibration, []
    rows = read_table(path, CALIBRATION)
    for i, (name, camera) in enumerate(cameras.items()):
        error, chance = _by_chance(closures, i, requested.card.image_error)
        if chance >= IMPROBABLE:
            continue
        sizes = np.linalg.norm(camera.residuals, axis=1)
        worst = int(np.argmax(sizes))
        row = [row for row in rows if row.names["camera"] == name][worst]
        problem = (
            f"its targets contradict each other: '{row.names['target']}' is {sizes[worst]:.3g} "
            f"from where it would be seen, and the error of images is {error:.3g}"
        )
        advice = (
            "look for targets taken for others and wrong coordinates; images of a finer camera "
            "need a unit in which the errors of all are alike"
        )
        errors.append(DeckError(path, row.line, None, f"camera '{name}'", problem, advice))
    if errors:
        raise DeckErrors(errors)


def _check_pictures(
    requested: Requested, of_targets: list[tuple[float, int]], of_points: list[tuple[float, int]]
) -> None:
    """Refuse cameras that agree on their own targets and not on points. Raises DeckErrors."""
    if requested.card.image_error is not None:
        return
    own, left = sum(one for one, _ in of_targets), sum(count for _, count in of_targets)
    chi, freedom = sum(one for one, _ in of_points), sum(count for _, count in of_points)
    targets, points = float(np.sqrt(own / left)), float(np.sqrt(chi / freedom))
    chance = _by_chance([(chi, freedom), (own, left)], 0, None)[1]
    if points > COARSER * targets and chance < IMPROBABLE:
        problem = f"images of points contradict each other by {points:.3g}, those of targets by "
        advice = "look for exchanged cameras, a reversed axis of images, pictures of another size"
        path = requested.card.frames
        raise DeckErrors([DeckError(path, None, None, "", f"{problem}{targets:.3g}", advice)])


def _by_chance(
    closures: list[tuple[float, int]], i: int, given: float | None
) -> tuple[float, float]:
    """Error of images [image units], and the chance that the i-th closure is as large or larger.

    By chi-squared where the error is given, else by Fisher's F against all other equations.
    """
    from scipy.stats import chi2, f

    chi, freedom = closures[i]
    if given is not None:
        return given, float(chi2.sf(chi / given**2, freedom))
    others = sum(one for one, _ in closures) - chi
    left = sum(count for _, count in closures) - freedom
    error = max(float(np.sqrt(others / left)), EXACT)
    return error, float(f.sf(chi / freedom / error**2, freedom, left))


def _check(requested: Requested, frames: tuple[Frame, ...], error: float, volume: float) -> None:
    """Refuse points whose images do not belong together, or that hardly determine a position."""
    from scipy.stats import chi2

    errors = []
    for frame in frames:
        for point, deviation in zip(frame.points, frame.deviations(), strict=True):
            row, problem, advice = point.rows[0], "", ""
            if error > 0.0 and chi2.sf(point.closure / error**2, point.freedom) < IMPROBABLE:
                worst = int(np.argmax(np.abs(point.residuals).max(axis=1)))
                row = point.rows[worst]
                size = float(np.linalg.norm(point.residuals[worst]))
                problem = f"its images contradict each other: {size:.3g} from where camera "
                problem += f"'{row.names['camera']}' would see it, and the error of images is "
                problem += f"{error:.3g}"
                advice = "look for a point that was confused with another"
            elif not deviation.max() < volume:
                problem = f"its position is uncertain by {deviation.max():.3g} m, more than the "
                problem += f"targets extend, {volume:.3g} m"
                advice = DIRECTIONS
            elif point.nonlinearity * error > LINEAR:
                problem = f"errors of images of {error:.3g} change its equations by "
                problem += f"{100 * point.nonlinearity * error:.3g} %: its error of "
                problem += f"{deviation.max():.3g} m is not reliable"
                advice = f"{DIRECTIONS}, and the targets of each must be spread in all directions"
            if problem:
                what = f"point '{point.name}' at {frame.time:.6g} s"
                errors.append(
                    DeckError(requested.card.frames, row.line, None, what, problem, advice)
                )
    if errors:
        raise DeckErrors(errors)


def _all_spreads(cameras: dict[str, dlt.Camera]) -> Array:
    """Covariance (11 n, 11 n) of the L of all cameras."""
    n = dlt.UNKNOWNS
    spreads = np.zeros((n * len(cameras),) * 2)
    for i, camera in enumerate(cameras.values()):
        spreads[n * i : n * i + n, n * i : n * i + n] = camera.spread
    return spreads


def _extent(rows: list[Row]) -> float:
    x = np.array([_numbers(row, "xyz") for row in rows])
    return float(np.linalg.norm(np.ptp(x, axis=0)))


def _numbers(row: Row, names: str) -> list[float]:
    return [row.numbers[name] for name in names]
