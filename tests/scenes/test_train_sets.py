"""Claims of the train sets: the deck's own, and what would make it lie, each on few bodies."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command import crashsolve
from quick import first_quick

from crashpost.cli import main as crashpost
from crashpost.results.result import Result

SCENES = Path(__file__).parents[2] / "decks" / "scenes"
SHARED = SCENES / "shared"
MASS, LENGTH, MU, GRAVITY = 34e3, 26.0, 0.15, 9.81


def car(name: str, position: str, train: str, dimension: str) -> dict[str, object]:
    """An include of the one car that all decks share."""
    words = {"car": name, "x": position, "mass": "mass_1", "length": "length_1"}
    words |= {"train": train, "left": "LE", "right": "LE", "dimension": dimension}
    return {"file": str(SHARED / "rail_car.yaml"), "with": words}


def run(folder: Path, scene: dict[str, Any], end: float, interval: float) -> Result:
    """Result of a small scene."""
    control = {"end_time": end, "energy_limit": 0.01, "estimate": "off"}
    output = {"history": {"interval": interval}, "states": {"interval": end}}
    scene["include"] = [str(SHARED / "rail_numbers.yaml"), *scene["include"]]
    weight = {"weight": {"type": "gravity", "acceleration": [0, 0, -GRAVITY]}}
    scene["loads"] = scene.get("loads", {}) | weight
    deck = {"control": control, "output": output} | scene
    path = folder / "deck.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    done = crashsolve(path, "-o", folder / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    return Result(folder / "out")


def values(result: Result, channel: str) -> np.ndarray:
    series: np.ndarray = result.series(channel).values
    return series


def one_car(speed: float, dimension: str = "plane", mu: float = MU) -> dict[str, Any]:
    motion = {"v_parked": speed, "mu_parked": mu, "lift_parked": 0.0, "aside_parked": 0.0}
    return {
        "parameters": {"mass_1": MASS, "length_1": LENGTH, "x_1": 0.0} | motion,
        "include": [
            str(SHARED / f"rail_{dimension}.yaml"),
            car("car", "x_1", "parked", dimension),
        ],
    }


@pytest.mark.long
def test_a_braked_car_that_stands_does_not_move(tmp_path: Path) -> None:
    # settled by closed form, so nothing bounces; brakes push nothing backwards
    result = run(tmp_path, one_car(0.0), 0.02, 2e-3)
    # 1e-9: round-off of a force of 334 kN over its stiffness is 1e-17 m
    for body in ("car", "car_bogie_1", "car_left"):
        for axis in "xz":
            assert np.abs(values(result, f"rbdout.{body}.velocity.{axis}")).max() < 1e-9
    assert values(result, "rcforc.car_rails.normal") == pytest.approx(MASS * GRAVITY, rel=1e-9)
    assert np.abs(values(result, "rcforc.car_rails.tangential")).max() < 1e-3
    assert values(result, "rcforc.car_rails.touching").min() == 4


@pytest.mark.long
def test_brakes_stop_a_car_and_no_more(tmp_path: Path) -> None:
    speed = 0.3
    result = run(tmp_path, one_car(speed), 0.5, 5e-3)
    speeds = values(result, "glstat.model.momentum.x") / MASS
    # wheels slide at mu m g once their bristles are stretched; 1 %: found to 1e-4
    early = (result.time > 0.02) & (result.time < 0.15)
    assert np.abs(speeds - (speed - MU * GRAVITY * result.time))[early].max() < 0.01 * speed
    # then bristles, 4 * 1e7 N/m, and pivots, 2 * 5e6 N/m, swing by what mu m g stretches them
    give = MU * MASS * GRAVITY * (1.0 / 4e7 + 1.0 / 1e7)
    stop = speed**2 / (2.0 * MU * GRAVITY)
    position = values(result, "rbdout.car.position.x")
    assert stop - 2.0 * give < position[-1] < stop + 0.5 * give
    assert speeds.min() > -np.sqrt(MU * GRAVITY * give)
    limit = MU * values(result, "rcforc.car_rails.normal") * (1.0 + 1e-9)
    assert (np.abs(values(result, "rcforc.car_rails.tangential")) <= limit + 1e-3).all()
    # rubbing only takes
    assert np.diff(values(result, "rcforc.car_rails.friction_dissipated")).min() >= -1e-6


@pytest.mark.long
def test_a_coupler_pulls_until_it_breaks_and_nothing_else_pulls(tmp_path: Path) -> None:
    speed = 5.0
    names = {"n": "1_2", "a": "a", "b": "b"}
    lengths = {"length_a": "length_1", "length_b": "length_1"}
    # b rolls away from a, which stands
    scene = one_car(0.0, mu=0.0) | {
        "include": [
            str(SHARED / "rail_plane.yaml"),
            car("a", "x_a", "parked", "plane"),
            car("b", "x_b", "moving", "plane"),
            {
                "file": str(SHARED / "rail_interface.yaml"),
                "with": names | {"dimension": "plane"},
            },
            {"file": str(SHARED / "rail_coupler.yaml"), "with": names | lengths},
        ]
    }
    positions = {"x_a": -LENGTH / 2 - 0.005, "x_b": LENGTH / 2 + 0.005}
    moving = {"v_moving": speed, "mu_moving": 0.0, "lift_moving": 0.0, "aside_moving": 0.0}
    scene["parameters"] |= positions | moving
    del scene["parameters"]["x_1"]
    result = run(tmp_path, scene, 0.04, 5e-4)
    pull = values(result, "deforc.coupler_1_2.force")
    longer = values(result, "deforc.coupler_1_2.elongation")
    assert pull.min() >= 0.0
    for end in ("a_right", "b_left"):
        assert values(result, f"deforc.{end}_end.force").max() <= 0.0
    assert values(result, "rcforc.plates_1_2.normal").max() == 0.0
    momentum = values(result, "glstat.model.momentum.x")
    assert np.abs(momentum / (MASS * speed) - 1.0).max() < 1e-9
    # up its slope of 10 MN/m, down to nothing at 0.13 m, and then no more
    rising = (longer > 0.0) & (longer < 0.1)
    assert np.abs(pull - 1e7 * longer)[rising].max() < 1.0
    assert longer[-1] > 0.14
    assert pull[longer > 0.13].max() == 0.0
    # it has taken the area of its curve, 0.13 m * 1 MN / 2; dampers of pivots and ends take little
    lost = values(result, "glstat.model.energy.spring_dissipated")[-1]
    assert 65e3 * (1.0 - 1e-9) < lost < 1.2 * 65e3


def two_ends(high: Mapping[str, object]) -> dict[str, object]:
    """The heavy right end of a car a, the light left end of a car b, and where both cars begin."""
    low = {"mass": 1e9, "inertia": [1e9, 1e9, 1e9], "position": [-0.3, 0, 0]}
    words = {"n": "1_2", "a": "a", "b": "b", "dimension": "plane"}
    return {
        "include": [
            str(SHARED / "rail_plane.yaml"),
            {"file": str(SHARED / "rail_interface.yaml"), "with": words},
        ],
        "bodies": {"a_right": low, "b_left": {"inertia": [1e9, 1e9, 1e9], **high}},
        "surfaces": {
            "b_left_shell": {"type": "box", "body": "b_left", "size": [0.6, 2.6, 0.5]},
            "a_shell": {"type": "box", "at": [-6, 0, 0], "size": [10, 5, 4]},
            "b_shell": {"type": "box", "at": [16, 0, 0], "size": [10, 5, 4]},
        },
        "loads": {},
    }


@pytest.mark.parametrize("higher", first_quick([0.0, 0.4]))
def test_an_end_that_is_higher_than_the_other_passes_it_and_meets_the_car(
    tmp_path: Path, higher: float
) -> None:
    speed, mass = 10.0, 1e3
    end = {"mass": mass, "position": [0.31, 0, higher], "velocity": [-speed, 0, 0]}
    result = run(tmp_path, two_ends(end), 0.2, 1e-3)
    plates = values(result, "rcforc.plates_1_2.normal").max()
    car_of_a = values(result, "rcforc.under_1_2.normal")
    if higher == 0.0:
        # rebounds: of k_plate and c_plate
        assert plates > 0.0 and car_of_a.max() == 0.0
        assert values(result, "rbdout.b_left.velocity.x")[-1] > 0.0
    else:
        # the plate reaches 0.25 m up; the car of a begins 1 m behind it, and takes all of m v^2 / 2
        assert plates == 0.0
        assert not car_of_a[result.time < 0.1].any()
        crush = -1.0 - values(result, "rbdout.b_left.position.x").min() + 0.3
        # of the curve: 1.5 MN from 0.1 m on; the dashpot of 3e4 N s/m takes some of it
        assert 0.0 < crush < np.sqrt(mass * speed**2 / 1.5e7)


@pytest.mark.parametrize(("apart", "locks"), [(-0.001, True), (0.12, False)])
def test_ribs_lock_beyond_their_play_while_ends_are_near(
    tmp_path: Path, apart: float, locks: bool
) -> None:
    # the right end rises past the left one, which is heavy; plates without friction
    speed, light, stiffness, play = 1.0, 1e3, 2e7, 0.13
    high = {"mass": light, "position": [0.3 + apart, 0, 0], "velocity": [0, 0, speed]}
    scene = two_ends(high)
    numbers = (SHARED / "rail_numbers.yaml").read_text("utf-8")
    assert f"k_rib: {stiffness:.1e}".replace("e+0", "e+") in numbers
    result = run(tmp_path, scene, 0.15, 1e-3)
    gap = values(result, "disbout.gap_1_2.vector.z")
    if locks:
        # m v^2 / 2 against the rib alone: v sqrt(m / k) = 7 mm; its dashpot makes it less
        assert play < gap.max() < play + speed * np.sqrt(light / stiffness)
        assert values(result, "rcforc.ribs_1_2.force.z").max() > 0.0
    else:
        # the tooth is 5 cm behind the plate, ribs reach 15 cm: free beyond 10 cm
        assert gap[-1] == pytest.approx(speed * 0.15, rel=1e-9)
        assert np.abs(values(result, "rcforc.ribs_1_2.force.z")).max() == 0.0


@pytest.mark.long  # 30 s of CPU, 25 of them compiling
@pytest.mark.parametrize("speed", [30, 55])
def test_the_decks_own_expectations_are_met(tmp_path: Path, speed: int) -> None:
    words = ("--set", f"speed={speed} km/h", "--set", "control.estimate=off")
    done = crashsolve(SCENES / "train_sets.yaml", "-o", tmp_path, *words)
    assert done.returncode == 0, done.stdout + done.stderr
    assert crashpost(["expect", str(tmp_path)]) == 0
