"""Claim: the log states element-cycles per second of CPU, for models with shells alone."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from crashsolve.simulation.totals import _cost

CYCLES, STEPPING = 1000, 0.5


def account(*counts: int) -> Any:
    """Of a run whose parts have so many elements."""
    table = np.array([(n,) for n in counts], [("element_count", np.int64)])
    groups = [SimpleNamespace(parameters=table)] if counts else []
    return SimpleNamespace(
        phases=SimpleNamespace(
            cycles=lambda: CYCLES, simulated=lambda: 0.1, average_steps=lambda: {}
        ),
        engine=SimpleNamespace(model=SimpleNamespace(element_groups=lambda: groups)),
        cpu={"steps": STEPPING},
        cpu_seconds=lambda: 1.0,
    )


def test_elements_of_all_parts_count() -> None:
    cost = _cost(account(30, 18))["element-cycles per second"]
    rate, _, rest = cost.partition(" ")
    assert float(rate) == pytest.approx(48 * CYCLES / STEPPING, rel=5e-3)  # three digits
    assert rest.endswith("48 elements")


def test_rigid_models_have_none() -> None:
    assert "element-cycles per second" not in _cost(account())
