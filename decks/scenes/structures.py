"""The page structures.md with its pictures: three struck frames in all descriptions, run anew.

make structures  (or: python decks/scenes/structures.py [FOLDER], in an environment with matplotlib)

Runs whose results are in FOLDER are not repeated; all of them take some thirty minutes of CPU time.
"""

import json
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import finished, in_folder, values  # noqa: E402

from crashpost.results.result import Result  # noqa: E402

PICTURES = HERE / "structures"
FRAME = "parts.frame"
# the name of a run, what it is called on the page, and what it sets in the deck
DESCRIPTIONS: dict[str, tuple[str, dict[str, str]]] = {
    "rigid": ("rigid", {"deformation": "rigid"}),
    "hinges": ("hinges", {"deformation": "hinges"}),
    "fold": ("hinges, kecman", {"deformation": "hinges", "collapse": "kecman"}),
    "measured": ("hinges, curve of these shells", {"deformation": "hinges", "collapse": "given"}),
    "limit": ("hinges, curve of a fine mesh", {"deformation": "hinges", "collapse": "given"}),
    "segments": ("segments, 8", {"deformation": "segments"}),
    "beams": ("fibre beams, 8", {"deformation": "beams"}),
    "shells3": ("shells, 3 across", {"deformation": "shells", "across": "3"}),
    "shells4": ("shells, 4 across", {"deformation": "shells"}),
    "shells6": ("shells, 6 across", {"deformation": "shells", "across": "6"}),
    "shells8": ("shells, 8 across", {"deformation": "shells", "across": "8"}),
    "shells12": ("shells, 12 across", {"deformation": "shells", "across": "12"}),
}
PLAIN = ("rigid", "hinges", "fold", "measured", "limit", "segments", "beams")
# meshes of each scene, the finest last, with which all others are compared
SCENES = {
    "cantilever": ("A cantilever tube", ("shells4", "shells6", "shells8")),
    "portal": ("A portal frame", ("shells4", "shells6")),
    "rollover": ("A roll-over frame", ("shells3", "shells4", "shells6")),
}
VIEWS = {"cantilever": "side", "portal": "side", "rollover": "-1,-2,0.7"}
COLOURS = {
    "rigid": "0.6",
    "hinges": "#d1495b",
    "fold": "#edae49",
    "measured": "#7b2d8b",
    "limit": "#c77dd6",
    "segments": "#66a182",
    "beams": "#00798c",
} | dict.fromkeys(("shells3", "shells4", "shells6", "shells8", "shells12"), "#8d96a3")
BEST = "#1b1b1e"
# meshes that the tube is bent with slowly, and the plastic angles of the page's table
BENT, REPORTED = ("shells4", "shells6", "shells8", "shells12"), (0.02, 0.05, 0.1, 0.2, 0.3)
# angles at which a curve is read; the first moments still swing
ANGLES = np.concatenate([[0.002, 0.005, 0.01, 0.02, 0.03, 0.04], np.arange(0.06, 0.5, 0.02)])
# the last share of a run, over which the residual deflection is the mean of a frame that still
# swings
REST = 0.15


class Runs:
    """Runs of the decks, each once, in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __call__(self, scene: str, name: str, **settings: str) -> Result:
        """Result of a scene in a description; dots of fields set besides are written __."""
        folder = self.folder / ".".join([scene, name, *settings.values()])
        if not finished(folder):
            deck = HERE / "structures" / f"{scene}.yaml"
            if DESCRIPTIONS[name][1].get("collapse") == "given":
                deck = self.with_curve(deck, scene, name)
            command = [sys.executable, "-m", "crashsolve", str(deck), "-o", str(folder)]
            for word, value in DESCRIPTIONS[name][1].items():
                command += ["--set", f"{FRAME}.{word}={value}"]
            if DESCRIPTIONS[name][1].get("collapse") == "given":
                command += ["--set", f"{FRAME}.collapse_curve=collapse"]
            for word, value in settings.items():
                command += ["--set", f"{word.replace('__', '.')}={value}"]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return Result(folder)

    def with_curve(self, deck: Path, scene: str, name: str) -> Path:
        """The deck with moments of the slowly bent tube: of the scene's finest mesh, or of all."""
        mesh = SCENES[scene][1][-1]
        moments = limit(self) if name == "limit" else collapse(self("bent", mesh))
        points = [[0.0, float(moments[0])]]
        points += [[float(x), float(y)] for x, y in zip(ANGLES, moments, strict=True)]
        path = self.folder / f"{scene}.{name}.yaml"
        curve = {"collapse": {"points": points, "extrapolate": "hold"}}
        frame = {"include": str(deck), "curves": curve}
        path.write_text(json.dumps(frame), "utf-8")
        return path

    def cost(self, scene: str, name: str) -> float:
        """CPU time of the steps [s]."""
        status = json.loads((self.folder / f"{scene}.{name}" / "status.json").read_text("utf-8"))
        return float(status["cpu_steps"])


