"""A driver who follows a path: where he aims, what his hands do, and what he refuses."""

from pathlib import Path

import numpy as np
import pytest
from bench import Bench, assert_balanced, written

from crashsolve.foundation.errors import DeckErrors

L, X_0, T = 2.5, 3.0, 0.4
TEXT = """
curves: {{path: {{type: formula, expression: "1.5*sin(0.2*x)", from: -30, to: 30}}}}
joints: {{j: {{type: {joint}, a: a, b: b, at: [0.1, 0.2, 0], axis: [1, 2, -1]}}}}
loads: {{d: {{type: path_steering, joint: j, vehicle: {vehicle}, at: [0.2, 0.1, 0.3], path: path,
  forward: [1, 0.2, 0.1], along: [{along}], wheelbase: 2.5, preview_distance: 3, preview_time: 0.4,
  ratio: {ratio}, limit: 0.5, stiffness: 70, damping: 3, origin: [1, 2, 3]}}}}
"""


def driver(folder: Path, **words: object) -> Bench:
    usual = {"joint": "revolute", "along": "1, 0, 0", "ratio": -0.2, "vehicle": "a"}
    return Bench(folder, TEXT.format(**(usual | words)))


@pytest.mark.parametrize("along", [(1.0, 0.0), (0.6, -0.8), (0.0, 1.0)])
@pytest.mark.parametrize("seed", range(4))
def test_he_aims_at_the_path_ahead_and_steers_along_the_arc_there(
    tmp_path: Path, along: tuple[float, float], seed: int
) -> None:
    c, s = along
    law = driver(tmp_path, along=f"{c}, {s}, 0").law("loads", "d")
    law.bench.shake(seed, rotation=0.2)
    # so that it looks along the path, not across it
    law.bench.rotation(1, [0, 0, np.arctan2(s, c) - 0.2])
    out = law.force()
    body = law.bench.nodes[1]
    A = body.A.reshape(3, 3)
    # a's mass centre is at (0.05, 0, 0.1) in its frame
    arm = A @ (np.array([0.2, 0.1, 0.3]) - [0.05, 0, 0.1])
    forward = (A @ [1, 0.2, 0.1])[:2]
    forward /= np.linalg.norm(forward)
    side = np.array([-forward[1], forward[0]])
    x = (body.r + arm)[:2] - [1, 2]
    speed = forward @ (body.v + np.cross(body.w, arm))[:2]
    ahead = X_0 + T * max(speed, 0.0)
    t = np.linspace(-30, 30, 600001)
    points = np.outer(t, [c, s]) + np.outer(1.5 * np.sin(0.2 * t), [-s, c])
    # where the path crosses the line at right angles to his sight
    distance = (points - x) @ forward - ahead
    at = np.flatnonzero(distance[1:] * distance[:-1] <= 0.0)
    e = ((points[at] - x) @ side)[np.abs((points[at] - x) @ side).argmin()]
    # the grid is 1e-4 fine, and the cubics of a formula follow the sine to 1e-5
    assert out.preview_error == pytest.approx(e, abs=3e-4)
    # the circle through that point, tangent to his direction, has the radius (X^2 + e^2)/(2 e)
    wanted = np.arctan(L * 2 * e / (ahead**2 + e**2))
    moves = np.clip(speed / 0.5, 0.0, 1.0)
    assert out.steering_angle == pytest.approx(moves * np.clip(wanted, -0.5, 0.5), abs=1e-3)
    nearest = np.linalg.norm(points - x, axis=1).min()
    # along y, times the cosine of the slope there, for the distance: of curvature 0.06 / m
    assert abs(out.offset) == pytest.approx(nearest, abs=0.05 * nearest + 1e-4)


