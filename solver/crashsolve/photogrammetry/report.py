"""Results of a posture: the card for decks, tables of points and joints, and the printed report."""

import csv
import io
from pathlib import Path

import numpy as np

from crashsolve.output.files import reported
from crashsolve.photogrammetry.chain_fit import Chain, Fit, rotation
from crashsolve.photogrammetry.motion import Rates
from crashsolve.photogrammetry.points import Frame, Measured
from crashsolve.photogrammetry.request import Requested

Array = np.ndarray
COVARIANCE = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def card(requested: Requested, chain: Chain, offset: Array, fitted: Fit, moving: Rates) -> str:
    """The `postures` card of a fit; `offset` is the mass centre of the root in its axes."""
    A = rotation(fitted.q[3:6])
    v, w = moving.values[:3], moving.values[3:6]
    arm = A @ offset
    lines = [
        f"# Posture at {fitted.time:.9g} s, by crashsolve posture {requested.path.name}",
        "postures:",
        f"  {requested.card.name}:",
        f"    root: {chain.root_name}",
        f"    position: {_vector(fitted.q[:3] - arm)}",
        f"    rotation: {_rotation(fitted.q[3:6])}",
        f"    velocity: {_vector(v - np.cross(w, arm))}",
        f"    angular_velocity: {_vector(w)}",
        "    joints:",
    ]
    deviations = np.sqrt(np.diag(fitted.covariance))
    own = chain.split(np.append(fitted.q[:6], fitted.q[6:]))
    rates, spread = chain.split(moving.values), chain.split(deviations)
    for one, q, rate, s in zip(chain.links, own, rates, spread, strict=True):
        words = (
            f"rotation: {_rotation(q)}, angular_velocity: {_vector(rate)}"
            if one.axis is None
            else f"angle: {q[0]:.12g}, rate: {rate[0]:.9g}"
        )
        lines.append(f"      - {{joint: {one.joint}, {words}}}  # +- {s.max():.2g} rad")
    return "\n".join(lines) + "\n"


def points_table(measured: Measured) -> str:
    """All reconstructed points, with their covariance and residuals."""
    head = ["time [s]", "point", "x [m]", "y [m]", "z [m]"]
    head += [f"cov_{'xyz'[i]}{'xyz'[j]} [m^2]" for i, j in COVARIANCE]
    rows: list[list[object]] = [[*head, "cameras", "largest residual", "chi-squared", "freedom"]]
    for frame in measured.frames:
        for i, point in enumerate(frame.points):
            block = frame.covariance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3]
            residual = np.linalg.norm(point.residuals, axis=1).max()
            closure = point.closure / max(measured.image_error, 1e-300) ** 2
            numbers = [*point.x, *(block[at] for at in COVARIANCE)]
            cameras = " ".join(row.names["camera"] for row in point.rows)
            row = [f"{frame.time:.9g}", point.name, *(f"{number:.9g}" for number in numbers)]
            rows.append([*row, cameras, f"{residual:.4g}", f"{closure:.4g}", point.freedom])
    return _csv(rows)


def joints_table(chain: Chain, fits: list[Fit]) -> str:
    """Rotations of all joints in every frame, with standard deviations about the axes of a."""
    head = ["time [s]", "joint", "rx [rad]", "ry [rad]", "rz [rad]", "s_x", "s_y", "s_z"]
    rows: list[list[object]] = [list(head)]
    for one in fits:
        deviations = chain.split(np.sqrt(np.diag(one.covariance)))
        for joint, q, s in zip(chain.links, chain.split(one.q), deviations, strict=True):
            axis = np.ones(3) if joint.axis is None else joint.axis
            numbers = [*(q * axis), *np.abs(s * axis)]
            rows.append([f"{one.time:.9g}", joint.joint, *(f"{n:.9g}" for n in numbers)])
    return _csv(rows)


def summary(
    requested: Requested, chain: Chain, measured: Measured, fits: list[Fit], moving: Rates
) -> str:
    """The text that is printed."""
    given = (
        "given" if requested.card.image_error else f"from {measured.freedom} equations left over"
    )
    lines = [
        requested.card.title or requested.path.name,
        f"error of images {measured.image_error:.4g}, {given}",
    ]
    for name, camera in measured.cameras.items():
        rms = np.sqrt(np.mean(camera.residuals**2))
        lines.append(f"camera {name}: {len(camera.residuals)} targets, residual {rms:.4g} rms")
    for frame, one in zip(measured.frames, fits, strict=True):
        lines.append(_frame(frame, one))
    start = next(i for i, one in enumerate(fits) if one.time == _start(requested, measured))
    lines += [
        "",
        f"at {fits[start].time:.6g} s, the start:",
        *_points(measured.frames[start], fits[start]),
    ]
    lines += _joints(chain, fits[start], moving)
    return "\n".join(lines)


def write(folder: Path, files: dict[str, str]) -> list[Path]:
    """Write all files. Raises OutputError."""
    paths = []
    for name, text in files.items():
        path = folder / name
        with reported(path):
            folder.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8")
        paths.append(path)
    return paths


def _start(requested: Requested, measured: Measured) -> float:
    return measured.frames[0].time if requested.card.start is None else requested.card.start


def _frame(frame: Frame, one: Fit) -> str:
    rms = np.sqrt(np.mean(one.distances**2))
    deviation = frame.deviations().max()
    return (
        f"t = {one.time:.6g} s: {len(frame.points)} points within {deviation * 1e3:.3g} mm; from "
        f"the landmarks {rms * 1e3:.3g} mm rms, chi-squared {one.chi_squared:.4g} of {one.freedom}"
    )


def _points(frame: Frame, one: Fit) -> list[str]:
    lines = [
        f"{'point':16} {'x':>9} {'y':>9} {'z':>9} m   +-{'x':>7} {'y':>7} {'z':>7} mm   off mm"
    ]
    for point, s, off in zip(frame.points, frame.deviations(), one.distances, strict=True):
        location = " ".join(f"{value:9.4f}" for value in point.x)
        errors = " ".join(f"{1e3 * value:7.2f}" for value in s)
        lines.append(f"{point.name:16} {location}       {errors}   {1e3 * off:8.2f}")
    return lines


def _joints(chain: Chain, one: Fit, moving: Rates) -> list[str]:
    deviations = chain.split(np.sqrt(np.diag(one.covariance)))
    lines = ["", "joint: rotation in axes of a +- [deg], its rate +- [rad/s]"]
    parts = zip(
        chain.links,
        chain.split(one.q),
        deviations,
        chain.split(moving.values),
        chain.split(moving.deviations),
        strict=True,
    )
    for link, q, s, rate, s_rate in parts:
        values = ", ".join(
            f"{a:.1f} +- {b:.1f}" for a, b in zip(np.degrees(q), np.degrees(s), strict=True)
        )
        speeds = ", ".join(f"{a:.2f} +- {b:.2f}" for a, b in zip(rate, s_rate, strict=True))
        lines.append(f"{link.joint}: {values}; {speeds}")
    if moving.frames == 1:
        lines.append("one frame: everything is taken to be at rest")
    return lines


def _vector(values: Array) -> str:
    return f"[{', '.join(f'{value:.9g}' for value in values)}]"


def _rotation(vector: Array) -> str:
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return "{axis: [0, 0, 1], angle: 0}"
    return f"{{axis: {_vector(vector / angle)}, angle: {angle:.12g}}}"


def _csv(rows: list[list[object]]) -> str:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue()
