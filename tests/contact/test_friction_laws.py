"""What every friction law promises: at most mu N, in the plane, and its energy account."""

from pathlib import Path

import numpy as np
import pytest
from bench import written
from touching import Contact

from crashsolve.deck.laws import types_in

LAWS = {
    "coulomb": "friction_coefficient: 0.4, none_below: 0.01, full_above: 0.1",
    "stribeck": "static: 0.4, dynamic: 0.3, stribeck_speed: 0.2, smoothing_speed: 0.02",
    "bristle": "stiffness: 1e4, static: 0.4, dynamic: 0.3, stribeck_speed: 0.2",
}
MU_STATIC = 0.4


@pytest.fixture(params=LAWS)
def contact(request: pytest.FixtureRequest, tmp_path: Path) -> Contact:
    return make(tmp_path, request.param)


@pytest.fixture
def bristle(tmp_path: Path) -> Contact:
    return make(tmp_path, "bristle")


def make(folder: Path, law: str, extra: str = "") -> Contact:
    return Contact(folder, friction=f"{{type: {law}, {LAWS[law]}{extra}}}")


def test_every_law_is_under_this_contract() -> None:
    assert set(types_in("friction")) == set(LAWS)


def test_friction_is_tangential_and_at_most_mu_n(contact: Contact) -> None:
    rng = np.random.default_rng(1)
    for _ in range(200):
        n = unit(rng)
        slip = np.cross(n, rng.normal(size=3)) * 10.0 ** rng.uniform(-4, 1)
        load = rng.uniform(0.0, 500.0)
        out = contact.friction_force(load, slip, n, h=1e-3)
        contact.accept()
        # round-off of three products
        assert np.linalg.norm(out.force) <= MU_STATIC * load * (1 + 1e-14)
        assert abs(out.force @ n) <= 1e-12 * (1.0 + load)
        assert out.power >= -1e-12 * load


@pytest.mark.parametrize("law", ("coulomb", "stribeck"))
def test_sliding_friction_is_against_the_slip_and_all_work_is_lost(
    tmp_path: Path, law: str
) -> None:
    contact, rng = make(tmp_path, law), np.random.default_rng(2)
    for _ in range(100):
        n = unit(rng)
        slip = np.cross(n, rng.normal(size=3)) * 10.0 ** rng.uniform(-4, 1)
        out = contact.friction_force(100.0, slip, n)
        v = np.linalg.norm(slip)
        np.testing.assert_allclose(out.force, -out.power / v**2 * slip, rtol=1e-12, atol=1e-13)
        faster = contact.friction_force(100.0, slip * (1 + 1e-6), n)
        rise = (np.linalg.norm(faster.force) - np.linalg.norm(out.force)) / (1e-6 * v)
        # a difference over a millionth of the speed; 100 N round off at 1e-14
        assert rise <= out.damping * (1 + 1e-5) + 2e-14 * 40.0 / (1e-6 * v)


def test_coulomb_fades_out_between_its_two_speeds(tmp_path: Path) -> None:
    contact = make(tmp_path, "coulomb")
    speeds = (0.0, 0.01, 0.055, 0.1, 5.0)
    forces = [-contact.friction_force(100.0, (v, 0, 0), (0, 0, 1)).force[0] for v in speeds]
    np.testing.assert_allclose(forces, [0.0, 0.0, 20.0, 40.0, 40.0], rtol=1e-12, atol=1e-12)


def test_stribeck_has_its_static_slope_peak_and_viscous_end(tmp_path: Path) -> None:
    contact = make(tmp_path, "stribeck", ", viscous: 0.01")
    coefficient = [
        -contact.friction_force(1.0, (v, 0, 0), (0, 0, 1)).force[0] for v in (1e-6, 0.06, 3.0)
    ]
    assert coefficient[0] == pytest.approx(1e-6 * (0.4 / 0.02 + 0.01), rel=1e-8)
    assert 0.37 < coefficient[1] < 0.4
    assert coefficient[2] == pytest.approx(0.3 + 0.01 * 3.0, rel=1e-12)


