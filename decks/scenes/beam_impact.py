"""The page beam_impact.md with its pictures: the beam of section 4.5, run anew.

make beam        (or: python decks/scenes/beam_impact.py, in an environment with matplotlib)
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from os import cpu_count
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import values, write_page  # noqa: E402

from crashpost.results.result import Result  # noqa: E402

PICTURES = HERE / "beam_impact"
MESHES, FINER = (4, 10, 20), (4, 10, 20, 40, 80)
TIMES = (0.0, 0.5, 0.7, 0.8, 0.9, 1.0, 1.6, 2.0)
FRICTIONS = (0.0, 0.35)
WAVE = 17.72e-3  # 2 L / c [s]
LENGTH, MASS, SPEED, ENERGY = 1.0, 20.0, 2.0, 40.0
RIGID_IMPULSE = 40.064  # 2 m v / (1 + 3 sin^2 35.2 deg) [N s]
APART = 2e-3  # touches of less than this apart are one group [s]
MODELS = {
    "continuous, K = 1.2e8": ("continuous", {"K": "1.2e8"}),
    "continuous, K = 1.2e7": ("continuous", {"K": "1.2e7"}),
    "unilateral": ("unilateral", {}),
}
# the chapter's Table 1 [s]: before, during and after contact
PUBLISHED = {
    ("continuous", 4): (6.0e-4, 2.0e-4, 5.5e-4),
    ("continuous", 10): (2.4e-4, 1.5e-4, 2.0e-4),
    ("continuous", 20): (4.3e-5, 3.4e-5, 4.0e-5),
    ("unilateral", 4): (6.0e-4, 2.0e-5, 5.5e-4),
    ("unilateral", 10): (2.4e-4, 7.4e-6, 2.0e-4),
}


class Runs:
    """Runs of the decks, each once, in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __call__(self, deck: str, **settings: object) -> Result:
        """Result of a deck of this folder with parameters set."""
        words = [f"{name.replace('__', '.')}={value}" for name, value in settings.items()]
        out = self.folder / "_".join([deck, *words])
        if not (out / "status.json").exists():
            settings_words = [part for word in words for part in ("--set", word)]
            command = [sys.executable, "-m", "crashsolve", HERE / f"{deck}.yaml", "-o", out]
            command += ["--set", "control.estimate=off", *settings_words]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode:
                raise RuntimeError(f"{deck} {words}: {done.stdout[-500:]}{done.stderr}")
        return Result(out)

    def beam(self, model: str, elements: int, mu: float, **settings: object) -> Result:
        kind, given = MODELS[model]
        return self(f"beam_impact_10_{kind}", elements=elements, mu=mu, **given, **settings)


def positions(result: Result, time: float, nodes: list[str]) -> np.ndarray:
    """Positions (n, 2) of nodes at a time, in the plane of the motion."""
    names = [[f"rbdout.{node}.position.{axis}" for axis in "xy"] for node in nodes]
    at = result.series(names[0][0]).time
    return np.array([[np.interp(time, at, values(result, c)) for c in pair] for pair in names])


def beam_nodes(elements: int) -> list[str]:
    return ["beam_start", *(f"beam_{k}" for k in range(1, elements)), "beam_end"]


def groups(result: Result, node: int) -> list[tuple[float, float]]:
    """Start and length of each group of contacts of an end node [s]."""
    time, touching = result.time, values(result, f"rcforc.node_{node}.touching") > 0.0
    at = np.flatnonzero(touching)
    cuts = np.flatnonzero(np.diff(time[at]) > APART)
    first, last = time[at[np.r_[0, cuts + 1]]], time[at[np.r_[cuts, len(at) - 1]]]
    return [(float(a), float(b - a)) for a, b in zip(first, last, strict=True)]


# --- pictures -----------------------------------------------------------------------------------


def draw_frames(runs: Runs, plt: ModuleType) -> None:
    """Fig. 9: both models and the rigid bar, at the chapter's times."""
    figure, axes = plt.subplots(len(TIMES), len(MESHES), figsize=(9.0, 15.0), sharex=True)
    bar = runs("rigid_bar", control__end_time=2)
    for row, time in zip(axes, TIMES, strict=True):
        centre = positions(bar, time, ["bar"])[0]
        rotation = [
            np.interp(time, bar.time, values(bar, f"rbdout.bar.quaternion.{k}")) for k in "wz"
        ]
        angle = 2.0 * np.arctan2(rotation[1], rotation[0])
        half = 0.5 * LENGTH * np.array([np.cos(angle), np.sin(angle)])
        ends = np.array([centre - half, centre + half])
        for ax, elements in zip(row, MESHES, strict=True):
            ax.plot(*ends.T, color="0.6", lw=2.5, label="rigid bar")
            for model, style in (("continuous, K = 1.2e8", "-"), ("unilateral", "--")):
                x = positions(runs.beam(model, elements, 0.0), time, beam_nodes(elements))
                ax.plot(*x.T, style, marker=".", ms=3, lw=1.2, label=model)
            ax.axvline(1.0, color="k", lw=2)
            ax.set_aspect("equal")
            ax.set_xlim(-0.9, 1.05)
            ax.set_ylim(-0.35, 1.05)
            ax.set_xticks([-0.5, 0.0, 0.5, 1.0])
            ax.tick_params(labelsize=7)
        row[0].set_ylabel(f"{time:.1f} s")
    for ax, elements in zip(axes[0], MESHES, strict=True):
        ax.set_title(f"{elements} elements")
    axes[0][0].legend(fontsize=6, loc="lower left")
    save(figure, "frames")


