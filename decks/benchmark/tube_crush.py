"""The page tube_crush.md with its pictures: the crushed tube, run anew with both quadrilaterals.

make crush       (or: python decks/benchmark/tube_crush.py, in an environment with matplotlib)
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import values, write_page  # noqa: E402

from crashpost.results.result import Result  # noqa: E402

DECK = HERE / "tube_crush.yaml"
PICTURES = HERE / "tube_crush"
MEASURED = ROOT.parent / "shared" / "data" / "tube_crush"
# what is set for each run
COARSE: dict[str, int | str] = {"across": 12, "along": 72}
MESHES: dict[str, dict[str, int | str]] = {
    "reduced, 5 mm": COARSE,
    "fully integrated, 5 mm": COARSE | {"parts.tube.element": "fully_integrated"},
    "reduced, 3 mm": {},
    "fully integrated, 3 mm": {"parts.tube.element": "fully_integrated"},
}
# steps of the reduced element on 5 mm
STEPS: dict[str, dict[str, object]] = {
    "0.9 of the bound": {"control.safety": 0.9},
    "0.99 of the bound": {},
    "0.55 us": {"control.step": 5.5e-7},
    "0.62 us": {"control.step": 6.2e-7},
    "0.7 us": {"control.step": 7e-7},
}
FRAMES = (0, 2, 4, 8, 12, 20)  # ms
WINDOW = 1e-4  # of the mean force [s]
SAMPLE, LENGTH, KINETIC = 2e-5, 360.0, 3050.9  # s, mm, J
POSITIONS = (3, 4, 5, 6, 7, 8, 9, 10, 12, 13)  # shortening [mm]
STOPPED = 4  # exit code of a numerical stop
SHOWN = 160.0  # height of the pictures [mm]
# OpenRadioss bd4557b: peak [kN], shortening [mm], mean, mean over 20-80 mm [kN], final length [mm],
# rebound [m/s], hourglass [%]
PUBLISHED = {
    "OpenRadioss, Belytschko-Tsay, 5 mm": ("89.7", "92.2", "33.2", "32.2", "270.3", "0.68", "7.1"),
    "OpenRadioss, QEPH, 5 mm": ("89.8", "88.7", "34.5", "33.6", "273.9", "0.63", "0"),
    "OpenRadioss, fully integrated, 5 mm": ("89.6", "92.5", "33.1", "32.5", "269.0", "0.56", "0"),
    "OpenRadioss, QEPH, 4 mm": ("88.7", "97.2", "31.5", "", "", "", "0"),
    "OpenRadioss, QEPH, 3 mm": ("87.9", "99.9", "30.6", "", "", "", "0"),
}


def run(
    folder: Path, name: str, settings: Mapping[str, object], codes: tuple[int, ...] = (0,)
) -> Path:
    """Folder of a result of the deck, taken from `folder` if it is there; how it may end."""
    out = folder / name.replace(",", "").replace(" ", "_")
    if not (out / "status.json").exists():
        words = [w for name, n in settings.items() for w in ("--set", f"{name}={n}")]
        # an estimate of errors would take two runs
        words += ["--set", "control.estimate=off"]
        command = [sys.executable, "-m", "crashsolve", str(DECK), "-o", str(out), *words]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in codes:
            raise RuntimeError(f"{name}: {done.stdout[-500:]}{done.stderr}")
    return out


def status(out: Path) -> dict[str, Any]:
    content: dict[str, object] = json.loads((out / "status.json").read_text("utf-8"))
    return content


def cost(out: Path) -> float:
    """CPU time of steps and output [s]."""
    return sum(status(out)["cpu_stages"][stage] for stage in ("steps", "output"))


def force(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Shortening [mm] and mean force [kN] over WINDOW about each sample."""
    t, J = result.time, values(result, "rcforc.wall.impulse.z")
    z = values(result, "rbdout.ring.position.z")
    ahead, behind = (np.interp(t + s * WINDOW / 2, t, J) for s in (1, -1))
    return 1e3 * (z[0] - z), 1e-3 * np.abs(ahead - behind) / WINDOW


