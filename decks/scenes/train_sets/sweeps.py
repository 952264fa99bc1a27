"""Sweeps over what is assumed of the train sets: one number at a time, and all of them at once.

The ranges are those in the comments of shared/rail_numbers.yaml and shared/rail_trains.yaml.
"""

import re
import sys
from pathlib import Path
from typing import NamedTuple

sys.path[:0] = [str(Path(__file__).resolve().parents[2])]

from pages import swept  # noqa: E402

SHARED = Path(__file__).resolve().parents[1] / "shared"
DECK = SHARED.parent / "train_sets.yaml"
DRAWS = 16
# these play no part in the plane
INEFFECTIVE = {"k_side", "c_side", "spread", "k_yaw", "c_yaw", "end_inertia", "anchor", "run_in"}
INTERFACES = [f"{i}_{i + 1}" for i in range(1, 16)]
_LINE = re.compile(
    r'^  (?P<name>\w+): "?(?P<value>[^\s"]+)(?: t)?"? +# (?P<kind>assumed|shaped)\b.*?: '
    r"(?P<low>[\d.e]+)(?: \(\w+\))? to (?P<high>[\d.e]+)(?P<tonnes> t)?"
)


class Assumption(NamedTuple):
    """A number of the deck that the chapter does not give, and its range."""

    name: str
    kind: str
    low: str
    high: str

    @property
    def spans_decades(self) -> bool:
        """Whether equal factors, not equal differences, should be equally likely."""
        return float(self.low.split()[0]) > 0 and (
            float(self.high.split()[0]) > 3.0 * float(self.low.split()[0])
        )


class Extreme(NamedTuple):
    """A run of a sweep: its largest gap [m] and tangential force [N] over all interfaces."""

    values: dict[str, str]
    gap: float
    gap_at: str
    force: float
    force_at: str


def assumptions() -> list[Assumption]:
    """All that is assumed or shaped with a range, in the order of the files."""
    listed = []
    for file in ("rail_trains.yaml", "rail_numbers.yaml"):
        for line in (SHARED / file).read_text("utf-8").splitlines():
            match = _LINE.match(line)
            if match and match["name"] not in INEFFECTIVE:
                unit = match["tonnes"] or ""
                ends = (match["low"] + unit, match["high"] + unit)
                listed.append(Assumption(match["name"], match["kind"], *ends))
    return listed


def deck_value(name: str) -> str:
    """The number as the deck has it, with its unit."""
    for file in ("rail_trains.yaml", "rail_numbers.yaml"):
        text = (SHARED / file).read_text("utf-8")
        match = re.search(rf'^  {name}: "?(\$\{{.*?\}}|[^"#]+?)"? +#', text, re.M)
        if match:
            return match[1]
    raise KeyError(name)


def number(text: str) -> float | str:
    """A bare number as such; one with a unit as it is written."""
    return text if " " in text else float(text)


def _measures() -> list[dict[str, str]]:
    measures = []
    for n in INTERFACES:
        gap = f"disbout.gap_{n}.vector.z * rcforc.plates_{n}.touching"
        for name, channel, statistic in (
            ("high", gap, "max"),
            ("low", gap, "min"),
            ("force", f"rcforc.plates_{n}.tangential", "abs_max"),
        ):
            unit = "N" if name == "force" else "m"
            cells = {
                "name": f"{name} {n}",
                "channel": channel,
                "statistic": statistic,
                "unit": unit,
            }
            measures.append(cells)
    return measures


def _sweep(folder: Path, design: dict[str, object], vary: dict[str, object]) -> list[Extreme]:
    """Write the plan, run it by `crashsolve sweep`, and read its table."""
    plan = {
        "title": "What the assumed numbers of the train sets are worth",
        "deck": str(DECK),
        "design": design,
        "set": {
            "control.end_time": 1.2,
            "control.estimate": "off",
            "output.history.interval": 4e-3,
            "output.states.interval": 1.2,
        },
        "vary": vary,
        "measure": _measures(),
    }
    return [_extreme(row) for row in swept(plan, folder / "assumed.plan.yaml", folder / "runs")]


def _extreme(row: dict[str, str]) -> Extreme:
    column = {
        name.split(" [")[0]: float(text or "nan")
        for name, text in row.items()
        if re.match(r"(high|low|force) ", name)
    }
    gaps = {n: max(column[f"high {n}"], -column[f"low {n}"]) for n in INTERFACES}
    forces = {n: column[f"force {n}"] for n in INTERFACES}
    gap_at, force_at = max(gaps, key=lambda n: gaps[n]), max(forces, key=lambda n: forces[n])
    return Extreme(row, gaps[gap_at], gap_at, forces[force_at], force_at)


def one_at_a_time(folder: Path) -> tuple[Extreme, list[tuple[Assumption, Extreme, Extreme]]]:
    """The deck as it stands, and each assumption at both ends of its range."""
    every = assumptions()
    columns = {one.name: [number(deck_value(one.name))] * (2 * len(every) + 1) for one in every}
    for k, one in enumerate(every):
        columns[one.name][2 * k + 1 : 2 * k + 3] = [number(one.low), number(one.high)]
    runs = _sweep(folder, {"type": "list"}, dict(columns))
    return runs[0], [(one, runs[2 * k + 1], runs[2 * k + 2]) for k, one in enumerate(every)]


def all_at_once(folder: Path) -> list[Extreme]:
    """Draws over all ranges."""
    vary: dict[str, object] = {}
    for one in assumptions():
        kind = "log_uniform" if one.spans_decades else "uniform"
        low, high = number(one.low), number(one.high)
        vary[one.name] = {"from": low, "to": high, "distribution": kind}
    return _sweep(folder, {"type": "latin_hypercube", "runs": DRAWS}, vary)


def summary(runs: list[Extreme]) -> str:
    """Where the draws lie, in a sentence's words."""
    done = [run for run in runs if run.gap == run.gap]
    gaps, forces = sorted(1e3 * run.gap for run in done), sorted(1e-3 * run.force for run in done)
    near = sum(run.gap_at in ("7_8", "8_9", "9_10") for run in done)
    middle = len(done) // 2
    return (
        f"{len(done)} draws over all ranges give largest gaps of {gaps[0]:.0f} to "
        f"{gaps[-1]:.0f} mm, median\n{gaps[middle]:.0f} mm, and largest forces of {forces[0]:.0f} "
        f"to {forces[-1]:.0f} kN, median {forces[middle]:.0f} kN; in {near} of them the\n"
        "largest gap is at or next to the colliding interface"
    )
