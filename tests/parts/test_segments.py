"""Claims: a chain of finite segments converges to the beam, at the order that theory says."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bench import exponential, product

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.orientation import matrix
from crashsolve.model.build import build
from crashsolve.model.nodes import COMPLIANT

# a rod of L / r = 1000: shear and rotary inertia alter its frequencies by some 1e-6
DECK = """title: a cantilever of segments
control: {end_time: 1}
materials: {steel: {type: elastic, young: 2e11, poisson: 0.25, density: 8000}}
sections: {rod: {type: circle, radius: 1e-3}}
parts:
  arm:
    type: structure
    points: [{name: foot, at: [0, 0, 0], joint: 1e-9}, {name: tip, at: [1, 0, 0], joint: 1e-9}]
    members: [{from: foot, to: tip, divisions: COUNT}]
    section: rod
    material: steel
    deformation: segments
joints: {wall: {type: weld, b: arm_foot, at: [0, 0, 0]}}
"""
EI = 2e11 * np.pi * 1e-12 / 4.0
MASS = 8000 * np.pi * 1e-6


class Chain:
    """The model of n springs, its segments in the order of the chain and its springs."""

    def __init__(self, folder: Path, n: int) -> None:
        path = folder / "chain.yaml"
        path.write_text(DECK.replace("COUNT", str(n)), "utf-8")
        self.model, state = build(read_deck(path))
        self.nodes: Any = state.nodes.view(np.recarray)
        group = next(g for g in self.model.groups if g.keyword == "springs")
        self.law, self.springs = group.module, group.parameters.view(np.recarray)
        self.old, self.new = (group.history[k].view(np.recarray) for k in (0, 1))
        self.out = group.output.view(np.recarray)
        inner = [f"arm_member_1_{k}" for k in range(1, n)]
        self.order = [self.model.bodies.index(name) for name in (*inner, "arm_tip")]

    def frequencies(self) -> np.ndarray:
        """Angular frequencies of small motions, from the least on [rad/s]."""
        size, rows = 6 * len(self.nodes), np.zeros(6, COMPLIANT.dtype).view(np.recarray)
        K, M = np.zeros((size, size)), np.zeros((size, size))
        for i, p in enumerate(self.springs):
            self.law.tangent(p, self.old[i], self.nodes, None, rows, 0)
            at = np.r_[6 * p.node_a : 6 * p.node_a + 6, 6 * p.node_b : 6 * p.node_b + 6]
            for row in rows:
                K[np.ix_(at, at)] += row.stiffness * np.outer(row.D, row.D)
        for i, node in enumerate(self.nodes):
            A = node.A.reshape(3, 3)
            M[6 * i : 6 * i + 3, 6 * i : 6 * i + 3] = np.eye(3) / max(node.mass_inv, 1e-9)
            M[6 * i + 3 : 6 * i + 6, 6 * i + 3 : 6 * i + 6] = A @ node.J.reshape(3, 3) @ A.T
        free = np.concatenate([np.arange(6 * i, 6 * i + 6) for i in self.order])
        L = np.linalg.inv(np.linalg.cholesky(M[np.ix_(free, free)]))
        return np.sqrt(np.linalg.eigvalsh(L @ K[np.ix_(free, free)] @ L.T))

    def bent(self, force: float) -> tuple[float, float, float]:
        """Displacement of the tip across and back, and its turn, under a force that keeps its
        direction.
        """
        start = self.nodes.copy()
        tip = self.order[-1]
        arm = np.array([1.0, 0.0, 0.0]) - start[tip].r

        def left(x: np.ndarray, load: float) -> np.ndarray:
            """Forces and moments in the plane that are out of balance, in units of the load."""
            n = self.nodes
            n[:] = start
            n.force[:], n.torque[:] = 0.0, 0.0
            for i, (dx, dz, rotation) in zip(self.order, x.reshape(-1, 3), strict=True):
                n[i].r += [dx, 0.0, dz]
                n[i].q = product(exponential(np.array([0.0, -rotation, 0.0])), start[i].q)
                n[i].A = matrix(n[i].q).ravel()
            for k, p in enumerate(self.springs):
                args = (0.0, 0.0, n, None, None)
                self.law.force(p, self.old[k], self.new[k], self.out[k], *args)
            lever = matrix(n[tip].q) @ matrix(start[tip].q).T @ arm
            n[tip].force += [0.0, 0.0, load]
            n[tip].torque += np.cross(lever, [0.0, 0.0, load])
            return np.array(
                [[n[i].force[0], n[i].force[2], n[i].torque[1]] for i in self.order]
            ).ravel()

        x = np.zeros(3 * len(self.order))
        for share in np.linspace(0.25, 1.0, 4):
            x = newton(partial(left, load=share * force), x)
            assert np.abs(left(x, share * force)).max() < 1e-6 * force
        lever = matrix(self.nodes[tip].q) @ matrix(start[tip].q).T @ arm
        position = self.nodes[tip].r + lever
        return float(position[2]), float(1.0 - position[0]), float(x[-1])


def newton(left: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    """A root of a function by its central differences."""
    for _ in range(8):
        steps = 1e-6 * np.eye(len(x))
        slopes = np.array([left(x + step) - left(x - step) for step in steps]).T / 2e-6
        x = x - np.linalg.solve(slopes, left(x))
    return x


def orders(errors: list[float]) -> np.ndarray:
    """Orders that errors show on halving."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def test_frequencies_of_a_cantilever_converge_with_the_square_of_the_length(
    tmp_path: Path,
) -> None:
    """Benchmarks F16: beta L = 1.8751040687, 4.6940911330, 7.8547574382."""
    wanted = np.array([1.8751040687, 4.6940911330, 7.8547574382]) ** 2 * np.sqrt(EI / MASS)
    errors = []
    for n in (4, 8, 16, 32):
        # a round rod swings at each frequency in two planes
        frequencies = Chain(tmp_path, n).frequencies()[:6:2]
        errors.append(np.abs(frequencies / wanted - 1.0))
    assert errors[2][0] < 2e-3
    for mode in range(3):
        assert orders([e[mode] for e in errors]) == pytest.approx([2.0] * 3, abs=0.15)


