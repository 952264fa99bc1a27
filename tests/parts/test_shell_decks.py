"""Claim: the decks of shells meet their expectations with every kind of element."""

from pathlib import Path

import pytest
from command import crashsolve

from crashpost.cli import main as crashpost

DECKS = Path(__file__).resolve().parents[2] / "decks/verification/parts"
# benchmarks S1, S2, S5, S9, P10, X3, and their parts; those beyond ten seconds are long
PARTS = {
    "shell_roof": ("roof",),
    "shell_pinched": ("shell",),
    "shell_twisted": ("in_plane", "out_of_plane"),
    "shell_plate": ("plate",),
    "shell_panel": ("elastic", "plastic"),
    "shell_ball": ("plate",),
}
LONG = {"shell_pinched", "shell_ball", "shell_panel"}


def _met(deck: str, folder: Path, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    sets = [word for pair in words for word in ("--set", pair)]
    done = crashsolve(DECKS / f"{deck}.yaml", "-o", folder, "--set", "control.estimate=off", *sets)
    assert done.returncode == 0, done.stdout + done.stderr
    assert crashpost(["expect", str(folder)]) == 0, capsys.readouterr().out


@pytest.mark.parametrize(
    "deck", [pytest.param(d, marks=[pytest.mark.long] * (d in LONG)) for d in PARTS]
)
def test_full_integration_meets_the_expectations(
    deck: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _met(deck, tmp_path, [f"parts.{p}.element=fully_integrated" for p in PARTS[deck]], capsys)
