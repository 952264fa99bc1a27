"""Claim: the documents agree with the code: generated ones are fresh, examples work, links lead."""

import re
from pathlib import Path

import pytest

from crashsolve.deck.schema import equations_markdown, keywords_markdown

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = sorted(ROOT.glob("*.md")) + sorted((ROOT / "solver").rglob("*.md"))
GENERATED = {"KEYWORDS.md": keywords_markdown, "EQUATIONS.md": equations_markdown}


def blocks(path: Path, language: str) -> list[str]:
    """Fenced blocks of one language."""
    return re.findall(rf"```{language}\n(.*?)```", path.read_text("utf-8"), re.DOTALL)


@pytest.mark.parametrize("name", GENERATED)
def test_a_generated_document_is_fresh(name: str) -> None:
    text = (ROOT / "solver" / name).read_text("utf-8")
    assert text == GENERATED[name](), f"{name} is stale: make docs"


def test_the_first_deck_of_the_readme_is_the_tutorial() -> None:
    (deck,) = blocks(ROOT / "README.md", "yaml")
    assert deck == (ROOT / "decks" / "tutorial" / "bouncing_ball.yaml").read_text("utf-8")


def test_the_scripts_of_the_page_on_queues_are_the_examples() -> None:
    page, folder = ROOT / "solver" / "QUEUE.md", ROOT / "decks" / "queue"
    scripts = [folder / name for name in ("slurm.sh", "slurm_array.sh", "pbs.sh")]
    assert blocks(page, "bash") == [path.read_text("utf-8") for path in scripts]
    assert blocks(page, "yaml") == [(folder / "wagon.plan.yaml").read_text("utf-8")]


def test_the_commands_of_the_readme_are_targets_of_the_makefile() -> None:
    targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE)
    named = re.findall(r"make ([a-z]+)", (ROOT / "README.md").read_text("utf-8"))
    assert {"demo", "test"} <= set(named) <= set(targets)


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_links_and_files_named_in_a_document_exist(path: Path) -> None:
    text = re.sub(r"```.*?```", "", path.read_text("utf-8"), flags=re.DOTALL)
    # files that the page itself shows, for the reader to make
    text = re.sub(r"^`[\w./-]+`:$", "", text, flags=re.MULTILINE)
    links = re.findall(r"\]\((?!http)([^)#]+)\)", text)
    files = re.findall(r"`((?:solver|postproc|tests|decks|benchmarks)/[\w./-]+\.\w+)`", text)
    missing = [link for link in links if not (path.parent / link).exists()]
    missing += [name for name in files if not (ROOT / name).exists()]
    assert not missing
