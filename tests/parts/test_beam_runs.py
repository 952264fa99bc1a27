"""Claim: a run with beams goes on to the same bits after a stop, and draws what it computed."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve, datasets, gone_on

from crashpost.result import Result

FLIGHT = Path(__file__).resolve().parents[2] / "decks/verification/parts/free_flight.yaml"
# a worker compiles the scene once
pytestmark = pytest.mark.xdist_group("beams")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The deck with dumps, and its results."""
    folder = tmp_path_factory.mktemp("flight")
    deck = folder / "flight.yaml"
    deck.write_text(FLIGHT.read_text("utf-8") + "output: {restart: {every: 0.01}}\n", "utf-8")
    done = crashsolve(deck, "-o", folder / "whole")
    assert done.returncode == 0, done.stdout + done.stderr
    return deck, folder / "whole"


def test_a_flight_goes_on_from_its_dump_to_the_same_bits(
    whole: tuple[Path, Path], tmp_path: Path
) -> None:
    deck, folder = whole
    assert "t = 0.04 s" in gone_on(deck, folder, tmp_path / "again")


def test_elements_are_drawn_between_their_nodes_with_what_they_bear(
    whole: tuple[Path, Path],
) -> None:
    _, folder = whole
    mesh, result = datasets(folder / "mesh.h5"), Result(folder)
    path = folder / "states" / "000025.h5"
    with h5py.File(path) as file:
        moment = float(file.attrs["time"])
    state = datasets(path)
    ends = mesh["beams/points"] + state["beams/displacement"]
    assert ends.shape == (16, 3)

    def value(name: str) -> float:
        times, values, _ = result.series(name)
        return float(values[np.argmin(np.abs(times - moment))])

    for k, node in ((0, "start"), (1, "1"), (2, "1"), (15, "end")):
        place = [value(f"rbdout.tube_{node}.position.{axis}") for axis in "xyz"]
        # states are written in single precision
        np.testing.assert_allclose(ends[k], place, atol=1e-6)
    for column in ("force", "moment_a", "moment_b"):
        wanted = [[value(f"elout.tube_{k + 1}.{column}.{i}") for i in "xyz"] for k in range(8)]
        size = np.abs(wanted).max()
        np.testing.assert_allclose(state[f"beams/{column}"], wanted, rtol=1e-6, atol=1e-6 * size)
    length = np.linalg.norm(np.diff(mesh["beams/points"].reshape(8, 2, 3), axis=1)[:, 0], axis=1)
    stored = state["beams/elastic_energy_density"] @ length
    assert stored == pytest.approx(value("glstat.model.energy.spring_stored"), rel=1e-6)
