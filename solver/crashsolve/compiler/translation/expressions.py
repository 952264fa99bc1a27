"""Expressions of kernels, each a value of a kind."""

import ast
import builtins
import operator
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import ModuleType
from typing import Any

from crashsolve.compiler.translation import arithmetic, memory
from crashsolve.compiler.translation.kinds import (
    BOOL,
    INT,
    NOTHING,
    Column,
    Kind,
    Known,
    Row,
    Table,
    Tables,
    Tuple,
    Untranslatable,
    Value,
    known,
    tuple_of,
    unify,
)
from crashsolve.compiler.translation.text import FLAGS, Text

# translations of calls of functions that are not kernels, by the function
Builtin = Callable[["Expressions", list[Value]], Value]
BUILTINS: dict[Any, Builtin] = {}
# of constants, to settle before the run
KNOWN_ORDERS: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.Gt: operator.gt,
}
TRUE, FALSE = known(True), known(False)


class Expressions:
    """Values of expressions in the text of one function.

    `bound` are its variables; `call` translates a call of a kernel, `keep` puts constants aside.
    """

    # transformations of sums and products that LLVM may make
    flags = FLAGS

    def __init__(self, names: Mapping[str, object], module: Any) -> None:
        self.names, self.module = names, module
        # the owner of an index, for messages
        self.indexed: ast.expr | None = None
        self.text = Text(self.site if module.is_checked else None, self.flags)

    def site(self) -> str:
        """A constant with file, line and expression."""
        raise NotImplementedError

    def variable(self, name: str) -> Value | None:
        """The value of a variable of the function, or None."""
        raise NotImplementedError

    def value(self, node: ast.expr) -> Value:
        """The value of an expression. Raises Untranslatable."""
        translate = getattr(self, f"_value_{type(node).__name__}", None)
        if translate is None:
            raise Untranslatable(f"kernels have no {type(node).__name__}")
        translated: Value = translate(node)
        return translated

    def number(self, node: ast.expr) -> Value:
        """An index or a count."""
        whole = self.value(node)
        if whole.kind not in (INT, BOOL):
            raise Untranslatable("an index must be an integer")
        return arithmetic.convert(self.text, whole, INT)

    def _value_Constant(self, node: ast.Constant) -> Value:
        return known(node.value)

    def _value_Name(self, node: ast.Name) -> Value:
        variable = self.variable(node.id)
        if variable is not None:
            return variable
        if node.id in self.names:
            return known(self.names[node.id])
        if hasattr(builtins, node.id):
            return known(getattr(builtins, node.id))
        raise Untranslatable(f"unknown name `{node.id}`")

    def _value_Tuple(self, node: ast.Tuple) -> Value:
        return tuple_of(self._listed(node.elts))

    def _listed(self, nodes: list[ast.expr]) -> list[Value]:
        values: list[Value] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                values += self.value(node.value).items
            else:
                values.append(self.value(node))
        return values

    def _value_Attribute(self, node: ast.Attribute) -> Value:
        owner = self.value(node.value)
        kind = owner.kind
        if isinstance(kind, Known):
            if not isinstance(kind.what, (ModuleType, type)) or not hasattr(kind.what, node.attr):
                raise Untranslatable(f"{kind.what!r} has no `{node.attr}`")
            return known(getattr(kind.what, node.attr))
        if isinstance(kind, Row):
            return memory.read_column(self.text, owner, node.attr)
        if isinstance(kind, Tables):
            return memory.table_of(self.text, owner, node.attr)
        if isinstance(kind, Table) and node.attr == "shape":
            return tuple_of([Value(INT, (word,)) for word in owner.words[1:]])
        if isinstance(kind, Tuple) and node.attr in kind.names:
            return owner.items[kind.names.index(node.attr)]
        raise Untranslatable(f"this has no `{node.attr}`")

    def _value_Subscript(self, node: ast.Subscript) -> Value:
        owner = self.value(node.value)
        if isinstance(owner.kind, Tuple):
            return self._item(owner, node)
        if isinstance(owner.kind, Column):
            index, self.indexed = self.number(node.slice), node
            slot = memory.slot_of_number(self.text, owner, index)
            return memory.read_number(self.text, slot, owner.kind.dtype)
        if isinstance(owner.kind, Table):
            several = isinstance(node.slice, ast.Tuple)
            nodes = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            assert several or len(nodes) == 1
            indices, self.indexed = [self.number(part) for part in nodes], node
            return memory.row_of(self.text, owner, indices)
        raise Untranslatable("only tables, columns and tuples have items")

    def _item(self, owner: Value, node: ast.Subscript) -> Value:
        """An item of a tuple, or several by constant bounds."""
        index = node.slice
        if isinstance(index, ast.Slice):
            ends = [None if e is None else self.number(e) for e in (index.lower, index.upper)]
            if index.step is not None or any(e is not None and e.constant is None for e in ends):
                raise Untranslatable("bounds of a part of a tuple must be constant")
            bounds = [None if e is None else e.constant for e in ends]
            return tuple_of(owner.items[slice(*bounds)])
        at = self.number(index)
        if at.constant is not None:
            if not -len(owner.items) <= at.constant < len(owner.items):
                raise Untranslatable(f"a tuple of {len(owner.items)} has no item {at.constant}")
            return owner.items[at.constant]
        self.indexed = node
        return self._any_item(owner, at)

    def _any_item(self, owner: Value, at: Value) -> Value:
        """An item of a tuple whose number is known in the run alone."""
        items = owner.items
        count = str(len(items))
        inside = self.text.value(f"icmp ult i64 {at.words[0]}, {count}")
        self.text.test(inside, at.words[0], count)
        if self.text.site is not None:
            at = Value(INT, (self.text.value(f"select i1 {inside}, i64 {at.words[0]}, i64 0"),))
        kind: Kind | None = items[0].kind if items else None
        for item in items:
            kind = kind and unify(kind, item.kind)
        if kind is None:
            raise Untranslatable("items of a tuple taken by number must be of one kind")
        alike = [arithmetic.convert(self.text, item, kind).words for item in items]
        words = [
            self._picked(word, [item[k] for item in alike], at.words[0])
            for k, word in enumerate(kind.words)
        ]
        return Value(kind, tuple(words))

    def _picked(self, word: str, parts: list[str], at: str) -> str:
        """One of several, by its number; constant ones are kept by the module."""
        text, room = self.text, f"[{len(parts)} x {word}]"
        if any("%" in part for part in parts):
            slot = text.slot(room)
            for k, part in enumerate(parts):
                text.store(word, part, text.at(word, slot, str(k)))
        else:
            listed = ", ".join(f"{word} {part}" for part in parts)
            slot = self.module.keep(f"{room} [{listed}]")
        return text.load(word, text.at(word, slot, at))

    @contextmanager
    def named(self, node: ast.expr) -> Iterator[None]:
        """Failures of checked mode within this block name the expression `node`."""
        before, self.indexed = self.indexed, node
        yield
        self.indexed = before

    def _value_BinOp(self, node: ast.BinOp) -> Value:
        one, other = self.value(node.left), self.value(node.right)
        a, b = one.constant, other.constant
        if one.kind == other.kind == INT and a is not None and b is not None:
            folded = _folded(node.op, a, b)
            if folded is not None:
                return known(folded)
        with self.named(node):
            return arithmetic.operate(self.text, node.op, one, other)

    def _value_UnaryOp(self, node: ast.UnaryOp) -> Value:
        if isinstance(node.op, ast.Not):
            return arithmetic.opposite(self.text, self.condition(node.operand))
        value = self.value(node.operand)
        if isinstance(node.op, ast.USub):
            return arithmetic.negative(self.text, value)
        raise Untranslatable(f"kernels have no {type(node.op).__name__}")

    def _value_Compare(self, node: ast.Compare) -> Value:
        edges: list[tuple[str, str]] = []
        end, one = self.text.new_label(), self.value(node.left)
        for k, (how, part) in enumerate(zip(node.ops, node.comparators, strict=True)):
            other = self.value(part)
            truth = self._compared(how, one, other)
            if k + 1 == len(node.ops):
                return self._joined(truth, end, edges)
            one, more = other, self.text.new_label()
            edges.append(("false", self.text.label))
            self.text.choose(truth.words[0], more, end)
            self.text.begin(more)
        raise AssertionError

    def _compared(self, how: ast.cmpop, one: Value, other: Value) -> Value:
        if isinstance(how, (ast.Is, ast.IsNot)):
            if NOTHING not in (one.kind, other.kind):
                raise Untranslatable("`is` is for None alone")
            return known((one.kind == other.kind) == isinstance(how, ast.Is))
        a, b = one.constant, other.constant
        if type(a) is int and type(b) is int and type(how) in KNOWN_ORDERS:
            return known(KNOWN_ORDERS[type(how)](a, b))
        return arithmetic.compare(self.text, how, one, other)

    def _joined(self, last: Value, end: str, edges: list[tuple[str, str]]) -> Value:
        """A truth that was settled earlier, or is the last one."""
        if not edges:
            return last
        edges.append((last.words[0], self.text.label))
        self.text.begin(end)
        return Value(BOOL, (self.text.join("i1", edges),))

    def condition(self, node: ast.expr) -> Value:
        """Whether an expression holds: there alone `and` and `or` may join numbers."""
        if isinstance(node, ast.BoolOp):
            return self._short_circuited(node)
        return arithmetic.truth(self.text, self.value(node))

    def _value_BoolOp(self, node: ast.BoolOp) -> Value:
        return self._short_circuited(node, is_value=True)

    def _short_circuited(self, node: ast.BoolOp, is_value: bool = False) -> Value:
        """Parts from left to right, as far as one of them settles it. Raises Untranslatable."""
        is_and, text = isinstance(node.op, ast.And), self.text
        settles, end = (FALSE if is_and else TRUE), text.new_label()
        edges: list[tuple[str, str]] = []
        last = TRUE if is_and else FALSE
        for k, part in enumerate(node.values):
            last = self.value(part) if is_value else self.condition(part)
            if last.kind != BOOL:
                raise Untranslatable(
                    "as a value `and` or `or` of numbers is one of them in Python; "
                    "write `a if a != 0 else b`"
                )
            if last.constant is settles.constant:
                break
            if last.constant is not None or k + 1 == len(node.values):
                continue
            more = text.new_label()
            edges.append((settles.words[0], text.label))
            text.choose(last.words[0], *((more, end) if is_and else (end, more)))
            text.begin(more)
        return self._joined(last, end, edges)

    def _value_IfExp(self, node: ast.IfExp) -> Value:
        text, whether = self.text, self.condition(node.test)
        if whether.constant is not None:
            return self.value(node.body if whether.constant else node.orelse)
        starts, ends = [text.new_label() for _ in "ab"], [text.new_label() for _ in "ab"]
        text.choose(whether.words[0], *starts)
        values = []
        for start, end, part in zip(starts, ends, (node.body, node.orelse), strict=True):
            text.begin(start)
            values.append(self.value(part))
            text.go(end)
        kind = unify(values[0].kind, values[1].kind)
        if kind is None:
            raise Untranslatable("both sides of `if ... else` must be of one kind")
        # conversion of a side, once the other is known
        join, whole = text.new_label(), []
        for end, value in zip(ends, values, strict=True):
            text.begin(end)
            whole.append((arithmetic.convert(text, value, kind), text.label))
            text.go(join)
        text.begin(join)
        words = tuple(
            text.join(word, [(value.words[k], label) for value, label in whole])
            for k, word in enumerate(kind.words)
        )
        return Value(kind, words)

    def _value_Call(self, node: ast.Call) -> Value:
        called = self.value(node.func)
        if not isinstance(called.kind, Known) or node.keywords:
            raise Untranslatable("kernels call functions by name, with arguments by position")
        function = called.kind.what
        if function is bool and len(node.args) == 1:
            return self.condition(node.args[0])
        given = self._listed(node.args)
        if function in BUILTINS:
            with self.named(node):
                return BUILTINS[function](self, given)
        if isinstance(function, type) and hasattr(function, "_fields"):
            return tuple_of(given, function._fields)
        result: Value = self.module.call(self.text, function, given)
        return result


def _folded(how: ast.operator, a: int, b: int) -> int | None:
    """Sums and products of constants; so a number of an item may be written as one."""
    if isinstance(how, ast.Add):
        return a + b
    if isinstance(how, ast.Sub):
        return a - b
    if isinstance(how, ast.Pow) and b >= 0:
        if b >= 64 and abs(a) > 1:
            raise Untranslatable(f"{a}**{b} is beyond 64 bits")
        return int(a**b)
    return a * b if isinstance(how, ast.Mult) else None
