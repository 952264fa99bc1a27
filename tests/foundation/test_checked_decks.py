"""Claim: kernels of the solver stay within the bounds of their tables: checked, decks end well."""

from pathlib import Path

import pytest
from command import crashsolve
from quick import first_quick

DECKS = Path(__file__).resolve().parents[2] / "decks" / "verification"


@pytest.mark.parametrize(
    "deck", first_quick(["springs/elastoplastic", "loads/force", "sensors/angle"])
)
def test_shipped_laws_stay_within_their_bounds(deck: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = crashsolve(DECKS / f"{deck}.yaml", "-o", out, CRASHSOLVE_CHECKED="1")
    assert done.returncode == 0, done.stderr
