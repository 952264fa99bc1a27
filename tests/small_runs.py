"""Runs of small scenes, in processes of their own, and orders of their errors."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import yaml
from command import crashsolve

from crashpost.results.result import Result

# a cantilever of COUNT elements, described as WORD, whose tip is loaded at once
CANTILEVER = """materials: {m: {type: elastic, young: 2e11, poisson: 0.3, density: 7850}}
sections: {s: {type: circle, radius: 0.02}}
parts:
  arm:
    type: structure
    points: [{name: foot, at: [0, 0, 0], joint: 1e-6}, {name: tip, at: [1, 0, 0], joint: 1e-6}]
    members: [{from: foot, to: tip}]
    section: s
    material: m
    divisions: COUNT
    deformation: WORD
joints: {c: {type: weld, b: arm_foot, at: [0, 0, 0]}}
loads: {f: {type: force, body: arm_tip, at: [0, 0, 0], force: [0, 0, 100]}}"""


def run(
    folder: Path,
    scene: Mapping[str, object],
    end: float,
    step: float | None = None,
    plain: bool = False,
) -> Result:
    """Result of the scene with a fixed step, or with the automatic one.

    `plain`: as plain Python, where some hundred steps cost what the compiling of a scene does.
    """
    deck, out = folder / "deck.yaml", folder / f"{step}"
    control = {"end_time": end, "energy_limit": "off"} | ({"step": step} if step else {})
    # a sample cuts the step that would pass it: no more of them than these
    output = {"history": {"interval": end}, "states": {"interval": end}}
    text = yaml.safe_dump({"control": control, "output": output, **scene}, sort_keys=False)
    deck.write_text(text, "utf-8")
    done = crashsolve(deck, "-o", out, CRASHSOLVE_PLAIN="1" if plain else "0")
    assert done.returncode == 0, done.stdout + done.stderr
    return Result(out)


def last(result: Result, channel: str) -> float:
    """Value of a channel at the end of a run."""
    return float(result.series(channel).values[-1])


def slopes(errors: list[float]) -> np.ndarray:
    """Observed orders over halved steps."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
