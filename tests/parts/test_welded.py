"""Claims of nodes welded to a rigid body: its mass is theirs too, and nothing is lost between."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from bench import refusal
from command import crashsolve, differences

from crashpost.results.result import Result
from crashsolve.cli import main
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build

DECK = Path(__file__).resolve().parents[2] / "decks/verification/parts/welded.yaml"
TEXT = DECK.read_text("utf-8").partition("expect:")[0]
# a worker compiles the scene once
pytestmark = pytest.mark.xdist_group("welded")


def run(folder: Path, out: str, control: str, *words: str) -> Path:
    deck = folder / "deck.yaml"
    text = TEXT.replace("end_time: 0.2, step: 2e-5", control)
    assert control in text
    deck.write_text(text, "utf-8")
    done = crashsolve(deck, "-o", folder / out, *words)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / out


@pytest.mark.long
def test_methods_of_high_order_keep_the_momentum_too(tmp_path: Path) -> None:
    control = "end_time: 0.05, integrator: dormand_prince_8, tolerance: 1e-8"
    result = Result(run(tmp_path, "out", control))
    for name in ("momentum_error", "angular_momentum_error", "balance"):
        # of a method that conserves neither momentum nor energy by itself: its tolerance
        assert np.abs(result.series(f"glstat.model.{name}").values).max() < 1e-6
    apart = "rbdout.east_end.position.x - rbdout.east_2_end.position.x"
    assert np.abs(result.series(apart).values).max() < 1e-7


@pytest.mark.long
def test_a_run_with_welded_nodes_goes_on_to_the_same_bits(tmp_path: Path) -> None:
    control = "end_time: 0.02, step: 2e-5}\noutput: {restart: {every: 4e-3}"
    whole, again = run(tmp_path, "whole", control), tmp_path / "again"
    shutil.copytree(whole, again)
    max(again.glob("restart_*.h5"), key=lambda path: path.stat().st_mtime_ns).unlink()
    run(tmp_path, "again", control, "--restart")
    assert differences(again, whole) == []


def test_the_body_has_the_mass_and_inertia_of_all(tmp_path: Path) -> None:
    model, state = build(read_deck(DECK))
    hub, names = model.bodies.index("hub"), model.bodies
    welded = [names.index(name) for name in ("east_start", "plate", "north_start")]
    assert not model.mass[welded].any()
    others = ("east_2_start", "plate_2", "north_2_start")
    others_mass = sum(model.mass[names.index(name)] for name in others)
    assert model.mass[hub] == pytest.approx(0.5 + others_mass, rel=1e-14)
    # by pairs of the same parts apart: angular momentum about the origin of each
    apart = ["joined", *others]
    here, there = moment(state.nodes, model, ["hub"], 0.0), moment(state.nodes, model, apart, 5.0)
    np.testing.assert_allclose(here, there, rtol=1e-12, atol=1e-15)


def moment(nodes: np.ndarray, model: object, names: list[str], height: float) -> np.ndarray:
    """Angular momentum of some bodies about the world's z axis point at a height."""
    some = nodes[[model.bodies.index(name) for name in names]]  # type: ignore[attr-defined]
    p = some["v"] / some["mass_inv"][:, None]
    return (np.cross(some["r"] - [0.0, 0.0, height], p) + some["L"]).sum(0)


WRONG = {
    "twice": ("welded: [east_start]", "welded: [east_start, east_start]", "is welded twice"),
    "rigid": ("welded: [east_start]", "welded: [joined]", "'joined' is no node of a flexible part"),
    "motion": ("welded: [east_start]", "welded: [east_1]", "'east_1' begins"),
    "unknown": ("welded: [east_start]", "welded: [east_begin]", "unknown body 'east_begin'"),
    "joint": ("b: east_2_start", "b: east_start", "'east_start' is welded to 'hub' and is no body"),
    "joint of a part": ("b: plate_2,", "b: plate,", "'plate' is welded to 'hub' and is no body"),
    "method": ("step: 2e-5", "integrator: radau_iia_5", "'welded' is for explicit integrators"),
    "part of itself": ("part_of: hub", "part_of: plate", "must name another body"),
    "part of the ground": ("part_of: hub", "part_of: ground", "must name another body"),
    "part of a node": ("part_of: hub", "part_of: east_1", "'east_1' is a node of a part"),
    "part of a part": (
        "position: [0, 0, 5]}",
        "position: [0, 0, 5], part_of: plate}",
        "'plate' is part of 'hub' itself; name 'hub'",
    ),
    "part in motion": (
        'velocity: &at_north ["${-0.1*spin}", 0, 0.5]',
        "velocity: &at_north [0, 1, 0]",
        "'plate' begins",
    ),
    "part that turns": (
        'angular_velocity: &tumbling [5, 0, "${spin}"]',
        'angular_velocity: &tumbling [5, 1, "${spin}"]',
        "begins with another angular velocity than 'hub', by 1 rad/s",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_weld_is_refused(case: str, tmp_path: Path) -> None:
    old, new, message = WRONG[case]
    assert old in TEXT
    text = TEXT.replace(old, new)
    if case == "motion":
        text = text.replace('velocity: [0, "${0.1*spin}", 0]', "velocity: [0, 1, 0]")
    assert message in refusal(tmp_path, text)


@pytest.mark.parametrize("integrator", ["rattle", "dormand_prince_5"])
def test_a_body_that_is_part_of_another_is_accelerated_as_its_velocity_changes(
    tmp_path: Path, integrator: str
) -> None:
    """A turning plate under an eccentric force: central differences of the velocity."""
    deck = tmp_path / "deck.yaml"
    deck.write_text(
        f"control: {{end_time: 0.02, estimate: off, integrator: {integrator}}}\n"
        "output: {history: {interval: 1e-4}}\n"
        "bodies:\n"
        "  c: {mass: 1, inertia: [1, 1, 1], angular_velocity: [0, 0, 10]}\n"
        "  d: {mass: 1, inertia: [1, 1, 1], position: [1, 0.5, 0], part_of: c,\n"
        "    velocity: [-5, 10, 0], angular_velocity: [0, 0, 10]}\n"
        "loads: {f: {type: force, body: c, at: [0, 1, 0], force: [100, 0, 0]}}\n",
        "utf-8",
    )
    assert main(["run", str(deck), "-o", str(tmp_path / "out")]) == 0
    result = Result(tmp_path / "out")
    for axis in "xy":
        acceleration = result.series(f"rbdout.d.acceleration.{axis}").values[1:-1]
        velocity = result.series(f"rbdout.d.velocity.{axis}").values
        slope = (velocity[2:] - velocity[:-2]) / 2e-4
        # h^2 w^2 / 6 of differences over 0.1 ms at 11 rad/s
        assert np.abs(acceleration).max() > 10.0
        assert acceleration == pytest.approx(slope, rel=1e-5, abs=1e-3)
