"""Errors of beams over the mesh, and their order.

    python benchmarks/beam_convergence.py      (in an environment with matplotlib)

writes beam_convergence.md and .png beside it: benchmarks F1, F3 and F4, equilibria under the whole
load. Solutions of the rod as a boundary value problem are the references.
"""

import sys
import tempfile
from math import log2
from pathlib import Path

import numpy as np
from figures import finish

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.statics.equilibrium import StaticEngine

HERE = Path(__file__).resolve().parent
MESHES = (2, 4, 8, 16, 32)
# position of the tip
PROBLEMS = {
    "F1, elastica, P L^2 / E I = 10": (1.0 - 0.5549956, 0.81060902, 0.0),
    "F3, cantilever of Geradin": (5.0 - 0.5964713, 0.0, -2.1596939),
    "F4, bend of 45 degrees": (
        100.0 * (1.0 - np.sqrt(0.5)) - 13.731646,
        100.0 * np.sqrt(0.5) - 23.819092,
        53.607986,
    ),
}
STRAIGHT = """
title: {title}
control: {{end_time: 1, solution: quasi_static}}
materials: {{m: {{type: elastic, young: {E}, poisson: 0, density: 1}}}}
sections:
  s: {{type: general, area: {A}, I_y: {I}, I_z: {I}, torsion: {I}, shear_y: {k}, shear_z: {k}}}
curves: {{rise: {{points: [[0, 0], [1, 1]]}}}}
parts:
  p:
    type: beam
    mesh: {{shape: line, from: [0, 0, 0], to: [{L}, 0, 0], elements: {n}}}
    section: s
    material: m
    side: [0, 1, 0]
joints: {{clamp: {{type: weld, b: p_start, at: [0, 0, 0]}}}}
loads: {{tip: {{type: force, body: p_end, force: {force}, curve: rise}}}}
"""
CURVED = """
title: bend
control: {{end_time: 1, solution: quasi_static}}
materials: {{m: {{type: elastic, young: 1e7, poisson: 0, density: 0.01}}}}
sections: {{s: {{type: rectangle, width: 1, height: 1}}}}
curves: {{rise: {{points: [[0, 0], [1, 1]]}}}}
parts:
  p: {{type: frame, points: {points}, bars: {bars}, elements: 1, section: s, material: m}}
joints: {{clamp: {{type: weld, b: p_1, at: [0, 0, 0]}}}}
loads: {{tip: {{type: force, body: p_{end}, force: [0, 0, 600], curve: rise}}}}
"""
HEAD = """# Convergence of beams

Written by `python benchmarks/beam_convergence.py`. n is the number of elements; error the
distance of the tip from its position in the rod, over the distance it has travelled.

![errors over meshes](beam_convergence.png)
"""
TAIL = """
F1 is of order 4 until the rest is the stretch and shear of 1e-5 that its reference, which is
inextensible, leaves out.
"""


def deck(problem: str, n: int) -> str:
    """Text of a problem's deck with so many elements."""
    if problem.startswith("F1"):
        # E I = 1; stretch and shear are below P / E A = 1e-5
        words = {"E": 1, "A": 1e6, "I": 1, "k": 2, "L": 1, "force": [0, 10, 0]}
        return STRAIGHT.format(title="elastica", n=n, **words)
    if problem.startswith("F3"):
        E, GA, EI = 4.8e8, 3.231e8, 9.346e6
        words = {"E": E, "A": 1, "I": EI / E, "k": 2 * GA / E, "L": 5, "force": [0, 0, -6e5]}
        return STRAIGHT.format(title="cantilever", n=n, **words)
    rotations = np.linspace(0.0, 0.25 * np.pi, n + 1)
    points = [[100.0 * float(1.0 - np.cos(a)), 100.0 * float(np.sin(a)), 0.0] for a in rotations]
    return CURVED.format(points=points, bars=[[k, k + 1] for k in range(1, n + 1)], end=n + 1)


def error(folder: Path, problem: str, n: int) -> float:
    """Of the tip's position, over its displacement."""
    path = folder / "deck.yaml"
    path.write_text(deck(problem, n), "utf-8")
    read = read_deck(path)
    model, state = build(read)
    engine = StaticEngine(model, state, read.control)
    engine.start()
    start = state.nodes["r"][-1].copy()
    # load steps, so that Newton's method follows the rod
    for k in range(10):
        engine.reach(0.1 * (k + 1))
    exact = np.array(PROBLEMS[problem])
    return float(np.linalg.norm(state.nodes["r"][-1] - exact) / np.linalg.norm(exact - start))


def draw(results: dict[str, list[float]]) -> None:
    """The picture of all errors."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, len(results), figsize=(11, 4), layout="constrained")
    for axis, (name, errors) in zip(axes, results.items(), strict=True):
        axis.loglog(MESHES, errors, "o-", label="beam")
        axis.loglog(MESHES, [0.4 / n**2 for n in MESHES], "k:", label="order 2")
        axis.loglog(MESHES, [0.4 / n**4 for n in MESHES], "k--", label="order 4")
        axis.set(title=name, xlabel="elements", ylabel="error of the tip over its displacement")
    finish(figure, axes, MESHES, HERE / "beam_convergence.png")


def main() -> None:
    """Run everything, write the page."""
    results: dict[str, list[float]] = {}
    lines = [HEAD]
    with tempfile.TemporaryDirectory() as name:
        for problem in PROBLEMS:
            e = results[problem] = [error(Path(name), problem, n) for n in MESHES]
            lines += [f"## {problem}", "", "| n | error | order |", "|---|---|---|"]
            for k, n in enumerate(MESHES):
                order = f"{log2(e[k - 1] / e[k]):.2f}" if k else ""
                lines.append(f"| {n} | {e[k]:.2e} | {order} |")
            lines.append("")
            print("\n".join(lines[-8:]), file=sys.stderr)
    draw(results)
    (HERE / "beam_convergence.md").write_text("\n".join(lines).rstrip() + "\n" + TAIL, "utf-8")


if __name__ == "__main__":
    main()