def test_work_taken_is_stored_or_lost(contact: Contact) -> None:
    """A path in the plane that sticks, slides and turns back, under a changing load."""
    n, steps = unit(np.random.default_rng(3)), 8000
    e, f = np.linalg.svd(n[None])[2][1:]
    h, work, lost = 1.0 / steps, 0.0, 0.0
    before, slip_before = contact.friction_force(0.0, np.zeros(3), n), np.zeros(3)
    contact.accept()
    for k in range(1, steps + 1):
        t = k * h
        slip = 0.3 * np.sin(9 * t) * e + 0.2 * (np.cos(5 * t) - 1.0) * f
        now = contact.friction_force(100.0 + 50.0 * np.sin(20 * t), slip, n, h)
        contact.accept()
        work -= 0.5 * h * (before.force @ slip_before + now.force @ slip)
        lost += 0.5 * h * (before.power + now.power) + now.loss
        before, slip_before = now, slip
    # both sides are sums of second order over 8000 steps
    assert work == pytest.approx(before.stored + lost, rel=1e-5)
    assert lost > 1.0


def test_every_column_is_written_and_the_past_is_kept(contact: Contact) -> None:
    law = contact.group.friction
    before = contact.old.tobytes()
    contact.friction_force(10.0, (0.1, 0, 0), (0, 0, 1), h=1e-3)
    assert written(contact.new, law.HISTORY)
    contact.release(law)
    assert written(contact.new, law.HISTORY)
    assert contact.old.tobytes() == before


def test_steady_sliding_loses_mu_n_per_length(bristle: Contact) -> None:
    slip, n, h = (5.0, 0, 0), (0, 0, 1), 1e-3
    for _ in range(20):
        bristle.friction_force(100.0, slip, n, h)
        bristle.accept()
    out = bristle.friction_force(100.0, slip, n, h)
    # 5 m/s is 25 Stribeck speeds: the static part is exp(-625)
    assert out.force[0] == pytest.approx(-30.0, rel=1e-14)
    assert out.loss == pytest.approx(30.0 * 5.0 * h, rel=1e-12)
    assert out.power == pytest.approx(0.0, abs=1e-12)


def test_a_stuck_bristle_is_a_spring_that_loses_nothing(bristle: Contact) -> None:
    bristle.p.friction_damping_ratio = 0.0
    n, h, away = (0, 0, 1), 1e-3, 0.0
    bristle.friction_force(100.0, (0, 0, 0), n)
    bristle.accept()
    before = 0.0
    for k in range(500):
        slip = 0.1 * np.cos(0.05 * k)
        out = bristle.friction_force(100.0, (slip, 0, 0), n, h)
        away += 0.5 * h * (slip + before) if k else 0.5 * h * slip
        before = slip
        bristle.accept()
        assert abs(1e4 * away) < 40.0
        assert out.force[0] == pytest.approx(-1e4 * away, abs=1e-10)
        assert out.loss == pytest.approx(0.0, abs=1e-14)


def test_a_bristle_turns_with_the_normal_and_keeps_its_energy(bristle: Contact) -> None:
    bristle.friction_force(100.0, (0, 0, 0), (0, 0, 1))
    bristle.accept()
    bristle.friction_force(100.0, (0.1, 0.05, 0), (0, 0, 1), h=2e-2)
    bristle.accept()
    stored = bristle.friction_force(100.0, (0, 0, 0), (0, 0, 1)).stored
    for angle in (0.1, 0.3, 0.8):
        n = np.array([np.sin(angle), 0, np.cos(angle)])
        out = bristle.friction_force(100.0, (0, 0, 0), n)
        assert out.stored == pytest.approx(stored, rel=1e-14)
        assert abs(out.force @ n) < 1e-13
        bristle.accept()


def test_a_bristle_starts_straight_at_every_onset(bristle: Contact) -> None:
    for _ in range(2):
        assert bristle.friction_force(100.0, (0.01, 0, 0), (0, 0, 1), h=1e-2).stored == 0.0
        bristle.accept()
        bristle.friction_force(100.0, (0.01, 0, 0), (0, 0, 1), h=1e-2)
        bristle.accept()
        bristle.release(bristle.group.friction)
        bristle.accept()


def unit(rng: np.random.Generator) -> np.ndarray:
    x = rng.normal(size=3)
    return x / np.linalg.norm(x)