@pytest.mark.parametrize("joint", ["revolute", "prismatic", "cylindrical"])
@pytest.mark.parametrize("seed", range(3))
def test_his_hands_act_within_the_joint(tmp_path: Path, joint: str, seed: int) -> None:
    law = driver(tmp_path, joint=joint).law("loads", "d")
    law.bench.shake(seed, rotation=0.3)
    out = law.force()
    assert written(law.out, law.module.OUTPUT) and written(law.new, law.module.HISTORY)
    assert_balanced(law.bench.nodes)
    assert not law.bench.nodes.external.any()
    assert out.force == pytest.approx(
        70 * (-0.2 * out.steering_angle - out.coordinate) - 3 * out.rate, rel=1e-12
    )
    # the same products in another order
    assert float(out.power) == pytest.approx(law.power_on_bodies(), rel=1e-10)
    before = float(out.coordinate)
    law.accept()
    law.bench.drift(1e-7)
    # second differences of coordinates of 1, and round-off
    assert (law.force().coordinate - before) / 1e-7 == pytest.approx(
        float(out.rate), rel=1e-5, abs=1e-6
    )


def test_who_sees_no_path_ahead_steers_to_its_side(tmp_path: Path) -> None:
    law = driver(tmp_path).law("loads", "d")
    for heading, sign in ((np.pi / 2, -1.0), (-np.pi / 2, 1.0)):
        law.bench.move(1, q=[np.cos(heading / 2), 0, 0, np.sin(heading / 2)], r=[1, 8 * -sign, 0])
        law.bench.move(1, v=[0, -sign, 0])
        out = law.force()
        assert abs(out.steering_angle) == 0.5 and np.isfinite(float(out.force))


WRONG = {
    "ratio: must not be 0": {"ratio": 0},
    "vehicle: the ground follows no path": {"vehicle": "ground"},
    "along and up must be at right angles": {"along": "1, 0, 1"},
    "joint: 'j' is of type spherical": {"joint": "spherical"},
}


@pytest.mark.parametrize("message", WRONG)
def test_a_driver_who_cannot_be_meant_is_refused(tmp_path: Path, message: str) -> None:
    with pytest.raises(DeckErrors) as refused:
        text = TEXT.format(
            **(
                {"joint": "revolute", "along": "1, 0, 0", "ratio": 1, "vehicle": "a"}
                | WRONG[message]
            )
        )
        Bench(tmp_path, text.replace(", axis: [1, 2, -1]", "") if "spherical" in message else text)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("y", "heading"),
    [(-20.0, 0.0), (20.0, 1.5), (2.0, 3.1), (-8.0, -2.0), (0.0, np.pi)],
)
def test_he_comes_to_his_path_from_anywhere(tmp_path: Path, y: float, heading: float) -> None:
    text = """
curves: {path: {points: [[-100, 0], [60, 0], [60.1, 3], [300, 3]]}}
joints: {j: {type: revolute, a: a, b: b, at: [0, 0, 0], axis: [0, 0, 1]}}
loads: {d: {type: path_steering, joint: j, vehicle: a, path: path, wheelbase: 2.5,
  preview_distance: 3, preview_time: 0.3, ratio: 1, stiffness: 70}}"""
    law = Bench(tmp_path, text).law("loads", "d")
    body, x, V, h, headings = law.bench.nodes[1], 0.0, 5.0, 0.05, []
    for _ in range(600):
        c, s = np.cos(heading), np.sin(heading)
        body.A[:] = [c, -s, 0, s, c, 0, 0, 0, 1]
        # the mass centre of a is at (0.05, 0, 0.1) in its frame
        body.r[:], body.v[:], body.w[:] = (x + 0.05 * c, y + 0.05 * s, 0), (V * c, V * s, 0), 0
        delta = law.force().steering_angle
        x, y, heading = x + h * V * c, y + h * V * s, heading + h * V / 2.5 * np.tan(delta)
        headings.append(heading)
    # beyond a step of the path of 3 m; he turns round at most once
    assert x > 60.0 and abs(y - 3.0) < 0.01 and np.ptp(headings) < 1.5 * np.pi
    assert np.cos(heading) > 0.999
