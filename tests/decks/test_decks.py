"""Claim: every deck runs to its normal end and meets its own expectations.

The scenes have tests of their own, in tests/scenes. A deck whose first line is `# long` takes
long to run or to compile, and is run by `make long`.
"""

from pathlib import Path

import pytest
from command import crashsolve

from crashpost.cli import main as crashpost

DECKS = Path(__file__).resolve().parents[2] / "decks"
FOLDERS = ("tutorial", "verification", "benchmark", "queue", "occupants/tests")


def _decks() -> list[object]:
    """Decks to run, those that take long marked so."""
    params: list[object] = []
    for folder in FOLDERS:
        for path in sorted((DECKS / folder).rglob("*.yaml")):
            if path.name.endswith(".plan.yaml"):
                continue
            text = path.read_text("utf-8")
            marks = [pytest.mark.long] if text.startswith("# long\n") else []
            name = str(path.relative_to(DECKS).with_suffix(""))
            params.append(pytest.param(path, id=name, marks=marks))
    return params


@pytest.mark.parametrize("deck", _decks())
def test_a_deck_meets_its_expectations(
    deck: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # the values are known; tests/estimate is about errors that are not
    done = crashsolve(deck, "-o", tmp_path, "--set", "control.estimate=off")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("N o r m a l    t e r m i n a t i o n\n")
    code = crashpost(["expect", str(tmp_path)])
    verdicts = capsys.readouterr().out
    assert code == 0, verdicts
    assert "expectations met" in verdicts
