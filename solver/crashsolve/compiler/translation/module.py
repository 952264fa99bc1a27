"""A whole module in LLVM's language: some functions of a source file, and all they call."""

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import FunctionType

from crashsolve.compiler.table import Slot
from crashsolve.compiler.translation import addresses, builtin, lanes, threads
from crashsolve.compiler.translation.function import Function
from crashsolve.compiler.translation.kinds import (
    BOOL,
    FLOAT,
    Kind,
    Untranslatable,
    Value,
    tables_of,
)
from crashsolve.compiler.translation.text import REPORT, SCRATCH, Text, struct_of

# the first failure: its position in the source, the number that was wrong, and its limit
CHECKS = (
    f"{SCRATCH} = internal global [65536 x i8] zeroinitializer, align 64",
    "@failed = internal global { ptr, i64, i64 } zeroinitializer",
    f"define void {REPORT}(ptr %site, i64 %number, i64 %limit) nounwind noinline cold {{",
    "%pair = cmpxchg ptr @failed, ptr null, ptr %site acq_rel acquire",
    "%first = extractvalue { ptr, i1 } %pair, 1",
    "br i1 %first, label %keep, label %end",
    "keep:",
    "%a = getelementptr i64, ptr @failed, i64 1",
    "store i64 %number, ptr %a",
    "%b = getelementptr i64, ptr @failed, i64 2",
    "store i64 %limit, ptr %b",
    "br label %end",
    "end:",
    "ret void",
    "}",
    'define ptr @"first_failure"() nounwind { ret ptr @failed }',
)


class TranslationError(Exception):
    """A kernel cannot be compiled: file, line, and why."""


@dataclass(frozen=True)
class Known:
    """A translated kernel: its symbol, and the kind of its result."""

    symbol: str
    returns: Kind


class Module:
    """Functions of a module, each for every combination of kinds it is called with."""

    def __init__(self, slots: dict[str, Slot], is_checked: bool = False) -> None:
        self.is_checked = is_checked
        self.tables = tables_of(slots)
        self.has_lanes = "lanes" in slots
        self.parts: list[str] = []
        self.constants: dict[str, str] = {}
        self._known: dict[tuple[FunctionType, tuple[Kind, ...]], Known | None] = {}

    def entry(self, function: FunctionType, name: str) -> None:
        """A function of a number, a flag and the tables, which machine.py makes callable from
        Python.
        """
        self._translate(function, (FLOAT, BOOL, self.tables), name)

    def text(self) -> str:
        """The module. Constants stand first, by name."""
        constants = [f"{name} = private constant {text}" for text, name in self.constants.items()]
        checks = CHECKS if self.is_checked else ()
        heads = [*builtin.declarations(), *threads.DECLARED, *addresses.DECLARED, *checks]
        return "\n".join([*heads, *constants, *self.parts])

    def keep(self, text: str) -> str:
        """The name of a constant."""
        return self.constants.setdefault(text, f"@c{len(self.constants)}")

    def call(self, text: Text, function: FunctionType, given: list[Value]) -> Value:
        """Call a kernel. Raises Untranslatable, TranslationError."""
        if not hasattr(function, "compiled_as"):
            raise Untranslatable(f"{getattr(function, '__name__', function)} is no kernel")
        key = (function, tuple(value.kind for value in given))
        if key not in self._known:
            self._known[key] = None
            symbol = f"{function.__module__}.{function.__name__}.{len(self._known)}"
            self._known[key] = self._translate(function, key[1], symbol)
        called = self._known[key]
        if called is None:
            raise Untranslatable(f"{function.__name__} calls itself")
        words = [
            f"{word} {part}"
            for value in given
            for word, part in zip(value.kind.words, value.words, strict=True)
        ]
        line = f'call {struct_of(called.returns.words)} @"{called.symbol}"({", ".join(words)})'
        kinds = called.returns.words
        if not kinds:
            text.put(line)
            return Value(called.returns)
        whole = text.value(line)
        if len(kinds) == 1:
            return Value(called.returns, (whole,))
        struct = struct_of(kinds)
        parts = (text.value(f"extractvalue {struct} {whole}, {k}") for k in range(len(kinds)))
        return Value(called.returns, tuple(parts))

    def _translate(self, function: FunctionType, kinds: tuple[Kind, ...], symbol: str) -> Known:
        tree = _trees(Path(function.__code__.co_filename))[function.__code__.co_firstlineno]
        one = Function(tree, function, kinds, self)
        try:
            one.translate()
        except Untranslatable as why:
            where = f"{function.__code__.co_filename}:{one.where}: {function.__name__}"
            raise TranslationError(f"{where}: {why}") from why
        assert one.returns is not None
        self.parts.append(self._whole(one, function, symbol))
        return Known(symbol, one.returns)

    def _whole(self, one: Function, function: FunctionType, symbol: str) -> str:
        """The function with its head."""
        how = function.compiled_as  # type: ignore[attr-defined]
        alone = " noalias" * (how == "blockwise")
        # Python passes a truth value as a byte
        whole = " zeroext" * (how == "entry")
        marks = {"ptr": alone, "i1": whole}
        given = ", ".join(
            f"{word}{marks.get(word, '')} {name}"
            for k, kind in enumerate(one.kinds)
            for word, name in zip(kind.words, one.arguments(k), strict=True)
        )
        assert one.returns is not None
        linkage = "" if how == "entry" else "linkonce_odr "
        head = f'define {linkage}{struct_of(one.returns.words)} @"{symbol}"({given}) nounwind'
        head += " alwaysinline" * (how in ("inlined", "stage"))
        head += " noinline" * (how == "apart")
        end = [] if one.text.ended else ["unreachable"]
        return "\n".join([head + " {", "entry:", *one.rooms(), *one.text.lines, *end, "}"])


@cache
def _trees(path: Path) -> dict[int, ast.FunctionDef]:
    """Functions of a file by the line in which they, or their decorators, begin."""
    found: dict[int, ast.FunctionDef] = {}
    left: list[ast.AST] = [ast.parse(path.read_text("utf-8"), str(path))]
    while left:
        # statements alone: functions stand in no expression
        node = left.pop()
        left += [*getattr(node, "body", ()), *getattr(node, "orelse", ())]
        if isinstance(node, ast.FunctionDef):
            first = node.decorator_list[0].lineno if node.decorator_list else node.lineno
            found[first] = node
    return found


assert lanes
