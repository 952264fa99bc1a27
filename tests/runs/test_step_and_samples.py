"""Claim: a stated step that samples cut short is reported, and one that they do not is taken."""

from pathlib import Path

import pytest
from command import crashsolve

DECK = """
title: A mass on a spring
control: {{end_time: 1, step: {step}, estimate: "off"}}
{output}
bodies: {{ball: {{mass: 1, inertia: [1, 1, 1], velocity: [1, 0, 0]}}}}
springs: {{spring: {{type: linear, b: ball, at_a: [-1, 0, 0], stiffness: 1}}}}
"""


@pytest.mark.parametrize(
    ("step", "interval", "is_cut"),
    [(4e-3, None, True), (1e-3, None, False), (4e-3, 4e-3, False), (4e-3, 2e-3, True)],
)
def test_a_step_cut_by_samples(
    tmp_path: Path, step: float, interval: float | None, is_cut: bool
) -> None:
    output = f"output: {{history: {{interval: {interval}}}}}" if interval else ""
    deck = tmp_path / "deck.yaml"
    deck.write_text(DECK.format(step=step, output=output), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "results")
    assert done.returncode == 0, done.stderr
    said = done.stdout + done.stderr
    assert ("is cut to" in said) == is_cut
    steps = round(1.0 / min(step, interval or 1e-3))
    assert f"{steps}, 0" in said


def test_a_method_that_samples_within_its_steps_cuts_none(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    text = DECK.format(step=4e-3, output="").replace(
        "end_time", "integrator: dormand_prince_5, end_time"
    )
    deck.write_text(text, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "results")
    assert done.returncode == 0, done.stderr
    said = done.stdout + done.stderr
    assert "is cut to" not in said
    assert "250, 0" in said
