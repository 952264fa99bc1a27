"""Claims of the train test: what must hold exactly, and what the chapter's figures show."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.cli import main as crashpost
from crashpost.results.result import Result
from crashsolve.channels.series import within
from crashsolve.channels.statistic import statistic

DECK = Path(__file__).parents[2] / "decks" / "scenes" / "train_test.yaml"
MASS = {"A": 60.4e3, "C": 30.5e3, "B": 70.0e3}
SPEED = 15.0
# one worker runs all of them, and compiles the scene once
pytestmark = pytest.mark.xdist_group("train_test")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of the deck as it stands."""
    results: Path = tmp_path_factory.mktemp("train") / "train_test.results"
    done = crashsolve(DECK, "-o", results)
    assert done.returncode == 0, done.stderr
    assert "N o r m a l" in done.stdout
    return results


@pytest.fixture(scope="module")
def result(folder: Path) -> Result:
    return Result(folder)


def test_the_decks_own_expectations_are_met(folder: Path) -> None:
    assert crashpost(["expect", str(folder)]) == 0


def test_momentum_along_the_track_is_kept(result: Result) -> None:
    momentum = result.series("glstat.model.momentum.x").values
    exact = MASS["A"] * SPEED
    assert np.abs(momentum / exact - 1.0).max() < 1e-9


def test_energy_balance_closes(result: Result) -> None:
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.1  # %


def test_the_bodies_of_a_car_weigh_what_the_car_weighs(result: Result) -> None:
    # at rest the rails carry the weight: the scene starts in equilibrium
    for car, mass in MASS.items():
        force = result.series(f"rcforc.{car}_rails.normal").values[0]
        assert force == pytest.approx(9.81 * mass, rel=1e-9)


def test_a_car_that_is_not_yet_struck_stays_at_rest(result: Result) -> None:
    for name in ("B.velocity.z", "B_bogie_1.velocity.z", "C_bogie_2.angular_velocity.y"):
        series = within(result.series(f"rbdout.{name}"), (0.0, 1e-3))
        assert np.abs(series.values).max() < 1e-4


def test_all_cars_come_near_the_common_speed_of_a_plastic_impact(result: Result) -> None:
    # the kinetic energy is least when all parts move alike; it cannot be less
    kinetic = result.series("glstat.model.energy.kinetic")
    least = (MASS["A"] * SPEED) ** 2 / (2.0 * sum(MASS.values()))
    assert least < kinetic.values.min() < 1.01 * least
    assert 0.25 < statistic(kinetic, "argmin") < 0.35


def test_nothing_is_won_by_crushing(result: Result) -> None:
    for kind in ("contact", "spring", "friction", "brake"):
        # the record of what a dashpot and a slider lose never falls
        assert np.diff(result.series(f"glstat.model.energy.{kind}_dissipated").values).min() > -1e-6
    assert np.abs(result.series("glstat.model.energy.external_work").values).max() == 0.0


def test_the_buffers_of_a_and_c_carry_one_force(result: Result) -> None:
    # between them is only the inertia of the heads, 0.3 t
    both = result.series(
        "rcforc.buffers.normal + deforc.C_buffers.force + deforc.heads_friction.force.x"
    )
    heads = result.series("300 * rbdout.C_heads.acceleration.x")
    # the plates are tilted by less than 0.01 rad
    assert np.abs(both.values - heads.values).max() < 0.01 * 3e6


@pytest.mark.long
def test_the_report_puts_our_figures_beside_the_chapters(folder: Path, tmp_path: Path) -> None:
    page = tmp_path / "report.html"
    assert crashpost(["report", str(folder), "-o", str(page)]) == 0
    text = page.read_text("utf-8")
    for figure in ("Fig. 16", "Fig. 17", "Fig. 18", "Fig. 19"):
        assert figure in text
    assert "2500 to 3000\u00a0kN" in text
    assert "stand-in data" in text


def test_other_speeds_and_masses_need_no_other_deck(tmp_path: Path) -> None:
    changes = ("--set", "speed=36 km/h", "--set", "mass_A=80 t", "--set", "mu=0.3")
    done = crashsolve(DECK, "-o", tmp_path, "--set", "control.estimate=off", *changes)
    assert done.returncode == 0, done.stderr
    result = Result(tmp_path)
    momentum = result.series("glstat.model.momentum.x").values
    assert np.abs(momentum / (80e3 * 10.0) - 1.0).max() < 1e-9
    assert result.series("rcforc.A_rails.normal").values[0] == pytest.approx(9.81 * 80e3, rel=1e-9)
