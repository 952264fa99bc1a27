"""What retractors promise: a constant pull, locks that hold, limiters, pretensioners, energy."""

from pathlib import Path

import numpy as np
import pytest
from bench import Bench, Law, refusal, written

BODIES = """
title: belt on a retractor
control: {end_time: 1}
bodies:
  a: {mass: 2, inertia: [0.5, 0.6, 0.4], position: [2, 0, 0]}
  car: {mass: 20, inertia: [5, 6, 4], position: [0, 0, -1]}
curves:
  flat: {points: [[0, 4000], [0.3, 4000]]}
  film: {points: [[0, 0], [0.05, 1500], [0.3, 2500]]}
  winding: {points: [[0, 3000], [0.1, 2000]]}
"""
K = 1e5


def belt(folder: Path, words: str, slack: float = 0.0, mu: float = 0.2) -> Law:
    text = (
        f"belts:\n  s:\n    webbing: {{stiffness: {K}}}\n    slack: {slack}\n    route:\n"
        f"      - {{retractor: {{body: car, {words}}}}}\n"
        f"      - {{ring: {{at: [0, 0, 0.5], friction_coefficient: {mu}}}}}\n"
        "      - {anchor: {body: a}}\n"
    )
    return Bench(folder, text, BODIES).law("belts", "s")


def go(law: Law, far: float, steps: int = 10, h: float = 1e-3, t: float = 0.0) -> None:
    """Move the end out [m], in steps of h [s]."""
    for k in range(steps):
        law.bench.move(1, r=law.bench.nodes[1].r + np.array([far / steps, 0.0, 0.0]))
        law.force(h, t + (k + 1) * h)
        assert written(law.new, law.module.HISTORY) and written(law.out, law.module.OUTPUT)
        law.accept()


@pytest.mark.parametrize("slack", [0.0, 1e-3, 0.3])
def test_unlocked_it_retracts_slack_and_pays_out_at_its_spring_force(
    tmp_path: Path, slack: float
) -> None:
    law = belt(tmp_path, "pull: 8, lock_time: 9", slack)
    for far in (0.0, 0.3, -0.2, 0.4):
        go(law, far)
        # the force is the pull of the spring, whatever the webbing does
        assert law.out.force[0] == pytest.approx(8.0, rel=1e-6)
        # behind the ring within its friction
        c = np.exp(0.2 * law.out.angle[1]) * (1.0 + 1e-6)
        assert 8.0 / c <= law.out.force[1] <= 8.0 * c
        length = law.out.length[:2]
        unstrained = (length / (1.0 + law.out.force[:2] / K)).sum()
        # webbing that there is: that of the start and what has left the spool
        assert law.p.total + law.out.pay_out == pytest.approx(unstrained, rel=1e-12)
    assert law.out.locked == 0


def test_locked_it_pays_out_no_webbing(tmp_path: Path) -> None:
    law = belt(tmp_path, "pull: 8, lock_time: 0.0205")
    go(law, 0.1, steps=20)
    out = float(law.out.pay_out)
    assert law.out.locked == 0 and out > 0.05
    go(law, 0.02, t=0.02)
    assert law.out.locked == 1
    for far in (0.1, -0.3, 0.4):
        held = float(law.out.pay_out)
        go(law, far, t=0.1)
        assert law.out.pay_out == held
    assert law.out.force[0] > 1000.0


def test_it_locks_by_the_rate_of_webbing_and_by_the_acceleration_of_its_body(
    tmp_path: Path,
) -> None:
    law = belt(tmp_path, "lock_rate: 0.5")
    go(law, 0.004, steps=10)
    assert law.out.locked == 0
    go(law, 0.006, steps=10)
    assert law.out.locked == 1
    law = belt(tmp_path, "lock_acceleration: 5")
    go(law, 0.01)
    law.bench.move(2, v=[0.0049, 0, 0])
    go(law, 0.01)
    assert law.out.locked == 0
    law.bench.move(2, v=[0.0, 0.002, 0])
    go(law, 0.01, steps=1)
    assert law.out.locked == 1


@pytest.mark.parametrize("curve, at", [("flat", 4000.0), ("film", None)])
def test_the_limiter_yields_along_its_curve_and_does_not_retract(
    tmp_path: Path, curve: str, at: float | None
) -> None:
    law = belt(tmp_path, f"lock_time: 0, limiter: {curve}", mu=0.0)
    go(law, 0.0, steps=1)
    go(law, 0.25, steps=50)
    w = float(law.out.pay_out)
    expected = at or 1500.0 + (w - 0.05) / 0.25 * 1000.0
    assert law.out.force[0] == pytest.approx(expected, rel=1e-6)
    # the imposed displacement: stretch of the webbing, and what has gone out
    stretch = law.out.length[:2].sum() - law.p.total - w
    assert stretch == pytest.approx((law.p.total + w) * expected / K, rel=1e-9)
    go(law, -0.1)
    assert law.out.pay_out == w
    taken = float(law.out.retractor)
    from_curve = 4000.0 * w if at else 0.5 * 1500.0 * 0.05 + 0.5 * (1500.0 + expected) * (w - 0.05)
    # the webbing is longer as it goes out, by T / k of 4 % at most
    assert taken == pytest.approx(from_curve, rel=0.05)


