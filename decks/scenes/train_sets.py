"""The page train_sets.md with its pictures: the trains of section 5.1, run anew.

make trains      (or: python decks/scenes/train_sets.py [FOLDER], in an environment with matplotlib)

Runs whose results are in FOLDER are not repeated.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc")]

from crashpost.result import Result  # noqa: E402

PICTURES = HERE / "train_sets"
SPEEDS = (30, 40, 55)
CARS = range(1, 17)
INTERFACES = range(1, 16)
COLOURS = {30: "#8fb8de", 40: "#3f7fbf", 55: "#12355b"}
MASS, MOVING = 680e3, 340e3  # both trains, the moving one [kg]
# (parameter, unit, low, high) of shared/rail_numbers.yaml and train_sets.yaml: their ranges there
ASSUMED = (
    ("k_grip", "N/m", 3e6, 2e7),
    ("mu_plate", "1", 0.05, 0.5),
    ("body_height", "m", 1.4, 1.9),
    ("buffer_height", "m", 0.98, 1.065),
    ("k_secondary", "N/m", 0.7e6, 1.5e6),
    ("k_primary", "N/m", 1.5e6, 3.5e6),
)
# a parked train that stands as Table 2 prints it: its motor car at the far end
REVERSED = {9: (51, 26), 10: (34, 26), 15: (51, 26), 16: (68, 20)}


class Runs:
    """Runs of the deck, each once, in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __call__(self, speed: int = 55, **settings: Any) -> Result:
        """Result at a speed [km/h] with parameters or fields set; dots of fields written __."""
        words = [f"speed={speed} km/h", "control.estimate=off"]
        words += [f"{name.replace('__', '.')}={value}" for name, value in settings.items()]
        name = "_".join([str(speed), *(f"{k}={v}" for k, v in settings.items())]).replace(" ", "")
        folder = self.folder / name[:200]
        if not finished(folder):
            deck = str(HERE / "train_sets.yaml")
            command = [sys.executable, "-m", "crashsolve", deck, "-o", str(folder)]
            for word in words:
                command += ["--set", word]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return Result(folder)


def finished(folder: Path) -> bool:
    """Whether a run has come to its normal end there."""
    log = folder / "log.txt"
    return log.exists() and "N o r m a l" in log.read_text("utf-8")


def values(result: Result, channel: str) -> np.ndarray:
    found: np.ndarray = result.series(channel).values
    return found


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
        force, way = (values(result, f"deforc.{end}.{what}") for what in ("force", "elongation"))
        total += float(np.trapezoid(force, way))
    for what in ("plates", "ribs"):
        for lost in ("dissipated", "friction_dissipated"):
            total += values(result, f"rcforc.{what}_{n}.{lost}")[-1]
    return total


def rails(result: Result, what: str) -> np.ndarray:
    """Sum over all cars."""
    return values(result, " + ".join(f"rcforc.car_{i}_rails.{what}" for i in CARS))


def draw_bars(runs: Runs, plt: Any) -> None:
    """Figs 13 and 14."""
    names = [f"{i}-{i + 1}" for i in INTERFACES]
    for file, measure, scale, limit, label, title in (
        ("gaps", gap, 1e3, 130, "vertical gap g [mm]", "Fig. 13: largest vertical gap"),
        ("forces", tangential, 1e-3, 200, "tangential force [kN]", "Fig. 14: tangential force"),
    ):
        figure, axes = plt.subplots(figsize=(11, 4.2), layout="constrained")
        for k, speed in enumerate(SPEEDS):
            bars = [scale * extreme(measure(runs(speed), i)) for i in INTERFACES]
            places = np.arange(15) + 0.27 * (k - 1)
            axes.bar(places, bars, 0.25, color=COLOURS[speed], label=f"{speed} km/h")
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


