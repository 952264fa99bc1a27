"""Claims of the sled: what slack, limiter, pretensioner and padding do, and what holds exactly."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.results.result import Result

DECK = Path(__file__).parents[2] / "decks" / "occupants" / "tests" / "sled.yaml"
# slack [m], level of the limiter [N], padding [N]
SLACK, LIMIT, PAD = 0.12, 2000.0, 2000.0
CASES = {
    "tight": {},
    "slack": {"slack": SLACK},
    "some slack": {"slack": 0.05},
    "wound": {"slack": 0.05, "fires": 0.015},
    "limited": {"limit": LIMIT},
    "rigid": {"knee_gap": 0.03},
    "padded": {"knee_gap": 0.03, "pad": PAD},
}
# one worker runs all of them, and compiles the scene once
pytestmark = [pytest.mark.xdist_group("sled"), pytest.mark.long]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Result]:
    folder = tmp_path_factory.mktemp("sled")
    results = {}
    for name, changes in CASES.items():
        given = {"control.estimate": "off", "control.end_time": 0.13, "output.states.interval": 1}
        words = [x for k, v in (given | changes).items() for x in ("--set", f"{k}={v}")]
        done = crashsolve(DECK, "-o", folder / name, *words)
        assert done.returncode == 0, done.stderr
        results[name] = Result(folder / name)
    return results


def largest(result: Result, channel: str) -> float:
    return float(np.asarray(result.series(channel).values).max())


def chest(result: Result) -> float:
    return largest(result, "clip(nodout.man_chest_acceleration.resultant, '3 ms')")


def hic(result: Result) -> float:
    return largest(result, "hic(nodout.man_head_acceleration.resultant, '36 ms')")


def test_the_pulse_is_that_of_the_source(runs: dict[str, Result]) -> None:
    acceleration = runs["tight"].series("rbdout.sled.acceleration.x")
    # samples of 0.1 ms find the corner at 77 ms
    assert -acceleration.values.min() / 9.81 == pytest.approx(18.2, rel=1e-6)
    assert acceleration.time[acceleration.values.argmin()] == pytest.approx(0.077, abs=1e-4)
    # the driver closes to its tolerance
    final = runs["tight"].series("rbdout.sled.velocity.x").values[-1]
    assert -final == pytest.approx(11.21, rel=1e-6)


def test_energy_closes_though_nothing_but_the_occupant_has_mass(runs: dict[str, Result]) -> None:
    for result in runs.values():
        # 0.5 % is asked for
        assert np.abs(result.series("glstat.model.balance").values).max() < 0.5


def test_slack_makes_the_chest_worse_by_more_than_a_fifth(runs: dict[str, Result]) -> None:
    # SAE 980557: 120 mm of slack, more than 20 %; the head meets nothing, and its HIC says little
    assert chest(runs["slack"]) > 1.2 * chest(runs["tight"])
    assert chest(runs["slack"]) > chest(runs["some slack"]) > chest(runs["tight"])
    head = "disbout.head.vector.x"
    # by 130 ms; the slack is shared by the shoulder and the lap
    assert largest(runs["slack"], head) > largest(runs["tight"], head) + 0.5 * SLACK


def test_a_pretensioner_undoes_slack(runs: dict[str, Result]) -> None:
    # what goes in is the slack and a stretch besides
    assert -runs["wound"].series("beltout.belt.pay_out").values[-1] > 0.05
    # SAE 2015-01-1460: all measures are less
    for measure in (chest, hic):
        assert measure(runs["wound"]) < measure(runs["some slack"])
    head = "disbout.head.vector.x"
    assert largest(runs["wound"], head) < largest(runs["some slack"], head)


def test_a_limiter_bounds_the_belt_and_lets_the_head_go_further(runs: dict[str, Result]) -> None:
    # at the retractor exactly; behind the D-ring up to exp(mu beta), not above a half turn
    assert largest(runs["limited"], "beltout.belt.force.1") == pytest.approx(LIMIT, rel=1e-6)
    assert largest(runs["limited"], "beltout.belt.force.2") < LIMIT * np.exp(0.2 * np.pi)
    assert chest(runs["limited"]) < chest(runs["tight"])
    head = "disbout.head.vector.x"
    assert largest(runs["limited"], head) > largest(runs["tight"], head)


def test_padding_bounds_what_a_knee_bears(runs: dict[str, Result]) -> None:
    # two knees at the plateau, which is flat: round-off
    assert largest(runs["padded"], "rcforc.knees.normal") == pytest.approx(2 * PAD, rel=1e-6)
    thigh = "-secforc.man_femur_load_left.force.z"
    # Schwarze (2019): 15 % less
    assert largest(runs["padded"], thigh) < 0.85 * largest(runs["rigid"], thigh)