def draw_forces(runs: Runs, plt: ModuleType) -> None:
    """Fig. 10: forces on both end nodes, 10 elements, on a log axis."""
    rows = [("continuous, K = 1.2e8", 0.0), ("continuous, K = 1.2e8", 0.35), ("unilateral", 0.0)]
    figure, axes = plt.subplots(len(rows), 1, figsize=(9.0, 9.0), sharex=True)
    bar = runs("rigid_bar")
    for ax, (model, mu) in zip(axes, rows, strict=True):
        for result, name, colours, width in (
            (runs.beam(model, 10, mu, sample=1e-4), f"{model}, mu = {mu:g}", ("C0", "C1"), 0.9),
            (bar, "rigid bar, mu = 0", ("0.4", "0.7"), 1.6),
        ):
            for node, colour in zip((1, 2), colours, strict=True):
                force = values(result, f"rcforc.node_{node}.normal")
                label = f"{name}, node {node}"
                ax.plot(result.time, np.where(force > 0, force, np.nan), color=colour, lw=width)
                ax.plot([], [], color=colour, label=label)
        ax.set_yscale("log")
        ax.set_ylim(1.0, 1e6)
        ax.set_xlim(0.4, 1.2)
        ax.set_ylabel("normal force [N]")
        ax.legend(fontsize=7, loc="upper left", ncol=2)
    axes[-1].set_xlabel("time [s]")
    save(figure, "forces")


def draw_meshes(runs: Runs, plt: ModuleType) -> None:
    """Impulse, captured energy and tip path over the number of elements."""
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 4.0))
    for mu, style in zip(FRICTIONS, ("-", "--"), strict=True):
        for k, model in enumerate(MODELS):
            impulses = [impulse(runs.beam(model, n, mu)) for n in FINER]
            label = f"{model}, mu = {mu:g}"
            axes[0].plot(FINER, impulses, style, marker="o", ms=4, color=f"C{k}", label=label)
        lost = [captured(runs.beam("unilateral", n, mu)) for n in FINER]
        axes[1].plot(FINER, lost, style, marker="o", color="C2", label=f"mu = {mu:g}")
        apart = [tips_apart(runs, n, mu) for n in FINER]
        axes[2].plot(FINER, apart, style, marker="o", color="C3", label=f"mu = {mu:g}")
    axes[0].axhline(RIGID_IMPULSE, color="0.6", lw=2)
    titles = ("impulse on node 1 [N s] (grey: rigid)", "energy lost by captures [J]")
    for ax, title in zip(axes, (*titles, "models apart: tips, to 0.75 s [m]"), strict=True):
        ax.set_title(title, fontsize=9)
        ax.set_xscale("log")
        ax.set_ylim(bottom=20.0 if ax is axes[0] else 0.0)
        ax.set_xlabel("elements")
        ax.set_xticks(FINER, [str(n) for n in FINER])
        ax.minorticks_off()
        ax.legend(fontsize=6, handlelength=4)
    save(figure, "meshes")


def save(figure: Figure, name: str) -> None:
    PICTURES.mkdir(exist_ok=True)
    figure.tight_layout()
    figure.savefig(PICTURES / f"{name}.png", dpi=90)


# --- numbers ------------------------------------------------------------------------------------


def impulse(result: Result, time: float = 0.7) -> float:
    """Impulse of the wall on node 1 before node 2 strikes [N s]."""
    return -float(np.interp(time, result.time, values(result, "rcforc.node_1.impulse.x")))


def captured(result: Result, time: float = 2.0) -> float:
    """Energy lost by captures [J]."""
    lost = values(result, "glstat.model.energy.contact_dissipated")
    return float(np.interp(time, result.time, lost))


