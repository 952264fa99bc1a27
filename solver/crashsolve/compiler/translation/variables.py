"""Variables of a kernel: their storage, and their kinds where branches join."""

from dataclasses import dataclass, field

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
