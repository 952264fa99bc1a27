"""Claim: scenes with an occupant meet the laws of momentum and energy that their decks expect."""

from pathlib import Path

import pytest
from command import crashsolve

from crashpost.cli import main as crashpost

SCENES = Path(__file__).parents[2] / "decks" / "scenes"


@pytest.mark.long
@pytest.mark.parametrize("scene", ["motorcycle", "roll_cage", "wheelchair"])
def test_a_scene_meets_its_expectations(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # the values are known; tests/estimate is about errors that are not
    words = (SCENES / f"{scene}.yaml", "-o", tmp_path, "--set", "control.estimate=off")
    done = crashsolve(*words)
    assert done.returncode == 0, done.stdout + done.stderr
    assert crashpost(["expect", str(tmp_path)]) == 0, capsys.readouterr().out