def collapse(result: Result) -> np.ndarray:
    """Moments at the foot of the bent tube at the plastic ANGLES of its tip [N m]."""
    # of the tube in struck.yaml, between joints of 25 mm: theta = M L / 2 E I + plastic angle
    second, length = (0.05**4 - 0.046**4) / 12.0, 0.95
    moment = np.abs(values(result, "jntforc.floor.moment.y"))
    angle = np.abs(values(result, "disbout.tip.angle")) - moment * length / (2 * 2.1e11 * second)
    moments: np.ndarray = np.interp(ANGLES, np.maximum.accumulate(angle), moment)
    return moments


def limit(runs: Runs, finest: int = 4) -> np.ndarray:
    """The same of elements of no length, by a line through two meshes: errors of first order."""
    names = BENT[finest - 2 : finest]
    size = [1.0 / float(DESCRIPTIONS[name][1].get("across", 4)) for name in names]
    coarse, fine = (collapse(runs("bent", name)) for name in names)
    return fine - size[1] / (size[0] - size[1]) * (coarse - fine)


def bent_table(runs: Runs) -> str:
    """Moments of the bent tube over its plastic angle, of all meshes."""
    lines = {DESCRIPTIONS[name][0]: collapse(runs("bent", name)) for name in BENT}
    lines["line through 8 and 12"] = limit(runs)
    lines["line through 6 and 8"] = limit(runs, 3)
    lines["hinges"] = collapse(runs("bent", "hinges"))
    lines["hinges, kecman"] = collapse(runs("bent", "fold"))
    head = "|moment [N m] at a plastic angle of|" + "".join(f"{x:g} rad|" for x in REPORTED)
    rows = [
        f"| {name} | " + " | ".join(f"{np.interp(x, ANGLES, moments):.0f}" for x in REPORTED) + " |"
        for name, moments in lines.items()
    ]
    return "\n".join([head, "|---" * (len(REPORTED) + 1) + "|", *rows])


def draw_bent(runs: Runs, plt: ModuleType) -> None:
    """Moments over plastic angles."""
    figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
    for name, style in zip(BENT, (":", "-.", "--", "-"), strict=True):
        moments = collapse(runs("bent", name))
        axes.plot(ANGLES, 1e-3 * moments, style, color=BEST, lw=1.2, label=DESCRIPTIONS[name][0])
    axes.plot(ANGLES, 1e-3 * limit(runs), color=COLOURS["limit"], lw=2.2, label="of a fine mesh")
    for name in ("hinges", "fold"):
        moments = collapse(runs("bent", name))
        axes.plot(ANGLES, 1e-3 * moments, color=COLOURS[name], label=DESCRIPTIONS[name][0])
    axes.set(xlabel="plastic angle [rad]", ylabel="moment at the foot [kN m]", ylim=(0.0, None))
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(PICTURES / "bent.png", dpi=100)
    plt.close(figure)


def force(result: Result) -> np.ndarray:
    """Size of the force of the blow [N]."""
    return np.sqrt(sum(values(result, f"rcforc.blow.force.{k}") ** 2 for k in "xyz"))


def displacement(result: Result) -> np.ndarray:
    """Distance of the struck point from where it was [m]."""
    return np.linalg.norm([values(result, f"disbout.deflection.vector.{k}") for k in "xyz"], axis=0)