def test_the_pretensioner_winds_in_until_its_force_is_that_of_the_webbing(tmp_path: Path) -> None:
    words = "lock_time: 0, pretensioner: {time: 0.005, curve: winding, duration: 0.005}"
    law = belt(tmp_path, words, slack=0.03)
    go(law, 0.0, steps=4)
    assert law.out.pay_out == 0.0 and law.out.force[0] == 0.0
    go(law, 0.0, steps=6, t=0.004)
    s = -float(law.out.pay_out)
    assert s > 0.03
    assert law.out.force[0] == pytest.approx(3000.0 - 1e4 * s, rel=1e-6)
    assert law.out.retractor < 0.0
    # the next moments hold what is wound in
    go(law, 0.05, t=0.02)
    assert law.out.pay_out == -s


def test_the_pretensioner_winds_in_no_more_slack_than_its_curve_is_long(tmp_path: Path) -> None:
    words = "lock_time: 0, pretensioner: {time: 0.005, curve: winding, duration: 0.005}"
    law = belt(tmp_path, words, slack=0.3)
    go(law, 0.0, steps=12)
    # the curve ends at 0.1 m; the last digits of a route of 2 m
    assert law.out.pay_out == pytest.approx(-0.1, abs=1e-14)
    assert law.out.force[0] == 0.0 and law.out.locked == 1


@pytest.mark.parametrize(
    "words",
    [
        "lock_time: 0.01, limiter: flat",
        "lock_time: 0.3, limiter: film",
        "lock_time: 0.02, limiter: flat, pretensioner: {time: 0.005, curve: winding}",
    ],
)
def test_energy_is_balanced_with_the_retractor(tmp_path: Path, words: str) -> None:
    law = belt(tmp_path, words, slack=-0.001)
    law.bench.move(1, r=[2.2, 0, 0])
    law.force(0.0)
    law.accept()
    first, work, lost = float(law.out.stored), 0.0, 0.0
    T, length = np.array(law.out.force[:2]), np.array(law.out.length[:2])
    for k in range(200):
        law.bench.move(1, r=law.bench.nodes[1].r + np.array([2e-3 * np.cos(k / 100), 0, 0]))
        law.force(1e-3, 1e-3 * (k + 1))
        now = np.array(law.out.force[:2])
        assert now.min() > 0.0
        work += float(0.5 * (T + now) @ (law.out.length[:2] - length))
        lost += float(law.out.loss)
        T, length = now, np.array(law.out.length[:2])
        law.accept()
    # round-off of sums of 200 terms of some hundred joules
    assert work - lost == pytest.approx(float(law.out.stored) - first, abs=1e-9)
    parts = law.out.friction + law.out.hysteresis + law.out.retractor
    assert parts == pytest.approx(lost, rel=1e-12)


@pytest.mark.parametrize("steps", [1, 7, 30])
@pytest.mark.parametrize("words", ["lock_time: 9", "lock_time: 0, limiter: flat"])
def test_an_empty_spool_holds_and_is_reported(tmp_path: Path, words: str, steps: int) -> None:
    """Free or through its limiter it pays out its reserve, and not a millimetre more."""
    law = belt(tmp_path, f"{words}, reserve: 0.1", mu=0.0)
    go(law, 0.3, steps=steps)
    assert law.new.emptied == 1 and law.out.locked == 1
    assert law.out.pay_out == pytest.approx(0.1, rel=1e-12)
    force = K * (law.out.length[:2].sum() / (law.p.total + 0.1) - 1.0)
    assert force > 5000.0
    assert law.out.force[0] == pytest.approx(force, rel=1e-9)
    go(law, -0.1, steps=steps)
    assert law.out.pay_out == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize(
    "words, said",
    [
        ("pull: 5", "needs one of lock_time"),
        ("lock_time: 0, limiter: nothing", "nothing"),
        ("lock_time: 0, limiter: below", "not below zero"),
        ("lock_time: 0, limiter: falls", "not below zero"),
        ("lock_time: 0, pull: -1", "pull"),
        ("lock_time: -1", "lock_time"),
    ],
)
def test_a_retractor_that_makes_no_sense_is_refused(tmp_path: Path, words: str, said: str) -> None:
    text = (
        BODIES + "  below: {points: [[0, 10], [1, -10], [2, 0]]}\n"
        "  falls: {points: [[0, 10], [1, -10]]}\n"
        "belts:\n  s:\n    webbing: {stiffness: 1e5}\n    route:\n"
        f"      - {{retractor: {{{words}}}}}\n      - {{anchor: {{body: a}}}}\n"
    )
    assert said in refusal(tmp_path, text)
