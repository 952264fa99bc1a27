"""The sweep of the roll-over varies every number marked as assumed, in the range beside it."""

import re
from pathlib import Path

import pytest

from crashsolve.sweep.plan import read_plan

DECKS = Path(__file__).parents[2] / "decks"
PLAN = DECKS / "queue" / "rollover.plan.yaml"
FILES = (
    "scenes/rollover.yaml",
    "scenes/shared/rollover_vehicle.yaml",
    "occupants/shared/numbers.yaml",
)
NUMBER = r"-?\d+\.?\d*(?:e[+-]?\d+)?"


def marked() -> dict[str, str]:
    """Comments of the parameters that the decks mark as assumed or shaped, by their names."""
    comments = {}
    for name in FILES:
        for line in (DECKS / name).read_text().splitlines():
            line_of = re.fullmatch(r"  (\w+): .* # (?:assumed|shaped)\b(.*)", line)
            if line_of:
                comments[line_of[1]] = line_of[2]
    return comments


@pytest.mark.parametrize("name", marked())
def test_assumed_numbers_vary_over_the_range_beside_them(name: str) -> None:
    plan = read_plan(PLAN)
    if name in plan.card.set:
        # follows from others: of the seats, whose feet stand on the floor, and of the firewall
        assert "${" in str(plan.card.set[name])
        return
    axis = plan.axes[name]
    ends = re.findall(rf"({NUMBER}) (?:\(of dummies\) )?to ({NUMBER})", marked()[name])[-1]
    given = [float(str(end).split()[0]) for end in (axis.from_, axis.to)]
    assert given == [float(end) for end in ends]


def test_nothing_else_varies() -> None:
    assert set(read_plan(PLAN).axes) <= set(marked())
