"""The page sled.md with its picture: what slack, limiter, pretensioner and padding do on a sled.

make sled  (or: python decks/occupants/sled.py [FOLDER], with matplotlib)

The sweep is kept in FOLDER, and not repeated where it is there.
"""

import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import yaml

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "postproc"), str(ROOT / "decks")]

from pages import in_folder, swept, write_page  # noqa: E402

from crashpost.results.result import Result  # noqa: E402

PAGE = HERE / "sled.md"
PLAN = ROOT / "decks" / "queue" / "sled.plan.yaml"
MEASURES = ("chest", "HIC36", "deflection", "shoulder belt", "lap belt", "thigh")
UNITS = ("g", "", "mm", "kN", "kN", "kN")
NONE = 1e5  # a limit or padding above it is none [N]
AS, LESS, NOT = "as published", "in the same direction, less of it", "**not as published**"
PART = "the chest as published; HIC not, where the head meets nothing"
LATE = 0.2  # a pretensioner after it does not fire [s]

Row = dict[str, str]
Key = tuple[float, float, float, float, float]
FAR = 0.3  # the knees do not reach the dash [m]
NEAR = 0.03


def key(row: Row) -> Key:
    """Slack [m], limit [N], firing time [s], padding [N], distance of the dash [m] of a run."""
    names = ("slack", "limit", "fires", "pad", "knee_gap")
    slack, limit, fires, pad, gap = (float(row[name]) for name in names)
    return slack, limit, fires, pad, gap


def words(at: Key) -> str:
    """What a run has, for a reader."""
    slack, limit, fires, pad, gap = at
    parts = [f"slack of {1e3 * slack:.0f} mm"] if slack > 0.0 else []
    parts += [f"limiter of {limit / 1e3:g} kN"] if limit < NONE else []
    parts += [f"pretensioner at {1e3 * fires:.0f} ms"] if fires < LATE else []
    parts += [f"padding of {pad / 1e3:g} kN"] if pad < NONE else []
    parts += ["rigid dash"] if pad > NONE and gap < FAR else []
    return ", ".join(parts) or "tight belt alone"


def measure(row: Row, name: str) -> float:
    """A measure of a run, from the column that begins with its name."""
    texts = [text for head, text in row.items() if head.split(" [")[0] == name]
    return float(texts[0])


def history(row: Row, channel: str, folder: Path) -> Any:
    return Result(folder / "runs" / f"{int(row['run']):04d}").series(channel)


def excursion(row: Row, name: str, folder: Path) -> float:
    """Motion of the head or the hip forwards on the sled [mm]."""
    start = history(row, f"disbout.{name}.vector.x", folder).values[0]
    return measure(row, f"{name} forwards") - 1e3 * float(start)


def table(rows: dict[Key, Row], folder: Path) -> str:
    heads = [f"{m} [{u}]" if u else m for m, u in zip(MEASURES, UNITS, strict=True)]
    lines = [
        f"| | {' | '.join(heads)} | head forwards [mm] | hip forwards [mm] | paid out [mm] |",
        "|" + "---|" * (len(heads) + 4),
    ]
    for at, row in rows.items():
        cells = [f"{measure(row, name):.3g}" for name in MEASURES]
        cells += [f"{excursion(row, name, folder):.0f}" for name in ("head", "hip")]
        lines.append(f"| {words(at)} | {' | '.join(cells)} | {measure(row, 'paid out'):.0f} |")
    return "\n".join(lines)


def percent(new: float, old: float) -> float:
    return 100.0 * (new / old - 1.0)


