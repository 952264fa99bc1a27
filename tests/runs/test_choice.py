"""Claim: `integrator: auto` takes the method that a deck's stiffness and smoothness ask for."""

from pathlib import Path

import pytest
import yaml
from command import crashsolve

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
    "whole steps": (DECKS / "scenes/train_test.yaml", (), "rattle", "counts in whole steps"),
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
