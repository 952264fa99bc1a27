"""Claim: RATTLE is of second order on mechanisms, free bodies and located Hertz impacts."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.integrators.rattle import ORDER
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

# the slope of a method of order p over halved steps is p but for terms one order higher
SLOPE = 0.15

PENDULUM: dict[str, object] = {
    "bodies": {"bob": {"mass": 1.0, "inertia": [1e-10] * 3, "position": [-1, 0, 0]}},
    "joints": {"pin": {"type": "revolute", "b": "bob", "at": [0, 0, 0], "axis": [0, 0, 1]}},
    "loads": {"weight": {"type": "gravity", "acceleration": [0, -9.81, 0]}},
}
TOP: dict[str, object] = {
    "bodies": {
        "top": {
            "mass": 15.0,
            "inertia": [0.234375, 0.46875, 0.234375],
            "position": [0, 1, 0],
            "velocity": [4.61538, 0, 0],
            "angular_velocity": [0, 150, -4.61538],
        }
    },
    "joints": {"tip": {"type": "spherical", "b": "top", "at": [0, 0, 0]}},
    "loads": {"weight": {"type": "gravity"}},
}
IMPACT: dict[str, object] = {
    "bodies": {
        "ball": {
            "mass": 1.0,
            "inertia": [0.1] * 3,
            "position": [0, 0, 0.10013],
            "velocity": [0, 0, -1.0],
        }
    },
    "surfaces": {
        "skin": {"type": "sphere", "body": "ball", "radius": 0.1},
        "floor": {"type": "plane"},
    },
    "contacts": {
        "hit": {
            "a": ["skin"],
            "b": ["floor"],
            "normal": {"type": "lankarani_nikravesh", "stiffness": 1e9, "restitution": 0.5},
        }
    },
}
# share of its speed that the ball keeps: chi (1 + x) = ln[(1 + chi) / (1 - chi x)], chi = 9/16 (E1)
RETURNED = 0.7252411140101969


def final(folder: Path, scene: dict[str, object], end: float, step: float) -> Engine:
    """The scene after a run with a fixed step."""
    path = folder / "deck.yaml"
    control = {"end_time": end, "step": step, "energy_limit": "off"}
    path.write_text(yaml.safe_dump({"control": control} | scene))
    engine = Engine(*build(read_deck(path)))
    engine.start()
    engine.advance(end)
    return engine


def slopes(errors: list[float]) -> np.ndarray:
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def test_pendulum_converges_at_order_two(tmp_path: Path) -> None:
    # position after 2 s, benchmark A1 (closed form by elliptic functions)
    exact = np.array([-0.7935661954, -0.6084839304])
    errors = [
        float(np.linalg.norm(final(tmp_path, PENDULUM, 2.0, h).state.nodes["r"][1, :2] - exact))
        for h in (8e-3, 4e-3, 2e-3, 1e-3)
    ]
    assert np.allclose(slopes(errors), ORDER, atol=SLOPE)


@pytest.mark.long
def test_heavy_top_converges_at_order_two(tmp_path: Path) -> None:
    # mass centre after 0.1 s, benchmark A6
    exact = np.array([0.42129666, 0.89457197, -0.1491647])
    errors = [
        float(np.linalg.norm(final(tmp_path, TOP, 0.1, h).state.nodes["r"][1] - exact))
        for h in (4e-4, 2e-4, 1e-4)
    ]
    assert np.allclose(slopes(errors), ORDER, atol=SLOPE)


def test_located_impact_converges_at_order_two(tmp_path: Path) -> None:
    assert pytest.approx(np.log((1 + 9 / 16) / (1 - 9 / 16 * RETURNED))) == 9 / 16 * (1 + RETURNED)
    errors = [
        abs(final(tmp_path, IMPACT, 2e-3, h).state.nodes["v"][1, 2] - RETURNED)
        for h in (4e-5, 2e-5, 1e-5, 5e-6)
    ]
    assert np.allclose(slopes(errors), ORDER, atol=SLOPE)


def test_onset_of_an_impact_is_located(tmp_path: Path) -> None:
    # the speed before an impact without gravity is exact, so the latched speed must be 1
    engine = final(tmp_path, IMPACT, 2e-4, 5e-5)
    speed = engine.model.contact_groups[0].history[engine.clock.current]["impact_speed"][0]
    assert speed == pytest.approx(1.0, abs=1e-12)
    assert engine.clock.located == 1


def test_constraints_hold_after_every_step(tmp_path: Path) -> None:
    engine = final(tmp_path, PENDULUM, 2.0, 1e-3)
    assert engine.clock.residual <= 1e-10
    # an inertia of 1e-10 kg m^2 costs ten digits of the solve: refinement must win them back
    assert engine.clock.rate_residual <= 1e-10
    bob = engine.state.nodes[1]
    assert abs(np.dot(bob["r"], bob["v"])) < 1e-10
