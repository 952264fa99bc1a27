"""Claim: words that NOTATION.md bans are in no file of the project, or no names in its code."""

import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOTATION = ROOT / "solver" / "NOTATION.md"
HEADING = "## Words that do not return"
FOLDERS = ("solver", "postproc", "tests", "decks", "benchmarks")
ENDINGS = {".py", ".md", ".yaml", ".txt", ".sh"}
# files that name old words on purpose
NAMING = {
    NOTATION,
    Path(__file__).resolve(),
    ROOT / "solver" / "crashsolve" / "deck" / "renamed.py",
    ROOT / "tests" / "deck" / "test_renamed.py",
}


def banned(where: str) -> list[str]:
    """Words of the table of NOTATION.md with this word in its second column."""
    table = NOTATION.read_text("utf-8").partition(HEADING)[2]
    rows = [line.split("|") for line in table.splitlines() if line.count("|") == 4]
    return [w for row in rows if row[2].strip() == where for w in re.findall(r"`(\w+)`", row[1])]


@cache
def files() -> tuple[Path, ...]:
    paths = [path for name in FOLDERS for path in (ROOT / name).rglob("*")]
    paths += [ROOT / name for name in ("README.md", "CHANGELOG.md", "Makefile")]
    hidden = {"__pycache__", ".pytest_cache"}
    return tuple(
        path
        for path in paths
        if path not in NAMING and (path.suffix in ENDINGS or path.name == "Makefile")
        if path.is_file() and not hidden & set(path.parts)
        if not any(part.endswith(".results") for part in path.parts)
    )


@cache
def words(path: Path) -> frozenset[str]:
    text = path.read_text("utf-8", "replace")
    return frozenset(re.findall(r"\w+", text))


def names(path: Path) -> Iterator[str]:
    for token in tokenize.generate_tokens(io.StringIO(path.read_text("utf-8")).readline):
        if token.type == tokenize.NAME:
            yield token.string


def test_the_table_is_read() -> None:
    assert "mantle" in banned("nowhere") and "way" in banned("no name")


@pytest.mark.parametrize("word", banned("nowhere"))
def test_a_word_is_nowhere(word: str) -> None:
    either = {word, word.capitalize()}
    assert not [str(path.relative_to(ROOT)) for path in files() if either & words(path)]


def test_words_are_no_names() -> None:
    given = set(banned("no name"))
    banned_names = [
        f"{path.relative_to(ROOT)}: {word}"
        for path in files()
        if path.suffix == ".py"
        for word in given & set(names(path))
    ]
    assert not banned_names, "\n".join(banned_names)
