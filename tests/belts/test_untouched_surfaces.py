"""A run names the surfaces of a belt's route that it never lay on: what they belong to was free."""

from pathlib import Path

import pytest
from command import crashsolve

# the ball of a body that falls past a taut line, or into it
DECK = """
title: A ball and a belt
control: {{end_time: 0.05, estimate: off}}
bodies:
  man: {{mass: 10, inertia: [1, 1, 1], position: [{aside}, 0, 0.02], velocity: [0, 0, -1]}}
surfaces:
  chest: {{type: {shape}, body: man}}
belts:
  s:
    webbing: {{stiffness: 1.0e+5}}
    route:
      - {{anchor: {{at: [0, -1, -0.1]}}}}
      - {{wrap: {{surface: chest}}}}
      - {{anchor: {{at: [0, 1, -0.1]}}}}
"""
SHAPES = ("sphere, radius: 0.1", "ellipsoid, semi_axes: [0.1, 0.2, 0.1]")


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("aside", [0.0, 0.2])
def test_a_surface_that_the_belt_passed_by_is_reported(
    aside: float, shape: str, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(DECK.format(aside=aside, shape=shape), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    is_reported = "belt 's': it never lay on the surface of its fitting 2" in done.stdout
    assert is_reported == (aside > 0.1), done.stdout
