"""Pictures of rollover.md: Figs 27 and 28 of the chapter, from a run of rollover.yaml.

make rollover  (or: python decks/scenes/rollover.py [FOLDER], with matplotlib and pyvista)

A run whose result is in FOLDER is not repeated; the film is left there.
"""

import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import finished, in_folder  # noqa: E402

from crashpost.results.result import Result  # noqa: E402

PICTURES = HERE / "rollover"
# read off Fig. 28: where the three curves end
LOW, HIGH = 1000, 3500
HEADS = {"driver": "driver", "passenger": "front passenger", "rear": "rear occupant"}
MOMENTS = "0,0.2,0.4,0.6,0.9,1.2,1.6,2.2"


def call(module: str, *words: object) -> None:
    command = [sys.executable, "-m", module, *map(str, words)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def severity(folder: Path) -> None:
    """Fig. 28: the Severity Index of the three heads over time in one chart."""
    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    axes.axhspan(LOW, HIGH, color="#edae49", alpha=0.4, label="Fig. 28 ends: 1000 to 3500")
    axes.axhline(1000, color="grey", lw=0.8)
    for name, label in HEADS.items():
        index = Result(folder).series(f"si(nodout.{name}_head_acceleration.resultant)")
        axes.plot(index.time, index.values, label=label)
    # three decades: the curves of the chapter stay below 4000, ours do not
    axes.set(xlabel="time [s]", ylabel="Severity Index", yscale="log", ylim=(10, 1e5))
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right")
    figure.savefig(PICTURES / "severity.png", dpi=100)
    plt.close(figure)


def main(folder: Path) -> None:
    """Run the deck where it has not been, and draw."""
    out = folder / "rollover"
    if not finished(out):
        call("crashsolve", HERE / "rollover.yaml", "-o", out, "--set", "control.estimate=off")
    severity(out)
    strip = PICTURES / "front.png"
    view = ("--view", "front", "--no-ghost")
    call("crashpost", "render", out, "--at", MOMENTS, *view, "-o", strip)
    call("crashpost", "film", out, "--slow", 4, *view, "-o", folder / "rollover.mp4")


if __name__ == "__main__":
    in_folder(main)
