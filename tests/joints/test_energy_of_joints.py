"""Claim: joints that create or lose energy in too long steps stop the run, whatever else moves."""

from pathlib import Path

import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import SolverError
from crashsolve.model import ledger
from crashsolve.model.build import build
from crashsolve.recording.engines import engine_of
from crashsolve.system.engine import Engine

# two rods on one another swing with 20 rad/s: half a radian and more in steps of 0.03 s
BODIES = """
control: {step: STEP, end_time: 1, integrator: rattle, estimate: "off"}
bodies:
  a:
    {mass: 1, inertia: [0.01, 0.01, 0.01], position: [0.5, 0, 0], angular_velocity: [0, 20, 0],
      velocity: [FAST, 0, -10]}
  b: {mass: 1, inertia: [0.01, 0.02, 0.03], position: [1.25, 0, 0], velocity: [FAST, 0, -20]}
"""
# beside them 5e10 J
HEAVY = "  c: {mass: 1000, inertia: [1, 1, 1], position: [0, 50, 0], velocity: [1e4, 0, 0]}\n"
ELBOW = "joints:\n  elbow: {type: revolute, a: a, b: b, at: [1, 0, 0], axis: [0, 1, 0]}\n"
# and beside them 1000 kg more on a guide of its own
GUIDED = "  d: {mass: 1000, inertia: [1, 1, 1], position: [0, 60, 0], velocity: [1e4, 0, 0]}\n"
GUIDE = "  guide: {type: prismatic, b: d, at: [0, 60, 0], axis: [1, 0, 0]}\n"
PIN = "  pin: {type: revolute, b: a, at: [0, 0, 0], axis: [0, 1, 0]}\n"


def swing(text: str, folder: Path, step: float, fast: float = 0.0) -> Engine:
    path = folder / "deck.yaml"
    path.write_text(text.replace("STEP", repr(step)).replace("FAST", repr(fast)), "utf-8")
    deck = read_deck(path)
    engine = engine_of(deck, *build(deck))
    engine.start()
    engine.advance(1.0)
    engine.sample()
    return engine


def test_joints_that_lose_energy_are_named_beside_far_more_of_it(tmp_path: Path) -> None:
    engine = swing(BODIES + HEAVY + GUIDED + ELBOW + PIN + GUIDE, tmp_path, 0.03)
    assert abs(engine.ledger[ledger.IMBALANCE]) < 1e-6 * engine.ledger[ledger.LARGEST]
    with pytest.raises(SolverError) as stop:
        engine.finish()
    assert "joint 'elbow': it has, with the other joint of its mechanism, lost" in str(stop.value)
    assert "take a shorter step" in str(stop.value)


def test_their_work_is_the_change_of_energy_in_any_frame(tmp_path: Path) -> None:
    created = []
    for joints, fast in ((ELBOW + PIN, 0.0), (ELBOW, 0.0), (ELBOW, 1e4)):
        engine = swing(BODIES + joints, tmp_path, 0.03, fast)
        created.append(float(engine.state.nodes["joint_work"].sum()))
        # nothing else acts, and every step takes three iterations and more; of 1e8 J round-off
        change = float(engine.ledger[ledger.IMBALANCE])
        assert created[-1] == pytest.approx(change, rel=1e-8)
        assert abs(change) > 1.0
    assert created[2] == pytest.approx(created[1], rel=1e-8)


def test_good_steps_are_not_looked_at(tmp_path: Path) -> None:
    engine = swing(BODIES + ELBOW + PIN, tmp_path, 5e-4)
    engine.finish()
    assert engine.step_warnings() == []
    assert not engine.state.nodes["joint_exchange"].any()
