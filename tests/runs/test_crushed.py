"""Claim: what is shorter at the end than a folded tube is named."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from crashsolve.simulation.remarks import FOLDED, crushed


def engine(*stretches: float) -> Any:
    """As far as the remark asks: springs of 0.1 m each with a stretch over it, and a beam."""
    n = len(stretches)
    output = np.zeros(n, [("displacement", float, 3), ("plastic_strain", float)])
    output["displacement"][:, 0] = 0.1 * np.array(stretches)
    parameters = np.zeros(n, [("length", float)])
    parameters["length"] = 0.1
    beams = np.zeros(1, [("strain", float, 3)])
    beams["strain"][0, 0] = 0.2
    groups = [
        SimpleNamespace(
            keyword="springs",
            names=[f"post_{k + 1}" for k in range(n)],
            parameters=parameters,
            output=output,
        ),
        SimpleNamespace(keyword="parts", names=["arm_1"], parameters=parameters[:1], output=beams),
    ]
    return cast(Any, SimpleNamespace(model=SimpleNamespace(groups=groups)))


@pytest.mark.parametrize(
    ("stretches", "words"),
    [
        ((-0.5, 0.1), ()),
        ((-0.5, -FOLDED - 0.01), ("'post_2' is 74 % shorter", "solid")),
        ((-1.2, -0.9), ("'post_1' is 120 % shorter", "(1 more", "inside out")),
    ],
)
def test_what_is_crushed_beyond_its_folds_is_named(
    stretches: tuple[float, ...], words: tuple[str, ...]
) -> None:
    warnings = crushed(engine(*stretches))
    assert len(warnings) == bool(words)
    assert all(word in warnings[0] for word in words)
