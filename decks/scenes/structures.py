"""The page structures.md with its pictures: three struck frames in all descriptions, run anew.

make structures  (or: python decks/scenes/structures.py [FOLDER], in an environment with matplotlib)

Runs whose results are in FOLDER are not repeated; all of them take some ten minutes of CPU time.
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
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import finished, values  # noqa: E402

from crashpost.results.result import Result  # noqa: E402

PICTURES = HERE / "structures"
FRAME = "parts.frame"
# the name of a run, what it is called on the page, and what it sets in the deck
DESCRIPTIONS: dict[str, tuple[str, dict[str, str]]] = {
    "rigid": ("rigid", {"deformation": "rigid"}),
    "hinges": ("hinges", {"deformation": "hinges"}),
    "fold": ("hinges, kecman", {"deformation": "hinges", "collapse": "kecman"}),
    "segments": ("segments, 8", {"deformation": "segments"}),
    "beams": ("fibre beams, 8", {"deformation": "beams"}),
    "shells3": ("shells, 3 across", {"deformation": "shells", "across": "3"}),
    "shells4": ("shells, 4 across", {"deformation": "shells"}),
    "shells6": ("shells, 6 across", {"deformation": "shells", "across": "6"}),
}
PLAIN = ("rigid", "hinges", "fold", "segments", "beams")
# meshes of each scene, the finest last, with which all others are compared
SCENES = {
    "cantilever": ("A cantilever tube", ("shells4", "shells6")),
    "portal": ("A portal frame", ("shells4", "shells6")),
    "rollover": ("A roll-over frame", ("shells3", "shells4")),
}
VIEWS = {"cantilever": "side", "portal": "side", "rollover": "-1,-2,0.7"}
COLOURS = dict(
    zip(
        DESCRIPTIONS,
        ("0.6", "#d1495b", "#edae49", "#66a182", "#00798c", "#8d96a3", "#8d96a3", "#1b1b1e"),
        strict=True,
    )
)
# the last share of a run, over which the way at rest is the mean of a frame that still swings
REST = 0.15


class Runs:
    """Runs of the decks, each once, in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __call__(self, scene: str, name: str, **settings: str) -> Result:
        """Result of a scene in a description; dots of fields set besides are written __."""
        folder = self.folder / ".".join([scene, name, *settings.values()])
        if not finished(folder):
            deck = str(HERE / "structures" / f"{scene}.yaml")
            command = [sys.executable, "-m", "crashsolve", deck, "-o", str(folder)]
            for word, value in DESCRIPTIONS[name][1].items():
                command += ["--set", f"{FRAME}.{word}={value}"]
            for word, value in settings.items():
                command += ["--set", f"{word.replace('__', '.')}={value}"]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return Result(folder)

    def cost(self, scene: str, name: str) -> float:
        """CPU time of the steps [s]."""
        status = json.loads((self.folder / f"{scene}.{name}" / "status.json").read_text("utf-8"))
        return float(status["cpu_steps"])


def force(result: Result) -> np.ndarray:
    """Size of the force of the blow [N]."""
    return np.sqrt(sum(values(result, f"rcforc.blow.force.{k}") ** 2 for k in "xyz"))


def way(result: Result) -> np.ndarray:
    """Distance of the struck point from where it was [m]."""
    return np.linalg.norm([values(result, f"disbout.way.vector.{k}") for k in "xyz"], axis=0)


def numbers(result: Result) -> np.ndarray:
    """Peak force [N], largest way and way at rest [m], energy of plastic work [J]."""
    x = way(result)
    end = result.time > (1.0 - REST) * result.time[-1]
    work = values(result, "glstat.model.energy.plastic")[-1]
    return np.array([force(result).max(), x.max(), x[end].mean(), work])


def difference(result: Result, best: Result) -> float:
    """Root mean square of the difference of ways over the run, over the largest way."""
    other = np.interp(best.time, result.time, way(result))
    return float(np.sqrt(np.mean((other - way(best)) ** 2)) / way(best).max())


def table(runs: Runs, scene: str) -> str:
    """One line for each description."""
    meshes = SCENES[scene][1]
    best, finest = runs(scene, meshes[-1]), runs.cost(scene, meshes[-1])
    exact = numbers(best)
    head = "description|peak force [kN]|largest way [mm]|way at rest [mm]|plastic work [J]|"
    head += "difference of the history|CPU of the steps [s]|finest shells cost"
    lines = []
    for name in (*PLAIN, *meshes):
        result, cost = runs(scene, name), runs.cost(scene, name)
        found = numbers(result)
        cells = [DESCRIPTIONS[name][0]]
        for value, wanted, scale, digits in zip(
            found, exact, (1e-3, 1e3, 1e3, 1.0), (2, 1, 1, 0), strict=True
        ):
            told = f"{scale * value:.{digits}f}"
            is_best = name == meshes[-1]
            cells.append(told if is_best else f"{told} ({100 * (value / wanted - 1):+.0f} %)")
        cells.append("-" if name == meshes[-1] else f"{100 * difference(result, best):.1f} %")
        cells += [f"{cost:.2f}", f"{finest / cost:.0f} times"]
        lines.append("| " + " | ".join(cells) + " |")
    rule = "|".join("---" for _ in head.split("|"))
    return "\n".join([f"|{head}|", f"|{rule}|", *lines])