def peak(result: Result) -> float:
    """Largest mean of five samples 0.02 ms apart, the first at the start [kN]."""
    t, J = result.time, np.abs(values(result, "rcforc.wall.impulse.z"))
    at = np.arange(0.0, 1e-3, SAMPLE)
    low, high = np.maximum(at - SAMPLE / 2, 0.0), at + SAMPLE / 2
    samples = (np.interp(high, t, J) - np.interp(low, t, J)) / (high - low)
    return float(1e-3 * max(samples[k : k + 5].mean() for k in range(len(at) - 4)))


def figures(result: Result) -> tuple[str, ...]:
    """What PUBLISHED states, of a run."""
    stroke, mean = force(result)
    stop = int(stroke.argmax())
    kinetic = values(result, "glstat.model.energy.kinetic")
    between = (stroke[:stop] > 20.0) & (stroke[:stop] < 80.0)
    part = np.trapezoid(mean[:stop][between], stroke[:stop][between]) / np.ptp(
        stroke[:stop][between]
    )
    hourglass = 100.0 * values(result, "matsum.tube.hourglass").max() / KINETIC
    return (
        f"{peak(result):.1f}",
        f"{stroke[stop]:.1f}",
        f"{(kinetic[0] - kinetic[stop]) / stroke[stop]:.1f}",
        f"{part:.1f}",
        f"{LENGTH - stroke[-1]:.1f}",
        f"{values(result, 'rbdout.ring.velocity.z')[-1]:.2f}",
        f"{hourglass:.1f}",
    )


def table(head: str, lines: list[list[str]]) -> str:
    titles = head.split("|")
    rule = "|".join("---" for _ in titles)
    return "\n".join([f"|{head}|", f"|{rule}|", *(f"| {' | '.join(line)} |" for line in lines)])


def compared(runs: dict[str, Result]) -> str:
    """Our figures beside those of OpenRadioss."""
    lines = [[name, *cells] for name, cells in PUBLISHED.items()]
    lines += [[f"crashsolve, {mesh}", *figures(result)] for mesh, result in runs.items()]
    head = "code, element, mesh|peak [kN]|shortening [mm]|mean force [kN]|mean over 20-80 mm [kN]"
    return table(f"{head}|final length [mm]|rebound [m/s]|hourglass [%]", lines)


def fold(runs: dict[str, Result]) -> str:
    """Lines of the first fold: force at POSITIONS."""
    lines = []
    for mesh, result in runs.items():
        stroke, mean = force(result)
        stop = int(stroke.argmax())
        forces = np.interp(POSITIONS, stroke[:stop], mean[:stop])
        lines.append(
            f"| {mesh.removesuffix(', 5 mm')} | {' | '.join(f'{F:.1f}' for F in forces)} |"
        )
    return "\n".join(lines)


def checked(runs: dict[str, Result]) -> str:
    """Energies, depth of touches, and cost of our runs."""
    lines = []
    for mesh, result in runs.items():
        cpu = cost(result.folder)
        cycles = values(result, "glstat.model.cycle")[-1]
        with h5py.File(result.folder / "mesh.h5") as file:
            count = len(file["part_tube/cells"])
        cells = [f"{np.abs(values(result, 'glstat.model.balance')).max():.3f}"]
        for channel in ("strain", "hourglass", "drilling", "plastic"):
            cells.append(f"{100 * values(result, f'matsum.tube.{channel}').max() / KINETIC:.1f}")
        cells.append(f"{1e6 * values(result, 'rcforc.folds.peak_depth').max():.0f}")
        cells += [f"{cycles:.0f}", f"{cpu:.0f}", f"{1e-6 * cycles * count / cpu:.2f}"]
        lines.append([mesh, *cells])
    head = (
        "element, mesh|balance [%]|elastic|hourglass|drilling|plastic [%]|deepest touch [um]|cycles"
    )
    return table(f"{head}|CPU [s]|million element-cycles/s", lines)


