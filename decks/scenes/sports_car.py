"""Pictures of sports_car.md: forces on the wall, motion from above, plastic strain.

make car  (or: python decks/scenes/sports_car.py [FOLDER], with matplotlib and pyvista)

The scenarios are run as the sweep of decks/queue/sports_car.plan.yaml, which makes the table of
that page; a sweep that is in FOLDER is not repeated.
"""

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import in_folder  # noqa: E402

PLAN = ROOT / "decks" / "queue" / "sports_car.plan.yaml"
PICTURES = HERE / "sports_car"
FORCE = " + ".join(f"rcforc.{side}_on_wall.normal" for side in ("box", "chassis", "wheels"))
# the wall at 0, 10 and 20 degrees, without friction, as in Fig. 34
A, B, C = "0001", "0002", "0003"


def call(module: str, *words: object) -> None:
    command = [sys.executable, "-m", module, *map(str, words)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def main(folder: Path) -> None:
    """Run the scenarios where they have not been, and draw."""
    call("crashsolve", "sweep", PLAN, "-o", folder / "sports_car")
    a, b, c = (folder / "sports_car" / "runs" / name for name in (A, B, C))
    words = ("--title", "Force between front and wall", "--x-range", "0:100", "--unit", "kN,ms")
    call("crashpost", "plot", a, b, c, FORCE, *words, "-o", PICTURES / "force.png")
    times = "0,40ms,80ms,200ms"
    call("crashpost", "render", c, "--view", "top", "--at", times, "-o", PICTURES / "above_c.png")
    words = ("--view", "side", "--at", "0,20ms,40ms,200ms", "--color", "plastic_strain")
    call("crashpost", "render", a, *words, "-o", PICTURES / "side_a.png")


if __name__ == "__main__":
    in_folder(main)
