"""Claim: kernels of the solver stay within the bounds of their tables: checked, decks end well."""

from pathlib import Path

import pytest
from command import crashsolve
from quick import first_quick

DECKS = Path(__file__).resolve().parents[2] / "decks" / "verification"
FIRST = "springs/elastoplastic"
# a deck for every law (tests/architecture/test_laws.py); one of small cost first
NAMES = sorted(str(path.relative_to(DECKS).with_suffix("")) for path in DECKS.rglob("*.yaml"))


@pytest.mark.parametrize("deck", first_quick([FIRST, *(n for n in NAMES if n != FIRST)]))
def test_shipped_laws_stay_within_their_bounds(deck: str, tmp_path: Path) -> None:
    words = ("-o", tmp_path / "out", "--set", "control.estimate=off")
    done = crashsolve(DECKS / f"{deck}.yaml", *words, CRASHSOLVE_CHECKED="1")
    assert done.returncode == 0, done.stderr
