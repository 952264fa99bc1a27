"""Sensors against derivatives of known motions, and forces known by hand."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bench import Bench, exponential, product, written

from crashsolve.deck.laws import types_in
from crashsolve.foundation.errors import DeckErrors

# every sensor, in each of its ways
SENSORS = {
    "chip": "type: accelerometer, body: b, at: [0.4, -0.2, 0.1]",
    "real": "type: accelerometer, body: b, at: [0.4, -0.2, 0.1], gravity: true",
    "apart": "type: displacement, a: a, b: b, at_a: [0.1, 0.2, 0], at_b: [0, 0.3, 0]",
    "seen": "type: displacement, a: a, b: b, at_a: [0.1, 0.2, 0], at_b: [0, 0.3, 0], axes: a",
    "rotated": "type: angle, a: a, b: b, axis: [1, -1, 2]",
    "cut": "type: section_force, joint: pin",
    "cut_at": "type: section_force, joint: pin, axes: a, at: [1, 1, 1]",
}
TEXT = """
joints:
  pin: {type: weld, a: a, b: b, at: [0.5, 0.3, 0.1]}
loads:
  weight: {type: gravity, acceleration: [0, 0, -10]}
  drift: {type: gravity, acceleration: [1, 0, 0]}
sensors:
""" + "".join(f"  {name}: {{{words}}}\n" for name, words in SENSORS.items())
Motion = Callable[[float], None]


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    bench = Bench(tmp_path, TEXT)
    bench.shake(3)
    return bench


def motion(bench: Bench, node: int) -> Motion:
    """A motion of constant accelerations through the present state at t = 0."""
    b = bench.nodes[node]
    r, q, v, w = (b[name].copy() for name in ("r", "q", "v", "w"))
    b.v_dot, b.w_dot = [0.3, -1, 2], [-0.5, 1, 0.7]
    v_dot, w_dot = b.v_dot.copy(), b.w_dot.copy()

    def at(t: float) -> None:
        # fourth order in t; the term in t^3 is that of the commutator of w and w_dot
        rotation = w * t + w_dot * t**2 / 2 + np.cross(w_dot, w) * t**3 / 12
        position = r + v * t + v_dot * t**2 / 2
        bench.move(node, position, product(exponential(rotation), q), v + v_dot * t, w + w_dot * t)

    return at


def both(bench: Bench) -> Motion:
    first, second = motion(bench, 1), motion(bench, 2)

    def at(t: float) -> None:
        first(t)
        second(t)

    return at


def test_every_sensor_is_under_this_contract() -> None:
    assert set(types_in("sensors")) == {w.split(",")[0].split()[1] for w in SENSORS.values()}


@pytest.mark.parametrize("name", SENSORS)
def test_every_output_is_written(bench: Bench, name: str) -> None:
    sensor = bench.law("sensors", name)
    assert written(sensor.measure(), sensor.module.OUTPUT)


def test_accelerometer_shows_the_second_derivative_of_its_position(bench: Bench) -> None:
    sensor, at = bench.law("sensors", "chip"), motion(bench, 2)
    b, h = bench.nodes[2], 1e-3
    point = np.array([0.4, -0.2, 0.1]) - [0, -0.1, 0]
    positions = []
    for t in (-h, 0.0, h):
        at(t)
        positions.append(b.r + b.A.reshape(3, 3) @ point)
    at(0.0)
    A = b.A.reshape(3, 3)
    out = sensor.measure()
    second = (positions[0] - 2 * positions[1] + positions[2]) / h**2
    # h^2 / 12 of a fourth derivative of some 10 m/s^4, round-off 1e-16 / h^2
    np.testing.assert_allclose(A @ out.acceleration, second, atol=1e-5)
    np.testing.assert_allclose(A @ out.velocity, (positions[2] - positions[0]) / (2 * h), atol=1e-5)
    np.testing.assert_allclose(A @ out.angular_velocity, b.w, atol=1e-14)
    assert float(out.resultant) == pytest.approx(np.linalg.norm(out.acceleration))


def test_instrument_subtracts_the_sum_of_all_gravity(bench: Bench) -> None:
    motion(bench, 2)
    bare = bench.law("sensors", "chip").measure().acceleration.copy()
    real = bench.law("sensors", "real").measure().acceleration.copy()
    A = bench.nodes[2].A.reshape(3, 3)
    np.testing.assert_allclose(A @ (bare - real), [1, 0, -10], atol=1e-14)


@pytest.mark.parametrize("name", ["apart", "seen"])
def test_rates_of_a_displacement_are_its_derivatives(bench: Bench, name: str) -> None:
    sensor, at = bench.law("sensors", name), both(bench)
    h = 1e-5
    values = []
    for t in (-h, h):
        at(t)
        out = sensor.measure()
        values.append(np.array([out.distance, *out.vector]))
    at(0.0)
    out = sensor.measure()
    # central difference: h^2 = 1e-10 times third derivatives of some 10, round-off 1e-16 / h
    slopes = (values[1] - values[0]) / (2 * h)
    np.testing.assert_allclose([out.rate, *out.velocity], slopes, atol=1e-8)
    assert np.linalg.norm(out.vector) == pytest.approx(float(out.distance))


def test_change_of_a_displacement_is_from_the_start(tmp_path: Path) -> None:
    bench = Bench(tmp_path, TEXT)
    out = bench.law("sensors", "apart").measure()
    # round-off: compiled code may fuse products and sums, the distance at the start is numpy's
    assert abs(out.change) <= 4 * np.finfo(float).eps * out.distance


def test_angle_is_the_integral_of_its_rate_over_many_turns(bench: Bench) -> None:
    sensor = bench.law("sensors", "rotated")
    for node in (1, 2):
        # about its start, so that the angle begins near zero
        bench.move(node, v=[0, 0, 0], w=[0, 0, 0])
    axis = bench.nodes[1].A.reshape(3, 3) @ np.array([1, -1, 2]) / np.sqrt(6)
    start = float(sensor.measure().angle)
    for _ in range(100):
        bench.rotation(2, 0.5 * axis)
        out = sensor.measure()
        sensor.accept()
    # 50 rad in 100 steps, each to round-off
    assert float(out.angle) - start == pytest.approx(50.0, abs=1e-11)
    bench.move(2, w=3.0 * axis)
    assert float(sensor.measure().rate) == pytest.approx(3.0)


def test_section_force_is_the_wrench_of_the_rows(bench: Bench) -> None:
    """Rows of any numbers: each puts lambda D_v on b and lambda D_w about its mass centre."""
    rng = np.random.default_rng(7)
    bench.rows.D = rng.normal(size=bench.rows.D.shape)
    bench.rows.reaction = rng.normal(size=len(bench.rows))
    wrench = (bench.rows.D[:, 6:] * bench.rows.reaction[:, None]).sum(axis=0)
    f, torque = wrench[:3], wrench[3:]
    b, a = bench.nodes[2], bench.nodes[1]
    A = a.A.reshape(3, 3)
    x_b = b.r + b.A.reshape(3, 3) @ bench.model.joints[0].frame["point_b"]
    out = bench.law("sensors", "cut").measure()
    np.testing.assert_allclose(out.force, f, atol=1e-13)
    np.testing.assert_allclose(out.moment, torque + np.cross(b.r - x_b, f), atol=1e-13)
    x = a.r + A @ (np.array([1, 1, 1]) - [0.05, 0, 0.1])
    out = bench.law("sensors", "cut_at").measure()
    np.testing.assert_allclose(A @ out.force, f, atol=1e-13)
    np.testing.assert_allclose(A @ out.moment, torque + np.cross(b.r - x, f), atol=1e-13)


def test_sensor_between_a_body_and_itself_is_refused(tmp_path: Path) -> None:
    text = "sensors:\n  s: {type: angle, a: b, b: b, axis: [1, 0, 0]}\n"
    with pytest.raises(DeckErrors, match="a and b must differ"):
        Bench(tmp_path, text)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("role: neck", "in the axes of the head, body b of 'pin': give axes: b"),
        ("role: neck, axes: a", "in the axes of the head, body b of 'pin': give axes: b"),
        ("role: femur_left, axes: b", "in the axes of the thigh, body a of 'pin': give axes: a"),
    ],
)
def test_a_load_in_other_axes_than_its_measure_reads_is_refused(
    tmp_path: Path, words: str, message: str
) -> None:
    """It would turn compression into tension, or one axis into another."""
    text = TEXT[: TEXT.index("sensors:")]
    with pytest.raises(DeckErrors, match=message):
        Bench(tmp_path, f"{text}sensors:\n  s: {{type: section_force, joint: pin, {words}}}\n")
