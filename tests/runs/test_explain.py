"""Claim: explain shows what a scene uses, what it leaves out, and Python that composes its step."""

import ast
from pathlib import Path

from command import crashsolve


def test_explain_shows_laws_and_the_composed_step(mechanism: Path) -> None:
    done = crashsolve("explain", mechanism)
    assert done.returncode == 0, done.stderr
    summary, _, step = done.stdout.partition("\ncomposed step\n-------------\n")
    used, _, left = summary.partition("left out")
    assert "joints: revolute, spherical" in used
    assert "contact loop: sphere_plane_exact_restitution_bristle, pairs 2" in used
    assert "prismatic" in left
    functions = {node.name for node in ast.parse(step).body if isinstance(node, ast.FunctionDef)}
    assert {"residual", "force_pass", "energy", "advance"} <= functions
    # a revolute joint is a point and an axis in common
    assert "basic_point.residual" in step
    assert "basic_parallel.residual" in step
    assert "prismatic" not in step
