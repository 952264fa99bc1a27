"""Variables of a kernel: their storage, and their kinds where branches join."""

import ast
from dataclasses import dataclass, field
from functools import cache

from crashsolve.compiler.translation.kinds import Kind, Value, unify


class Lost(Kind):
    """Value of a variable that has different kinds on different branches."""


LOST = Lost()


class Unset(Kind):
    """Value of a variable that is set on some branches only."""


UNSET = Unset()


@dataclass(frozen=True)
class Slots:
    """Stack slots of a variable."""

    kind: Kind
    names: tuple[str, ...]


Bound = dict[str, Slots | Value]
# of every use of a name, the loops around it
Uses = dict[str, list[tuple[ast.AST, ...]]]


@dataclass
class Edge:
    """One of several edges to where branches join: its label, and the variables on it."""

    label: str
    bound: Bound


@dataclass
class Loop:
    """The edges by `continue` and by `break`, and the variables at the start of every iteration."""

    start: str
    started: Bound = field(default_factory=dict)
    continued: list[Edge] = field(default_factory=list)
    broken: list[Edge] = field(default_factory=list)


def wider(one: Kind, other: Kind) -> Kind:
    """The kind that holds both, or that of an undefined value."""
    for kind in (UNSET, LOST):
        if kind in (one, other):
            return kind
    return unify(one, other) or LOST


@cache
def stored_in(tree: ast.FunctionDef) -> frozenset[str]:
    """Names that a function gives a value to: once for all kinds of its arguments."""
    return frozenset(_uses(tree)[0])


@cache
def set_once_in(tree: ast.FunctionDef) -> frozenset[str]:
    """Names that are set in one place, which is translated once and lies before all their uses.

    In a loop it is set anew every time, so no use may lie outside of that loop.
    """
    stores, loads = _uses(tree)
    return frozenset(
        name
        for name, (loops, *others) in stores.items()
        if not others
        and not any(isinstance(loop, ast.For) and not _is_range(loop) for loop in loops)
        and all(used[: len(loops)] == loops for used in loads.get(name, ()))
    ) - {argument.arg for argument in tree.args.args}


@cache
def _uses(tree: ast.FunctionDef) -> tuple[Uses, Uses]:
    """The loops around every store and every load of a name; ast.walk takes several times as
    long.
    """
    stores, loads = Uses(), Uses()
    left: list[tuple[ast.AST, tuple[ast.AST, ...]]] = [(tree, ())]
    while left:
        node, loops = left.pop()
        if isinstance(node, ast.Name):
            is_store = isinstance(node.ctx, ast.Store)
            (stores if is_store else loads).setdefault(node.id, []).append(loops)
            continue
        inside = (*loops, node) if isinstance(node, (ast.For, ast.While)) else loops
        for field_name, part in vars(node).items():
            if type(part) is list:
                left += [(inner, inside) for inner in part if isinstance(inner, ast.AST)]
            elif isinstance(part, ast.AST) and field_name != "ctx":
                left.append((part, loops if field_name == "iter" else inside))
    return stores, loads


def _is_range(loop: ast.For) -> bool:
    """Whether the body is translated once; it is for every item of a tuple."""
    match loop.iter:
        case ast.Call(func=ast.Name(id="range")):
            return True
    return False
