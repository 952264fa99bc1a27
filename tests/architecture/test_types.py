"""Claim: an editor knows what a law is given: the scene of its build, the rows of its kernels."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from crashsolve import materials
from crashsolve.deck import roles
from crashsolve.deck.family import families
from crashsolve.stubs import PACKAGE, laws

FOLDERS = list(dict.fromkeys(family.folder for family in families().values()))
PROTOCOLS = [
    part
    for home in (roles, materials)
    for part in vars(home).values()
    if getattr(part, "_is_protocol", False)
]
# functions that the step or an element calls of a law
CALLED = {name for part in PROTOCOLS for name, value in vars(part).items() if callable(value)}


def functions(path: Path) -> Iterator[ast.FunctionDef]:
    tree = ast.parse(path.read_text("utf-8"))
    return (node for node in tree.body if isinstance(node, ast.FunctionDef))


def type_of(argument: ast.arg) -> str:
    return ast.unparse(argument.annotation) if argument.annotation else ""


@pytest.mark.parametrize("folder", FOLDERS)
def test_every_build_is_given_the_protocol_of_the_scene(folder: str) -> None:
    wrong = [
        f"{path.name}:{function.lineno}"
        for path in sorted((PACKAGE / folder).glob("*.py"))
        for function in functions(path)
        for argument in function.args.args
        if function.name == "build" and argument.arg == "scene" and type_of(argument) != "Scene"
    ]
    assert not wrong, f"scene: Scene, from deck/building.py: {wrong}"


def test_kernels_state_the_stub_of_their_parameters() -> None:
    known = {path.parent.parent / f"{path.stem}.py" for path, _ in laws()}
    wrong = [
        f"{path.relative_to(PACKAGE)}:{function.lineno} {function.name}"
        for path in sorted(known)
        for function in functions(path)
        for argument in function.args.args[:1]
        if function.name in CALLED and argument.arg in ("p", "m")
        if type_of(argument) != "Parameters"
    ]
    assert not wrong, f"p: Parameters, from _rows: {wrong}"
