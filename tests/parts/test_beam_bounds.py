"""Claim: steps of bent beams, and of beams on bodies, are bounded by their highest frequency.

Frequencies come from the element's tangent, which test_beam.py proves, without time steps.
"""

from pathlib import Path

import numpy as np
import pytest
from bench import exponential, product

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.orientation import matrix
from crashsolve.foundation.rows import as_rows
from crashsolve.model.build import build
from crashsolve.system.attachments import move_nodes, transfer_forces

# stocky elements, whose axial and bending modes have one frequency: I / A = l^2 / 15
CHAIN = """
title: chain between two bodies
control: {end_time: 1}
materials: {m: {type: elastic, young: 2000, poisson: 0.3, density: 3}}
sections: {s: {type: rectangle, width: 0.9, height: 0.9}}
bodies:
  left: {mass: LEFT, inertia: [LEFT, LEFT, LEFT], position: [0, 0, 0], welded: [p_start, q_start]}
  right: {mass: RIGHT, inertia: [RIGHT, RIGHT, RIGHT], position: [3, 0.1, 0], welded: [p_end]}
parts:
  p: {type: beam, mesh: {shape: line, from: [0, 0, 0], to: [3, 0, 0], elements: 3}, section: s, material: m, side: [0, 1, 0]}
  q: {type: beam, mesh: {shape: line, from: [0, 0, 0], to: [0, 0, 4], elements: 1}, section: s, material: m, side: [0, 1, 0]}
"""  # noqa: E501


class Chain:
    """Two bodies, the chain and an arm on one of them, at rest in any configuration."""

    def __init__(self, folder: Path, left: float, right: float) -> None:
        text = CHAIN.replace("LEFT", str(left)).replace("RIGHT", str(right))
        path = folder / "chain.yaml"
        path.write_text(text, "utf-8")
        self.model, state = build(read_deck(path))
        self.nodes, self.start = as_rows(state.nodes), state.nodes.copy()
        self.attached = as_rows(self.model.attached_nodes)
        self.bodies = {int(row.node): int(row.body) for row in self.attached}
        (self.group,) = [g for g in self.model.groups if g.keyword == "parts"]

    def deform(self, seed: int, bend: float) -> None:
        """Rotate and move from the start what moves by itself."""
        rng, self.nodes[:] = np.random.default_rng(seed), self.start
        for node, b in enumerate(self.nodes):
            if node > 0 and node not in self.bodies:
                b.q[:] = product(exponential(rng.uniform(-bend, bend, 3)), b.q)
                b.A[:] = matrix(b.q).ravel()
                b.r[:] += bend * rng.uniform(-0.2, 0.2, 3)
        move_nodes(self.attached, self.nodes)

    def bound(self) -> float:
        """2 max_i stiffness_i (system.timestep)."""
        nodes, curves = self.nodes, as_rows(self.model.curves)
        for name in ("force", "torque", "stiffness", "damping"):
            nodes[name] = 0.0
        g = self.group
        rows = (as_rows(table) for table in (g.parameters, *g.history, g.output))
        for p, old, new, out in zip(*rows, strict=True):
            g.module.force(p, old, new, out, 0.0, 1.0, nodes, None, curves)
        transfer_forces(self.attached, nodes)
        return float(2.0 * nodes.stiffness[1:].max())

    def highest(self) -> float:
        """Largest eigenvalue of M^-1 K of all that moves."""
        nodes, p = self.nodes, self.group.parameters
        K, M = (np.zeros((6 * len(nodes), 6 * len(nodes))) for _ in range(2))
        blocks = self.group.module.forces_by_motions(p, None, nodes, None)
        for own, block in zip(p, blocks, strict=True):
            T = np.zeros((12, len(K)))
            for k, node in enumerate((int(own["node_a"]), int(own["node_b"]))):
                body = self.bodies.get(node, node)
                x, y, z = nodes[node].r - nodes[body].r
                T[6 * k : 6 * k + 6, 6 * body : 6 * body + 6] = np.eye(6)
                arm = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
                T[6 * k : 6 * k + 3, 6 * body + 3 : 6 * body + 6] = arm
            K -= T.T @ block @ T
        for node in range(1, len(nodes)):
            at = slice(6 * node, 6 * node + 3), slice(6 * node + 3, 6 * node + 6)
            A = nodes[node].A.reshape(3, 3)
            M[at[0], at[0]] = np.eye(3) / nodes[node].mass_inv
            M[at[1], at[1]] = A @ nodes[node].J.reshape(3, 3) @ A.T
        free = [k for k in range(6, len(K)) if k // 6 not in self.bodies]
        square = np.linalg.solve(M[np.ix_(free, free)], K[np.ix_(free, free)])
        return float(np.linalg.eigvals(square).real.max())


@pytest.mark.parametrize("bend", [0.0, 0.1, 0.4, 1.0])
@pytest.mark.parametrize(("left", "right"), [(0.01, 0.01), (5.0, 1e4), (1e6, 1e6)])
def test_the_bound_of_a_chain_between_bodies_holds(
    tmp_path: Path, left: float, right: float, bend: float
) -> None:
    chain, ratios = Chain(tmp_path, left, right), []
    for seed in range(6 if bend else 1):
        chain.deform(seed, bend)
        ratios.append(chain.highest() / chain.bound())
    # 1e-9: round-off
    assert max(ratios) <= 1.0 + 1e-9
    # 3 springs and 2 masses between heavy bodies have 3 k / m; as if their ends were free, 4 k / m
    if bend == 0.0 and left > 1e5:
        assert max(ratios) > 0.9
