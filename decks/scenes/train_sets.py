"""The page train_sets.md with its pictures: the trains of section 5.1, run anew.

make trains      (or: python decks/scenes/train_sets.py [FOLDER], in an environment with matplotlib)

Runs whose results are in FOLDER are not repeated.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import finished, values, write_page  # noqa: E402

from crashpost.results.result import Result  # noqa: E402

sys.path.append(str(HERE / "train_sets"))

import by_hand  # noqa: E402
import sweeps  # noqa: E402

PICTURES = HERE / "train_sets"
SPEEDS = (30, 40, 55)
CARS = range(1, 17)
INTERFACES = range(1, 16)
COLOURS = {30: "#8fb8de", 40: "#3f7fbf", 55: "#12355b"}
MASS, MOVING = 680e3, 340e3  # both trains, the moving one [kg]
# a parked train that stands as Table 2 prints it: its motor car at the far end
REVERSED = {9: (51, 26), 10: (34, 26), 15: (51, 26), 16: (68, 20)}
# ends out of line, m
OFFSETS: tuple[dict[str, float], ...] = (
    {},
    {"lift_parked": 0.04},
    {"aside_parked": 0.04},
    {"lift_parked": 0.04, "aside_parked": 0.04},
)
MIDDLE_CARS = "car_7*,car_8*,car_9*,car_10*"


class Runs:
    """Runs of the deck, each once, in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __call__(self, speed: int = 55, deck: str = "", **settings: object) -> Result:
        """Result at a speed [km/h] with parameters or fields set; dots of fields written __."""
        words = [f"speed={speed} km/h", "control.estimate=off"]
        words += [f"{name.replace('__', '.')}={value}" for name, value in settings.items()]
        name = "_".join([str(speed), *(f"{k}={v}" for k, v in settings.items())]).replace(" ", "")
        folder = self.folder / f"{'space_' * bool(deck)}{name}"[:200]
        if not finished(folder):
            path = str(HERE / f"train_sets{deck}.yaml")
            command = [sys.executable, "-m", "crashsolve", path, "-o", str(folder)]
            for word in words:
                command += ["--set", word]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return Result(folder)


def interface(i: int) -> str:
    return f"{i}_{i + 1}"


def gap(result: Result, i: int) -> np.ndarray:
    """Distance g of Fig. 12 while the plates touch, else 0 [m]; right car higher is positive."""
    n = interface(i)
    touching = values(result, f"rcforc.plates_{n}.touching")
    return values(result, f"disbout.gap_{n}.vector.z") * (touching > 0.0)


def tangential(result: Result, i: int) -> np.ndarray:
    """Force on the left car along the plate of the right one, upwards positive, with ribs [N]."""
    n = interface(i)
    x, z = (
        values(result, f"rcforc.plates_{n}.force.{axis} + rcforc.ribs_{n}.force.{axis}")
        for axis in "xz"
    )
    end = f"rbdout.car_{i + 1}_left.quaternion"
    pitch = 2.0 * np.arctan2(values(result, f"{end}.y"), values(result, f"{end}.w"))
    return z * np.cos(pitch) + x * np.sin(pitch)


def extreme(series: np.ndarray) -> float:
    """The value of largest magnitude, with its sign."""
    return float(series[np.argmax(np.abs(series))])


def crush(result: Result, i: int) -> float:
    """What both ends of an interface have been pushed in together at most [m]."""
    ends = f"deforc.car_{i}_right_end.elongation", f"deforc.car_{i + 1}_left_end.elongation"
    return float(-values(result, " + ".join(ends)).min())


def absorbed(result: Result, i: int) -> float:
    """Work on both ends, and what plates and ribs have lost, to the end of the run [J]."""
    n, total = interface(i), 0.0
    for end in (f"car_{i}_right_end", f"car_{i + 1}_left_end"):
        force, displacement = (
            values(result, f"deforc.{end}.{what}") for what in ("force", "elongation")
        )
        total += float(np.trapezoid(force, displacement))
    for what in ("plates", "ribs"):
        for lost in ("dissipated", "friction_dissipated"):
            total += values(result, f"rcforc.{what}_{n}.{lost}")[-1]
    return total


def rails(result: Result, what: str) -> np.ndarray:
    """Sum over all cars."""
    return values(result, " + ".join(f"rcforc.car_{i}_rails.{what}" for i in CARS))


