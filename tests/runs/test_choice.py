"""Claim: `integrator: auto` takes the method that a deck's stiffness and smoothness ask for."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from command import crashsolve

from crashsolve.deck.reading.deck import read_deck
from crashsolve.estimate.estimator import estimate_in_memory
from crashsolve.model.build import build

DECKS = Path(__file__).resolve().parents[2] / "decks"
HERE = Path(__file__).parent
# deck, further settings, method, part of the reason
CASES = {
    "stiff": (DECKS / "benchmark/flyball_governor.yaml", (), "radau_iia_5", "stable below"),
    "stiff and coarse": (
        DECKS / "benchmark/flyball_governor.yaml",
        ("control.tolerance=1e-3",),
        "generalized_alpha",
        "stable below",
    ),
    "smooth": (DECKS / "benchmark/andrews_squeezer.yaml", (), "dormand_prince_8", "smooth"),
    "smooth and coarse": (
        DECKS / "benchmark/andrews_squeezer.yaml",
        ("control.tolerance=1e-3",),
        "dormand_prince_5",
        "smooth",
    ),
    "a contact": (DECKS / "tutorial/bouncing_ball.yaml", (), "dormand_prince_5", "contacts"),
    "whole steps": (DECKS / "scenes/train_test.yaml", (), "rattle", "is computed in whole steps"),
    "corners": (DECKS / "extreme/steep_curve.yaml", (), "dormand_prince_5", "corners"),
    "yield": (
        DECKS / "verification/springs/elastoplastic.yaml",
        (),
        "dormand_prince_5",
        "corners",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_choice_follows_from_the_deck(case: str) -> None:
    deck, settings, method, reason = CASES[case]
    words = [word for s in ("control.integrator=auto", *settings) for word in ("--set", s)]
    done = crashsolve("explain", deck, *words)
    assert done.returncode == 0, done.stderr
    line = next(line for line in done.stdout.splitlines() if line.startswith("integrator "))
    assert line.startswith(f"integrator {method}: ")
    assert reason in line


# deck, further settings, method, part of the reason
DEFAULTS = {
    "smooth": (HERE / "pendulum.yaml", ("control.step=auto",), "dormand_prince_8", "smooth"),
    "a stated step": (HERE / "pendulum.yaml", (), "rattle", ""),
    "a stated safety": (
        HERE / "pendulum.yaml",
        ("control.step=auto", "control.safety=0.05"),
        "rattle",
        "",
    ),
    "a contact": (DECKS / "tutorial/bouncing_ball.yaml", (), "rattle", "contacts"),
    "curves": (DECKS / "extreme/steep_curve.yaml", (), "rattle", "corners"),
    "stiff": (
        DECKS / "extreme/stiffness_decades.yaml",
        ("end=0.01",),
        "dormand_prince_8",
        "smooth",
    ),
    "whole steps": (
        DECKS / "verification/springs/brake.yaml",
        ("control.step=auto",),
        "rattle",
        "is computed in whole steps",
    ),
    "beams": (DECKS / "verification/parts/free_flight.yaml", (), "rattle", "flexible"),
}


@pytest.mark.parametrize("case", DEFAULTS)
def test_a_deck_that_names_no_method_gets_the_one_that_passes(case: str) -> None:
    deck, settings, method, reason = DEFAULTS[case]
    model, _ = build(read_deck(deck, dict(word.split("=") for word in settings), False))
    assert model.integrator == method
    assert reason in model.choice


OSCILLATOR = """
title: A mass on a spring, beside something far and fast
parameters: {n: 16, far: 2, fast: 0}
control: {end_time: "${(n + 0.125)*2*pi/10}"}
bodies:
  a: {mass: 2, inertia: [1, 1, 1], position: [1.1, 0, 0]}
  far: {mass: 1, inertia: [1, 1, 1], position: ["${far}", 5, 0], velocity: [0, "${fast}", 0]}
springs: {s: {type: linear, b: a, stiffness: 200, length: 1}}
watch: [{channel: "rbdout.a.position.x - 1", statistic: final}]
"""


# the size and the speed of a model state nothing of its smallest oscillator
@pytest.mark.parametrize(("periods", "far", "fast"), [(16, 2, 0), (160, 2, 0), (16, 1e6, 1e4)])
def test_vibrations_keep_three_digits_by_default(
    periods: int, far: float, fast: float, tmp_path: Path
) -> None:
    path = tmp_path / "deck.yaml"
    path.write_text(OSCILLATOR)
    words = {"n": periods, "far": far, "fast": fast}
    deck = read_deck(path, {name: repr(value) for name, value in words.items()})
    _, (estimated,), _ = estimate_in_memory(deck)
    # cos(omega t) an eighth of a period after a whole number of them
    true = 0.1 / np.sqrt(2)
    assert estimated.value is not None and estimated.error is not None
    assert estimated.value == pytest.approx(true, abs=1e-4)
    # the estimate holds within its factor of ten, beside round-off of a position
    assert abs(estimated.value - true) <= 10 * estimated.error + 1e-9


def test_many_bodies_in_contact_are_not_for_located_onsets(tmp_path: Path) -> None:
    names = [f"ball_{i}" for i in range(60)]
    scene = {
        "control": {"end_time": 1, "integrator": "auto"},
        "bodies": {
            name: {"mass": 1, "inertia": [1] * 3, "position": [3 * i, 0, 0]}
            for i, name in enumerate(names)
        },
        "surfaces": {name: {"type": "sphere", "body": name, "radius": 1} for name in names},
        "contacts": {
            "all": {"a": names, "b": names, "normal": {"type": "hertz", "stiffness": 1e6}}
        },
    }
    deck = tmp_path / "balls.yaml"
    deck.write_text(yaml.safe_dump(scene))
    done = crashsolve("explain", deck)
    assert "integrator rattle: contacts" in done.stdout, done.stderr
    assert "list of near pairs" in done.stdout


def test_the_log_gives_the_choice_and_why(tmp_path: Path) -> None:
    done = crashsolve(HERE / "pendulum.yaml", "-o", tmp_path, "--set", "control.integrator=auto")
    assert done.returncode == 0, done.stderr
    assert "dormand_prince_8: smooth, not stiff" in (tmp_path / "log.txt").read_text("utf-8")
