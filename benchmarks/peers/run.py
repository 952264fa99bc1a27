"""crashsolve beside Exudyn and MuJoCo: error against CPU time, same problems, same run.

    python benchmarks/peers/run.py [PROBLEM ...]

Problems: A1 A2 A3 A5 A6 train_16 rigid_bar; all when none is named. Each method of each code runs
over its steps or tolerances, five times each; the medians and a plot go to `results/`. The table of
CPU time at equal errors, from all results there, goes to the screen and to `benchmarks/README.md`.
"""

import csv
import importlib
import sys
from pathlib import Path

from compare import at_equal_error
from plot import plot
from problem import Point, Problem, sweep

REPEATS = 5
FOLDER = Path(__file__).resolve().parent
RESULTS, README = FOLDER / "results", FOLDER.parent / "README.md"
FILES = {
    "A1": "pendulum",
    "A2": "four_bar",
    "A3": "squeezer",
    "A5": "governor",
    "A6": "heavy_top",
    "train_16": "train_16",
    "rigid_bar": "rigid_bar",
}
BEGIN, END = "<!-- peers: begin -->", "<!-- peers: end -->"
COLUMNS = ["code", "method", "knob", "value", "error", "solve ms", "build ms", "note"]


def cells(point: Point) -> list[str]:
    ran = not point.note
    return [
        point.code,
        point.method,
        point.knob,
        f"{point.value:.3g}",
        f"{point.error:.2e}" if ran else "",
        f"{1e3 * point.cpu:.3f}" if ran else "",
        f"{1e3 * point.build:.1f}",
        point.note,
    ]


def write(problem: Problem, points: list[Point]) -> None:
    """All lines of a problem, as CSV and as markdown."""
    rows = [cells(point) for point in points]
    with open(RESULTS / f"{problem.name}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])
    lines = [f"# {problem.title}", "", f"Error: {problem.measure}.", ""]
    lines += [f"* {note}" for note in problem.notes] + [""] * bool(problem.notes)
    lines += [f"![error against CPU time]({problem.name}.png)", "", *markdown(COLUMNS, rows), ""]
    (RESULTS / f"{problem.name}.md").write_text("\n".join(lines))


def markdown(head: list[str], rows: list[list[str]]) -> list[str]:
    table = [head, ["---"] * len(head), *rows]
    return ["| " + " | ".join(row) + " |" for row in table]


def read(name: str) -> list[Point]:
    """Lines of an earlier run; those that stopped are left out."""
    with open(RESULTS / f"{name}.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if not row["note"]]
    return [
        Point(
            row["code"],
            row["method"],
            row["knob"],
            float(row["value"]),
            float(row["error"]),
            float(row["solve ms"]) / 1e3,
            float(row["build ms"]) / 1e3,
        )
        for row in rows
    ]


def summary() -> list[str]:
    """Table at equal errors of every problem with results."""
    head = ["problem", "error", "crashsolve ms", "exudyn ms", "mujoco ms", "crashsolve / best peer"]
    known = [name for name in FILES if (RESULTS / f"{name}.csv").exists()]
    rows = [[name, *row] for name in known for row in at_equal_error(read(name))]
    return markdown(head, rows)


def renew_readme(table: list[str]) -> None:
    """Puts the table between the marks of the README."""
    before, rest = README.read_text().split(BEGIN)
    after = rest.split(END)[1]
    README.write_text("\n".join([before + BEGIN, *table, END + after]))


def run(name: str) -> None:
    problem = importlib.import_module(FILES[name]).PROBLEM
    print(f"{problem.title}; error: {problem.measure}", flush=True)
    points = sweep(problem, REPEATS)
    for point in points:
        print("  ".join(f"{cell:>10}" for cell in cells(point)), flush=True)
    write(problem, points)
    plot(problem, points, RESULTS / f"{problem.name}.png")


def main() -> None:
    names = sys.argv[1:] or list(FILES)
    unknown = [name for name in names if name not in FILES]
    if unknown:
        raise SystemExit(f"unknown: {', '.join(unknown)}; known: {', '.join(FILES)}")
    RESULTS.mkdir(exist_ok=True)
    for name in names:
        run(name)
    table = summary()
    print("\n".join(table))
    renew_readme(table)


if __name__ == "__main__":
    main()