def draw_bars(runs: Runs, plt: ModuleType) -> None:
    """Figs 13 and 14."""
    names = [f"{i}-{i + 1}" for i in INTERFACES]
    for file, measure, scale, limit, label, title in (
        ("gaps", gap, 1e3, 130, "vertical gap g [mm]", "Fig. 13: largest vertical gap"),
        ("forces", tangential, 1e-3, 200, "tangential force [kN]", "Fig. 14: tangential force"),
    ):
        figure, axes = plt.subplots(figsize=(11, 4.2), layout="constrained")
        for k, speed in enumerate(SPEEDS):
            bars = [scale * extreme(measure(runs(speed), i)) for i in INTERFACES]
            positions = np.arange(15) + 0.27 * (k - 1)
            axes.bar(positions, bars, 0.25, color=COLOURS[speed], label=f"{speed} km/h")
        axes.axvline(6.5, color="0.8", lw=1)
        axes.axvline(7.5, color="0.8", lw=1)
        axes.axhline(0, color="0.3", lw=0.8)
        axes.set_xticks(range(15), names, rotation=45)
        axes.set(xlabel="interface (8-9: between the trains)", ylabel=label)
        axes.set_title(f"{title}; the chapter's stay within {limit} {label[-3:-1]}")
        axes.legend(frameon=False)
        axes.spines[["top", "right"]].set_visible(False)
        figure.savefig(PICTURES / f"{file}.png", dpi=110)
        plt.close(figure)


def draw_crush(runs: Runs, plt: ModuleType) -> None:
    """Crush and energy per interface."""
    figure, both = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained")
    for k, speed in enumerate(SPEEDS):
        result, positions = runs(speed), np.arange(15) + 0.27 * (k - 1)
        look = {"width": 0.25, "color": COLOURS[speed], "label": f"{speed} km/h"}
        both[0].bar(positions, [crush(result, i) for i in INTERFACES], **look)
        both[1].bar(positions, [1e-6 * absorbed(result, i) for i in INTERFACES], **look)
    for axes, label in zip(both, ("crush of both ends [m]", "energy absorbed [MJ]"), strict=True):
        axes.set_xticks(range(15), [f"{i}-{i + 1}" for i in INTERFACES], rotation=60)
        axes.set(xlabel="interface", ylabel=label)
        axes.spines[["top", "right"]].set_visible(False)
    both[0].legend(frameon=False)
    figure.savefig(PICTURES / "crush.png", dpi=110)
    plt.close(figure)


def draw_motion(runs: Runs, plt: ModuleType) -> None:
    """Time and position of all cars, and their speeds, at 55 km/h."""
    result = runs(55)
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    colour_scale = plt.get_cmap("viridis")(np.linspace(0.0, 0.92, 16))
    for i, shade in zip(CARS, colour_scale, strict=True):
        left.plot(values(result, f"rbdout.car_{i}.position.x"), result.time, color=shade)
        speed = 3.6 * values(result, f"rbdout.car_{i}.velocity.x")
        right.plot(result.time, speed, color=shade, lw=1, label=f"car {i}")
    left.set(xlabel="middle of the car [m]", ylabel="time [s]")
    common = 3.6 * values(result, "glstat.model.momentum.x") / MASS
    right.plot(result.time, common, "k--", lw=1.5, label="mass centre")
    right.set(xlabel="time [s]", ylabel="speed [km/h]", ylim=(-5, 60))
    right.legend(frameon=False, fontsize=7, ncols=2)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(PICTURES / "motion.png", dpi=110)
    plt.close(figure)


def table(head: str, lines: list[list[str]]) -> str:
    titles = head.split("|")
    rule = "|".join("---" for _ in titles)
    return "\n".join([f"|{head}|", f"|{rule}|", *(f"| {' | '.join(line)} |" for line in lines)])


def largest(result: Result, measure: Callable[[Result, int], np.ndarray]) -> tuple[float, str]:
    """The largest magnitude over all interfaces, and where it is."""
    values = {i: abs(extreme(measure(result, i))) for i in INTERFACES}
    i = max(values, key=lambda k: values[k])
    return values[i], f"{i}-{i + 1}"


