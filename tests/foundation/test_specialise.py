"""Claim: a loop over placeholders becomes, for a scene, what one would write for it by hand."""

import ast
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest

from crashsolve.compiler.program import Program
from crashsolve.compiler.specialise import SpecialiseError

HOME = """
GROUPS = ()
FLAG = True
"""
LOOPS = '''
from math import cos, sin

from bench_home import FLAG, GROUPS

LARGEST = 2.0 * 3.0
SMALLEST = 1.0


def total(time, scene):
    """The sum."""
    total = 0.0
    for k, group in enumerate(GROUPS):
        if hasattr(group.law, "push"):
            total += group.law.push(group.rows[k], LARGEST)
        if group.is_round and total > 1.0:
            total += one(group, time, scene)
        elif FLAG:
            total -= 1.0
    nothing(time, scene)
    return total if FLAG else sin(time)


def one(group, time, scene):
    return cos(time) * group.rows.shape[0]


def nothing(time, scene):
    """Of no use here."""
    for group in GROUPS:
        if group.is_square:
            unused(group, scene)


def unused(group, scene):
    return SMALLEST


def same(time):
    # a comment that is kept
    return 2.0  *  time


def cut_short(scene):
    for group in GROUPS:
        break


def asks_too_much(scene):
    for group in GROUPS:
        print(group.colour)


def has_no_tables(time):
    for group in GROUPS:
        print(group.rows)


def clashes(time):
    return same(time) + sin(time)
'''


class Group:
    TABLES = ("rows",)
    is_square = False

    def __init__(self, word: str, law: ModuleType, is_round: bool) -> None:
        self.word, self.law, self.is_round, self.rows = word, law, is_round, [1.0]


# makes a program with some placeholders changed
Make = Callable[..., Program]


@pytest.fixture
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Make]:
    """A program of loops in files of their own, for two groups."""
    for name, text in (("bench_home", HOME), ("bench_loops", LOOPS)):
        (tmp_path / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    laws = [ModuleType(f"springs.{name}") for name in ("soft", "stiff")]
    laws[0].push = lambda row, largest: 0.0  # type: ignore[attr-defined]
    groups = (Group("soft_springs", laws[0], True), Group("stiff_springs", laws[1], False))

    def make(**changes: object) -> Program:
        given = {"GROUPS": groups, "FLAG": True} | changes
        return Program(given, "bench_home", lambda name: name == "bench_loops", {})

    yield make
    for name in ("bench_home", "bench_loops"):
        sys.modules.pop(name, None)


def body(text: str, name: str) -> str:
    """Statements of a function of a module."""
    functions = {f.name: f for f in ast.parse(text).body if isinstance(f, ast.FunctionDef)}
    return "\n".join(map(ast.unparse, functions[name].body))


def test_groups_are_written_out_without_excluded_blocks(program: Make) -> None:
    made = program()
    assert made.add("bench_loops", "total") == "total"
    text = made.text()
    assert body(text, "total") == (
        "'The sum.'\n"
        "total = 0.0\n"
        "total += springs_soft.push(scene.soft_springs_rows[0], LARGEST)\n"
        "if total > 1.0:\n"
        "    total += one_soft_springs(time, scene)\n"
        "else:\n"
        "    total -= 1.0\n"
        "total -= 1.0\n"
        "return total"
    )
    assert body(text, "one_soft_springs") == "return cos(time) * scene.soft_springs_rows.shape[0]"
    # neither what nothing reaches, nor what is empty, nor the names that these would need
    assert "unused" not in text and "nothing" not in text and "SMALLEST" not in text
    assert "import sin" not in text and "springs_stiff" not in text
    assert "LARGEST = 2.0 * 3.0" in text and "from springs import soft as springs_soft" in text
    # before what needs them
    assert max(text.index("LARGEST = "), text.index("def one_")) < text.index("def total")


def test_a_flag_turns_the_other_branch_on(program: Make) -> None:
    made = program(FLAG=False, GROUPS=())
    made.add("bench_loops", "total")
    assert body(made.text(), "total") == "'The sum.'\ntotal = 0.0\nreturn sin(time)"


def test_what_depends_on_no_placeholder_keeps_its_text(program: Make) -> None:
    made = program()
    made.add("bench_loops", "same")
    assert "    # a comment that is kept\n    return 2.0  *  time\n" in made.text()


@pytest.mark.parametrize(
    ("name", "reported"),
    [
        ("cut_short", "cut_short: a loop over groups cannot be left"),
        ("asks_too_much", "asks_too_much: group soft_springs has no 'colour'"),
        ("has_no_tables", "has_no_tables: its tables need an argument 'scene'"),
    ],
)
def test_a_loop_that_cannot_be_copied_is_refused_with_the_reason(
    program: Make, name: str, reported: str
) -> None:
    with pytest.raises(SpecialiseError, match=reported):
        program().add("bench_loops", name)


def test_a_name_has_one_meaning(program: Make) -> None:
    made = program()
    made.alias(ModuleType("math.sin"))
    made._meanings["sin"] = ("elsewhere", "sin")
    with pytest.raises(SpecialiseError, match="'sin' is"):
        made.add("bench_loops", "clashes")


def test_a_placeholder_without_a_value_is_reported(program: Make) -> None:
    made = program()
    del made.placeholders["FLAG"]
    with pytest.raises(SpecialiseError, match="nothing stands for the placeholder FLAG"):
        made.add("bench_loops", "total")
