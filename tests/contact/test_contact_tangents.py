"""Claim: the tangents of contact laws that implicit integrators get are their derivatives."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from test_friction_laws import LAWS as FRICTIONS
from test_normal_laws import LAWS as NORMALS
from touching import Contact

from crashsolve.deck.card import law_class


@pytest.mark.parametrize("law", NORMALS)
def test_a_normal_tangent_is_the_derivative(law: str, tmp_path: Path) -> None:
    contact = Contact(tmp_path, f"{{type: {law}, {NORMALS[law]}}}")
    rng = np.random.default_rng(2)
    tangent = contact.group.normal.normal_tangent
    for _ in range(50):
        depth, rate = float(rng.uniform(1e-3, 0.015)), float(rng.uniform(0.01, 2.0))
        contact.old.active, contact.old.impact_speed = 1, 2.0
        contact.press(depth, rate)
        contact.accept()
        k, c = tangent(contact.p, contact.old, depth, rate, 1.0, contact.bench.curves)
        step = 1e-7
        ahead, here = contact.press(depth + step, rate).force, contact.press(depth, rate).force
        # one side, for a crush that grows: second derivatives are below 1e8
        assert (ahead - here) / step == pytest.approx(k, rel=1e-4, abs=20.0)
        above, below = (contact.press(depth, rate + side * step).force for side in (1, -1))
        # round-off of forces of 1e4 over the step
        assert (above - below) / (2 * step) == pytest.approx(c, rel=1e-5, abs=1e-4)


@pytest.mark.parametrize("law", [law for law in FRICTIONS if law != "bristle"])
def test_a_friction_tangent_is_the_derivative_along_and_across(law: str, tmp_path: Path) -> None:
    contact = Contact(tmp_path, friction=f"{{type: {law}, {FRICTIONS[law]}}}")
    tangent = contact.group.friction.friction_tangent
    n, u, across = np.eye(3)[[2, 0, 1]]
    for v in (0.02, 0.07, 0.3, 2.0):
        along, side = tangent(contact.p, 100.0, (v, 0.0, 0.0))
        step = 1e-6
        ends = [contact.friction_force(100.0, (v + s) * u, n).force @ u for s in (step, -step)]
        # central differences of a force of 40 N: round-off 1e-8, third derivatives below 1e6
        assert (ends[1] - ends[0]) / (2 * step) == pytest.approx(along, rel=1e-6, abs=1e-5)
        ends = [
            contact.friction_force(100.0, v * u + s * across, n).force @ across
            for s in (step, -step)
        ]
        assert (ends[1] - ends[0]) / (2 * step) == pytest.approx(side, rel=1e-6, abs=1e-5)


def test_only_a_law_of_whole_steps_has_no_tangent() -> None:
    for family, laws, name in (
        ("contact/normal", NORMALS, "normal_tangent"),
        ("friction", FRICTIONS, "friction_tangent"),
    ):
        for law in laws:
            module = import_module(law_class(family, law).__module__)
            assert hasattr(module, name) != getattr(module, "STEPWISE", False), law