def energy_table(runs: Runs) -> str:
    """What is spent, against a plastic impact less the work of the brakes."""
    lines = []
    for speed in SPEEDS:
        result = runs(speed)
        momentum = values(result, "glstat.model.momentum.x")
        spread = values(result, "glstat.model.energy.kinetic") - momentum**2 / (2.0 * MASS)
        k = int(np.argmin(spread))
        kinds = ("contact", "spring", "friction", "brake")
        lost = " + ".join(f"glstat.model.energy.{kind}_dissipated" for kind in kinds)
        spent = values(result, lost)[k]
        braked = rails(result, "friction_dissipated")[k]
        plastic = MOVING * (speed / 3.6) ** 2 / 4.0
        start = MOVING * (speed / 3.6) ** 2 / 2.0
        due = start - momentum[k] ** 2 / (2.0 * MASS) - braked
        pushed = momentum - rails(result, "impulse.x")
        error = np.abs(pushed / (MOVING * speed / 3.6) - 1.0).max()
        cells = (plastic, braked, due, spent - braked)
        lines.append(
            [str(speed), f"{result.time[k]:.2f}", f"{3.6 * momentum[k] / MASS:.2f}"]
            + [f"{1e-6 * x:.3f}" for x in cells]
            + [f"{100 * ((spent - braked) / due - 1):+.1f} %", f"{error:.0e}"]
        )
    head = "speed [km/h]|all at one speed at [s]|that speed [km/h]|1/4 M v^2 [MJ]|brakes [MJ]"
    return table(f"{head}|due from the rest [MJ]|found [MJ]|difference|error of momentum", lines)


def kinematics_table(runs: Runs) -> str:
    lines = []
    for speed in SPEEDS:
        result = runs(speed)
        (g, at), (f, where) = largest(result, gap), largest(result, tangential)
        lifted = [i for i in CARS if values(result, f"rcforc.car_{i}_rails.touching").min() < 4]
        ribs = [i for i in INTERFACES if values(result, f"rcforc.ribs_{interface(i)}.onsets")[-1]]
        pulled = [
            i
            for i in INTERFACES
            if i != 8 and values(result, f"deforc.coupler_{interface(i)}.force").max() > 1.0
        ]
        cells = [", ".join(map(str, some)) or "none" for some in (lifted, ribs, pulled)]
        lines.append([str(speed), f"{1e3 * g:.0f}", at, f"{1e-3 * f:.0f}", where, *cells])
    head = "speed [km/h]|largest gap [mm]|at|largest tangential force [kN]|at"
    return table(f"{head}|cars with a wheel off the rail|ribs that locked|couplers pulled", lines)


def cells(run: sweeps.Extreme) -> str:
    """Largest gap in mm and largest force in kN of a run, with their positions."""
    if np.isnan(run.gap):
        return "no answer"
    gap_at, force_at = run.gap_at.replace("_", "-"), run.force_at.replace("_", "-")
    return f"{1e3 * run.gap:.0f} ({gap_at}), {1e-3 * run.force:.0f} ({force_at})"


def assumption_table(folder: Path) -> str:
    """What each assumption is worth, at 55 km/h: the larger its effect, the higher it stands."""
    stands, every = sweeps.one_at_a_time(folder)
    spread = {
        one.name: np.nanmax(np.abs([low.gap - stands.gap, high.gap - stands.gap]))
        for one, low, high in every
    }
    every.sort(key=lambda row: -spread[row[0].name])
    lines = [["as the deck stands", "", "", cells(stands), cells(stands)]]
    for one, low, high in every:
        value = sweeps.deck_value(one.name).strip("${}")
        lines.append(
            [one.name, f"{value}, {one.kind}", f"{one.low} to {one.high}", cells(low), cells(high)]
        )
    return table("assumption|deck|range|at its low end|at its high end", lines)


def space_table(runs: Runs) -> str:
    """The train sets in space, with ends in line and out of line."""
    lines = []
    for offset in OFFSETS:
        result = runs(55, "_3d", **offset)
        (g, at), (f, where) = largest(result, gap), largest(result, tangential)
        aside = max(
            np.abs(values(result, f"disbout.gap_{interface(i)}.vector.y")).max() for i in INTERFACES
        )
        guided = max(
            values(result, f"rcforc.car_{i}_guidance_{side}.normal").max()
            for i in CARS
            for side in ("left", "right")
        )
        name = ", ".join(f"{k.split('_')[0]} {1e3 * v:.0f} mm" for k, v in offset.items())
        line = [name or "in line", f"{1e3 * g:.1f} ({at})", f"{1e3 * gap_at(result, 8):.1f}"]
        line += [f"{1e-3 * f:.1f} ({where})", f"{1e3 * aside:.1f}", f"{1e-3 * guided:.0f}"]
        lines.append(line)
    head = "ends of the parked train|largest gap [mm]|gap at 8-9 [mm]|largest tangential force [kN]"
    return table(f"{head}|largest offset along y [mm]|flange on rail [kN]", lines)


def gap_at(result: Result, i: int) -> float:
    return extreme(gap(result, i))


