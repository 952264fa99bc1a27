"""Claims of the roll-over's vehicle alone: static roll, tilt table, free roll by closed forms."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from scipy.linalg import expm

from crashpost.cli import main as crashpost
from crashpost.results.result import Result

DECK = Path(__file__).parents[2] / "decks" / "scenes" / "vehicle_alone.yaml"
# of decks/scenes/shared/rollover_vehicle.yaml
G, SPRUNG, UNSPRUNG, HEIGHT, TRACK, RADIUS = 9.81, 1100.0, 34.8, 0.65, 1.35, 0.372
FRONT, WHEELBASE, STRUT, TYRE = 1.13, 2.16, 2.4e4, 2.2e5
# one worker runs all of them, and compiles the scene once
pytestmark = [pytest.mark.xdist_group("vehicle_alone"), pytest.mark.long]


def run(folder: Path, **values: float) -> Result:
    words = [word for name, value in values.items() for word in ("--set", f"{name}={value}")]
    done = crashsolve(DECK, "-o", folder, "--set", "control.estimate=off", *words)
    assert done.returncode == 0, done.stderr
    return Result(folder)


RIGID = {"strut_stiffness": 1e7, "tyre_stiffness": 1e7, "tyre_friction": 3, "end": 0.01}
STATIC = {
    "as it is": {},
    "to the other side, soft and narrow": {
        **{"slope": -0.03, "strut_stiffness": 4e4, "track": 1.2, "mass_height": 0.5},
    },
    "stiff tyres, rear axle closer": {"slope": 0.01, "tyre_stiffness": 6e5, "front": 1.3},
}


@pytest.mark.parametrize("case", STATIC)
def test_it_rolls_statically_as_its_moments_say(case: str, tmp_path: Path) -> None:
    run(tmp_path / "out", **STATIC[case])
    assert crashpost(["expect", str(tmp_path / "out")]) == 0


def centre_of_mass() -> float:
    """Height of the mass centre of the whole on rigid tyres [m]."""
    return (SPRUNG * HEIGHT + 4 * UNSPRUNG * RADIUS) / (SPRUNG + 4 * UNSPRUNG)


@pytest.mark.parametrize("share", [0.5, 0.9, 0.995])
def test_on_a_tilt_table_rigid_wheels_lift_at_half_the_track_over_the_height(
    share: float, tmp_path: Path
) -> None:
    static = (SPRUNG + 4 * UNSPRUNG) * G / 2
    lift = TRACK / 2 / centre_of_mass()
    result = run(tmp_path / "out", slope=share * lift, **RIGID)
    names = ("front_right", "rear_right")
    high = sum(result.series(f"tyrout.tyre_{name}.normal").values for name in names)
    # what is left of the load falls in proportion to the slope, to none where the wheels lift;
    # springs of 1e7 N/m give by 1 mm of 0.6 m
    angles = share * lift / (1 - high / static)
    assert angles == pytest.approx(np.full(len(high), lift), rel=2e-3)


def test_a_steeper_table_is_refused(tmp_path: Path) -> None:
    # by twice what springs of 1e7 N/m give
    slope = 1.005 * TRACK / 2 / centre_of_mass()
    words = [word for name, value in RIGID.items() for word in ("--set", f"{name}={value}")]
    done = crashsolve(DECK, "-o", tmp_path / "out", "--set", f"slope={slope}", *words)
    assert done.returncode == 4
    refusal = done.stderr + done.stdout
    # none at all, or one on the wheels of one side, from which the car falls on
    assert "there is no equilibrium" in refusal or "the equilibrium is unstable" in refusal


def linear_model() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, C and K of lateral displacement on the road, lean, yaw and one hub of each axle.

    Lean is towards the left; hubs move up on the left, and down on the right.
    """
    M, C, K = (np.zeros((5, 5)) for _ in range(3))

    def add(matrix: np.ndarray, value: float, row: list[float]) -> None:
        matrix += value * np.outer(row, row)

    add(M, SPRUNG, [1, HEIGHT, 0, 0, 0])
    add(M, 360.0, [0, 1, 0, 0, 0])
    add(M, 1400.0, [0, 0, 1, 0, 0])
    own = 0.1 + 0.35 * 19.8 * RADIUS**2
    for axle, x in enumerate((FRONT, FRONT - WHEELBASE)):
        load = G * (SPRUNG * (WHEELBASE - FRONT if axle == 0 else FRONT) / WHEELBASE / 2 + UNSPRUNG)
        deflection = load / TYRE
        r = RADIUS - deflection
        hub = [float(axle == k) for k in (0, 1)]
        depth, foot = [0, TRACK / 2, 0, -hub[0], -hub[1]], [1, 0, x, 0, 0]
        for _ in ("left", "right"):
            add(M, UNSPRUNG, [1, r, x, 0, 0])
            add(M, UNSPRUNG, depth)
            add(M, UNSPRUNG * (TRACK / 2) ** 2 + own, [0, 0, 1, 0, 0])
            add(M, own, [0, 1, 0, 0, 0])
            add(K, STRUT, [0, 0, 0, *hub])
            add(C, 1600.0, [0, 0, 0, *hub])
            add(K, TYRE, depth)
            add(C, 500.0, depth)
            # carcass: C_y / sigma, and k_V / sigma at rest
            add(K, 6e4 / 0.3, foot)
            add(C, 770.0 / 0.3, foot)
            K[1, 1] -= UNSPRUNG * G * r + load * deflection
    K[1, 1] -= SPRUNG * G * HEIGHT
    return M, C, K


def test_it_rolls_freely_as_its_linear_equations_say(tmp_path: Path) -> None:
    rate = 0.01
    result = run(tmp_path / "out", slope=0, roll_rate=rate, end=1.2)
    roll = result.series("disbout.roll.angle")
    M, C, K = linear_model()
    A = np.block(
        [
            [np.zeros((5, 5)), np.eye(5)],
            [-np.linalg.solve(M, K), -np.linalg.solve(M, C)],
        ]
    )
    start = np.zeros(10)
    start[6] = -rate
    expected = [-(expm(A * t) @ start)[1] for t in roll.time]
    assert np.ptp(expected) > 1e-3
    # of 1e-3 rad, whose square counts; spins of wheels and pitch are left out
    assert np.abs(roll.values - expected).max() < 1e-3 * np.abs(expected).max()