def verdicts(rows: dict[Key, Row], folder: Path) -> str:
    """Rows of the comparison with what is published."""
    tight, loose = rows[0.0, 1e6, 1.0, 1e6, FAR], rows[0.12, 1e6, 1.0, 1e6, FAR]
    wound, some = rows[0.05, 1e6, 0.015, 1e6, FAR], rows[0.05, 1e6, 1.0, 1e6, FAR]
    limited, both = rows[0.0, 2000.0, 1.0, 1e6, FAR], rows[0.0, 2000.0, 0.015, 1e6, FAR]
    fired = rows[0.0, 1e6, 0.015, 1e6, FAR]
    hard, soft = (rows[0.0, 1e6, 1.0, pad, NEAR] for pad in (1e6, 3500.0))

    def change(new: Row, old: Row, name: str) -> float:
        return percent(measure(new, name), measure(old, name))

    chest = [change(loose, tight, name) for name in ("chest", "HIC36")]
    heads = [excursion(row, "head", folder) for row in (some, wound, tight, limited)]
    alone, beside = change(limited, tight, "chest"), change(both, fired, "chest")
    knees = change(soft, hard, "thigh")
    matching = [
        (
            "120 mm of slack",
            "injury indexes more than 20 % worse (SAE 980557)",
            f"chest {chest[0]:+.0f} %, HIC {chest[1]:+.0f} %",
            AS if min(chest) > 20.0 else PART if chest[0] > 20.0 else NOT,
        ),
        (
            "pretensioner",
            "improves all values (SAE 2015-01-1460)",
            f"on 50 mm of slack: chest {change(wound, some, 'chest'):+.0f} %, "
            f"HIC {change(wound, some, 'HIC36'):+.0f} %",
            AS if max(change(wound, some, name) for name in ("chest", "HIC36")) < 0.0 else NOT,
        ),
        (
            "",
            "with a limiter: head forwards 17 % less (child-size subject)",
            f"alone: {percent(heads[1], heads[0]):+.0f} %",
            AS if heads[1] < heads[0] else NOT,
        ),
        (
            "load limiter",
            "less of chest measures, more so without a pretensioner (SAE 2015-01-1460)",
            f"2 kN: chest {alone:+.0f} % without one, {beside:+.0f} % beside one",
            (AS if alone < beside else "less, but not more so") if alone < 0.0 else NOT,
        ),
        (
            "",
            "the head goes further (IRCOBI)",
            f"2 kN: {percent(heads[3], heads[2]):+.0f} %",
            AS if heads[3] > heads[2] else NOT,
        ),
        (
            "padding of the knees",
            "peak 15 % less on average, 29 % of the means of 5.9 and 4.2 kN (Schwarze)",
            f"3.5 kN: thigh {knees:+.0f} %",
            AS if knees < -15.0 else LESS if knees < 0.0 else NOT,
        ),
    ]
    return "\n".join(
        f"| {of} | {sample} | {value} | {verdict} |" for of, sample, value, verdict in matching
    )


def curves(rows: dict[Key, Row], folder: Path) -> None:
    """Chest, belt and thigh over time."""
    pictures: dict[str, tuple[str, float, list[Key]]] = {
        "chest [g]": (
            "nodout.man_chest_acceleration.resultant",
            1 / 9.81,
            [(0.0, 1e6, 1.0, 1e6, FAR), (0.12, 1e6, 1.0, 1e6, FAR), (0.0, 2000.0, 1.0, 1e6, FAR)],
        ),
        "shoulder belt [kN]": (
            "beltout.belt.force.2",
            1e-3,
            [
                (0.05, 1e6, 1.0, 1e6, FAR),
                (0.05, 1e6, 0.015, 1e6, FAR),
                (0.0, 2000.0, 0.015, 1e6, FAR),
            ],
        ),
        "thigh [kN]": (
            "-secforc.man_femur_load_left.force.z",
            1e-3,
            [(0.0, 1e6, 1.0, pad, NEAR) for pad in (1e6, 3500.0, 1000.0)],
        ),
    }
    figure, panels = plt.subplots(1, 3, figsize=(13, 3.8), layout="constrained")
    for axes, (label, (channel, scale, keys)) in zip(panels, pictures.items(), strict=True):
        for at in keys:
            curve = history(rows[at], channel, folder)
            axes.plot(1e3 * curve.time, scale * np.asarray(curve.values), label=words(at))
        axes.set(xlabel="time [ms]", ylabel=label)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7)
    figure.savefig(PAGE.with_suffix("") / "curves.png", dpi=100)
    plt.close(figure)


def main(folder: Path) -> None:
    """Run what is not there, draw the picture and write the page."""
    plan: dict[str, object] = yaml.safe_load(PLAN.read_text("utf-8"))
    plan["deck"] = str(HERE / "tests" / "sled.yaml")
    rows = {key(row): row for row in swept(plan, folder / "sled.plan.yaml", folder / "sled")}
    curves(rows, folder / "sled")
    parts = {"table": table(rows, folder / "sled"), "verdicts": verdicts(rows, folder / "sled")}
    write_page(PAGE, parts)


if __name__ == "__main__":
    in_folder(main)
