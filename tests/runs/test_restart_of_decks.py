"""Claim: whatever laws a deck has, a run that goes on from a dump ends in the same bits."""

from pathlib import Path

import pytest
from command import crashsolve, differences, go_on
from quick import first_quick

from crashsolve.deck.reading.deck import read_deck

DECKS = Path(__file__).parents[2] / "decks"
# dumps: the run goes on from the second, in the middle of it
PARTS = 3.7


def short_decks() -> list[Path]:
    """Decks that are run by the quick tests; first one whose loads change in time."""
    folders = (DECKS / name for name in ("extreme", "verification", "tutorial"))
    paths = [path for folder in folders for path in sorted(folder.rglob("*.yaml"))]
    short = [path for path in paths if not path.read_text("utf-8").startswith("# long\n")]
    return sorted(short, key=lambda path: path.stem != "table_end")


@pytest.mark.parametrize("path", first_quick(short_decks()), ids=lambda path: path.stem)
def test_a_run_goes_on_to_the_same_bits(path: Path, tmp_path: Path) -> None:
    control = read_deck(path).control
    every = (control.end_time - control.start_time) / PARTS
    words = [f"--set=output.restart.every={every!r}", "--set=control.estimate=off"]
    done = crashsolve(path, "-o", tmp_path / "whole", *words)
    assert done.returncode == 0, done.stderr
    if len(list((tmp_path / "whole").glob("restart_*.h5"))) < 2:
        pytest.skip("a run of few steps is not dumped twice")
    go_on(path, tmp_path / "whole", tmp_path / "again", *words)
    others = differences(tmp_path / "again", tmp_path / "whole")
    # of a pair that is apart, a dump has the normal of its last evaluation
    assert [name for name in others if not name.startswith("dump:")] == []
