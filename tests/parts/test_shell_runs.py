"""Claim: shells go on to the same bits, draw what they computed, and stop where unstable."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve, datasets, gone_on

from crashpost.results.result import Result

BALL = Path(__file__).resolve().parents[2] / "decks/verification/parts/shell_ball.yaml"
# a worker compiles the scene once
pytestmark = pytest.mark.xdist_group("shells")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The ball on the plate, yielding and thinning, with dumps, and its results."""
    folder = tmp_path_factory.mktemp("ball")
    deck = folder / "ball.yaml"
    text = BALL.read_text("utf-8").partition("expect:")[0]
    text = text.replace("type: elastic,", "type: elastoplastic, yield_stress: 2e8,")
    text = text.replace("layers: 2", "layers: 3\n    thinning: true")
    text = text.replace("2.4e-3", "4e-4").replace(
        "{history: {interval: 2e-5}}",
        "{history: {interval: 2e-5}, states: {interval: 1e-4}, restart: {every: 1e-4}}",
    )
    deck.write_text(text, "utf-8")
    done = crashsolve(deck, "-o", folder / "whole")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "plate_" in done.stdout  # an element sets the step
    return deck, folder / "whole"


@pytest.mark.long
def test_a_plate_goes_on_from_its_dump_to_the_same_bits(
    whole: tuple[Path, Path], tmp_path: Path
) -> None:
    deck, folder = whole
    gone_on(deck, folder, tmp_path / "again")


def test_states_hold_what_histories_hold(whole: tuple[Path, Path]) -> None:
    _, folder = whole
    mesh, result = datasets(folder / "mesh.h5"), Result(folder)
    assert mesh["part_plate/cells"].shape == (400, 4)
    with h5py.File(folder / "states" / "000004.h5") as file:
        moment = float(file.attrs["time"])
        fields = {name: file["part_plate"][name][:] for name in file["part_plate"]}
    series = result.series("rbdout.plate_mid.position.z")
    position = float(np.interp(moment, series.time, series.values))
    # single precision
    assert fields["displacement"][:, 2].min() == pytest.approx(position, rel=1e-6)
    assert fields["displacement"].shape == (441, 3)
    assert (fields["plastic_strain_top"] > 0.0).any()
    assert fields["thickness"].min() < 0.002
    # the energies of all elements are those of the part
    area = (0.3 / 20) ** 2
    plastic = (fields["plastic_energy_density"] * 0.002 * area).sum()
    reported = result.series("matsum.plate.plastic").values[-1]
    assert plastic == pytest.approx(reported, rel=1e-5)
    assert (fields["von_mises"] < 2e8 * (1.0 + 1e-6)).all()


def test_energies_of_shells_are_booked_under_their_own_names(whole: tuple[Path, Path]) -> None:
    result = Result(whole[1])

    def values(channel: str) -> np.ndarray:
        return result.series(channel).values

    of_part = {"elastic": "strain", "hourglass": "hourglass", "plastic": "plastic"}
    for entry, name in of_part.items():
        reported = values(f"glstat.model.energy.{entry}")
        assert reported.max() > 0.0
        assert np.array_equal(reported, values(f"matsum.plate.{name}"))
    internal = values("matsum.plate.strain") + values("matsum.plate.plastic")
    assert np.array_equal(values("glstat.model.energy.internal"), internal)
    # the ball meets the plate, and there is no spring
    assert not values("glstat.model.energy.spring_dissipated").any()


def test_a_step_too_long_is_stopped(tmp_path: Path) -> None:
    # five times the stable one
    done = crashsolve(BALL, "-o", tmp_path / "long", "--set", "control.step=1.2e-5")
    assert done.returncode == 4
    # by a guard of energy, the model's or the contact's, before motion has grown beyond all bounds
    last = done.stderr.splitlines()[-1]
    assert "the energy balance is off by" in last or "more than it took" in last
    assert "take a shorter step" in last
    result = Result(tmp_path / "long")
    for channel in result.channels("*"):
        assert np.isfinite(result.series(channel.name).values).all(), channel.name
    # what has no energy to stand on is not answered: the files end before
    kinetic = result.series("glstat.model.energy.kinetic").values
    assert kinetic.max() < 11.0 * kinetic[0]


def test_a_curve_that_ends_for_a_step_too_long_says_so(tmp_path: Path) -> None:
    deck = tmp_path / "ball.yaml"
    text = BALL.read_text("utf-8").partition("expect:")[0]
    text = text.replace("type: elastic,", "type: elastoplastic, curve: flow,")
    deck.write_text(text + "curves: {flow: {points: [[0, 2e8], [0.02, 3e8]]}}\n", "utf-8")
    # without guards of energy, which would see it first
    words = ("--set", "control.step=4.8e-6", "--set", "control.energy_limit=off")
    done = crashsolve(deck, "-o", tmp_path / "long", *words)
    assert done.returncode == 4
    last = done.stderr.splitlines()[-1]
    # half as long again as is stable
    assert "curve 'flow': read at 0.02" in last and "with a step 1.6 times" in last
