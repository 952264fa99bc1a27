"""The page certification.md with its pictures: tests of the Hybrid III 50th in their corridors.

make certification  (or: python decks/occupants/certification.py [FOLDER], with matplotlib)

Runs whose results are in FOLDER are not repeated.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import finished, in_folder, values, write_page  # noqa: E402

from crashpost.results.result import Result  # noqa: E402

PAGE = HERE / "certification.md"
G = 9.81
# moments on the head about the condyles, of the joint's ranges and friction
NECK = ("condyles_cone", "condyles_twist", "condyles_rest")
LINE, ALLOWED = "#00798c", "#edae49"


class Measure(NamedTuple):
    """A number of a test, its requirement and source."""

    test: str
    what: str
    computed: float
    low: float
    high: float
    unit: str
    source: str

    def row(self) -> str:
        """A row of the table of the page."""
        verdict = "within" if self.low <= self.computed <= self.high else "**outside**"
        requested = (
            f"{self.low:.4g} to {self.high:.4g}" if self.low > -np.inf else f"<= {self.high:.4g}"
        )
        cells = (
            self.test,
            self.what,
            f"{self.computed:.4g} {self.unit}",
            requested,
            verdict,
            self.source,
        )
        return f"| {' | '.join(cells)} |"


def solved(name: str, folder: Path) -> Result:
    """Result of a deck in tests, which is run if it has not been yet."""
    out = folder / name
    if not finished(out):
        deck = HERE / "tests" / f"{name}.yaml"
        words = [str(deck), "-o", str(out), "--set", "control.estimate=off"]
        command = [sys.executable, "-m", "crashsolve", *words]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return Result(out)


def framed(title: str, x: str, y: str) -> Any:
    """Axes of one picture."""
    figure, axes = plt.subplots(figsize=(5.2, 3.4), layout="constrained")
    axes.set(title=title, xlabel=x, ylabel=y)
    axes.grid(alpha=0.3)
    return figure, axes


def save(figure: Figure, name: str) -> None:
    figure.savefig(PAGE.with_suffix("") / f"{name}.png", dpi=110)
    plt.close(figure)


def head(folder: Path) -> list[Measure]:
    result = solved("head_drop", folder)
    acceleration = result.series("cfc(nodout.head.resultant, 1000)")
    figure, axes = framed("Head drop, 376 mm", "time [ms]", "acceleration [g], CFC 1000")
    axes.axhspan(225, 275, color=ALLOWED, alpha=0.4, label="peak: 225 to 275 g")
    axes.plot(1e3 * acceleration.time, acceleration.values / G, color=LINE)
    axes.legend()
    save(figure, "head_drop")
    peak = float(acceleration.values.max()) / G
    after = acceleration.values[np.argmax(acceleration.values) :] / G
    # what comes once the pulse has fallen to a hundredth
    over = np.flatnonzero(after < 0.01 * peak)
    later = float(after[over[0] :].max()) / peak if len(over) else np.inf
    source = "572.32, read"
    return [
        Measure("head drop", "peak acceleration", peak, 225, 275, "g", source),
        Measure("", "later oscillation", 100 * later, -np.inf, 10, "% of it", source),
    ]


def thorax(folder: Path) -> list[Measure]:
    result = solved("thorax_pendulum", folder)
    force = 23.36 * values(result, "rbdout.probe.acceleration.x")
    depth = -values(result, "disbout.man_chest_deflection.change")
    figure, axes = framed("Thorax, 6.71 m/s", "deflection of the sternum [mm]", "force [kN]")
    axes.axhspan(5.16, 5.894, color=ALLOWED, alpha=0.4, label="peak: 5.16 to 5.89 kN")
    axes.axvspan(63.5, 72.6, color="#66a182", alpha=0.4, label="peak: 63.5 to 72.6 mm")
    axes.plot(1e3 * depth, force / 1e3, color=LINE)
    axes.legend(loc="lower right")
    save(figure, "thorax")
    steps = np.diff(depth)
    work = 0.5 * (force[1:] + force[:-1]) * steps
    hysteresis = 100 * work.sum() / work[steps > 0].sum()
    source = "572.34, read"
    return [
        Measure("thorax", "peak force", force.max() / 1e3, 5.160, 5.894, "kN", source),
        Measure("", "deflection", 1e3 * depth.max(), 63.5, 72.6, "mm", source),
        Measure("", "internal hysteresis", hysteresis, 69, 85, "%", source),
    ]


def hip(folder: Path) -> list[Measure]:
    angles = solved("hip_flexion", folder).series("disbout.flexion.angle")
    angle, moment = np.degrees(angles.values), 25.0 * angles.time
    figure, axes = framed("Hip flexion", "flexion from the seated posture [deg]", "moment [N m]")
    axes.plot([30, 30], [0, 95], color=ALLOWED, lw=5, label="at most 95 N m at 30 deg")
    axes.plot([40, 50], [203, 203], color="#d1495b", lw=5, label="203 N m at 40 to 50 deg")
    axes.plot(angle, moment, color=LINE)
    axes.legend(loc="upper left")
    save(figure, "hip")
    at_30 = float(np.interp(30, np.maximum.accumulate(angle), moment))
    at_203 = float(np.interp(203, moment, angle))
    source = "572.35(c), from memory, unverified"
    return [
        Measure("hip flexion", "moment at 30 deg", at_30, -np.inf, 95, "N m", source),
        Measure("", "angle at 203 N m", at_203, 40, 50, "deg", source),
    ]


def knee(folder: Path) -> list[Measure]:
    force = solved("knee_impact", folder).series("secforc.man_femur_load_left.force.z")
    figure, axes = framed("Knee impact, 5 kg at 2.1 m/s", "time [ms]", "force of the femur [kN]")
    axes.axhspan(4.7, 5.8, color=ALLOWED, alpha=0.4, label="peak: 4.7 to 5.8 kN")
    axes.plot(1e3 * force.time, -force.values / 1e3, color=LINE)
    axes.set_xlim(0, 5)
    axes.legend()
    save(figure, "knee")
    peak = -float(force.values.min()) / 1e3
    source = "572.35(b), from memory, unverified"
    return [Measure("knee impact", "peak force of the femur", peak, 4.7, 5.8, "kN", source)]


def neck(folder: Path) -> list[Measure]:
    result = solved("neck_pendulum", folder)
    angle = np.degrees(values(result, "disbout.rotation.angle"))
    time = result.series("disbout.rotation.angle").time
    moment = -values(result, "secforc.man_neck_load.moment.y")
    for part in NECK:
        moment = moment - values(result, f"deforc.man_{part}.moment.y")
    figure, axes = framed("Neck flexion, 7.01 m/s", "rotation of the head [deg]", "moment [N m]")
    axes.fill_between([64, 78], 88, 108, color=ALLOWED, alpha=0.5, label="peaks")
    axes.plot(angle, moment, color=LINE)
    axes.legend(loc="upper left")
    save(figure, "neck")
    source = "572.33, from memory, unverified"
    return [
        Measure("neck flexion", "rotation", angle.max(), 64, 78, "deg", source),
        Measure("", "when", 1e3 * time[angle.argmax()], 57, 64, "ms", source),
        Measure("", "moment about the condyles", moment.max(), 88, 108, "N m", source),
        Measure("", "when", 1e3 * time[moment.argmax()], 47, 58, "ms", source),
        Measure("", "moment back at 0", 1e3 * _end(time, moment), 97, 107, "ms", source),
        Measure("", "rotation back at 0", 1e3 * _end(time, angle), 113, 128, "ms", source),
    ]


def _end(time: np.ndarray, values: np.ndarray) -> float:
    """When values first fall to 0 after their peak [s]."""
    top = int(values.argmax())
    return float(time[top + int(np.argmax(values[top:] <= 0.0))])


def main(folder: Path) -> None:
    """Run what is not there, draw the pictures and write the page."""
    measures = [m for test in (head, thorax, hip, knee, neck) for m in test(folder)]
    rows = ["| test | measure | found | required | | corridor |", "|---|---|---|---|---|---|"]
    write_page(PAGE, {"table": "\n".join(rows + [m.row() for m in measures])})


if __name__ == "__main__":
    in_folder(main)
