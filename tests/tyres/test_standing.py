"""Claims of tyres that stand: an equilibrium start holds a car on a slope, up to friction."""

from pathlib import Path

import numpy as np
import pytest
from quick import first_quick

from crashpost.results.result import Result
from crashsolve import run
from crashsolve.scripting import RunFailed

M, G, MU, C_X, C_Y, SIGMA_X, SIGMA_Y = 1000.0, 9.81, 0.6, 8e4, 6e4, 0.1, 0.3


def solved(folder: Path, text: str) -> Result:
    path = folder / "deck.yaml"
    path.write_text(f"title: A car on a slope\n{text}", "utf-8")
    return Result(run(path, folder / "results"))


def car(tyre: str, along: float, across: float, velocity: float = 0.0, height: float = 0.5) -> str:
    """A body on four locked wheels on slopes in both directions."""
    n = np.array([-along, -across, 1.0]) / np.sqrt(1 + along**2 + across**2)
    corners = {"fl": (1.1, 0.7), "fr": (1.1, -0.7), "rl": (-1.4, 0.7), "rr": (-1.4, -0.7)}
    tyres = "".join(
        f"  {name}: {{type: {tyre}, wheel: car, at: [{x}, {y}, -0.2], road: [road], radius: 0.32,"
        f" stiffness: 2e5, damping: 3000, slip_stiffness: {C_X}, cornering_stiffness: {C_Y},"
        f" relaxation: {SIGMA_X}, side_relaxation: {SIGMA_Y}, friction_max: {MU}}}\n"
        for name, (x, y) in corners.items()
    )
    return (
        "control: {end_time: 0.5, step: 5e-4, start: equilibrium, estimate: off}\n"
        "output: {history: {interval: 0.01}}\n"
        f"bodies: {{car: {{mass: {M}, inertia: [400, 1300, 1500], position: [0, 0, {height}],"
        f" velocity: [{velocity}, 0, 0]}}}}\n"
        f"surfaces: {{road: {{type: plane}}}}\ntyres:\n{tyres}"
        f"loads: {{w: {{type: gravity, acceleration: {(-G * n * [-1, -1, 1]).tolist()}}}}}\n"
    )


@pytest.mark.parametrize("tyre", first_quick(["gim", "fiala"]))
@pytest.mark.parametrize("along, across", first_quick([(0.0, 0.35), (0.2, 0.0), (-0.3, 0.1)]))
def test_a_car_with_locked_wheels_stands_on_a_slope(
    tmp_path: Path, tyre: str, along: float, across: float
) -> None:
    result = solved(tmp_path, car(tyre, along, across))
    weight = M * G / np.sqrt(1 + along**2 + across**2)
    names = ("fl", "fr", "rl", "rr")
    for axis, share in (("x", along), ("y", across), ("z", 1.0)):
        force = sum(result.series(f"tyrout.{n}.force.{axis}").values for n in names)
        # 1 % of the static loads is allowed; the search ends at 1e-11 of the size of 2.5 m, which
        # springs of 1e6 N/m answer with 1e-5 N
        assert np.abs(force - share * weight).max() < 1e-4
    speed = [np.abs(result.series(f"rbdout.car.velocity.{axis}").values).max() for axis in "xyz"]
    assert max(speed) < 1e-8
    assert np.abs(result.series("glstat.model.balance").values).max() < 1e-8


def test_it_hangs_in_the_springs_of_its_carcasses(tmp_path: Path) -> None:
    result = solved(tmp_path, car("gim", 0.02, 0.0))
    # four brushes of C/sigma, softer than that by what slides: q/(3 mu F) of the patch, 1 % each
    slips = np.mean([result.series(f"tyrout.{n}.slip").values[0] for n in ("fl", "fr", "rl", "rr")])
    assert abs(slips) == pytest.approx(0.02 * M * G / (4 * C_X), rel=0.05)


