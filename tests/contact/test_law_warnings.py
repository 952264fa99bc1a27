"""Claim: the log names the contacts whose law was used outside its range, and no others."""

from pathlib import Path
from typing import Any

import pytest
from small_runs import run

STEEL = {"young_a": 2.1e11, "poisson_a": 0.3, "density_a": 7850.0}
# 1e-5 sqrt(E/rho)
LIMIT = 0.0517
LAW = "lankarani_nikravesh with restitution"
TOO_FAST = "impact faster than 1e-5 sqrt(E/rho): outside the law's range of validity"


def drop(**balls: tuple[float, float]) -> dict[str, object]:
    """Steel balls 1 um above a floor, each with its speed and the restitution asked for."""
    scene: dict[str, Any] = {
        "bodies": {},
        "surfaces": {"floor": {"type": "plane"}},
        "contacts": {},
    }
    for k, (name, (speed, restitution)) in enumerate(balls.items()):
        scene["bodies"][name] = {
            "mass": 1,
            "inertia": [0.01] * 3,
            "position": [k, 0, 0.1 + 1e-6],
            "velocity": [0, 0, -speed],
        }
        scene["surfaces"][name] = {"type": "sphere", "body": name, "radius": 0.1}
        law = {"type": "lankarani_nikravesh", "restitution": restitution} | STEEL
        scene["contacts"][name] = {"a": [name], "b": ["floor"], "normal": law}
    return scene


def warned(log: str) -> list[str]:
    """Warnings as they first occur."""
    lines = [line.removeprefix("warning: ") for line in log.splitlines() if "warning: " in line]
    # these runs have one sample, which shows none of the touches
    return [line for line in lines if "between samples" not in line]


def test_each_contact_outside_its_range_is_named(tmp_path: Path) -> None:
    scene = drop(
        fast=(1.05 * LIMIT, 0.95), slow=(0.95 * LIMIT, 0.95), soft=(0.5 * LIMIT, 0.5), dead=(0.5, 0)
    )
    log = run(tmp_path, scene, 1e-3, plain=True).log
    assert warned(log) == [
        f"contact 'soft': {LAW} 0.5 gives a restitution of 0.725 in a free impact; "
        "type: exact_restitution gives the one asked for",
        f"contact 'dead': {LAW} 0 gives a restitution of 0.663 in a free impact; "
        "type: exact_restitution gives the one asked for",
        f"contact 'fast': {TOO_FAST}",
        f"contact 'dead': {TOO_FAST}",
    ]
    # all of them once more at the end
    assert log.count(TOO_FAST) == 4 and log.count(LAW) == 4


@pytest.mark.parametrize("restitution", [0.9, 1.0])
def test_nothing_is_said_within_the_range(tmp_path: Path, restitution: float) -> None:
    result = run(tmp_path, drop(slow=(0.95 * LIMIT, restitution)), 1e-3, plain=True)
    assert result.series("rcforc.slow.onsets").values[-1] == 1.0
    assert warned(result.log) == []
