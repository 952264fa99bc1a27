"""The walks of ADDING.md: files named and shown there, put into a copy of the package."""

import os
import re
import shutil
import subprocess
from pathlib import Path

from command import crashsolve

ROOT = Path(__file__).resolve().parents[2]
GUIDE = ROOT / "solver" / "ADDING.md"
# a line with a path, and the block below it
SHOWN = re.compile(
    r"^`((?:solver|decks)/[\w./-]+)`:\n\n```\w+\n(.*?)^```", re.MULTILINE | re.DOTALL
)


def files(walk: str) -> dict[str, str]:
    """Files of the walk under a heading, by their path in the repository."""
    page = GUIDE.read_text("utf-8")
    section = page.split(f"\n## {walk}\n")[1].split("\n## ")[0]
    return dict(SHOWN.findall(section))


def walks() -> list[str]:
    """Headings of the walks that show files."""
    return [w for w in re.findall(r"^## (\d+\. .*)$", GUIDE.read_text("utf-8"), re.M) if files(w)]


class Copy:
    """A copy of the solver's package, with its documents, to which files are added."""

    def __init__(self, home: Path) -> None:
        self.home = home
        package = home / "solver" / "crashsolve"
        shutil.copytree(ROOT / "solver" / "crashsolve", package, ignore=lambda *_: ["__pycache__"])

    def add(self, texts: dict[str, str]) -> list[Path]:
        """Write files; the decks among them."""
        for name, text in texts.items():
            path = self.home / name
            path.parent.mkdir(parents=True, exist_ok=True)
            assert not path.exists(), f"{name} is there already"
            path.write_text(text, "utf-8")
        return [self.home / name for name in texts if name.endswith(".yaml")]

    @property
    def environment(self) -> dict[str, str]:
        """Changes of the environment with which commands are those of the copy."""
        search = os.pathsep.join([str(self.home / "solver"), str(ROOT / "postproc")])
        return {"PYTHONPATH": search}

    def crashsolve(self, *words: object) -> subprocess.CompletedProcess[str]:
        """A command of the copy."""
        return crashsolve(*words, **self.environment)