@pytest.mark.parametrize("along, across", first_quick([(-0.5, 0.4), (0.65, 0.0), (0.0, 0.65)]))
def test_a_slope_steeper_than_friction_is_refused(
    tmp_path: Path, along: float, across: float
) -> None:
    with pytest.raises(
        RunFailed, match=r"there is no equilibrium.*tyres slide and carry no more force"
    ):
        solved(tmp_path, car("gim", along, across))


def test_a_car_that_rolls_is_not_held(tmp_path: Path) -> None:
    with pytest.raises(RunFailed, match="there is no equilibrium"):
        solved(tmp_path, car("gim", 0.2, 0.0, velocity=1.0))


def test_being_set_down_leaves_no_forces_across(tmp_path: Path) -> None:
    result = solved(tmp_path, car("gim", 0.0, 0.0, height=0.62))
    for name in ("fl", "fr", "rl", "rr"):
        for axis in "xy":
            # of 2450 N; what it pitched as it was set down, let go twice
            assert abs(result.series(f"tyrout.{name}.force.{axis}").values[0]) < 1.0


@pytest.mark.parametrize("tyre", first_quick(["gim", "fiala"]))
def test_a_tyre_that_sinks_to_its_centre_is_reported(tmp_path: Path, tyre: str) -> None:
    # it would sag by 0.35 m, beyond its radius of 0.32
    soft = car(tyre, 0.0, 0.0).replace("stiffness: 2e5", "stiffness: 7e3")
    soft = soft.replace("damping: 3000", "damping: 100")
    log = (
        solved(tmp_path, soft.replace("start: equilibrium, ", "")).folder / "log.txt"
    ).read_text()
    assert "tyre 'fl': the wheel centre has reached the road" in log


def test_two_roads_in_one_plane_are_reported(tmp_path: Path) -> None:
    text = car("gim", 0.0, 0.0).replace("start: equilibrium, ", "").replace("[road]", "[road, two]")
    both = text.replace("{road: {type: plane}}", "{road: {type: plane}, two: {type: plane}}")
    message = "tyre 'fl': two roads pressed it from one side, and their forces were added"
    assert message in (solved(tmp_path, both).folder / "log.txt").read_text()
    # a kerb beside it does not
    kerb = "two: {type: box, at: [1.5, 0, 0], size: [0.4, 4, 0.2]}"
    apart = text.replace("{road: {type: plane}}", f"{{road: {{type: plane}}, {kerb}}}")
    assert message not in (solved(tmp_path, apart).folder / "log.txt").read_text()


def test_a_car_dropped_on_its_tyres_is_seen_before_it_lands(tmp_path: Path) -> None:
    """Off the road nothing else bounds the step; the first one would go through it."""
    drop = car("gim", 0.0, 0.0, height=0.57).replace("start: equilibrium, ", "")
    result = solved(
        tmp_path, drop.replace("step: 5e-4, ", "").replace("damping: 3000", "damping: 0")
    )
    height = result.series("rbdout.car.position.z").values
    # it falls 0.05 m to the road, and on springs of 8e5 N/m goes on by
    # m g (1 + sqrt(1 + 2 k h/m g))/k
    k, h = 8e5, 0.05
    deepest = M * G / k * (1 + np.sqrt(1 + 2 * k * h / (M * G)))
    assert 0.52 - height.min() == pytest.approx(deepest, rel=5e-3)
    # %, of a step that meets the road at any point of itself
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.5


def test_the_height_of_a_flying_wheel_does_not_shorten_the_step(tmp_path: Path) -> None:
    """It will meet the road in its circle, whose points are no farther from it at any height.

    Both fall for 0.1 s; the lower one has 0.5 m more to go then.
    """
    cycles = []
    for height in (1.1, 50.0):
        drop = car("gim", 0.0, 0.0, height=height).replace("start: equilibrium, ", "")
        drop = drop.replace("end_time: 0.5, step: 5e-4", "end_time: 0.1")
        drop = drop.replace("damping: 3000", "damping: 0")
        (folder := tmp_path / f"{height}").mkdir()
        cycles.append(solved(folder, drop).status["cycle"])
    assert cycles[0] == cycles[1]