def numbers(result: Result) -> np.ndarray:
    """Peak force [N], peak deflection and residual deflection [m], energy of plastic work [J]."""
    x = displacement(result)
    end = result.time > (1.0 - REST) * result.time[-1]
    work = sum(
        values(result, f"glstat.model.energy.{k}")[-1] for k in ("plastic", "hinge_dissipated")
    )
    return np.array([force(result).max(), x.max(), x[end].mean(), work])


def difference(result: Result, best: Result) -> float:
    """Root mean square of the difference of deflections over the run, over the peak deflection."""
    other = np.interp(best.time, result.time, displacement(result))
    return float(np.sqrt(np.mean((other - displacement(best)) ** 2)) / displacement(best).max())


def table(runs: Runs, scene: str) -> str:
    """One line for each description."""
    meshes = SCENES[scene][1]
    best, finest = runs(scene, meshes[-1]), runs.cost(scene, meshes[-1])
    exact = numbers(best)
    head = "description|peak force [kN]|peak deflection [mm]|residual [mm]|plastic work [J]|"
    head += "difference of the history|CPU of the steps [s]|finest shells cost"
    lines = []
    for name in (*PLAIN, *meshes):
        result, cost = runs(scene, name), runs.cost(scene, name)
        computed = numbers(result)
        cells = [DESCRIPTIONS[name][0]]
        for value, wanted, scale, digits in zip(
            computed, exact, (1e-3, 1e3, 1e3, 1.0), (2, 1, 1, 0), strict=True
        ):
            shown_values = f"{scale * value:.{digits}f}"
            is_best = name == meshes[-1]
            cells.append(
                shown_values if is_best else f"{shown_values} ({100 * (value / wanted - 1):+.0f} %)"
            )
        cells.append("-" if name == meshes[-1] else f"{100 * difference(result, best):.1f} %")
        cells += [f"{cost:.2f}", f"{finest / cost:.0f} times"]
        lines.append("| " + " | ".join(cells) + " |")
    rule = "|".join("---" for _ in head.split("|"))
    return "\n".join([f"|{head}|", f"|{rule}|", *lines])