def draw(runs: Runs, scene: str, plt: Any) -> None:
    """Ways and forces of all descriptions over time."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained")
    names = (*PLAIN[1:], *SCENES[scene][1])
    for name in names:
        result = runs(scene, name)
        look: dict[str, Any] = {"color": COLOURS[name], "label": DESCRIPTIONS[name][0]}
        look["lw"] = 2.2 if name == names[-1] else 1.2
        left.plot(1e3 * result.time, 1e3 * way(result), **look)
        right.plot(1e3 * result.time, 1e-3 * force(result), **look)
    left.set(xlabel="time [ms]", ylabel="way of the struck point [mm]")
    right.set(xlabel="time [ms]", ylabel="force of the blow [kN]")
    left.legend(frameon=False, fontsize=8)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(PICTURES / f"{scene}_history.png", dpi=100)
    plt.close(figure)


def picture(runs: Runs, scene: str) -> None:
    """The frame at its end in all descriptions, one below the other."""
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
    height, width = (min(shot.shape[k] for shot in shots) for k in (0, 1))
    cut = [shot[:height, :width] for shot in shots]
    rows = [np.concatenate(cut[:2], axis=1), np.concatenate(cut[2:], axis=1)]
    whole = np.concatenate(rows, axis=0)
    step = max(1, round(whole.shape[1] / 1400))
    image.imsave(PICTURES / f"{scene}_end.png", whole[::step, ::step])


def waves(runs: Runs) -> dict[str, str]:
    """When the foot of the cantilever feels the blow, and its first moments."""
    told = {}
    for name in ("hinges", "segments", "beams", "shells4"):
        result = runs(
            "cantilever", name, control__end_time="6e-3", output__history__interval="1e-5"
        )
        moment = values(result, "jntforc.floor.moment.y")
        start = float(result.time[force(result) > 0.0][0])
        largest = np.abs(moment).max()
        felt = float(result.time[np.abs(moment) > 0.05 * largest][0])
        told[f"{name}_felt"] = f"{1e3 * (felt - start):.2f}"
        told[f"{name}_first"] = f"{np.abs(moment).max():.0f}"
        sign = np.sign(moment[np.argmax(np.abs(moment))])
        told[f"{name}_back"] = f"{max(0.0, float((-sign * moment).max())):.0f}"
    return told


def words(runs: Runs) -> dict[str, str]:
    """Numbers that the text of the page names."""
    # half of the eighth part of what bends between joints of 25 mm
    told = waves(runs) | {"cantilever_half": f"{0.5 * 950 / 8:.0f}"}
    for scene, (_, meshes) in SCENES.items():
        best = numbers(runs(scene, meshes[-1]))
        told[f"{scene}_finest"] = DESCRIPTIONS[meshes[-1]][0]
        told[f"{scene}_table"] = table(runs, scene)
        told[f"{scene}_ratio"] = f"{runs.cost(scene, meshes[0]) / runs.cost(scene, 'hinges'):.0f}"
        finest = runs.cost(scene, meshes[-1]) / runs.cost(scene, "hinges")
        told[f"{scene}_finest_ratio"] = f"{finest:.0f}"
        for name in dict.fromkeys((*PLAIN, *meshes)):
            found = numbers(runs(scene, name))
            told[f"{scene}_{name}_rest"] = f"{100 * (found[2] / best[2] - 1):+.0f} %"
            told[f"{scene}_{name}_back"] = f"{1e3 * (found[1] - found[2]):.1f}"
        coarse = numbers(runs(scene, meshes[0]))
        told[f"{scene}_mesh"] = f"{100 * abs(coarse[2] / best[2] - 1):.0f} %"
    return told


def main(folder: Path) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    runs = Runs(folder)
    page = (PICTURES / "page.txt").read_text("utf-8")
    told = words(runs)
    for scene in SCENES:
        draw(runs, scene, plt)
        picture(runs, scene)
    for name, text in told.items():
        page = page.replace(f"<{name}>", text)
    (HERE / "structures.md").write_text(page, "utf-8")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(folder))
