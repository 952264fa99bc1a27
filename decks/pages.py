"""What the scripts that write pages beside decks share: runs, numbers of results, text."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from crashpost.results.result import Result


def in_folder(main: Callable[[Path], None]) -> None:
    """Run `main` in the folder named on the command line, or in one that is deleted afterwards."""
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as folder:
            main(Path(folder))


def finished(folder: Path) -> bool:
    """Whether a run has come to its normal end there."""
    log = folder / "log.txt"
    return log.exists() and "N o r m a l" in log.read_text("utf-8")


def values(result: Result, channel: str) -> np.ndarray:
    """A history of a result, in its unit."""
    series: np.ndarray = result.series(channel).values
    return series


def swept(plan: dict[str, object], path: Path, folder: Path) -> list[dict[str, str]]:
    """Rows of the table of `crashsolve sweep`, which is run if it has not been yet.

    The plan is written to `path`, the runs to `folder`.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    # JSON is YAML
    path.write_text(json.dumps(plan, indent=1), "utf-8")
    csv_file = folder / "sweep.csv"
    if not csv_file.exists():
        command = [sys.executable, "-m", "crashsolve", "sweep", str(path), "-o", str(folder)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with csv_file.open(encoding="utf-8") as rows:
        return list(csv.DictReader(rows))


def write_page(path: Path, parts: dict[str, str]) -> None:
    """The text of page.txt, in the folder named like the page, with its parts in their places."""
    text = (path.with_suffix("") / "page.txt").read_text("utf-8")
    for name, part in parts.items():
        text = text.replace(f"@{name}@", part)
    path.write_text(text, "utf-8")
