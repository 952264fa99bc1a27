"""A wagon at a buffer stop, swept over its speed and mass: the plan, the command, the table."""

import csv
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from command import crashsolve, environment

WAGON = Path(__file__).resolve().parents[2] / "decks" / "queue" / "wagon.yaml"
# a step that makes a run of some seconds, and the usual one
LONG, SHORT = "1.5e-8", "1e-3"
PLAN = """deck: wagon.yaml
design: list
set: {{control.estimate: "off", control.end_time: 0.5}}
vary:
  speed: [{speeds}]
  control.step: [{steps}]
measure:
  - {{name: peak, channel: rcforc.buffer.normal, statistic: max, unit: kN}}
  - {{name: moment, channel: rcforc.buffer.normal, statistic: argmax}}
"""


def written(folder: Path, count: int = 3, step: str = SHORT) -> Path:
    """A plan of some runs beside a copy of the deck."""
    shutil.copy(WAGON, folder / "wagon.yaml")
    speeds = ", ".join(f'"{5 + k} km/h"' for k in range(count))
    path = folder / "plan.yaml"
    path.write_text(PLAN.format(speeds=speeds, steps=", ".join([step] * count)), "utf-8")
    return path


def words_of(plan: Path) -> tuple[object, ...]:
    return ("sweep", plan, "-o", plan.parent / "out", "--jobs", "2")


def swept(plan: Path, *more: str) -> subprocess.CompletedProcess[str]:
    """Run the sweep of a plan into the folder `out` beside it."""
    return crashsolve(*words_of(plan), *more)


def gathered(folder: Path) -> subprocess.CompletedProcess[str]:
    """Gather the table of a sweep."""
    words = [sys.executable, "-m", "crashpost", "sweep", str(folder), "--table"]
    return subprocess.run(words, capture_output=True, text=True, env=environment())


def table(folder: Path) -> list[dict[str, str]]:
    with (folder / "sweep.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def status(folder: Path, number: int) -> dict[str, Any]:
    """status.json of a run; empty while there is none."""
    try:
        text = (folder / "runs" / f"{number:04d}" / "status.json").read_text("utf-8")
    except OSError:
        return {}
    content: dict[str, object] = json.loads(text)
    return content


def begun(folder: Path) -> dict[str, str]:
    """When each run began, as its results state: what is kept keeps it."""
    times = {}
    for path in sorted((folder / "runs").glob("*/log.txt")):
        times[path.parent.name] = str(path.stat().st_mtime_ns)
    return times
