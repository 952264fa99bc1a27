"""One kernel: its statements, and the kinds of its variables.

A variable has a slot for every kind that it takes; one that is set in a single place is that value
itself, and needs no slot. Where branches with numbers of different kinds in a variable join, each
is converted to the widest kind. The kinds at the end of a loop are known after its start has been
translated: if they differ, the function is translated again.
"""

from __future__ import annotations

import ast
from types import FunctionType
from typing import TYPE_CHECKING

from crashsolve.compiler.translation import arithmetic, memory
from crashsolve.compiler.translation.expressions import Expressions
from crashsolve.compiler.translation.kinds import (
    BOOL,
    INT,
    NOTHING,
    Column,
    Kind,
    Known,
    Row,
    Untranslatable,
    Value,
    tuple_of,
    unify,
)
from crashsolve.compiler.translation.text import FLAGS_OF_LANES
from crashsolve.compiler.translation.variables import (
    LOST,
    UNSET,
    Bound,
    Edge,
    Loop,
    Slots,
    set_once_in,
    stored_in,
    wider,
)

if TYPE_CHECKING:
    import numpy as np


class Again(Exception):
    """The function must be translated again: more is known of its variables."""


class Function(Expressions):
    """The text of a kernel for arguments of given kinds."""

    def __init__(
        self, tree: ast.FunctionDef, function: FunctionType, kinds: tuple[Kind, ...], module: object
    ) -> None:
        if getattr(function, "compiled_as", "") == "blockwise":
            self.flags = FLAGS_OF_LANES
        super().__init__(function.__globals__, module)
        self.tree, self.function, self.kinds = tree, function, kinds
        self.where = tree.lineno
        self.stored, self.set_once = stored_in(tree), set_once_in(tree)
        self.returns: Kind | None = None
        # kinds of variables at the start of loops, where the end brings other ones
        self.wider: dict[tuple[int, str], Kind] = {}

    def translate(self) -> None:
        """Write the text. Raises Untranslatable."""
        while True:
            super().__init__(self.names, self.module)
            self.slots: dict[tuple[str, Kind], Slots] = {}
            self.loops: list[Loop] = []
            self.bound: Bound = {}
            try:
                self._body()
                return
            except Again:
                continue

    def _body(self) -> None:
        names = [argument.arg for argument in self.tree.args.args]
        if len(names) != len(self.kinds):
            raise Untranslatable(f"{self.tree.name} takes {len(names)}, not {len(self.kinds)}")
        for k, (name, kind) in enumerate(zip(names, self.kinds, strict=True)):
            value = Value(kind, self.arguments(k))
            if name in self.stored:
                self.assign_name(name, value)
            else:
                self.bound[name] = value
        self.statements(self.tree.body)
        if not self.text.ended:
            self._return(Value(NOTHING))

    def site(self) -> str:
        code = self.function.__code__
        what = "" if self.indexed is None else f": `{ast.unparse(self.indexed)}`"
        text = f"{code.co_filename}:{self.where}: {self.tree.name}{what}".encode()
        listed = "".join(f"\\{byte:02X}" for byte in text + b"\0")
        address: str = self.module.keep(f'[{len(text) + 1} x i8] c"{listed}"')
        return address

    def arguments(self, k: int) -> tuple[str, ...]:
        """Names of the words of an argument."""
        return tuple(f"%a{k}_{i}" for i in range(len(self.kinds[k].words)))

    # variables

    def variable(self, name: str) -> Value | None:
        slots = self.bound.get(name)
        if slots is None and name in self.stored:
            raise Untranslatable(f"`{name}` has no value yet")
        if slots is None or isinstance(slots, Value):
            return slots
        return self._read(slots, name)

    def _read(self, slots: Slots, name: str) -> Value:
        if slots.kind == UNSET:
            raise Untranslatable(f"`{name}` may have no value here: not every branch sets it")
        if slots.kind == LOST:
            raise Untranslatable(f"`{name}` is not of one kind here")
        pairs = zip(slots.kind.words, slots.names, strict=True)
        return Value(slots.kind, tuple(self.text.load(word, slot) for word, slot in pairs))

    def assign_name(self, name: str, value: Value) -> None:
        """name = value."""
        if isinstance(value.kind, Known):
            self.bound[name] = value
            return
        if name in self.set_once:
            # what Python knows of the value does not count: variables are not constants
            self.bound[name] = Value(value.kind, value.words)
            return
        key = (name, value.kind)
        if key not in self.slots:
            self.slots[key] = Slots(value.kind, tuple(self.text.name() for _ in value.words))
        self.bound[name] = self.slots[key]
        for word, part, slot in zip(
            value.kind.words, value.words, self.slots[key].names, strict=True
        ):
            self.text.store(word, part, slot)

    def edge(self) -> list[Edge]:
        """The edge from here to where branches join; none where control has ended."""
        if self.text.ended:
            return []
        label = self.text.new_label()
        self.text.go(label)
        return [Edge(label, self.bound)]

    def join(self, edges: list[Edge]) -> None:
        """Continue where branches join, if any do."""
        if not edges:
            return
        merged = self._merged([edge.bound for edge in edges])
        end, bound = self.text.new_label(), Bound()
        for edge in edges:
            self.text.begin(edge.label)
            self.bound = dict(edge.bound)
            for name, kind in merged.items():
                self._convert_variable(name, kind)
            bound |= self.bound
            self.text.go(end)
        self.bound = bound
        self.text.begin(end)

    def _merged(self, edges: list[Bound]) -> dict[str, Kind]:
        """Kinds of the variables where control comes together."""
        merged: dict[str, Kind] = {}
        for name in dict.fromkeys(name for edge in edges for name in edge):
            kinds = [edge[name].kind for edge in edges if name in edge]
            if len(kinds) < len(edges):
                merged[name] = UNSET
                continue
            widest = kinds[0]
            for kind in kinds[1:]:
                widest = wider(widest, kind)
            merged[name] = widest
        return merged

    def _convert_variable(self, name: str, kind: Kind) -> None:
        """Convert a variable to the kind that it has on every branch."""
        had = self.bound.get(name)
        if kind == UNSET:
            self.bound[name] = Slots(UNSET, ())
            return
        if had is None or had.kind == kind:
            return
        if kind == LOST:
            self.bound[name] = Slots(LOST, ())
        elif isinstance(had, Slots):
            value = arithmetic.convert(self.text, self._read(had, name), kind)
            self.assign_name(name, value)

    # statements

    def statements(self, nodes: list[ast.stmt]) -> None:
        """One after the other, as far as control gets."""
        for node in nodes:
            if self.text.ended:
                return
            self.where, self.indexed = node.lineno, None
            translate = getattr(self, f"_do_{type(node).__name__}", None)
            if translate is None:
                raise Untranslatable(f"kernels have no {type(node).__name__}")
            translate(node)

    def _do_Pass(self, node: ast.Pass) -> None:
        pass

    def _do_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)

    def _do_Assign(self, node: ast.Assign) -> None:
        value = self.value(node.value)
        for target in node.targets:
            self.assign(target, value)

    def _do_AugAssign(self, node: ast.AugAssign) -> None:
        target = node.target
        if isinstance(target, ast.Name):
            old = self.value(ast.Name(target.id, ast.Load()))
            self.assign_name(
                target.id, arithmetic.operate(self.text, node.op, old, self.value(node.value))
            )
            return
        slot, dtype = self.slot_of(target)
        old = memory.read_number(self.text, slot, dtype)
        new = arithmetic.operate(self.text, node.op, old, self.value(node.value))
        memory.write_number(self.text, slot, dtype, new)

    def assign(self, target: ast.expr, value: Value) -> None:
        """target = value."""
        if isinstance(target, ast.Name):
            self.assign_name(target.id, value)
        elif isinstance(target, (ast.Tuple, ast.List)):
            self._assign_items(target.elts, value.items)
        else:
            slot, dtype = self.slot_of(target)
            with self.named(target):
                memory.write_number(self.text, slot, dtype, value)

    def _assign_items(self, targets: list[ast.expr], items: list[Value]) -> None:
        stars = [k for k, target in enumerate(targets) if isinstance(target, ast.Starred)]
        if stars:
            first, last = stars[0], stars[0] + 1 + len(items) - len(targets)
            items = [*items[:first], tuple_of(items[first:last]), *items[last:]]
        if len(items) != len(targets):
            raise Untranslatable(f"{len(items)} values for {len(targets)} names")
        for target, item in zip(targets, items, strict=True):
            self.assign(target.value if isinstance(target, ast.Starred) else target, item)

    def slot_of(self, target: ast.expr) -> tuple[str, np.dtype]:
        """Address and type of a number that is to be written."""
        if isinstance(target, ast.Attribute):
            row = self.value(target.value)
            if isinstance(row.kind, Row):
                slot, dtype, several = memory.slot_of_column(self.text, row, target.attr)
                if not several:
                    return slot, dtype
        elif isinstance(target, ast.Subscript):
            column = self.value(target.value)
            if isinstance(column.kind, Column):
                index, self.indexed = self.number(target.slice), target
                return memory.slot_of_number(self.text, column, index), column.kind.dtype
        raise Untranslatable("kernels write numbers, to rows and columns")

    def _do_Return(self, node: ast.Return) -> None:
        self._return(Value(NOTHING) if node.value is None else self.value(node.value))

    def _return(self, value: Value) -> None:
        if self.returns is None:
            self.returns = value.kind
        kind = unify(self.returns, value.kind)
        if kind is None:
            raise Untranslatable("what a kernel returns must be of one kind")
        if kind != self.returns:
            self.returns = kind
            raise Again
        self.text.ret(kind.words, arithmetic.convert(self.text, value, kind).words)

    def _do_If(self, node: ast.If) -> None:
        text, whether = self.text, self.condition(node.test)
        if whether.constant is not None:
            self.statements(node.body if whether.constant else node.orelse)
            return
        labels = [text.new_label(), text.new_label()]
        before, edges = self.bound, []
        text.choose(whether.words[0], *labels)
        for label, nodes in zip(labels, (node.body, node.orelse), strict=True):
            text.begin(label)
            self.bound = dict(before)
            self.statements(nodes)
            edges += self.edge()
        self.join(edges)

    def _do_While(self, node: ast.While) -> None:
        loop = self._open(node)
        whether = self.condition(node.test)
        out = self._enter(whether)
        self._iteration(node, loop)
        self._close(node, loop, out)

    def _enter(self, whether: Value) -> list[Edge]:
        """Into the body of a loop under a condition; returns the exit."""
        if whether.constant is True:
            return []
        inside, out = self.text.new_label(), Edge(self.text.new_label(), dict(self.bound))
        self.text.choose(whether.words[0], inside, out.label)
        self.text.begin(inside)
        return [out]

    def _do_For(self, node: ast.For) -> None:
        called = node.iter
        whose = self.value(called.func).kind if isinstance(called, ast.Call) else None
        if isinstance(called, ast.Call) and isinstance(whose, Known) and whose.what is range:
            if not 1 <= len(called.args) <= 3 or called.keywords:
                raise Untranslatable("range takes one to three numbers")
            self._for_range(node, [self.number(part) for part in called.args])
        else:
            self._for_each(node)

    def _for_range(self, node: ast.For, numbers: list[Value]) -> None:
        first = numbers[0] if len(numbers) > 1 else Value(INT, ("0",), 0)
        last = numbers[1] if len(numbers) > 1 else numbers[0]
        step = numbers[2] if len(numbers) > 2 else Value(INT, ("1",), 1)
        if step.constant == 0:
            raise Untranslatable("a range has no step of 0")
        if step.constant is None and self.text.site is not None:
            by = step.words[0]
            with self.named(node.iter):
                self.text.test(self.text.value(f"icmp ne i64 {by}, 0"), by, "0")
        text, count = self.text, self.text.slot("i64")
        text.store("i64", first.words[0], count)
        loop = self._open(node)
        now = text.load("i64", count)
        out = self._enter(Value(BOOL, (self._is_within(now, last.words[0], step),)))
        self.assign(node.target, Value(INT, (now,)))
        self._iteration(node, loop)
        if not text.ended:
            after = text.value(f"add nsw i64 {now}, {step.words[0]}")
            text.store("i64", after, count)
        ends = (first.constant, last.constant, step.constant)
        self._close(node, loop, out, None not in ends and len(range(*ends)) > 0)

    def _is_within(self, now: str, last: str, step: Value) -> str:
        """Whether a range has further values."""
        text = self.text
        if step.constant:
            how = "slt" if step.constant > 0 else "sgt"
            return text.value(f"icmp {how} i64 {now}, {last}")
        edges = [text.value(f"icmp {how} i64 {now}, {last}") for how in ("slt", "sgt")]
        rises = text.value(f"icmp sgt i64 {step.words[0]}, 0")
        return text.value(f"select i1 {rises}, i1 {edges[0]}, i1 {edges[1]}")

    def _for_each(self, node: ast.For) -> None:
        """Once for every item of a tuple, one after the other."""
        if node.orelse:
            raise Untranslatable("loops of kernels have no `else`")
        broken: list[Edge] = []
        for item in self.value(node.iter).items:
            loop = Loop("", broken=broken)
            self.assign(node.target, item)
            self._iteration(node, loop)
            if self.text.ended:
                break
        if broken:
            self.join(broken + self.edge())

    def _open(self, node: ast.For | ast.While) -> Loop:
        """Begin a loop; returns the kinds of variables at its head."""
        if node.orelse:
            raise Untranslatable("loops of kernels have no `else`")
        self.bound = dict(self.bound)
        for name in list(self.bound):
            if (id(node), name) in self.wider:
                self._convert_variable(name, self.wider[id(node), name])
        loop = Loop(self.text.new_label(), dict(self.bound))
        self.text.begin(loop.start)
        return loop

    def _iteration(self, node: ast.For | ast.While, loop: Loop) -> None:
        """The body of a loop, up to the target of `continue`."""
        self.loops.append(loop)
        self.statements(node.body)
        self.loops.pop()
        if loop.continued:
            self.join(loop.continued + self.edge())

    def _close(
        self, node: ast.For | ast.While, loop: Loop, out: list[Edge], is_entered: bool = False
    ) -> None:
        """Back to the start of a loop with variables of the same kinds, and on after it.

        `is_entered`: whether its body has been done at least once then.
        """
        gained: Bound = {}
        if not self.text.ended:
            for name, had in loop.started.items():
                widest = wider(had.kind, self.bound[name].kind)
                if widest != had.kind:
                    self.wider[id(node), name] = widest
                    raise Again
                self._convert_variable(name, had.kind)
            gained = {name: p for name, p in self.bound.items() if name not in loop.started}
            self.text.go(loop.start)
        for edge in out:
            for name, slots in gained.items():
                edge.bound.setdefault(name, slots if is_entered else Slots(UNSET, ()))
        self.join(out + loop.broken)

    def _do_Break(self, node: ast.Break) -> None:
        self.loops[-1].broken += self.edge()

    def _do_Continue(self, node: ast.Continue) -> None:
        self.loops[-1].continued += self.edge()

    def rooms(self) -> list[str]:
        """Lines that make room for the variables."""
        lines = list(self.text.slots)
        for (_, kind), slots in self.slots.items():
            for word, slot in zip(kind.words, slots.names, strict=True):
                lines.append(f"{slot} = alloca {word}")
        return lines
