"""Claims of the roll-over: the sequence of events of the chapter, and what holds exactly."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.cli import main as crashpost
from crashpost.results.result import Result

DECK = Path(__file__).parents[2] / "decks" / "scenes" / "rollover.yaml"
# 25 mph in m/s, and the masses of the deck in kg
SPEED = 11.176
VEHICLE, OCCUPANT = 1100 + 4 * (15 + 19.8), 75.3366
# one worker runs all of them, and compiles the scene once
pytestmark = pytest.mark.xdist_group("rollover")


def run(folder: Path, end_time: float, *settings: str) -> Result:
    words = [f"control.end_time={end_time}", "control.estimate=off", *settings]
    done = crashsolve(DECK, "-o", folder, *(x for word in words for x in ("--set", word)))
    assert done.returncode == 0, done.stderr
    assert "N o r m a l" in done.stdout
    return Result(folder)


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Result:
    """The first 0.22 s: the fall and the blow of the left tyres."""
    return run(tmp_path_factory.mktemp("rollover"), 0.22)


def first(result: Result, channel: str) -> float:
    """Time at which a channel first has a value [s]; infinite where it never has."""
    series = result.series(channel)
    at = np.flatnonzero(series.values)
    return float(series.time[at[0]]) if len(at) else np.inf


def test_all_fly_as_one_until_the_tyres_touch(result: Result) -> None:
    # gravity alone acts from outside: the momentum grows by m g t, and none of it goes aside
    vertical, across = (result.series(f"glstat.model.momentum.{axis}") for axis in "zy")
    touch = min(first(result, f"tyrout.tyre_{end}_left.normal") for end in ("front", "rear"))
    assert 0.1 < touch < 0.2
    flying = vertical.time < touch
    mass = VEHICLE + 3 * OCCUPANT
    fallen = vertical.values - vertical.values[0] + mass * 9.81 * vertical.time
    # constraints are kept to 1e-10 of the model's size
    assert np.abs(fallen[flying]).max() < 1e-6 * mass * SPEED
    # all mass centres go aside at the speed of the cart, but for the roll rate: those of people,
    # a sixth of the mass, are 0.5 m higher, and 1.5 rad/s change the whole by a hundredth
    assert across.values[0] == pytest.approx(mass * SPEED, rel=0.02)
    assert np.ptp(across.values[flying]) < 1e-6 * mass * SPEED


def test_the_left_tyres_strike_first(result: Result) -> None:
    right = min(first(result, f"tyrout.tyre_{end}_right.normal") for end in ("front", "rear"))
    assert np.isinf(right)
    assert np.isinf(first(result, "rcforc.bar_on_ground.normal"))


@pytest.mark.parametrize("who", ["driver", "passenger"])
def test_belts_bear_and_only_pull(result: Result, who: str) -> None:
    forces = [result.series(f"beltout.belt_{who}.force.{k}").values for k in range(1, 8)]
    assert min(force.min() for force in forces) >= 0.0
    assert max(force.max() for force in forces) > 0.0
    # no webbing is lost or made: the retractor has locked
    webbing = sum(result.series(f"beltout.belt_{who}.webbing.{k}").values for k in range(1, 8))
    assert np.ptp(webbing) < 1e-12


@pytest.mark.parametrize("slack", [0.0, 1e-9])
def test_belts_without_slack_make_no_energy_while_all_fly_as_one(
    slack: float, tmp_path: Path
) -> None:
    # round-off of lengths draws them by 1e-16 of 1 m: a gain of 1e-16 J stopped the run
    flown = run(tmp_path / "out", 2e-3, "control.step=1e-4", f"belt_slack={slack}")
    for who in ("driver", "passenger"):
        largest = max(
            flown.series(f"beltout.belt_{who}.force.{k}").values.max() for k in range(1, 8)
        )
        assert largest < 1e-3  # N, of webbing of 5e5 N


def test_energy_closes(result: Result) -> None:
    # 0.5 % is asked for
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.1  # %


@pytest.mark.long
def test_the_sequence_of_the_chapter(tmp_path: Path) -> None:
    """Left tyres, roll bar, ejection of the rear occupant, and after a whole turn the tyres."""
    result = run(tmp_path, 3.0)
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.5  # %
    tyres = min(first(result, f"tyrout.tyre_{end}_left.normal") for end in ("front", "rear"))
    bar = first(result, "rcforc.bar_on_ground.normal")
    right = min(first(result, f"tyrout.tyre_{end}_right.normal") for end in ("front", "rear"))
    assert tyres < bar < right
    # out of his seat while the vehicle is on its side; the belted ones stay
    away = result.series("disbout.rear_seat.distance")
    assert bar - 0.1 < away.time[np.flatnonzero(away.values > 1.0)[0]] < right
    roll = -np.degrees(result.series("disbout.roll.angle").values)
    assert roll.max() > 337.0
    for who in ("driver", "passenger"):
        seat = np.array(
            [result.series(f"rbdout.{who}_lower_torso.position.{a}").values for a in "xyz"]
        )
        vehicle = np.array([result.series(f"rbdout.vehicle.position.{a}").values for a in "xyz"])
        # both mass centres: 0.4 m apart at the start, never a metre
        assert np.linalg.norm(seat - vehicle, axis=0).max() < 1.0


def test_the_bus_on_the_edge_meets_its_closed_form(tmp_path: Path) -> None:
    done = crashsolve(DECK.with_name("tilting_bus.yaml"), "-o", tmp_path)
    assert done.returncode == 0, done.stderr
    assert crashpost(["expect", str(tmp_path)]) == 0
