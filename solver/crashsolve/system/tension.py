"""What tension lends to beams, where an element is too long to show it.

    N > l k_y   or   N > l k_z,   slender: N l^2 > 12 E I

An element of a beam measures bending in the mean of its ends: of the work of its tension N along
the bent line it has less than a continuous beam. Drawn straight it would fold sideways by itself,
elastic or not, from N l^2 = 12 E I on with hinges at its ends, and from (6 + sqrt(84)) E I =
15.2 E I on if clamped at one end and free at the other. That is no way out of a beam. So where an
element of a model bears more than the bounds above, stability is judged with what its elements are
without (parts/_beam_tangent.py), and a warning names it, as how it bends is wrong. Below these
bounds no element folds so. Consequence to test: no tension is unstable.

Reference: Przemieniecki (1968), Theory of Matrix Structural Analysis, 15.2 (geometric stiffness).
"""

from typing import Any

import numpy as np

from crashsolve.foundation.posture import products
from crashsolve.parts._beam_tangent import lack_in_tension

# unknowns of a matrix that is judged as a whole
MOST_UNKNOWNS = 1500


def beams(groups: list[Any]) -> list[Any]:
    """Those whose entries are elements of beams."""
    return [
        g
        for g in groups
        if g.keyword == "parts" and "turning_stiffness" in (g.parameters.dtype.names or ())
    ]


def overdrawn(groups: list[Any]) -> str:
    """The element whose tension is largest over its bound; empty where none is above it."""
    name, most = "", 1.0
    for g in beams(groups):
        p = g.parameters
        share = g.output["force"][:, 0] / (p["length"] * p["stiffness"][:, 1:].min(axis=1))
        if share.max(initial=0.0) > most:
            name, most = g.names[int(share.argmax())], float(share.max())
    return name


def lack(groups: list[Any], nodes: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Stiffness (6 n, 6 n) by tension that elements of beams are without, of the free nodes."""
    n = len(free)
    K, place = np.zeros((n + 1, n + 1, 6, 6)), np.full(len(nodes), n)
    place[free] = np.arange(n)
    for g in beams(groups):
        p = g.parameters
        a, b = nodes[p["node_a"]], nodes[p["node_b"]]
        q_a, q_b = a["q"], b["q"]
        if "turn" in p.dtype.names:
            q_a, q_b = products(q_a, p["turn"]), products(q_b, p["turn"])
        found = lack_in_tension(p, q_a, q_b, b["r"] - a["r"], g.output["force"][:, 0])
        found = found.reshape(-1, 2, 6, 2, 6)
        ends = place[p["node_a"]], place[p["node_b"]]
        for i, j in np.ndindex(2, 2):
            np.add.at(K, (ends[i], ends[j]), found[:, i, :, j])
    return K[:n, :n].transpose(0, 2, 1, 3).reshape(6 * n, 6 * n)


def assembled(tableau: Any, joint_rows: int, count: int, free: np.ndarray) -> np.ndarray:
    """K (6 n, 6 n) of the free ones of `count` nodes, as an implicit step has it."""
    columns, blocks = tableau["columns_0"], tableau["blocks_0"]
    K = np.zeros((count, count, 6, 6))
    for c in columns[columns["node"] > 0]:
        for e in range(c["block"], c["block_end"]):
            other = int(columns[blocks[e]["column"]]["node"])
            if other > 0:
                K[other, c["node"]] += blocks[e]["stiff"].reshape(6, 6)
                if e > c["block"]:
                    K[c["node"], other] += blocks[e]["stiff_above"].reshape(6, 6).T
    for row in tableau["compliant_0"][joint_rows:]:
        D, ends = row["D"].reshape(2, 6), (row["node_a"], row["node_b"])
        for i, j in np.ndindex(2, 2):
            K[ends[i], ends[j]] += max(float(row["stiffness"]), 0.0) * np.outer(D[i], D[j])
    return K[np.ix_(free, free)].transpose(0, 2, 1, 3).reshape(6 * len(free), 6 * len(free))


def warning(element: str, time: float) -> str:
    """What is told of an element above its bound."""
    return (
        f"element '{element}' bears more tension at t = {time:.6g} s than its length allows "
        "(N l^2 > 12 E I): such an element resists being bent too little, or not at all. Its "
        "stretch is right, and stability is judged with the stiffness that tension lends to "
        "bending; but how it bends is wrong. Give the part more elements"
    )
