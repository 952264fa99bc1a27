"""Claim: a run with beams goes on to the same bits after a stop, and draws what it computed."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve, datasets, gone_on

from crashpost.results.result import Result

DECKS = Path(__file__).resolve().parents[2] / "decks/verification/parts"
FLIGHT, ROLL_UP = DECKS / "free_flight.yaml", DECKS / "roll_up.yaml"
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


@pytest.mark.long
def test_a_flight_goes_on_from_its_dump_to_the_same_bits(
    whole: tuple[Path, Path], tmp_path: Path
) -> None:
    deck, folder = whole
    assert "t = 0.04 s" in gone_on(deck, folder, tmp_path / "again")


def test_elements_are_drawn_between_their_nodes_with_their_forces(
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
        position = [value(f"rbdout.tube_{node}.position.{axis}") for axis in "xyz"]
        # states are written in single precision
        np.testing.assert_allclose(ends[k], position, atol=1e-6)
    for column in ("force", "moment_a", "moment_b"):
        wanted = [[value(f"elout.tube_{k + 1}.{column}.{i}") for i in "xyz"] for k in range(8)]
        size = np.abs(wanted).max()
        drawn = np.column_stack([state[f"beams/{column}_{i}"] for i in "xyz"])
        np.testing.assert_allclose(drawn, wanted, rtol=1e-6, atol=1e-6 * size)
    length = np.linalg.norm(np.diff(mesh["beams/points"].reshape(8, 2, 3), axis=1)[:, 0], axis=1)
    stored = state["beams/elastic_energy_density"] @ length
    assert stored == pytest.approx(value("glstat.model.energy.elastic"), rel=1e-6)


# squares of 1e-2 reach 3e-10, a thirtieth of the tolerance, in four iterations; without the turning
# of forces 10.6 were taken. Stages one after the other leave 0.37 each: seven reach a thirtieth of
# the tolerance, without the turning 11.5 did. A hundredth of the error of a stated step, some
# thirty times less, takes log(30)/log(1/0.37) = 3.4 more
ITERATIONS = {"generalized_alpha": (0.05, 1e-8, 4.5), "radau_iia_5": (0.125, 1e-6, 10.5)}


@pytest.mark.parametrize("method", list(ITERATIONS))
def test_steps_that_bend_far_take_few_iterations(method: str, tmp_path: Path) -> None:
    """Two elements bend by 1.3 rad in a second."""
    step, tolerance, most = ITERATIONS[method]
    text = ROLL_UP.read_text("utf-8").partition("expect:")[0]
    assert "n: 10" in text and "end_time: 40, integrator: radau_iia_5, tolerance: 1e-5" in text
    text = text.replace("n: 10", "n: 2").replace(
        "end_time: 40, integrator: radau_iia_5, tolerance: 1e-5",
        f"end_time: 1, integrator: {method}, tolerance: {tolerance}, step: {step}",
    )
    deck = tmp_path / "deck.yaml"
    deck.write_text(text + "output: {history: {interval: 0.25}}\n", "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out", CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stdout + done.stderr
    assert (
        f"steps accepted, rejected                            {round(1 / step)}, 0" in done.stdout
    )
    reported = next(line for line in done.stdout.splitlines() if "iterations per step" in line)
    assert float(reported.split()[-1]) < most


ROPE = """
control: {end_time: 0.3, integrator: generalized_alpha, tolerance: 1e-3, estimate: "off"}
materials: {thin: {type: elastic, young: 1, poisson: 0, density: 1e-6}}
sections: {strip: {type: general, area: 1e5, I_y: 1, I_z: 1, torsion: 1, shear_y: 2, shear_z: 2}}
parts:
  p:
    type: beam
    mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 2}
    section: strip
    material: thin
    damping: 0.02
bodies: {hand: {mass: 1, inertia: [1, 1, 1], position: [1, 0.3, 0]}}
joints:
  root: {type: weld, b: p_start, at: [0, 0, 0]}
  guide: {type: prismatic, b: hand, at: [1, 0.3, 0], axis: [0, 1, 0]}
  motor: {type: point_driver, body: hand, axis: [0, 1, 0], curve: displacement}
curves: {displacement: {type: formula, expression: "0.25*(1 - cos(3.141592653589793*x))", from: 0, to: 1}}
springs:
  rope: {type: linear, a: hand, b: p_end, at_a: [1, 0.3, 0], at_b: [1, 0, 0], stiffness: 20, length: 0}
output: {history: {interval: 0.1}}
"""  # noqa: E501


@pytest.mark.long
def test_a_rope_that_pulls_and_turns_takes_few_iterations(tmp_path: Path) -> None:
    """Its tension over its length is above what the light beam resists the same way."""
    deck = tmp_path / "deck.yaml"
    deck.write_text(ROPE, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out", CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stdout + done.stderr
    reported = next(line for line in done.stdout.splitlines() if "iterations per step" in line)
    # without the turning of its force 5.4 were taken
    assert float(reported.split()[-1]) < 3.0