def draw_crush(runs: Runs, plt: Any) -> None:
    """Crush and energy per interface."""
    figure, both = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained")
    for k, speed in enumerate(SPEEDS):
        result, places = runs(speed), np.arange(15) + 0.27 * (k - 1)
        look = {"width": 0.25, "color": COLOURS[speed], "label": f"{speed} km/h"}
        both[0].bar(places, [crush(result, i) for i in INTERFACES], **look)
        both[1].bar(places, [1e-6 * absorbed(result, i) for i in INTERFACES], **look)
    for axes, label in zip(both, ("crush of both ends [m]", "energy absorbed [MJ]"), strict=True):
        axes.set_xticks(range(15), [f"{i}-{i + 1}" for i in INTERFACES], rotation=60)
        axes.set(xlabel="interface", ylabel=label)
        axes.spines[["top", "right"]].set_visible(False)
    both[0].legend(frameon=False)
    figure.savefig(PICTURES / "crush.png", dpi=110)
    plt.close(figure)


def draw_motion(runs: Runs, plt: Any) -> None:
    """Time and position of all cars, and their speeds, at 55 km/h."""
    result = runs(55)
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    shades = plt.get_cmap("viridis")(np.linspace(0.0, 0.92, 16))
    for i, shade in zip(CARS, shades, strict=True):
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


def largest(result: Result, measure: Any) -> tuple[float, str]:
    """The largest magnitude over all interfaces, and where it is."""
    found = {i: abs(extreme(measure(result, i))) for i in INTERFACES}
    i = max(found, key=lambda k: found[k])
    return found[i], f"{i}-{i + 1}"


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
        told = (plastic, braked, due, spent - braked)
        lines.append(
            [str(speed), f"{result.time[k]:.2f}", f"{3.6 * momentum[k] / MASS:.2f}"]
            + [f"{1e-6 * x:.3f}" for x in told]
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
        told = [", ".join(map(str, some)) or "none" for some in (lifted, ribs, pulled)]
        lines.append([str(speed), f"{1e3 * g:.0f}", at, f"{1e-3 * f:.0f}", where, *told])
    head = "speed [km/h]|largest gap [mm]|at|largest tangential force [kN]|at"
    return table(f"{head}|cars with a wheel off the rail|ribs that locked|couplers pulled", lines)


def assumption_table(runs: Runs) -> str:
    """What each assumption is worth, at 55 km/h."""
    cases: list[tuple[str, dict[str, Any]]] = [("as the deck stands", {})]
    for name, unit, low, high in ASSUMED:
        shown = "" if unit == "1" else f" {unit}"
        cases += [(f"{name} {x:g}{shown}", {name: x}) for x in (low, high)]
    other: dict[str, Any] = {}
    for car, (mass, length) in REVERSED.items():
        other |= {f"mass_{car}": f"{mass} t", f"length_{car}": length}
    cases.append(("parked train the other way round", other))
    lines = []
    for title, settings in cases:
        result = runs(55, **settings)
        (g, at), (f, where) = largest(result, gap), largest(result, tangential)
        most = max(crush(result, i) for i in INTERFACES)
        lines.append([title, f"{1e3 * g:.0f}", at, f"{1e-3 * f:.0f}", where, f"{most:.2f}"])
    head = "changed|largest gap [mm]|at|largest tangential force [kN]|at|largest crush [m]"
    return table(head, lines)


def price_table(runs: Runs) -> str:
    """Steps and their errors at 55 km/h to 1 s, against a quarter of the finest step here."""
    until = {"control__end_time": 1.0}
    best = runs(55, **until, control__safety=0.005)
    lines = []
    for safety in (0.1, 0.05, 0.02):
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
        told = [f"{x:.1e}" for x in errors]
        lines.append([f"{safety:g}", str(steps), *told])
    return table("safety|steps|error of largest gaps|of largest tangential forces", lines)


def main() -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(folder))
        for draw in (draw_bars, draw_crush, draw_motion):
            draw(runs, plt)
        parts = {
            "ENERGY": energy_table(runs),
            "KINEMATICS": kinematics_table(runs),
            "PRICE": price_table(runs),
            "ASSUMED": assumption_table(runs),
        }
    text = (PICTURES / "page.txt").read_text("utf-8")
    for name, part in parts.items():
        text = text.replace(f"@{name}@", part)
    (HERE / "train_sets.md").write_text(text, "utf-8")


if __name__ == "__main__":
    main()
