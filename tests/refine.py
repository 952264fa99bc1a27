"""Runs of small scenes with a fixed step, made shorter and shorter to see the order of an error.

They run as plain Python, in processes of their own: a few hundred steps cost less than a compiler.
"""

from pathlib import Path
from typing import Any

import numpy as np
import yaml
from command import crashsolve

from crashpost.result import Result


def run(folder: Path, scene: dict[str, Any], end: float, step: float) -> Result:
    """Result of the scene with a fixed step."""
    deck, out = folder / "deck.yaml", folder / f"{step:g}"
    control = {"end_time": end, "step": step, "energy_limit": "off"}
    # a sample cuts the step that would pass it: no more of them than these
    output = {"history": {"interval": end}, "states": {"interval": end}}
    deck.write_text(yaml.safe_dump({"control": control, "output": output} | scene), "utf-8")
    done = crashsolve(deck, "-o", out, NUMBA_DISABLE_JIT="1")
    assert done.returncode == 0, done.stdout + done.stderr
    return Result(out)


def last(result: Result, channel: str) -> float:
    """Value of a channel at the end of a run."""
    return float(result.series(channel).values[-1])


def slopes(errors: list[float]) -> np.ndarray:
    """Observed orders over halved steps."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
