"""Claim: what ADDING.md walks through is all that there is to do, and works as it stands."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from adding import GUIDE, ROOT, Copy, files, walks
from command import environment
from quick import first_quick

from crashsolve.deck import roles

# a family's walk is tried by test_families.py, that of a statistic by test_documents_of_channels.py
WALKS = [walk for walk in walks() if "family" not in walk]
PACKAGE = ROOT / "solver" / "crashsolve"


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Copy:
    return Copy(tmp_path_factory.mktemp("adding"))


@pytest.mark.parametrize("walk", first_quick(WALKS))
def test_a_walk_has_the_stated_result(copy: Copy, walk: str, tmp_path: Path) -> None:
    (deck,) = copy.add(files(walk))
    done = copy.crashsolve(deck, "-o", tmp_path, "--set", "control.estimate=off")
    assert done.returncode == 0, done.stdout + done.stderr
    command = [sys.executable, "-m", "crashpost", "expect", str(tmp_path)]
    given = environment(**copy.environment)
    reported = subprocess.run(command, capture_output=True, text=True, env=given, check=False)
    assert reported.returncode == 0, reported.stdout


@pytest.mark.long
def test_a_new_method_has_the_stated_order(tmp_path: Path) -> None:
    # a copy of its own: the walk may have been tried by another process, or be tried later
    copy = Copy(tmp_path / "copy")
    (walk,) = [walk for walk in WALKS if "method of integration" in walk]
    copy.add(files(walk))
    page = GUIDE.read_text("utf-8")
    (words,) = re.findall(r"^crashsolve (study .*)$", page, re.MULTILINE)
    study, deck, *rest = words.split()
    done = copy.crashsolve(study, copy.home / deck, *rest, "-o", tmp_path / "study", "--jobs", 1)
    assert done.returncode == 0, done.stderr
    orders = [float(x) for x in re.findall(r"\b([23]\.\d+)\b", done.stdout)]
    assert any(order == pytest.approx(3.0, abs=0.15) for order in orders), done.stdout


def test_the_page_walks_through_every_kind() -> None:
    requested = ("law", "joint", "spring with state", "pair of shapes", "statistic", "family")
    requested += ("law among several bodies", "mesh that parts share", "phase")
    for word in (*requested, "method of integration", "law of contact"):
        assert re.search(rf"^## \d+\. A {word}$", GUIDE.read_text("utf-8"), re.MULTILINE), word


# modules that are no laws: what is asked of them is no hook
NO_LAW = {"_fields", "_is_protocol", "compiled_as", "lineno", "dtype", "tolist"}


def test_the_page_names_every_hook() -> None:
    """What the package asks of a law by name, and what the roles of laws have."""
    page, requested = GUIDE.read_text("utf-8"), set[str]()
    of_laws = r"(?:module|law|narrow|normal|friction|own|home|method\(model\))"
    pattern = re.compile(rf'(?:has|get)attr\((?:\w+\.)*{of_laws}, "(\w+)"')
    for path in PACKAGE.rglob("*.py"):
        requested |= set(pattern.findall(path.read_text("utf-8")))
    for role in vars(roles).values():
        if getattr(role, "__module__", "") == roles.__name__:
            requested |= {n for n in (*vars(role), *role.__annotations__) if not n.startswith("_")}
    assert len(requested) > 40
    missing = sorted(n for n in requested - NO_LAW if not re.search(rf"\b{n}\b", page))
    assert not missing, missing
