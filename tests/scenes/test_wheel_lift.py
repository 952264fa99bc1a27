"""Claim: wheels of the train sets' car carry what levers ask, leave the rail and never pull."""

from pathlib import Path

import numpy as np
import pytest
from test_train_sets import GRAVITY, MASS, one_car, run, values

LIFTED = 3.0 * MASS * GRAVITY
RAIL_SIDE = 0.7525


@pytest.mark.long
def test_a_car_pulled_up_leaves_the_rails_and_falls_free_of_them(tmp_path: Path) -> None:
    scene = one_car(0.0, mu=0.0)
    scene["loads"] = {"crane": {"type": "force", "body": "car", "force": [0, 0, LIFTED]}}
    result = run(tmp_path, scene, 0.16, 2e-3)
    touching = values(result, "rcforc.car_rails.touching")
    normal = values(result, "rcforc.car_rails.normal")
    assert touching[0] == 4
    assert touching[-1] == 0
    assert normal.min() >= 0.0
    # once in the air nothing but crane and weight acts: the mass centre gains (3 - 1) g
    flying = touching == 0
    rise = values(result, "glstat.model.momentum.z")[flying] / MASS
    time = result.time[flying]
    assert flying.sum() > 5
    # 1e-9: exact but for round-off
    np.testing.assert_allclose(np.diff(rise), 2.0 * GRAVITY * np.diff(time), rtol=1e-9)


@pytest.mark.long
def test_a_car_pushed_aside_lifts_the_wheels_of_one_side_as_levers_say(tmp_path: Path) -> None:
    # pushed at the mass centre of its compartment, beyond the 0.4 of its weight that turns it over
    push, body = 0.6 * MASS * GRAVITY, "car"
    scene = one_car(0.0, "space", mu=0.9)
    scene["curves"] = {"grows": {"points": [[0, 0], [0.5, 1]], "extrapolate": "hold"}}
    scene["loads"] = {
        "wind": {"type": "force", "body": body, "force": [0, push, 0], "curve": "grows"}
    }
    result = run(tmp_path, scene, 0.7, 5e-3)
    names = {"left": "car_rails_left", "right": "car_rails_right"}
    carried = {side: values(result, f"rcforc.{name}.normal") for side, name in names.items()}
    assert min(side.min() for side in carried.values()) >= 0.0
    # about the track's middle line: what wheels carry on both sides, against weights that have
    # moved aside, the push, and what turning about x gains
    parts = [body, *(f"car_{part}" for part in ("bogie_1", "bogie_2", "left", "right"))]
    given = result.stored_json("parameters")
    each = [given["body_car"], *[given["bogie_car"]] * 2, *[given["end_mass"]] * 2]
    leaned = sum(
        mass * GRAVITY * values(result, f"rbdout.{part}.position.y")
        for part, mass in zip(parts, each, strict=True)
    )
    moved = values(result, "glstat.model.angular_momentum.x")
    height = values(result, f"rbdout.{body}.position.z")
    grown = push * np.clip(result.time / 0.5, 0.0, 1.0)
    levers = RAIL_SIDE * (carried["left"] - carried["right"]) - leaned - grown * height
    # the wheels' places move aside with their bogies: some millimetres of 0.75 m
    work, requested = np.trapezoid(levers, result.time), moved[-1] - moved[0]
    scale = np.trapezoid(grown * height, result.time)
    assert abs(work - requested) < 0.02 * scale
    assert carried["right"][-1] == 0.0
    assert values(result, "rcforc.car_rails_right.touching")[-1] == 0
    assert values(result, "rcforc.car_rails_left.touching")[-1] == 4