def draw(runs: Runs, scene: str, plt: ModuleType) -> None:
    """Deflections and forces of all descriptions over time."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained")
    names = (*PLAIN[1:], *SCENES[scene][1])
    for name in names:
        result = runs(scene, name)
        look: dict[str, object] = {
            "color": COLOURS[name],
            "label": DESCRIPTIONS[name][0],
            "lw": 1.2,
        }
        if name == names[-1]:
            look |= {"color": BEST, "lw": 2.2}
        elif name in SCENES[scene][1]:
            look["ls"] = ("--", ":")[SCENES[scene][1].index(name)]
        left.plot(1e3 * result.time, 1e3 * displacement(result), **look)
        right.plot(1e3 * result.time, 1e-3 * force(result), **look)
    left.set(xlabel="time [ms]", ylabel="deflection of the struck point [mm]")
    right.set(xlabel="time [ms]", ylabel="force of the blow [kN]")
    left.legend(frameon=False, fontsize=8)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(PICTURES / f"{scene}_history.png", dpi=100)
    plt.close(figure)


def picture(runs: Runs, scene: str) -> None:
    """The frame at its end in four descriptions, two beside each other."""
    import matplotlib.image as image

    shots = []
    for name in ("hinges", "segments", "beams", SCENES[scene][1][-1]):
        runs(scene, name)
        folder, target = runs.folder / f"{scene}.{name}", runs.folder / f"{scene}.{name}.png"
        command = [sys.executable, "-m", "crashpost", "render", str(folder), "--at", "end"]
        command += [f"--view={VIEWS[scene]}", "--show", "frame*"]
        command += ["--title", DESCRIPTIONS[name][0], "-o", str(target)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        shots.append(image.imread(target)[..., :3])
    height, width = (max(shot.shape[k] for shot in shots) for k in (0, 1))
    sheets = [np.ones((height, width, 3)) for _ in shots]
    for sheet, shot in zip(sheets, shots, strict=True):
        sheet[: shot.shape[0], : shot.shape[1]] = shot
    rows = [np.concatenate(sheets[:2], axis=1), np.concatenate(sheets[2:], axis=1)]
    whole = np.concatenate(rows, axis=0)
    step = max(1, round(whole.shape[1] / 1400))
    image.imsave(PICTURES / f"{scene}_end.png", whole[::step, ::step])


def waves(runs: Runs) -> dict[str, str]:
    """When the foot of the cantilever feels the blow, and its first moments."""
    shown_values = {}
    for name in ("hinges", "segments", "beams", "shells4"):
        result = runs(
            "cantilever", name, control__end_time="6e-3", output__history__interval="1e-5"
        )
        moment = values(result, "jntforc.floor.moment.y")
        start = float(result.time[force(result) > 0.0][0])
        largest = np.abs(moment).max()
        applied = float(result.time[np.abs(moment) > 0.05 * largest][0])
        shown_values[f"{name}_felt"] = f"{1e3 * (applied - start):.2f}"
        shown_values[f"{name}_first"] = f"{np.abs(moment).max():.0f}"
        sign = np.sign(moment[np.argmax(np.abs(moment))])
        shown_values[f"{name}_back"] = f"{max(0.0, float((-sign * moment).max())):.0f}"
    return shown_values


def words(runs: Runs) -> dict[str, str]:
    """Numbers that the text of the page names."""
    # half of the eighth part of what bends between joints of 25 mm
    shown_values = waves(runs) | {"cantilever_half": f"{0.5 * 950 / 8:.0f}"}
    shown_values["bent_table"] = bent_table(runs)
    apart = np.abs(limit(runs, 3) / limit(runs) - 1.0)[REPORTED[-1] >= ANGLES]
    shown_values["bent_apart"] = f"{100 * apart.max():.0f} %"
    fine, fold = limit(runs), collapse(runs("bent", "fold"))
    shares = (fold / fine)[(ANGLES >= REPORTED[0]) & (ANGLES <= REPORTED[-1])]  # noqa: SIM300
    shown_values["fold_low"], shown_values["fold_high"] = (
        f"{100 * x:.0f} %" for x in (shares.min(), shares.max())
    )
    for scene in ("cantilever", "portal"):
        moments = collapse(runs("bent", SCENES[scene][1][-1]))
        above = np.interp(0.2, ANGLES, moments) / np.interp(0.2, ANGLES, fine) - 1.0
        shown_values[f"bent_above_{scene}"] = f"{100 * above:.0f} %"
    for scene, (_, meshes) in SCENES.items():
        best = numbers(runs(scene, meshes[-1]))
        shown_values[f"{scene}_finest"] = DESCRIPTIONS[meshes[-1]][0]
        shown_values[f"{scene}_table"] = table(runs, scene)
        shown_values[f"{scene}_ratio"] = (
            f"{runs.cost(scene, meshes[0]) / runs.cost(scene, 'hinges'):.0f}"
        )
        finest = runs.cost(scene, meshes[-1]) / runs.cost(scene, "hinges")
        shown_values[f"{scene}_finest_ratio"] = f"{finest:.0f}"
        for name in dict.fromkeys((*PLAIN, *meshes)):
            moments = numbers(runs(scene, name))
            shown_values[f"{scene}_{name}_rest"] = f"{100 * (moments[2] / best[2] - 1):+.0f} %"
            shown_values[f"{scene}_{name}_back"] = f"{1e3 * (moments[1] - moments[2]):.1f}"
        fold_rest, limit_rest = (numbers(runs(scene, name))[2] for name in ("fold", "limit"))
        shown_values[f"{scene}_fold_limit"] = f"{100 * (fold_rest / limit_rest - 1):+.0f} %"
        coarse = numbers(runs(scene, meshes[-2]))
        shown_values[f"{scene}_mesh"] = f"{100 * abs(coarse[2] / best[2] - 1):.0f} %"
    return shown_values


def main(folder: Path) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    runs = Runs(folder)
    page = (PICTURES / "page.txt").read_text("utf-8")
    shown_values = words(runs)
    draw_bent(runs, plt)
    for scene in SCENES:
        draw(runs, scene, plt)
        picture(runs, scene)
    for name, text in shown_values.items():
        page = page.replace(f"<{name}>", text)
    (HERE / "structures.md").write_text(page, "utf-8")


if __name__ == "__main__":
    in_folder(main)
