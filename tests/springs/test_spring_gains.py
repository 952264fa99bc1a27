"""Claim: a spring that makes energy in a stated step stops the run, whatever else moves."""

from pathlib import Path

import pytest
from command import crashsolve

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import SolverError
from crashsolve.foundation.rows import as_rows
from crashsolve.model.build import build
from crashsolve.recording.engines import engine_of
from crashsolve.system.engine import Engine
from crashsolve.system.gain import energy_gain

# a sledge of 1 kg runs at 2 m/s, 0.1 m ahead of what it strikes: 1e7 N/m hold it for 1 ms
DECK = """
control: {{end_time: 0.2, step: {step}, integrator: rattle, estimate: "off"}}
bodies:
  sledge:
    mass: 1
    primitive: {{shape: sphere, radius: 0.1}}
    position: [0, 0, {z!r}]
    velocity: [2, 0, 0]
  heavy: {{mass: 1000, inertia: [1, 1, 1], position: [0, 50, {z!r}], velocity: [{fast}, 0, 0]}}
joints: {{rail: {{type: prismatic, b: sledge, at: [0, 0, {z!r}], axis: [1, 0, 0]}}}}
loads: {{weight: {{type: gravity}}}}
springs:
  s: {{type: translation_stop, joint: rail, upper: 0.1, stiffness: 1e7}}
"""
HIDING = [(0.0, 0.0), (1e5, 0.0), (0.0, 1e4)]


def struck(folder: Path, step: float, z: float, fast: float) -> Engine:
    path = folder / "deck.yaml"
    path.write_text(DECK.format(step=step, z=z, fast=fast), "utf-8")
    deck = read_deck(path)
    engine = engine_of(deck, *build(deck))
    engine.start()
    for k in range(1, 21):
        engine.reach(0.01 * k)
        engine.sample()
    return engine


@pytest.mark.parametrize(("z", "fast"), HIDING)
def test_a_stop_that_makes_energy_is_named_in_any_frame(
    z: float, fast: float, tmp_path: Path
) -> None:
    with pytest.raises(SolverError) as stop:
        struck(tmp_path, 3e-3, z, fast)
    # where nothing hides it, the balance of the whole is broken as well
    assert z == fast == 0.0 or "spring 's'" in str(stop.value)


@pytest.mark.parametrize(("z", "fast"), HIDING)
def test_a_run_whose_samples_are_taken_in_blocks_stops_too(
    z: float, fast: float, tmp_path: Path
) -> None:
    path = tmp_path / "deck.yaml"
    words = "title: stop\noutput: {history: {interval: 0.01}}\n"
    path.write_text(words + DECK.format(step=3e-3, z=z, fast=fast), "utf-8")
    done = crashsolve(path, "-o", tmp_path / "out")
    assert done.returncode == 4
    assert "spring 's': its force has created energy" in done.stderr


@pytest.mark.parametrize(("z", "fast"), HIDING)
def test_a_spring_in_short_steps_gives_what_it_took(z: float, fast: float, tmp_path: Path) -> None:
    engine = struck(tmp_path, 1e-5, z, fast)
    group = next(g for g in engine.model.force_groups() if g.is_watched)
    now = as_rows(group.history)[int(engine.clock["current"]), 0]
    # it takes and gives 1 kg (2 m/s)^2 / 2; 100 steps a half wave err by (pi / 100)^2 / 12
    assert now.exchanged == pytest.approx(4.0, rel=2e-3)
    assert abs(energy_gain(now, float(group.output["stored"][0]))) < 1e-3


@pytest.mark.parametrize(("step", "is_said"), [(2.1e-3, True), (1.5e-3, False)])
def test_a_linear_spring_too_fast_for_the_step_is_said(
    step: float, is_said: bool, tmp_path: Path
) -> None:
    """Its work is what it holds in any step; at 2e-3 s, omega h = 2, a swing of 2 m/s grew to 200.

    Height hides that from the balance of the whole.
    """
    path = tmp_path / "deck.yaml"
    spring = "s: {type: linear, at_a: [0, 0, 1e5], b: sledge, stiffness: 1e6, length: 0.1}"
    stop = "s: {type: translation_stop, joint: rail, upper: 0.1, stiffness: 1e7}"
    text = DECK.format(step=step, z=1e5, fast=1e4).replace(stop, spring)
    text = text.replace("position: [0, 0, 1", "position: [0.1, 0, 1")
    path.write_text(text, "utf-8")
    deck = read_deck(path)
    engine = engine_of(deck, *build(deck))
    engine.start()
    for k in range(1, 4):
        engine.reach(0.01 * k)
        engine.sample()
    said = [w for w in engine.step_warnings() if "body 'sledge'" in w and "1000 rad/s" in w]
    assert bool(said) == is_said


def test_no_run_that_chooses_its_steps_pays_for_it(tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    path.write_text(DECK.format(step="auto", z=0.0, fast=0.0), "utf-8")
    model, _ = build(read_deck(path))
    assert not any(g.is_watched for g in model.force_groups())


# 1 kg at 1 m/s: 1 kN stops it within a millisecond, and in steps of 5 ms turns it round in each
BOUNDED = """
control: {end_time: 0.5, step: 5e-3, integrator: rattle}
bodies:
  sledge: {mass: 1, inertia: [1, 1, 1], velocity: [1, 0, 0]}
  heavy: {mass: 1e5, inertia: [1, 1, 1], position: [0, 50, 0], velocity: [0, 0, 1e4]}
joints: {rail: {type: prismatic, b: sledge, at: [0, 0, 0], axis: [1, 0, 0]}}
curves: {force: {points: [[-9, -1e3], [-1e-3, -1e3], [0, 0], [1e-3, 1e3], [9, 1e3]]}}
springs:
  s: SPRING
"""
DAMPER = "{type: damper, b: sledge, at_a: [-1, 0, 0], curve: force}"
BRAKE = "{type: translation_friction, joint: rail, force: 1e3, stiffness: 1e5, damping: 1e4}"


def bounded(folder: Path, spring: str) -> Engine:
    path = folder / "deck.yaml"
    path.write_text(BOUNDED.replace("SPRING", spring), "utf-8")
    deck = read_deck(path)
    engine = engine_of(deck, *build(deck))
    engine.start()
    for k in range(1, 6):
        engine.reach(0.1 * k)
        engine.sample()
    return engine


def test_a_damper_that_turns_a_velocity_round_in_every_step_stops_the_run(tmp_path: Path) -> None:
    # each sample shows the velocity of the start, and other energy hides what it states to lose
    with pytest.raises(
        SolverError, match=r"spring 's': its force reverses a velocity in every step"
    ):
        bounded(tmp_path, DAMPER)


def test_friction_that_turns_a_velocity_round_in_every_step_is_said(tmp_path: Path) -> None:
    # it does no work at all in a step: nothing shows in any balance
    warnings = bounded(tmp_path, BRAKE).step_warnings()
    assert (
        len(warnings) == 1 and "body 'sledge': dampers, friction or contacts stop it" in warnings[0]
    )
