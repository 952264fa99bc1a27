"""Writes decks/README.md: a picture and a line for every scene, benchmark and tutorial deck.

    make gallery                                  runs all decks, some of which take minutes
    python decks/gallery.py heavy_top pendulum    renews the pictures of these
    python decks/gallery.py --list                renews the page alone

A picture is that of `crashpost render`: the first scene under `output: report: scenes:` of the
deck, or four moments. Results are kept in gallery.results/; a run that is there is not repeated.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

from PIL import Image

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors

DECKS = Path(__file__).resolve().parent
PICTURES = DECKS / "pictures"
FOLDERS = {"tutorial": "Tutorial", "scenes": "Scenes", "benchmark": "Benchmarks"}
# what is changed for the picture alone: finer meshes take longer than a picture is worth
SETTINGS = {"tube_crush": ["across=12", "along=72"]}
# colours of a picture and its width: none is above 100 kB
COLOURS, WIDTH = 128, 900


def decks() -> list[Path]:
    """All decks of the gallery, in its order."""
    return [deck for folder in FOLDERS for deck in sorted((DECKS / folder).glob("*.yaml"))]


def name_of(deck: Path) -> str:
    """Name of a deck among all: with its folder where another has the same."""
    is_shared = sum(other.stem == deck.stem for other in decks()) > 1
    return f"{deck.parent.name}_{deck.stem}" if is_shared else deck.stem


def draw(deck: Path, results: Path) -> str:
    """Solve a deck and draw it; returns what went wrong."""
    folder = results / name_of(deck)
    if not finished(folder):
        # errors are estimated by further runs, which no picture shows
        values = [*settings(deck), "--set", "control.estimate=off"]
        command = [sys.executable, "-m", "crashsolve", str(deck), "-o", str(folder), *values]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            return (done.stderr or done.stdout).strip().splitlines()[-1]
    target = PICTURES / f"{name_of(deck)}.png"
    command = [sys.executable, "-m", "crashpost", "render", str(folder), "-o", str(target)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        return done.stderr.strip()
    shrink(target)
    return ""


def settings(deck: Path) -> list[str]:
    """Words of the command line that change a deck for its picture."""
    return [word for text in SETTINGS.get(deck.stem, []) for word in ("--set", text)]


def finished(folder: Path) -> bool:
    """Whether a run in this folder has reached its end."""
    try:
        state = json.loads((folder / "status.json").read_text("utf-8"))["state"]
    except (OSError, ValueError, KeyError):
        return False
    return bool(state == "finished")


def shrink(path: Path) -> None:
    """Make a picture as small as a page needs it."""
    with Image.open(path) as opened:
        whole = opened.convert("RGB")
    size = (WIDTH, round(whole.height * WIDTH / whole.width))
    small = whole.resize(size, Image.Resampling.LANCZOS) if whole.width > WIDTH else whole
    # small areas of their own colour, such as arrows, keep it
    few = small.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(path, optimize=True)


def page() -> str:
    """The text of decks/README.md."""
    lines = [
        "# The decks in pictures",
        "",
        "Made by `make gallery`; do not edit. Each picture is that of `crashpost render` on the",
        "result of the deck; `python decks/gallery.py NAME` renews one.",
    ]
    for folder, title in FOLDERS.items():
        lines += ["", f"## {title}"]
        for deck in (deck for deck in decks() if deck.parent.name == folder):
            changed = f" (here `{' '.join(settings(deck))}`)" if settings(deck) else ""
            lines += ["", f"**[{deck.stem}]({folder}/{deck.name})**: {title_of(deck)}{changed}"]
            if (PICTURES / f"{name_of(deck)}.png").exists():
                lines += ["", f"![{deck.stem}](pictures/{name_of(deck)}.png)"]
    return "\n".join([*lines, ""])


def title_of(deck: Path) -> str:
    """What a deck is about, as it says itself."""
    try:
        return read_deck(deck).title
    except DeckErrors as errors:
        raise SystemExit(str(errors)) from None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="decks; all when absent")
    parser.add_argument("--list", action="store_true", help="renew the page without any picture")
    parser.add_argument("--results", type=Path, default=Path("gallery.results"), metavar="DIR")
    options = parser.parse_args()
    known = {name_of(deck): deck for deck in decks()}
    unknown = [name for name in options.names if name not in known]
    if unknown:
        parser.error(f"no deck '{unknown[0]}' (known: {', '.join(known)})")
    PICTURES.mkdir(exist_ok=True)
    failed = 0
    for name in () if options.list else options.names or known:
        problem = draw(known[name], options.results)
        failed += bool(problem)
        print(f"{name}: {problem or 'drawn'}", flush=True)
    (DECKS / "README.md").write_text(page(), "utf-8")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
