"""Claims of the sports car: suspension by an independent calculation, statements of the chapter."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.results.result import Result

SCENES = Path(__file__).parents[2] / "decks" / "scenes"
MASS, GRAVITY, WHEELBASE, SPEED = 980.0, 9.81, 2.18, 13.4
# one worker runs all of them, and compiles each scene once
pytestmark = pytest.mark.xdist_group("sports_car")


def run(deck: str, folder: Path, **values: object) -> Result:
    words = [word for name, value in values.items() for word in ("--set", f"{name}={value}")]
    done = crashsolve(SCENES / deck, "-o", folder, "--set", "control.estimate=off", *words)
    assert done.returncode == 0, done.stderr
    assert "N o r m a l" in done.stdout
    return Result(folder)


def rotation(w: np.ndarray) -> np.ndarray:
    """Matrix of the rotation vector w (3,) by Rodrigues' formula."""
    angle = np.linalg.norm(w)
    if angle < 1e-300:
        return np.eye(3)
    x, y, z = w / angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def newton(residual: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    for _ in range(50):
        columns = [(residual(x + e) - residual(x - e)) / 2e-7 for e in 1e-7 * np.eye(6)]
        step = np.linalg.solve(np.array(columns).T, residual(x))
        x = x - step
        if np.linalg.norm(step) < 1e-14:
            break
    assert np.abs(residual(x)).max() < 1e-12
    return x


# y of hard points over those of the cars they are taken from
FRONT, REAR = 0.715 / 0.80, 0.715 / 0.94
# what a point of the upright keeps its distance to, from the origin of the hard points: scenes.md L
ROUND = {
    "front": [
        ((-0.04, 0.695 * FRONT, 0.105), (-0.1, 0.47 * FRONT, 0.105)),
        ((-0.04, 0.695 * FRONT, 0.105), (-0.25, 0.51 * FRONT, 0.11)),
        ((0, 0.77 * FRONT, -0.32), (0.2, 0.42 * FRONT, -0.27)),
        ((0, 0.77 * FRONT, -0.32), (-0.2, 0.47 * FRONT, -0.265)),
        ((-0.15, 0.77 * FRONT, -0.12), (-0.2, 0.44, -0.096)),
    ],
    "rear": [
        ((-0.02165, 0.94058 * REAR, -0.17403), (0.22, 0.52 * REAR, -0.156)),
        ((-0.02165, 0.94058 * REAR, -0.17403), (-0.3, 0.507 * REAR, -0.137)),
        ((-0.23738, 0.89495 * REAR, -0.01605), (-0.3, 0.332, -0.003)),
    ],
}
WHEEL = {"front": (0, 0.715, -0.11), "rear": (-0.022, 0.73, -0.03)}
MOUNT, LOW = np.array([-0.115, 0.785 * REAR, 0.579]), np.array([-0.07403, 0.85329 * REAR, 0.24845])


def upright(end: str, travel: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacement (3,) of the wheel's centre and rotation (3, 3) of the left upright."""
    centre = np.array(WHEEL[end])
    along = (MOUNT - LOW) / np.linalg.norm(MOUNT - LOW)
    across = [np.cross(along, [1, 0, 0]), np.cross(along, np.cross(along, [1, 0, 0]))]

    def residual(x: np.ndarray) -> np.ndarray:
        A, u = rotation(x[3:]), x[:3]

        def at(point: np.ndarray) -> np.ndarray:
            return centre + u + A @ (np.array(point) - centre)

        lengths = [
            np.linalg.norm(at(own) - other) - np.linalg.norm(np.array(own) - other)
            for own, other in ROUND[end]
        ]
        # the upper mount stays on the line of the strut
        strut = [(MOUNT - at(LOW)) @ A @ e for e in across] if end == "rear" else []
        return np.array([*lengths, *strut, u[2] - travel])

    x = newton(residual, np.array([0, 0, travel, 0, 0, 0.0]))
    return x[:3], rotation(x[3:])


@pytest.fixture(scope="module")
def moved(tmp_path_factory: pytest.TempPathFactory) -> Result:
    return run("sports_car/suspension.yaml", tmp_path_factory.mktemp("suspension"))


@pytest.mark.parametrize("end", ["front", "rear"])
def test_the_suspension_moves_as_its_hard_points_say(moved: Result, end: str) -> None:
    wheel, body = f"rbdout.wheel_{end}_left", f"rbdout.upright_{end}_left"
    position = np.array([moved.series(f"{wheel}.position.{axis}").values for axis in "xyz"]).T
    q = np.array([moved.series(f"{body}.quaternion.{axis}").values for axis in "wxyz"]).T
    for i in range(0, len(position), 25):
        travel = position[i] - position[0]
        displacement, A = upright(end, travel[2])
        # positions of 1 m from joints closed to 1e-10 of the model's 2.4 m
        assert travel == pytest.approx(displacement, abs=1e-9)
        w, x, y, z = q[i]
        axle = (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x))
        assert axle == pytest.approx(A[:, 1], abs=4e-9)


def test_the_car_stands_on_its_wheels(tmp_path: Path) -> None:
    rolling = run("sports_car/rolling.yaml", tmp_path, **{"control.end_time": 1})
    loads = {
        end: sum(rolling.series(f"tyrout.tyre_{end}_{side}.normal").values for side in sides)
        for end, sides in (("front", ("left", "right")), ("rear", ("left", "right")))
    }
    weight = MASS * GRAVITY
    # 40 % in front by the lever arms, but that masses of the corners count as at the axles
    assert loads["front"] == pytest.approx(0.4 * weight, rel=3e-3)
    assert loads["rear"] == pytest.approx(0.6 * weight, rel=3e-3)
    # it begins in equilibrium: 1 % of the static loads is allowed for a transient
    for load in loads.values():
        assert np.abs(load - load[0]).max() < 1e-4 * load[0]
    assert loads["front"][0] + loads["rear"][0] == pytest.approx(weight, rel=1e-6)
    # it rolls on without loss
    assert rolling.series("rbdout.chassis.velocity.x").values[-1] == pytest.approx(SPEED, rel=1e-6)


def test_a_car_that_falls_upwards_is_refused_with_the_reason(tmp_path: Path) -> None:
    words = ("--set", "gravity=-9.81", "--set", "control.estimate=off")
    done = crashsolve(SCENES / "sports_car/rolling.yaml", "-o", tmp_path, *words)
    assert done.returncode == 4
    assert f"loads, {MASS * GRAVITY:.4g} N along z" in done.stderr + done.stdout
    assert "no tyre carries them (tyre_front_left" in done.stderr + done.stdout


@pytest.mark.long
def test_a_driver_takes_the_car_through_the_cones_of_a_lane_change(tmp_path: Path) -> None:
    drive = run("sports_car/lane_change.yaml", tmp_path)
    x, y, heading = (
        drive.series(channel).values
        for channel in (
            "rbdout.chassis.position.x",
            "rbdout.chassis.position.y",
            "disbout.heading.angle",
        )
    )
    # ISO 3888-2: begin, length, middle and width of the lanes for a car 1.75 m wide and 3.7 m long
    w = 1.75
    one, two, three = 1.1 * w + 0.25, w + 1.0, max(1.3 * w + 0.25, 3.0)
    lanes = [
        (0, 12, 0, one),
        (25.5, 11, one / 2 + 1 + two / 2, two),
        (49, 12, (three - one) / 2, three),
    ]
    for a in (0.6 * WHEELBASE + 0.8, -0.4 * WHEELBASE - 0.7):
        for b in (w / 2, -w / 2):
            at = x - 8.0 + np.cos(heading) * a - np.sin(heading) * b
            aside = y + np.sin(heading) * a + np.cos(heading) * b
            assert at[-1] > 49 + 0.5
            for begin, length, middle, width in lanes:
                within = (at >= begin) & (at <= begin + length)
                # 0.11 m of room at the least
                assert np.abs(aside[within] - middle).max() < width / 2 - 0.05


SCENARIOS = {
    "head-on": {"angle": "0 deg"},
    "10 degrees": {"angle": "10 deg"},
    "20 degrees": {"angle": "20 deg"},
    "friction": {"angle": "20 deg", "wall_friction": 0.5},
}


@pytest.fixture(scope="module")
def crash(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Result]:
    """A scenario, run once."""
    root = tmp_path_factory.mktemp("sports_car")

    @cache
    def of(name: str) -> Result:
        folder = root / name.replace(" ", "_")
        return run("sports_car.yaml", folder, end=0.1, **SCENARIOS[name])

    return of


@pytest.fixture(scope="module")
def crashes(crash: Callable[[str], Result]) -> dict[str, Result]:
    return {name: crash(name) for name in SCENARIOS}


def share_left(result: Result) -> float:
    kinetic = result.series("glstat.model.energy.kinetic").values
    return float(kinetic[-1] / kinetic[0])


def peak(result: Result) -> float:
    return float(result.series("rcforc.box_on_wall.normal").values.max())


@pytest.mark.long
def test_head_on_the_crash_box_absorbs_the_energy(crash: Callable[[str], Result]) -> None:
    # Ambrosio (2003), 5.3.2: "dissipates all kinetic energy"; what is left is a rebound
    assert share_left(crash("head-on")) < 0.05
    # Fig. 34
    assert 350e3 < peak(crash("head-on")) < 400e3


@pytest.mark.long
def test_without_friction_the_car_is_deflected_and_turns(crashes: dict[str, Result]) -> None:
    assert share_left(crashes["20 degrees"]) > 2 * share_left(crashes["10 degrees"])
    turned, aside = (
        {name: abs(float(result.series(channel).values[-1])) for name, result in crashes.items()}
        for channel in ("rbdout.chassis.angular_velocity.z", "rbdout.chassis.velocity.y")
    )
    assert turned["20 degrees"] > turned["10 degrees"] > 10 * turned["head-on"]
    assert aside["20 degrees"] > aside["10 degrees"] > 10 * aside["head-on"]
    # peak forces fall with the angle
    assert peak(crashes["head-on"]) > peak(crashes["10 degrees"]) > peak(crashes["20 degrees"])


@pytest.mark.long
def test_with_friction_the_box_is_crushed_as_head_on(crashes: dict[str, Result]) -> None:
    friction, sliding = crashes["friction"], crashes["20 degrees"]
    assert share_left(friction) < 0.05
    plastic = {
        name: float(result.series("glstat.model.energy.plastic").values[-1])
        for name, result in crashes.items()
    }
    # "a crushing mechanism similar to that of the frontal impact"
    assert plastic["friction"] == pytest.approx(plastic["head-on"], rel=0.1)
    assert plastic["20 degrees"] < 0.85 * plastic["head-on"]
    # no deflection, "only a slight sideways translation", and no turn along the wall
    aside = [abs(r.series("rbdout.chassis.velocity.y").values[-1]) for r in (friction, sliding)]
    assert aside[0] < aside[1] / 2
    turned = [float(r.series("disbout.heading.angle").values[-1]) for r in (friction, sliding)]
    assert abs(turned[0]) < abs(turned[1]) / 2


@pytest.mark.long
def test_the_crash_box_has_186_free_coordinates(crash: Callable[[str], Result]) -> None:
    names = {str(channel.name).split(".")[1] for channel in crash("head-on").channels("rbdout.*")}
    box = {name for name in names if name.startswith("box_")}
    # what is welded: to the chassis, or, as ends of members, to their joints
    tied = {name for name in box if "_rear_" in name and "brace" not in name}
    tied |= {name for name in box if name.endswith(("_start", "_end"))}
    assert 6 * len(box - tied) == 186


def test_the_car_with_its_crash_box_stands_at_rest(tmp_path: Path) -> None:
    """Its wheels may roll, light nodes of the box are on stiff tubes: no false refusal."""
    stands = run("sports_car.yaml", tmp_path / "out", speed=0, end=0.01)
    loads = sum(
        stands.series(f"tyrout.tyre_{end}_{side}.normal").values
        for end in ("front", "rear")
        for side in ("left", "right")
    )
    # the tubes add 2.3 kg to what the chassis has less: their nodes within members
    assert loads == pytest.approx(np.full(len(loads), MASS * GRAVITY), rel=5e-3)
    assert np.abs(loads - loads[0]).max() < 1e-6 * loads[0]
    assert stands.series("glstat.model.energy.kinetic").values.max() < 1e-9


def test_walls_to_both_sides_are_mirror_images_and_may_overlap(tmp_path: Path) -> None:
    turned, force = [], []
    for angle in ("20 deg", "-20 deg"):
        crash = run("sports_car.yaml", tmp_path / angle[:3], angle=angle, end=0.012)
        turned.append(crash.series("rbdout.chassis.angular_velocity.z").values)
        force.append(crash.series("rcforc.box_on_wall.normal").values)
    assert force[0][0] == 0.0 and force[0].max() > 1e5
    # round-off of contacts of 2e7 N/m^1.5 that begin in different order
    assert force[1] == pytest.approx(force[0], abs=1e-5 * force[0].max())
    assert turned[1] == pytest.approx(-turned[0], abs=1e-5 * np.abs(turned[0]).max())
    # a wall within the pads pushes the car back before the start
    overlap, free = (
        run("sports_car.yaml", tmp_path / str(gap), gap=gap, end=2e-4, speed=1)
        .series("rbdout.chassis.position.x")
        .values[0]
        for gap in (-0.001, 0.0)
    )
    assert overlap - free == pytest.approx(-0.001, abs=1e-5)


@pytest.mark.long
@pytest.mark.parametrize("height", [0.5, 1.0])
def test_a_steep_ramp_keeps_the_balance(tmp_path: Path, height: float) -> None:
    ramp = run("sports_car.yaml", tmp_path / "out", ramp_height=height, gap=1.8, end=0.35)
    # the front wheels lean by more than 0.3 rad at its edge
    assert np.abs(ramp.series("tyrout.tyre_front_left.camber").values).max() > 0.3
    # %, that of the box; 0.4 and 2.3 without the force of the normal that turns
    assert np.abs(ramp.series("glstat.model.balance").values).max() < 0.05


@pytest.mark.long
def test_a_wall_along_the_car_is_met_from_outside(tmp_path: Path) -> None:
    passed = run("sports_car.yaml", tmp_path / "out", angle="89 deg")
    force = passed.series("rcforc.wheels_on_wall.normal").values
    assert force[0] == 0.0 and force.max() > 0.0
    assert np.abs(passed.series("glstat.model.balance").values).max() < 0.05