def tips_apart(runs: Runs, elements: int, mu: float, until: float = 0.75) -> float:
    """Largest distance between the paths of the end nodes of both models [m]."""
    both = [runs.beam(m, elements, mu) for m in ("continuous, K = 1.2e8", "unilateral")]
    times, worst = np.arange(0.5, until, 2.5e-3), 0.0
    for node in ("beam_start", "beam_end"):
        apart = np.zeros(len(times))
        for axis in "xy":
            channel = f"rbdout.{node}.position.{axis}"
            a, b = (np.interp(times, r.time, values(r, channel)) for r in both)
            apart += (a - b) ** 2
        worst = max(worst, float(np.sqrt(apart.max())))
    return worst


def table(head: str, lines: list[list[str]]) -> str:
    titles = head.split("|")
    rule = "|".join("---" for _ in titles)
    return "\n".join([f"|{head}|", f"|{rule}|", *(f"| {' | '.join(line)} |" for line in lines)])


def steps_table(runs: Runs) -> str:
    """Table 1 beside our average steps."""
    methods = {
        "rattle, safety 0.18": {},
        "rattle, safety 0.6": {"control__safety": 0.6, "control__energy_limit": "off"},
        "dormand_prince_8, 1e-4": {
            "control__integrator": "dormand_prince_8",
            "control__tolerance": 1e-4,
        },
    }
    lines = []
    for kind, model in (("continuous", "continuous, K = 1.2e8"), ("unilateral", "unilateral")):
        for elements in MESHES:
            known = PUBLISHED.get((kind, elements))
            cells = ["-"] * 3 if known is None else [f"{h:.1e}" for h in known]
            lines.append([kind, str(elements), "chapter", *cells, ""])
            for name, settings in methods.items():
                if kind == "unilateral" and "dormand" in name:
                    continue
                result = runs.beam(model, elements, 0.0, sample=2.5e-3, **settings)
                lines.append([kind, str(elements), name, *steps(result), balance(result)])
    return table("model|elements|method|before [s]|during [s]|after [s]|balance [%]", lines)


def steps(result: Result) -> list[str]:
    status = json.loads((result.folder / "status.json").read_text("utf-8"))
    averages = status["average_step"]
    return [f"{averages[phase]:.1e}" for phase in ("before", "during", "after")]


def balance(result: Result) -> str:
    return f"{np.abs(values(result, 'glstat.model.balance')).max():.2g}"


def groups_table(runs: Runs) -> str:
    """Duration of the first groups of contacts of both ends."""
    lines = []
    for mu in FRICTIONS:
        for model in MODELS:
            for elements in (*MESHES, 40):
                result = runs.beam(model, elements, mu)
                cells = []
                for node in (1, 2):
                    durations = groups(result, node)
                    cells += [" ".join(f"{1e3 * long:.1f}" for _, long in durations)]
                    cells += [f"{1e3 * np.sum([long for _, long in durations]):.0f}"]
                lines.append([model, f"{mu:g}", str(elements), *cells])
    head = "model|mu|elements|groups of node 1 [ms]|sum|groups of node 2 [ms]|sum"
    return table(head, lines)


def equivalence_table(runs: Runs) -> str:
    """Impulse, energies and tips of the models as the mesh is refined."""
    lines = []
    for mu in FRICTIONS:
        for elements in FINER:
            impulses = [impulse(runs.beam(model, elements, mu)) for model in MODELS]
            last = runs.beam("unilateral", elements, mu)
            first = 0.5 * MASS / (2.0 * elements) * SPEED**2
            until, whole = (captured(last, time) for time in (0.7, 2.0))
            apart = f"{1e3 * tips_apart(runs, elements, mu):.0f}"
            cells = [f"{x:.2f}" for x in impulses] + [
                f"{first:.2f}",
                f"{until:.2f}",
                f"{whole:.2f}",
            ]
            lines.append([f"{mu:g}", str(elements), *cells, apart])
    head = "mu|elements|J, K = 1.2e8|J, K = 1.2e7|J, unilateral|first capture [J]"
    return table(f"{head}|captures to 0.7 s|captures to 2 s|tips apart [mm]", lines)


def jobs() -> list[tuple[str, int, float]]:
    """All meshes with all models, which most of the page is about."""
    return [(model, n, mu) for model in MODELS for n in FINER for mu in FRICTIONS]


def main() -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(folder))
        for model in ("continuous, K = 1.2e8", "unilateral"):
            runs.beam(model, 4, 0.0)  # compiled once, before two runs want it
        with ThreadPoolExecutor(cpu_count()) as pool:
            list(pool.map(lambda job: runs.beam(*job), jobs()))
        for draw in (draw_frames, draw_forces, draw_meshes):
            draw(runs, plt)
        parts = {
            "STEPS": steps_table(runs),
            "GROUPS": groups_table(runs),
            "EQUIVALENCE": equivalence_table(runs),
        }
    write_page(HERE / "beam_impact.md", parts)


if __name__ == "__main__":
    main()
