"""Work-precision plot of a problem: error over CPU time, one curve per method."""

from math import isfinite
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from problem import Point, Problem  # noqa: E402

COLOURS = {"crashsolve": "#c0392b", "exudyn": "#2471a3", "mujoco": "#239b56", "(kernel)": "#7f8c8d"}
MARKS = "os^Dv"


def plot(problem: Problem, points: list[Point], path: Path) -> None:
    figure, axes = plt.subplots(figsize=(6.4, 5.0), layout="constrained")
    used: dict[str, int] = {}
    for code, method in dict.fromkeys((point.code, point.method) for point in points):
        chosen = [p for p in points if (p.code, p.method) == (code, method)]
        # a run that stopped, or diverged, is useless on a logarithmic scale
        chosen = [p for p in chosen if not p.note and isfinite(p.error) and p.error > 0.0]
        number = used.get(code, 0)
        used[code] = number + 1
        axes.loglog(
            [1e3 * p.cpu for p in chosen],
            [p.error for p in chosen],
            color=COLOURS[code],
            marker=MARKS[number % len(MARKS)],
            linestyle=("-", "--", ":", "-.")[number % 4],
            markersize=4,
            label=f"{code}: {method}",
        )
    axes.set(title=problem.title, xlabel="CPU time of the solve [ms]", ylabel="error")
    axes.grid(True, which="major", alpha=0.3)
    figure.legend(loc="outside lower center", ncols=2, fontsize=7)
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)
