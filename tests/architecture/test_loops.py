"""Claim: the step is ordinary Python; what composes it knows neither mechanics nor families."""

import ast
import re
from importlib import import_module
from pathlib import Path

import pytest

from crashsolve.deck.keywords import SECTIONS
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.model.ledger import ENTRIES
from crashsolve.system import placeholders
from crashsolve.system.compose import compose

ROOT = Path(__file__).resolve().parents[2]
SOLVER = ROOT / "solver" / "crashsolve"
COMPOSERS = ("system/compose.py", "compiler/program.py", "compiler/specialise.py")
# rigid and flexible, explicit and implicit, of pairs and of nodes, with and without samples within
DECKS = (
    "tutorial/bouncing_ball",
    "benchmark/andrews_squeezer",
    "verification/contact/faces_friction",
    "verification/contact/flat_on_flat",
    "verification/contact/unilateral",
    "verification/parts/shell_implicit",
    "verification/sensors/section_force",
)


def strings(path: Path) -> list[str]:
    """Texts in a file that are no docstrings."""
    tree = ast.parse(path.read_text("utf-8"))
    said = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    constants = (n for n in ast.walk(tree) if isinstance(n, ast.Constant) and id(n) not in said)
    return [node.value for node in constants if isinstance(node.value, str)]


@pytest.mark.parametrize("name", COMPOSERS)
def test_a_composer_names_no_family_and_no_energy(name: str) -> None:
    tree = ast.parse((SOLVER / name).read_text("utf-8"))
    words = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    words |= {n.attr for n in ast.walk(tree) if isinstance(n, ast.Attribute)}
    words |= {word for text in strings(SOLVER / name) for word in re.findall(r"\w+", text)}
    # the choice between two time steps asks for elements of any kind
    mechanics = {*SECTIONS, *ENTRIES, *(entry.upper() for entry in ENTRIES), "force", "gap"}
    assert not words & mechanics


def test_no_physics_is_written_as_text() -> None:
    for path in (*(SOLVER / "system").rglob("*.py"), *(SOLVER / "integrators").rglob("*.py")):
        code = [t for t in strings(path) if re.search(r"@kernel|^ *(for|if|def) .*:$", t, re.M)]
        assert not code, f"{path}: {code[0]}"


def test_there_is_one_loop_over_time() -> None:
    homes = [
        path.name
        for path in SOLVER.rglob("*.py")
        for node in ast.parse(path.read_text("utf-8")).body
        if isinstance(node, ast.FunctionDef) and node.name == "advance"
    ]
    assert homes == ["_advance.py"]


@pytest.mark.parametrize("name", DECKS)
def test_every_function_of_a_step_has_its_file(name: str) -> None:
    text = compose(build(read_deck(ROOT / "decks" / f"{name}.yaml"))[0])
    functions = re.findall(r"^# (crashsolve[.\w]+)\n@\w+\ndef (\w+)", text, re.M)
    assert len(functions) == len(re.findall(r"^def ", text, re.M)) > 3
    for module, function in functions:
        # a copy for a group has the group's name behind its own
        names = [n for n in vars(import_module(module)) if f"{function}_".startswith(f"{n}_")]
        assert names, f"{module} has no {function}"
    # the names of placeholders have given way to what they stand for
    tree = ast.parse(text)
    left = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    assert not left & {name for name in vars(placeholders) if name.isupper()}


def test_every_placeholder_has_a_value() -> None:
    model, _ = build(read_deck(ROOT / "decks/tutorial/bouncing_ball.yaml"))
    tree = ast.parse((SOLVER / "system/placeholders.py").read_text("utf-8"))
    declared = {
        ast.unparse(node.target if isinstance(node, ast.AnnAssign) else node.targets[0])
        for node in tree.body
        if isinstance(node, (ast.Assign, ast.AnnAssign))
    }
    assert declared == set(placeholders.placeholders(model))
