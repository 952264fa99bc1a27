"""The page train_test.md: which assumption of the three-wagon test rules its vertical force.

make trains      (or: python decks/scenes/train_test.py [FOLDER])

One number at a time at both ends of the range that its comment in train_test.yaml states, and some
together, by `crashsolve sweep`. A sweep whose table is in FOLDER is not repeated.
"""

import re
import sys
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent)]

from pages import swept  # noqa: E402

DECK = HERE / "train_test.yaml"
_LINE = re.compile(
    r'^  (?P<name>\w+): "?(?P<value>[^\s"]+)(?P<unit> t)?"? +# (?:assumed|shaped)\b.*?: '
    r"(?P<low>[\d.e]+) to (?P<high>[\d.e]+)"
)
TONNE = 9806.65  # force in the chapter's tons [N]
# the settling time: when A and B are most nearly equally fast
MEASURES = (
    ("force", "rcforc.buffers.force.z", "abs_max", [0, 0.3]),
    ("gap", "-disbout.gap.vector.z", "min", [0, 0.3]),
    ("settles", "abs(rbdout.A.velocity.x - rbdout.B.velocity.x)", "argmin", [0, 0.4]),
    ("stroke A", "rcforc.buffers.depth", "max", None),
    ("stroke C", "-deforc.C_buffers.elongation", "max", None),
    ("largest", "rcforc.buffers.normal", "max", None),
)
# ends that dive differently: A high and short, C low, its bogies heavy and pulling far below
APART = {
    "height_A": 1.9,
    "height_C": 1.4,
    "buffer_height": 1.065,
    "pivot_height": 0.6,
    "bogie": "6.5 t",
    "length_A": 15,
    "pivot_A": 5.5,
    "k_secondary": 0.7e6,
    "k_primary": 1.5e6,
    "c_secondary": 3e4,
}
# devices at the upper ends of their levels
HARD = {
    "plateau_C": 1.8e6,
    "device_C": 2.5e6,
    "ends_CB": 1.8e6,
    "buffer_A_200": 1.2e6,
    "buffer_A_250": 2.0e6,
    "damping": 5e4,
}
TOGETHER = (
    ("stiffer guides of the buffers, k_plate 4.9 MN/m", {"k_plate": 4.9e6}),
    ("the ends dive differently", APART | {"k_plate": 4.9e6}),
    ("harder devices", HARD),
    ("both", APART | HARD | {"k_plate": 4.9e6}),
    ("both, k_plate 10 MN/m", APART | HARD | {"k_plate": 1e7}),
)
ALONE: tuple[str, ...] = (
    "height_A",
    "height_C",
    "height_B",
    "buffer_height",
    "pivot_height",
    "bogie",
    "length_A",
)
ALONE += ("length_C", "k_secondary", "k_primary", "c_secondary", "k_plate", "mu", "k_lift")
ALONE += ("k_traction", "plateau_C", "device_C", "ends_CB", "buffer_A_200", "damping")


def ranges() -> dict[str, tuple[str, ...]]:
    """Value, low and high end of every number with a range, as the deck writes them."""
    limits: dict[str, tuple[str, ...]] = {}
    for line in DECK.read_text("utf-8").splitlines():
        match = _LINE.match(line)
        if match:
            unit = match["unit"] or ""
            limits[match["name"]] = tuple(match[k] + unit for k in ("value", "low", "high"))
    return limits


def number(text: object) -> Any:
    """A bare number as such; one with a unit as it is written."""
    return float(text) if isinstance(text, str) and " " not in text else text


def cases() -> list[tuple[str, dict[str, object]]]:
    """Names and settings of all runs."""
    stated = ranges()
    changes: list[tuple[str, dict[str, object]]] = [("as the deck stands", {})]
    for name in ALONE:
        _, low, high = stated[name]
        changes += [(f"{name} {end}", {name: number(end)}) for end in (low, high)]
    return changes + [(name, dict(some)) for name, some in TOGETHER]


def run(folder: Path) -> list[dict[str, str]]:
    """Rows of the sweep's table."""
    every, stated = cases(), ranges()
    names = sorted({name for _, some in every for name in some})
    vary = {name: [some.get(name, number(stated[name][0])) for _, some in every] for name in names}
    measures = []
    for name, channel, statistic, during in MEASURES:
        cells = {"name": name, "channel": channel, "statistic": statistic}
        measures.append(cells | ({"during": during} if during else {}))
    settings = {"control.end_time": 0.42, "control.estimate": "off", "output.states.interval": 0.4}
    plan = {
        "title": "What the assumed numbers of the train test are worth",
        "deck": str(DECK),
        "design": {"type": "list"},
        "set": settings | {"output.history.interval": 1e-3},
        "vary": vary,
        "measure": measures,
    }
    return swept(plan, folder / "train_test.plan.yaml", folder / "train_test.sweep")


def line(name: str, row: dict[str, str]) -> str:
    texts = {column.split(" [")[0]: text for column, text in row.items()}
    values = {key: float(texts[key]) for key, *_ in MEASURES}
    cells = (
        f"{values['force'] / TONNE:.1f}",
        f"{1e3 * values['gap']:.1f}",
        f"{1e3 * values['settles']:.0f}",
        f"{1e3 * values['stroke A']:.0f}, {1e3 * values['stroke C']:.0f}",
        f"{1e-6 * values['largest']:.2f}",
    )
    return f"| {name} | {' | '.join(cells)} |"


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        rows = run(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(folder))
    head = "|changed|vertical force [t]|gap [mm]|A and B equally fast at [ms]|strokes of A, C [mm]"
    table = [f"{head}|largest force of the buffers [MN]|", "|" + "---|" * 6]
    table.append("| the chapter | 15 | -15 | 250 to 300 | 220, 300 to 350 | 2.5 to 3 |")
    table += [line(name, row) for (name, _), row in zip(cases(), rows, strict=True)]
    text = (HERE / "train_test" / "page.txt").read_text("utf-8")
    (HERE / "train_test.md").write_text(text.replace("@TABLE@", "\n".join(table)), "utf-8")


if __name__ == "__main__":
    main()
