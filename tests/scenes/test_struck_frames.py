"""Claims: the struck frames meet their expectations, and a study knows their descriptions."""

from pathlib import Path

import pytest
from command import crashsolve
from quick import first_quick

from crashpost.cli import main as crashpost
from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckError
from crashsolve.study.settings import settings, varied

FRAMES = Path(__file__).resolve().parents[2] / "decks" / "scenes" / "structures"
WORDS = ["rigid", "hinges", "segments", "beams", "shells"]


@pytest.mark.long
@pytest.mark.parametrize("name", first_quick(("cantilever", "portal", "rollover")))
def test_a_frame_of_hinges_meets_its_expectations(name: str, tmp_path: Path) -> None:
    done = crashsolve(FRAMES / f"{name}.yaml", "-o", tmp_path, "--set", "control.estimate=off")
    assert done.returncode == 0, done.stdout + done.stderr
    assert crashpost(["expect", str(tmp_path)]) == 0


def test_a_study_varies_the_description_of_a_structure() -> None:
    deck = read_deck(FRAMES / "cantilever.yaml")
    field = "parts.frame.deformation"
    assert varied(deck, field) == (field, WORDS)
    assert varied(deck, f"{field}=beams, hinges") == (field, ["beams", "hinges"])
    runs = settings(deck, ["rattle"], "auto", None, vary=field)
    assert [run.overrides[field] for run in runs] == WORDS
    assert len({run.folder for run in runs}) == len(WORDS)


def test_a_field_without_words_needs_its_values() -> None:
    deck = read_deck(FRAMES / "cantilever.yaml")
    assert varied(deck, "parts.frame.divisions=4,8") == ("parts.frame.divisions", ["4", "8"])
    with pytest.raises(DeckError, match="write --vary parts.frame.divisions=A,B"):
        varied(deck, "parts.frame.divisions")


@pytest.mark.long
def test_explicit_and_implicit_methods_bend_segments_that_yield_alike(tmp_path: Path) -> None:
    outcomes = []
    for method in ("rattle", "generalized_alpha", "radau_iia_5"):
        words = f"parts.frame.deformation=segments control.integrator={method} end=0.015".split()
        words.append("control.estimate=off")
        sets = [text for word in words for text in ("--set", word)]
        done = crashsolve(FRAMES / "cantilever.yaml", "-o", tmp_path / method, *sets)
        assert done.returncode == 0, done.stdout + done.stderr
        result = Result(tmp_path / method)
        direction = result.series("disbout.deflection.vector.z").values[-1]
        outcomes.append([direction, result.series("glstat.model.energy.plastic").values[-1]])
    # steps of rattle have errors of the second order: 3e-6 of the way, 2e-4 of the plastic work
    assert outcomes[0][1] > 10.0
    assert [pair[0] for pair in outcomes[:2]] == pytest.approx([outcomes[2][0]] * 2, rel=1e-4)
    assert [pair[1] for pair in outcomes[:2]] == pytest.approx([outcomes[2][1]] * 2, rel=1e-3)
