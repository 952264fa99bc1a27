"""Claim: what a deck asks of a moment is sampled there; times of contact are exact."""

import json
from math import pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
import yaml
from command import crashsolve
from quick import first_quick

from crashpost.errors import PostError
from crashpost.results.result import Result
from crashpost.values.expectation import check_expectations
from crashsolve.channels.statistic import statistic
from crashsolve.recording.sampling import Schedule

RADIUS, SPEED, MASS, STIFFNESS, GAP = 0.1, 2.0, 1.0, 1e4, 0.05
OMEGA = sqrt(STIFFNESS / MASS)
FIRST = GAP / SPEED
RELEASE = FIRST + pi / OMEGA
T, WINDOW = 0.0301234567, [0.0277777, 0.0432101]
SCENE: dict[str, object] = {
    "bodies": {
        "ball": {"mass": MASS, "inertia": [1.0] * 3, "position": [0, 0, RADIUS + GAP],
                 "velocity": [1, 0, -SPEED]},
    },
    "surfaces": {"skin": {"type": "sphere", "body": "ball", "radius": RADIUS},
                 "floor": {"type": "plane"}},
    "contacts": {"hit": {"a": ["skin"], "b": ["floor"],
                         "normal": {"type": "kelvin_voigt", "stiffness": STIFFNESS,
                                    "damping": 0}}},
    "output": {"history": {"interval": 0.01}},
}  # fmt: skip
DEPTH = SPEED / OMEGA * sin(OMEGA * (T - FIRST))
QUOTIENT = "rcforc.hit.normal / rcforc.hit.touching"


def requested(channel: str, at: str, value: float, **words: object) -> dict[str, object]:
    card = {"channel": channel, "statistic": at, "value": value, "because": "exact"}
    return card | {"tolerance": 1.0, "source": "half a vibration"} | words


def solved(folder: Path, method: str, step: float | str = "auto") -> Result:
    control = {"end_time": 0.1, "integrator": method, "step": step, "tolerance": 1e-9}
    expect = [
        requested("rcforc.hit.depth", f"at:{T}", DEPTH),
        requested(QUOTIENT, f"at:{T}", STIFFNESS * DEPTH),
        requested("rcforc.hit.depth", "integral", 0.0, during=WINDOW),
    ]
    deck = folder / "deck.yaml"
    deck.write_text(yaml.safe_dump({"control": control, "expect": expect} | SCENE))
    done = crashsolve(deck, "-o", folder / method)
    assert done.returncode == 0, done.stdout + done.stderr
    return Result(folder / method)


@pytest.mark.parametrize("method", first_quick(["rattle", "dormand_prince_5"]))
def test_moments_windows_and_contact_times_are_exact(method: str, tmp_path: Path) -> None:
    result = solved(tmp_path, method)
    times = result.series("rcforc.hit.depth").time
    assert {T, *WINDOW} <= set(times.tolist())
    # eleven at intervals and these three; others are steps of the touch, which so few samples miss
    wanted = np.array([*np.linspace(0.0, 0.1, 11), T, *WINDOW])
    distance = np.abs(times[:, None] - wanted)
    assert distance.min(axis=0).max() < 1e-12
    further = times[distance.min(axis=1) > 1e-12]
    assert all(FIRST - 0.01 < time < RELEASE + 0.01 for time in further)
    depth, quotient, _ = check_expectations(result)
    # rattle errs by a 600th in its frequency, with omega h = 0.2
    close = {"rattle": 5e-3, "dormand_prince_5": 1e-6}[method]
    assert depth.computed == pytest.approx(DEPTH, rel=close)
    assert not quotient.problem
    assert quotient.computed == pytest.approx(STIFFNESS * DEPTH, rel=close)
    # nothing touches at other samples
    with pytest.raises(PostError, match="division by zero at t = 0"):
        statistic(result.series(QUOTIENT), "max")
    status = json.loads((tmp_path / method / "status.json").read_text())
    watched = {entry["channel"]: entry for entry in status["watched"]}
    assert watched[QUOTIENT]["value"] == pytest.approx(quotient.computed)
    assert abs(quotient.computed - STIFFNESS * DEPTH) < 10 * watched[QUOTIENT]["error"]

    first, last, lasted, touches = (
        float(result.series(f"rcforc.hit.{name}").values[-1])
        for name in ("first_touch", "last_release", "duration", "touches")
    )
    assert first == pytest.approx(FIRST, abs=1e-9)
    # rattle goes over the release: its frequency, and a (t_1 - t)(t - t_0) / 2 v
    assert last == pytest.approx(RELEASE, abs={"rattle": 1e-4, "dormand_prince_5": 1e-8}[method])
    assert lasted == pytest.approx(last - first, rel=1e-12)
    assert touches == 1
    # before it has touched at all
    assert result.series("rcforc.hit.first_touch").values[0] == -1.0
    assert result.series("rcforc.hit.duration").values[0] == 0.0


def test_samples_asked_for_lie_between_the_others() -> None:
    plain = Schedule(0.0, 1.0, 0.25)
    given = plain.with_times({0.1, 0.3, 0.31, 0.5, 1.5, 0.75 + 1e-12})
    times = [0.0, 0.1, 0.25, 0.3, 0.31, 0.5, 0.75, 1.0]
    assert [given.time(k) for k in range(8)] == times
    assert [given.number(t) for t in times] == list(range(8))
    assert [given.plain_number(k) for k in range(8)] == [0, None, 1, None, None, 2, 3, 4]
    assert [given.is_end(k) for k in (6, 7)] == [False, True]
    assert [plain.time(k) for k in range(5)] == np.linspace(0.0, 1.0, 5).tolist()
    # an interval that does not end at the end
    odd = Schedule(0.0, 1.0, 0.3).with_times({0.95})
    assert [odd.time(k) for k in range(6)] == pytest.approx([0.0, 0.3, 0.6, 0.9, 0.95, 1.0])


def test_the_times_of_samples_are_known_among_others() -> None:
    # an interval that does not end at the end, and samples that were asked for
    schedule = Schedule(0.1, 1.0, 0.3).with_times({0.25, 0.95})
    times = np.array([schedule.time(k) for k in range(6)])
    assert schedule.have(times).all()
    # a billionth of an interval is round-off
    assert schedule.have(times + 2e-10).all()
    between = np.array([0.1 + 1e-6, 0.24, 0.55, 0.96, 1.0 - 1e-6])
    assert not schedule.have(between).any()
    assert [schedule.has(t) for t in (0.25, 0.26)] == [True, False]
