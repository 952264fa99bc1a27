"""Claim: the generated pages are those of the present cards and docstrings (`make docs`)."""

from pathlib import Path

from crashsolve.deck.schema import equations_markdown, keywords_markdown

SOLVER = Path(__file__).resolve().parents[2] / "solver"


def test_keywords_are_fresh() -> None:
    assert (SOLVER / "KEYWORDS.md").read_text("utf-8") == keywords_markdown()


def test_equations_are_fresh() -> None:
    assert (SOLVER / "EQUATIONS.md").read_text("utf-8") == equations_markdown()