def plane_and_space(runs: Runs) -> str:
    """How far both models differ in a straight collision, over the largest of all interfaces."""
    flat, space = runs(55), runs(55, "_3d")
    parts = []
    for name, measure in (("gap", gap), ("tangential force", tangential)):
        size = largest(flat, measure)[0]
        apart = max(abs(extreme(measure(flat, i)) - extreme(measure(space, i))) for i in INTERFACES)
        parts.append(f"{name} {100 * apart / size:.2f} %")
    return ", ".join(parts)


def draw_assumptions(folder: Path, plt: ModuleType) -> None:
    """Largest gap and force of every run of the sweeps, beside what the chapter has."""
    stands, every = sweeps.one_at_a_time(folder / "one")
    draws = sweeps.all_at_once(folder / "all")
    figure, axes = plt.subplots(figsize=(7.5, 4.6), layout="constrained")
    single = [run for _, low, high in every for run in (low, high)]
    for some, look, label in (
        (draws, {"color": "0.6", "marker": "o"}, f"all drawn over their ranges, {len(draws)} runs"),
        (single, {"color": "#3f7fbf", "marker": "."}, "one number changed"),
        ([stands], {"color": "#d55e00", "marker": "*", "s": 160}, "the deck"),
    ):
        x, y = [1e3 * run.gap for run in some], [1e-3 * run.force for run in some]
        axes.scatter(x, y, label=label, **look)
    axes.axvline(130, color="0.3", ls="--", lw=0.8)
    axes.axhline(200, color="0.3", ls="--", lw=0.8)
    axes.annotate("Figs 13, 14 stay within the dashed lines", (128, 4), ha="right", fontsize=8)
    axes.set(xlabel="largest gap [mm]", ylabel="largest tangential force [kN]", ylim=(0, None))
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=3)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(PICTURES / "assumed.png", dpi=110)
    plt.close(figure)


def draw_film(result: Result) -> None:
    """Strip and film of the cars that meet."""
    for word, cells in (
        ("render", ("--at", "0,0.1,0.3,0.6,1.5", "-o", "strip.png")),
        ("film", ("--slow", "4", "--fps", "12", "--size", "960x270", "-o", "film.gif")),
    ):
        *options, file = cells
        command = [sys.executable, "-m", "crashpost", word, str(result.folder), "--view", "side"]
        command += ["--show", MIDDLE_CARS, "--title", "Cars 7 to 10 at 55 km/h", *options]
        subprocess.run([*command, str(PICTURES / file)], check=True, stdout=subprocess.DEVNULL)


def cost_table(runs: Runs) -> str:
    """Steps and their errors at 55 km/h to 1 s, against the finest."""
    until: dict[str, Any] = {"control__end_time": 1.0}
    best = runs(55, **until, control__safety=0.005)
    lines = []
    for safety in (0.8, 0.5, 0.3, 0.1):
        result = runs(55, **until, control__safety=safety)
        errors = []
        for measure in (gap, tangential):
            fine = [measure(best, i) for i in INTERFACES]
            size = max(np.abs(x).max() for x in fine)
            apart = [
                abs(extreme(measure(result, i))) - np.abs(fine[i - 1]).max() for i in INTERFACES
            ]
            errors.append(np.abs(apart).max() / size)
        status = json.loads((result.folder / "status.json").read_text("utf-8"))
        steps = int(status["cycle"])
        cost = f"{status['cpu_steps']:.2f}"
        cells = [f"{x:.1e}" for x in errors]
        lines.append([f"{safety:g}", str(steps), cost, *cells])
    return table(
        "safety|steps|CPU of the steps [s]|error of largest gaps|of largest tangential forces",
        lines,
    )


def main() -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        work = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(folder)
        runs = Runs(work)
        for draw in (draw_bars, draw_crush, draw_motion):
            draw(runs, plt)
        draw_assumptions(work, plt)
        draw_film(runs(55))
        reverse: dict[str, Any] = {}
        for car, (mass, length) in REVERSED.items():
            reverse |= {f"mass_{car}": f"{mass} t", f"length_{car}": length}
        other = runs(55, **reverse)
        rotated = f"{1e3 * largest(other, gap)[0]:.0f} mm"
        rotated += f" and {1e-3 * largest(other, tangential)[0]:.0f} kN"
        parts = {
            "ENERGY": energy_table(runs),
            "KINEMATICS": kinematics_table(runs),
            "HAND": by_hand.table(),
            "COST": cost_table(runs),
            "ASSUMED": assumption_table(work / "one"),
            "DRAWN": sweeps.summary(sweeps.all_at_once(work / "all")),
            "ROTATED": rotated,
            "AGREE": plane_and_space(runs),
            "SPACE": space_table(runs),
        }
    write_page(HERE / "train_sets.md", parts)


if __name__ == "__main__":
    main()