def test_one_spring_has_the_stiffness_of_the_whole_beam(tmp_path: Path) -> None:
    # small: the way along the axis is some (P L^2 / E I)^2 of it
    across, _, rotation = Chain(tmp_path, 1).bent(1e-3 * EI)
    assert across == pytest.approx(1e-3 / 3.0, rel=1e-5)
    assert rotation == pytest.approx(1e-3 / 2.0, rel=1e-5)


@pytest.mark.long
def test_large_deflections_converge_with_the_square_of_the_length(tmp_path: Path) -> None:
    """Benchmarks F1 at P L^2 / E I = 2."""
    wanted = np.array([0.49345748, 0.16064172, 0.78174983])
    errors = [np.array(Chain(tmp_path, n).bent(2.0 * EI)) - wanted for n in (2, 4)]
    assert np.abs(errors[-1]).max() < 1.5e-2
    for k in range(3):
        assert orders([abs(e[k]) for e in errors]) == pytest.approx([2.0], abs=0.35)


def buckling_load(folder: Path, count: int) -> float:
    """Of a straight cantilever of segments over that of Euler: K of its turns is singular there."""
    chain = Chain(folder, count)
    p, start = chain.springs, chain.nodes.copy()

    def softest(load: float) -> float:
        chain.nodes[:] = start
        for i, node in enumerate(chain.order):
            # every spring before it is shorter by P l / E A
            chain.nodes[node].r[0] -= (i + 1) * load / p[0].stiffness[0]
        own = chain.law.forces_by_motions(p, chain.old, chain.nodes, None)
        K = np.zeros((6 * len(chain.nodes), 6 * len(chain.nodes)))
        for k, forces in enumerate(own):
            at = np.r_[6 * p[k].node_a : 6 * p[k].node_a + 6, 6 * p[k].node_b : 6 * p[k].node_b + 6]
            K[np.ix_(at, at)] -= forces
        # the load keeps its direction, and its point is off the mass centre of the last half
        free = np.concatenate([np.arange(6 * i, 6 * i + 6) for i in chain.order])
        tip, arm = 6 * chain.order[-1], 1.0 - start[chain.order[-1]].r[0]
        K[[tip + 4, tip + 5], [tip + 4, tip + 5]] -= load * arm
        return float(np.linalg.eigvalsh(K[np.ix_(free, free)])[0])

    euler, low, high = np.pi**2 * EI / 4.0, 0.5, 1.5
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if softest(middle * euler) > 0.0 else (low, middle)
    return low


def test_a_column_of_segments_buckles_at_eulers_load_to_second_order(tmp_path: Path) -> None:
    # two segments are 8.7 % off, where the next term of the error, of fourth order, is still seen
    errors = [abs(buckling_load(tmp_path, count) - 1.0) for count in (4, 8, 16)]
    assert errors[-1] < 2e-3
    assert orders(errors) == pytest.approx([2.0] * 2, abs=0.1)


def test_a_hinge_forms_in_the_middle_of_the_first_length(tmp_path: Path) -> None:
    """So a cantilever bears M_p / (L - l / 2) at its end, which converges with l."""
    for n in (1, 4, 200):
        chain = Chain(tmp_path, n)
        p = chain.springs[0]
        at = chain.nodes[p.node_a].r + p.point_a
        assert at == pytest.approx([0.5 / n, 0.0, 0.0], abs=1e-8)
