"""Claim: beams at rest converge with the fourth power of the element's length, moving ones the 2nd.

Equilibria and frequencies come from the element's force and tangent alone, without time steps.
"""

from pathlib import Path

import numpy as np
import pytest
from bench import Bench, exponential, product

DECK = """
title: cantilever
control: {end_time: 1}
materials: {m: {type: elastic, young: YOUNG, poisson: 0, density: DENSITY}}
sections: {s: {type: general, area: 1, I_y: 1e-8, I_z: 1e-8, torsion: 1e-8, shear_y: 1, shear_z: 1}}
parts:
  p:
    type: beam
    mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: COUNT}
    section: s
    material: m
    side: [0, 1, 0]
"""


class Cantilever:
    """A slender beam of length 1 with E I = 1, its first node held."""

    def __init__(self, folder: Path, count: int) -> None:
        words = {"YOUNG": "1e8", "DENSITY": "1", "COUNT": str(count)}
        text = DECK
        for word, value in words.items():
            text = text.replace(word, value)
        self.bench, self.count = Bench(folder, "", text), count
        self.laws = [self.bench.law("parts", f"p_{k + 1}") for k in range(count)]
        self.module = self.laws[0].module

    def load(self) -> np.ndarray:
        """Forces and torques of the elements on all nodes but the first (6 n,)."""
        nodes = self.bench.nodes
        nodes.force[:] = nodes.torque[:] = 0.0
        for law in self.laws:
            args = (0.0, 0.0, nodes, self.bench.rows, self.bench.curves)
            self.module.force(law.p, law.old, law.new, law.out, *args)
        return np.hstack([nodes.force[2:], nodes.torque[2:]]).ravel()

    def stiffness(self) -> np.ndarray:
        """Derivative of the load by positions and turns, less its sign."""
        K = np.zeros((6 * self.count + 6, 6 * self.count + 6))
        for k, law in enumerate(self.laws):
            at = slice(6 * k, 6 * k + 12)
            K[at, at] -= self.module.forces_by_motions(
                law.p.reshape(1), None, self.bench.nodes, None
            )[0]
        return K[6:, 6:]

    def shift(self, direction: np.ndarray) -> None:
        for node, part in enumerate(direction.reshape(-1, 6), start=2):
            b = self.bench.nodes[node]
            self.bench.move(node, r=b.r + part[:3], q=product(exponential(part[3:]), b.q))

    def rest(self, load: float, steps: int = 3) -> None:
        """Newton's method to equilibrium under a dead load across the end, in a few portions."""
        outside = np.zeros(6 * self.count)
        for k in range(steps):
            outside[-5] = load * (k + 1) / steps
            for _ in range(30):
                direction = np.linalg.solve(self.stiffness(), self.load() + outside)
                # a bent strip that is nearly rigid along itself is approached by turning a little
                direction *= min(1.0, 0.3 / np.abs(direction).max())
                self.shift(direction)
                if np.abs(direction).max() < 1e-9:
                    break
            else:
                raise AssertionError("no equilibrium found")

    def frequencies(self, modes: int) -> np.ndarray:
        """Lowest natural frequencies [rad/s], two of each for both planes."""
        nodes = self.bench.nodes[2:]
        mass = np.repeat(1.0 / nodes.mass_inv, 3).reshape(-1, 3)
        J = nodes.J.reshape(-1, 3, 3)[:, [0, 1, 2], [0, 1, 2]]
        M = np.sqrt(np.hstack([mass, J]).ravel())
        squares = np.linalg.eigvalsh(self.stiffness() / np.outer(M, M))
        return np.sqrt(squares[:modes])


@pytest.mark.long
def test_the_tip_of_the_elastica_is_of_order_four(tmp_path: Path) -> None:
    """P L^2 / E I = 3: w = 0.60325344 (Mattiasson 1981, Int. J. Num. Meth. Eng. 17, 145-153)."""
    errors = []
    for count in (4, 8):
        beam = Cantilever(tmp_path, count)
        beam.rest(3.0)
        errors.append(beam.bench.nodes[count + 1].r[1] - 0.60325344)
    # the next term is of order six: a few per cent of the first
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)


def test_frequencies_of_a_cantilever_are_of_order_two(tmp_path: Path) -> None:
    """omega_k = (beta_k L)^2 sqrt(E I / rho A L^4), beta_k L of the Euler-Bernoulli beam."""
    exact = np.repeat(np.array([1.8751040687, 4.6940911330]) ** 2, 2)
    errors = []
    for count in (4, 8):
        errors.append(Cantilever(tmp_path, count).frequencies(4) / exact - 1.0)
    # slenderness: rotary inertia and shear are 1e-8 of bending
    order = np.log2(errors[0] / errors[1])
    np.testing.assert_allclose(order, 2.0, atol=0.2)
    assert np.abs(errors[1]).max() < 0.05