def stepped(folder: Path) -> str:
    """What longer steps cost and change."""
    lines = []
    for name, settings in STEPS.items():
        name_of_run = name if settings else "reduced, 5 mm"
        out = run(folder, name_of_run, COARSE | settings, (0, STOPPED))
        state, result = status(out), Result(out)
        line = [name, f"{1e6 * state['time'] / state['cycle']:.3f}", f"{state['cycle']}"]
        if state["state"] == "finished":
            _, _, mean, *_ = figures(result)
            stroke = LENGTH - 1e3 * values(result, "rbdout.ring.position.z").min()
            balance = np.abs(values(result, "glstat.model.balance")).max()
            line += [f"{stroke:.3f}", mean, f"{balance:.4f}", f"{cost(out):.0f}"]
        else:
            line += [f"stopped at {1e3 * state['time']:.1f} ms", "", "", ""]
        lines.append(line)
    head = "step|on average [us]|cycles|shortening [mm]|mean force [kN]|balance [%]|CPU [s]"
    return table(head, lines)


# --- pictures -----------------------------------------------------------------------------------


def draw_curves(runs: dict[str, Result], plt: ModuleType, name: str, until: float) -> None:
    """Force over shortening [mm], beside what has been measured where it is at hand."""
    figure, ax = plt.subplots(figsize=(9.0, 4.5))
    for element, style in (("belytschko_tsay", "0.5"), ("qeph", "0.75")):
        path = MEASURED / f"{element}_5mm.csv"
        if path.exists():
            curve = np.loadtxt(path, delimiter=",", skiprows=1)
            label = f"OpenRadioss, {element.replace('_', ' ')}, 5 mm"
            ax.plot(curve[:, 2], curve[:, 1], color=style, lw=1.6, label=label)
    for mesh, result in runs.items():
        ax.plot(*force(result), lw=1.0, label=f"crashsolve, {mesh}")
    ax.set_xlabel("shortening [mm]")
    ax.set_ylabel("force of the wall, mean over 0.1 ms [kN]")
    ax.set_xlim(0.0, until)
    ax.set_ylim(0.0, 100.0)
    ax.legend(fontsize=8)
    save(figure, name)


def draw_film(result: Result, plt: ModuleType) -> None:
    """The tube at FRAMES, coloured by plastic strain in its middle surface."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure = plt.figure(figsize=(1.8 * len(FRAMES), 3.6))
    with h5py.File(result.folder / "mesh.h5") as file:
        points, quads = file["part_tube/points"][:], file["part_tube/cells"][:]
    states = sorted((result.folder / "states").glob("*.h5"))
    for k, moment in enumerate(FRAMES):
        with h5py.File(states[moment]) as file:
            x = 1e3 * (points + file["part_tube/displacement"][:])
            strain = file["part_tube/plastic_strain_mid"][:].ravel()
        ax = figure.add_subplot(1, len(FRAMES), k + 1, projection="3d")
        shown = x[quads].mean(axis=1)[:, 2] < SHOWN
        faces = Poly3DCollection(x[quads[shown]], edgecolor="k", lw=0.15)
        faces.set_facecolor(plt.cm.viridis(np.clip(strain[shown] / 0.6, 0.0, 1.0)))
        ax.add_collection3d(faces)
        ax.set(xlim=(-45, 45), ylim=(-45, 45), zlim=(0, SHOWN), title=f"{moment} ms")
        ax.set_box_aspect((90, 90, SHOWN), zoom=1.12)
        ax.view_init(18, -50)
        ax.set_axis_off()
    save(figure, "film")


def save(figure: Figure, name: str) -> None:
    PICTURES.mkdir(exist_ok=True)
    figure.tight_layout()
    figure.savefig(PICTURES / f"{name}.png", dpi=110, bbox_inches="tight")


def main() -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(temporary)
        steps = stepped(folder)
        runs = {mesh: Result(run(folder, mesh, settings)) for mesh, settings in MESHES.items()}
        draw_curves(runs, plt, "force", 105.0)
        coarse = {mesh: result for mesh, result in runs.items() if "across" in MESHES[mesh]}
        draw_curves(coarse, plt, "first_fold", 25.0)
        draw_film(runs["reduced, 5 mm"], plt)
        parts = {"COMPARED": compared(runs), "CHECKED": checked(runs), "FOLD": fold(coarse)}
        parts["STEPS"] = steps
    write_page(HERE / "tube_crush.md", parts)


if __name__ == "__main__":
    main()
