"""Scatter of rollover.md: quartiles, rank correlations and a picture, from its sweep.

crashsolve sweep decks/queue/rollover.plan.yaml --jobs 2
python decks/scenes/rollover_scatter.py rollover.plan.sweep  (with matplotlib and scipy)

Of n runs, the rank correlation of independent numbers deviates by 1/sqrt(n - 1). With N numbers,
some of the N x 3 correlations are by chance beyond a limit in 5 % of all sweeps when the limit is
the normal quantile of 0.05/(2 N x 3) (Bonferroni).
"""

import csv
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, spearmanr

PICTURE = Path(__file__).resolve().parent / "rollover" / "scatter.png"
HEADS = ("SI of the driver", "SI of the passenger", "SI of the rear occupant")
SEAT, ROLL = "rear occupant from his seat [m]", "largest roll [deg]"
START, BALANCE = "contact energy at the start [J]", "energy balance [%]"
# J: a head of 4.5 kg at 1 m/s has 2; more is the answer to an overlap, not to the roll-over
LARGEST_START = 2.0
# read off Fig. 28: where the three curves end
LOW, HIGH = 1000, 3500
SHOWN = 8


def runs_of(folder: Path) -> list[dict[str, str]]:
    """Rows of the sweep's table, one for each run."""
    with (folder / "sweep.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def column(rows: list[dict[str, str]], name: str) -> NDArray[np.float64]:
    """Numbers of a column."""
    return np.array([float(row[name]) for row in rows])


def print_quartiles(rows: list[dict[str, str]]) -> None:
    """Least, quartiles and largest of all measures."""
    for name in (*HEADS, SEAT, ROLL, BALANCE):
        quartiles = np.quantile(column(rows, name), (0, 0.25, 0.5, 0.75, 1))
        print(f"{name:34}", *(f"{value:10.4g}" for value in quartiles))


def print_correlations(rows: list[dict[str, str]]) -> None:
    """The largest rank correlations of each measure with a varied number."""
    names = list(rows[0])
    varied = names[1 : names.index(HEADS[0])]
    limit = norm.isf(0.05 / (2 * len(varied) * len(HEADS))) / np.sqrt(len(rows) - 1)
    print(f"{len(varied)} numbers, +- {1 / np.sqrt(len(rows) - 1):.2f}, beyond chance: {limit:.2f}")
    for measure in (*HEADS, SEAT, ROLL):
        values = column(rows, measure)
        ranks = {name: spearmanr(column(rows, name), values).statistic for name in varied}
        largest = sorted(ranks, key=lambda name: -abs(ranks[name]))[:SHOWN]
        print(f"{measure}:", ", ".join(f"{name} {ranks[name]:+.2f}" for name in largest))


def draw(rows: list[dict[str, str]]) -> None:
    """Share of the runs over the Severity Index of each head."""
    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    axes.axvspan(LOW, HIGH, color="#edae49", alpha=0.4, label="Fig. 28 ends: 1000 to 3500")
    for name in HEADS:
        axes.ecdf(column(rows, name), label=name)
    axes.set(xlabel="Severity Index", ylabel="share of the runs below", xscale="log")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left")
    figure.savefig(PICTURE, dpi=100)
    plt.close(figure)


def main(folder: Path) -> None:
    """Print what rollover.md states of the scatter, and draw it."""
    runs = runs_of(folder)
    finished = [row for row in runs if row["state"] == "finished"]
    good = [row for row in finished if float(row[START]) <= LARGEST_START]
    print(f"{len(runs)} runs, {len(finished)} finished, {len(good)} began without an overlap")
    for row in runs:
        if row["state"] != "finished":
            print(row["run"], row["message"])
    away = column(good, SEAT)
    print("beyond 1, 2, 3 m of his seat:", *(int((away > limit).sum()) for limit in (1, 2, 3)))
    print_quartiles(good)
    print_correlations(good)
    draw(good)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
