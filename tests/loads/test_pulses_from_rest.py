"""Claim: a short pulse on a free shell or body at rest is no imbalance at any check."""

from pathlib import Path
from typing import Any

import pytest
import yaml
from command import crashsolve

# pulses over their length: one of straight lines, two, and one without an impulse
PULSES = {
    "alone": [[0, 0], [0.3, 1], [1, 0]],
    "repeated": [[0, 0], [0.5, 1], [1, 0], [9, 0], [9.5, 1], [10, 0]],
    "without impulse": [[0, 0], [0.25, 1], [0.75, -1], [1, 0]],
}
END = 5e-4
PART = {
    "type": "shell",
    "thickness": 2e-3,
    "material": "m",
    "mesh": {"type": "grid", "along": [0.1, 0, 0], "across": [0, 0.1, 0], "elements": [3, 2]},
}
FORCE = {"type": "force", "force": [1, 2, 3], "curve": "pulse"}
PRESSURE = {"type": "pressure", "part": "p", "pressure": 1e4, "curve": "pulse"}
EDGE = {"type": "nodal_force", "part": "p", "nodes": "u1", "force": [0, 0, 9], "curve": "pulse"}
LOADS: dict[str, dict[str, Any]] = {
    "pressure": {"a": PRESSURE},
    "pressures": {"a": PRESSURE, "b": {**PRESSURE, "pressure": 2e4}},
    "edge": {"a": EDGE},
    "edge in equal shares": {"a": {**EDGE, "share": "equal"}, "b": PRESSURE},
    "tied": {"a": {**PRESSURE, "part": "tied"}, "b": PRESSURE},
    "tied edge": {"a": {**EDGE, "part": "tied", "nodes": "u0", "force": [2, 1, 3]}},
    "named node": {"a": {**FORCE, "body": "p_tip"}, "b": PRESSURE},
    "body": {"a": {**FORCE, "body": "b"}},
    "body twice": {"a": {**FORCE, "body": "b"}, "b": {**FORCE, "body": "b", "at": [0.1, 0, 0]}},
}


def deck(load: str, pulse: str, begin: float, length: float, **control: object) -> dict[str, Any]:
    points = [[0, 0], *([begin + length * x, y] for x, y in PULSES[pulse])]
    part = PART | ({"nodes": [{"name": "tip", "at": [0, 0, 0]}]} if load == "named node" else {})
    scene: dict[str, Any] = {
        "control": {"end_time": END, "estimate": "off", "integrator": "rattle"} | control,
        "curves": {"pulse": {"points": points, "extrapolate": "hold"}},
        "materials": {"m": {"type": "elastic", "young": 2e9, "poisson": 0.3, "density": 7850}},
        "parts": {"p": part},
        "bodies": {"b": {"mass": 2, "inertia": [0.1, 0.1, 0.1], "position": [1, 1, 1]}},
        "loads": LOADS[load],
    }
    if load.startswith("tied"):
        # on a face from which its edge is a thickness away
        mesh = {"type": "grid", "at": [0.1, 0, 2e-3], "along": [0.1, 0, 0], "across": [0, 0.1, 0]}
        scene["parts"]["tied"] = PART | {"mesh": mesh | {"elements": [1, 5]}}
        scene["ties"] = {"seam": {"part": "tied", "nodes": "u0", "to": "p"}}
    return scene


def run(folder: Path, scene: dict[str, Any]) -> Any:
    path = folder / "deck.yaml"
    path.write_text(yaml.safe_dump(scene), "utf-8")
    return crashsolve(path, "-o", folder / "out")


@pytest.mark.parametrize("pulse", PULSES)
@pytest.mark.parametrize("load", LOADS)
def test_a_pulse_from_rest_is_no_imbalance(load: str, pulse: str, tmp_path: Path) -> None:
    done = run(tmp_path, deck(load, pulse, 1.03e-4, 4e-5, check_every=1))
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("load", ["edge", "edge in equal shares", "named node"])
@pytest.mark.parametrize("check_every", [1, 7])
def test_a_step_too_long_under_a_load_is_stopped(
    check_every: int, load: str, tmp_path: Path
) -> None:
    """The half kick of a load does not explain what unstable elements gain."""
    control = {"check_every": check_every, "step": 2e-4, "end_time": 0.02}
    scene = deck(load, "alone", 1e-4, 0.1, **control)
    scene["output"] = {"history": {"interval": 2e-4}}
    done = run(tmp_path, scene)
    assert done.returncode == 4, done.stdout
    assert "the energy balance is off by" in done.stderr.splitlines()[-1]
