"""Contract of every file of the family: derivatives, freedoms, balance of reactions.

A new joint is tested once it stands in every_joint.yaml under its own name.
"""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bench import Rows

import crashsolve.joints
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build

HERE = Path(__file__).parent
FOLDER = Path(crashsolve.joints.__file__).parent
TYPES = sorted(path.stem for path in FOLDER.glob("[a-z]*.py"))
# free degrees of freedom left to b when a is held: Kutzbach
FREEDOMS = {
    "weld": 0,
    "spherical": 3,
    "revolute": 1,
    "universal": 2,
    "cylindrical": 2,
    "prismatic": 1,
    "screw": 1,
    "planar": 3,
    "point_on_line": 4,
    "point_on_plane": 5,
    "distance": 5,
    "rotation_driver": 5,
    "translation_driver": 5,
    "point_driver": 5,
    "gear": 5,
    "rack": 5,
}
DRIVERS = ("rotation_driver", "translation_driver", "point_driver")
# central differences with steps of 1e-5: truncation 1e-10 times third derivatives of order 100,
# round-off 1e-16 / 1e-5
STEP, TOLERANCE = 1e-5, 2e-8


@cache
def built() -> Any:
    return build(read_deck(HERE / "every_joint.yaml"))


def case_of(name: str) -> Rows:
    """The joint of the deck of that name and type."""
    model, state = built()
    return Rows(model, state, next(g for g in model.joint_groups() if g.type == name), name)


@pytest.fixture(params=TYPES)
def case(request: pytest.FixtureRequest) -> Rows:
    return case_of(request.param)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)


def test_the_deck_shows_every_joint() -> None:
    deck = read_deck(HERE / "every_joint.yaml")
    assert set(TYPES) <= set(deck.entries["joints"]) and set(TYPES) == set(FREEDOMS)


def test_the_start_satisfies_the_joint(case: Rows) -> None:
    # round-off of sums of terms of order 1
    np.testing.assert_allclose(case.phi(), 0.0, atol=1e-15)


def test_jacobian_is_the_derivative_of_the_residual(case: Rows, rng: np.random.Generator) -> None:
    for _ in range(5):
        case.scramble(rng)
        case.rows.nu = 0.0
        case.jacobian()
        expected = case.total(case.dense() @ case.velocity())
        case.move(STEP)
        after = case.phi()
        case.move(-2 * STEP)
        slope = (after - case.phi()) / (2 * STEP)
        np.testing.assert_allclose(expected, slope, atol=TOLERANCE)


def test_nu_is_minus_the_derivative_in_time(case: Rows, rng: np.random.Generator) -> None:
    case.scramble(rng)
    case.jacobian()
    nu = case.total(case.rows.nu)
    case.t += STEP
    after = case.phi()
    case.t -= 2 * STEP
    np.testing.assert_allclose(nu, -(after - case.phi()) / (2 * STEP), atol=TOLERANCE)
    assert case.module.__name__.endswith(DRIVERS) or not nu.any()


def test_gamma_is_the_convective_term(case: Rows, rng: np.random.Generator) -> None:
    for _ in range(5):
        case.scramble(rng)
        gamma = case.gamma()
        case.move(STEP, time=True)
        after = case.rate()
        case.move(-2 * STEP, time=True)
        np.testing.assert_allclose(gamma, -(after - case.rate()) / (2 * STEP), atol=TOLERANCE)


def test_the_rank_leaves_the_right_freedoms(case: Rows) -> None:
    case.jacobian()
    D = case.dense().reshape(case.parts, case.m, -1).sum(axis=0)
    b = case.ends[1]
    held = D[:, 6 * b : 6 * b + 6]
    name = case.module.__name__.rpartition(".")[2]
    assert 6 - np.linalg.matrix_rank(held, tol=1e-9) == FREEDOMS[name]
    assert np.linalg.matrix_rank(D, tol=1e-9) == case.m


def test_forces_on_both_bodies_balance_where_the_rows_hold(case: Rows) -> None:
    case.jacobian()
    for i, row in enumerate(case.rows):
        part = i // case.m
        a, b = (case.nodes[end] for end in case.ends[2 * part : 2 * part + 2])
        force_a, torque_a, force_b, torque_b = row.D.reshape(4, 3)
        moment = np.cross(a.r, force_a) + torque_a + np.cross(b.r, force_b) + torque_b
        # round-off of products of order 10
        np.testing.assert_allclose(force_a + force_b, 0.0, atol=1e-14)
        np.testing.assert_allclose(moment, 0.0, atol=1e-14)


@pytest.mark.parametrize("name", ["rotation_driver", "gear", "rack"])
def test_turns_are_counted_without_a_jump(name: str) -> None:
    case = case_of(name)
    case.nodes.v[:] = case.nodes.w[:] = 0.0
    p, column = case.p, case.new.dtype.names[0]
    axis = case.nodes[p.node_a].A.reshape(3, 3) @ p.axis_a
    case.nodes[p.node_b].w[:] = axis
    for k in range(1, 1001):
        case.move(0.03)
        case.phi()
        # round-off of k products of rotation matrices
        assert abs(case.new[column] - 0.03 * k) < 1e-12
        case.old, case.new = case.new, case.old
    assert case.new[column] > 4 * 2 * np.pi
