"""Errors of all shell elements over the mesh, and their order: benchmarks S1 and S9.

    python benchmarks/shell_convergence.py      (in an environment with matplotlib)

writes shell_convergence.md and .png beside it. S9, the plate, is compared with Navier's series of a
plate with shear, under a hundredth of the deck's load, so that the answer is linear; S1, the roof,
with the converged value of FinEtoolsFlexStructures.jl. The order from differences of three meshes,
log2((w_2h - w_4h) / (w_h - w_2h)), needs no reference.
"""

import subprocess
import sys
import tempfile
from math import log2
from pathlib import Path

import numpy as np
from figures import finish

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path[:0] = [str(ROOT / "postproc")]

from crashpost.results.result import Result  # noqa: E402

DECKS = ROOT / "decks/verification/parts"
KINDS = ("reduced", "fully_integrated", "triangles")
MESHES = (4, 8, 16, 32)
HEAD = """# Convergence of shell elements

Written by `python benchmarks/shell_convergence.py`. n is the number of elements along a side of the
quadrilateral mesh; triangles are its quadrilaterals cut in two. "Order" is from the differences of
three meshes, in brackets from the errors of two.

![errors over meshes](shell_convergence.png)
"""
TAIL = """
Both quadrilaterals are one element as long as everything is elastic (`solver/theory/shells.md`).
The error of the triangle in the roof is that of constant strain in its plane.
"""


def navier() -> float:
    """Deflection of the middle of the plate of S9 with shear, for q = 10 Pa [m]."""
    E, nu, a, t, q = 2e11, 0.3, 1.0, 0.01, 10.0
    D, S = E * t**3 / (12.0 - 12.0 * nu**2), 5.0 / 6.0 * E / (2.0 + 2.0 * nu) * t
    odd = np.arange(1, 400, 2)
    m, n = np.meshgrid(odd, odd)
    k = (m**2 + n**2) * np.pi**2 / a**2
    load = 16.0 * q / (np.pi**2 * m * n) * np.sin(0.5 * np.pi * m) * np.sin(0.5 * np.pi * n)
    return float((load * (1.0 / (D * k**2) + 1.0 / (S * k))).sum())


# deck, part, settings, channel, reference
PROBLEMS = {
    "S9, simply supported plate": (
        ("shell_plate", "plate", ["q=10"], "rbdout.plate_mid.position.z"),
        navier(),
    ),
    "S1, Scordelis-Lo roof": (
        ("shell_roof", "roof", [], "nodout.roof_edge.displacement.z"),
        -0.30202e-3,
    ),
}


def answer(folder: Path, problem: tuple[str, str, list[str], str], kind: str, n: int) -> float:
    """Final value of a deck's channel with one kind of element."""
    deck, part, settings, channel = problem
    words = [*settings, f"parts.{part}.element={kind}", f"n={n}", "control.estimate=off"]
    sets = [part for word in words for part in ("--set", word)]
    out = folder / f"{deck}_{kind}_{n}"
    command = [sys.executable, "-m", "crashsolve", DECKS / f"{deck}.yaml", "-o", out, *sets]
    subprocess.run(command, check=True, capture_output=True)
    return float(Result(out).series(channel).values[-1])


def table(answers: dict[str, list[float]], reference: float) -> list[str]:
    """Lines of a problem: answers over the reference, errors and orders."""
    lines = ["| element | n | answer / reference | error | order |", "|---|---|---|---|---|"]
    for kind, values in answers.items():
        errors = [value / reference - 1.0 for value in values]
        for k, (n, error) in enumerate(zip(MESHES, errors, strict=True)):
            order = f"({log2(abs(errors[k - 1] / error)):.2f})" if k else ""
            if k > 1:
                ratio = (values[k - 1] - values[k - 2]) / (values[k] - values[k - 1])
                order = (f"{log2(ratio):.2f} " if ratio > 0.0 else "- ") + order
            lines.append(f"| {kind} | {n} | {1.0 + error:.5f} | {error:+.2e} | {order} |")
    return lines


def draw(results: dict[str, tuple[dict[str, list[float]], float]]) -> None:
    """The picture of all errors."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, len(results), figsize=(9, 4), layout="constrained")
    for axis, (name, (answers, reference)) in zip(axes, results.items(), strict=True):
        for (kind, values), mark in zip(answers.items(), ("o-", "x--", "^-"), strict=True):
            axis.loglog(MESHES, [abs(v / reference - 1.0) for v in values], mark, label=kind)
        axis.loglog(MESHES, [1.0 / n**2 for n in MESHES], "k:", label="order 2")
        axis.set(title=name, xlabel="elements along a side", ylabel="relative error")
    finish(figure, axes, MESHES, HERE / "shell_convergence.png")


def main() -> None:
    """Run everything, write the page."""
    results, lines = {}, [HEAD]
    with tempfile.TemporaryDirectory() as name:
        for title, (problem, reference) in PROBLEMS.items():
            answers = {
                kind: [answer(Path(name), problem, kind, n) for n in MESHES] for kind in KINDS
            }
            results[title] = (answers, reference)
            lines += [f"## {title}", "", f"Reference {reference:.6e} m.", ""]
            lines += [*table(answers, reference), ""]
    draw(results)
    (HERE / "shell_convergence.md").write_text("\n".join(lines).rstrip() + "\n" + TAIL, "utf-8")


if __name__ == "__main__":
    main()
