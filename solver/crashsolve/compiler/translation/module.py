"""Some functions of a source file and all they call, in LLVM's language, as units.

A unit is a function with the small ones that it calls, which LLVM may inline. Large ones, which it
would not, are units of their own. A symbol ends in a hash of the text of its function, which has
the symbols of all that this calls: a symbol has one meaning in all scenes, and kernels with the
same text are one. So the code of a unit serves every scene that needs it (compiler/process.py).
"""

import ast
import hashlib
import re
from collections.abc import Iterable
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


# a function with more lines is a unit of its own
LARGE = 150
REFERENCE = re.compile(r'@"([^"]+)"')


class TranslationError(Exception):
    """A kernel cannot be compiled: file, line, and why."""


@dataclass(frozen=True)
class Known:
    """A translated kernel: its symbol, and the kind of its result."""

    symbol: str
    returns: Kind


@dataclass(frozen=True)
class Part:
    """A translated function: its head and body, and the symbols that stand in these."""

    head: str
    body: str
    references: tuple[str, ...]
    is_first: bool  # of a unit

    def text(self, is_called_elsewhere: bool) -> str:
        linkage = "" if is_called_elsewhere else "linkonce_odr "
        return f"define {linkage}{self.head} {self.body}"

    @property
    def declaration(self) -> str:
        return f"declare {self.head}"


class Module:
    """Functions of a module, each for every combination of kinds it is called with."""

    def __init__(self, slots: dict[str, Slot], is_checked: bool = False) -> None:
        self.is_checked = is_checked
        self.tables = tables_of(slots)
        self.has_lanes = "lanes" in slots
        self.entries: set[str] = set()
        self.parts: dict[str, Part] = {}
        self.constants: dict[str, str] = {}
        self._known: dict[tuple[FunctionType, tuple[Kind, ...]], Known | None] = {}

    def entry(self, function: FunctionType, name: str) -> None:
        """A function of a number, a flag and the tables, which machine.py makes callable from
        Python.
        """
        self.entries.add(name)
        self._translate(function, (FLOAT, BOOL, self.tables), name)

    def units(self) -> dict[str, str]:
        """The texts of all units by names with a hash: the same name has the same text."""
        if self.has_lanes or self.is_checked:
            # lanes need all that a loop calls; failures are kept in one place
            texts = [part.text(name in self.entries) for name, part in self.parts.items()]
            whole = self._joined(texts, self.constants)
            return {_named("whole", whole): whole}
        firsts = [symbol for symbol, part in self.parts.items() if part.is_first]
        return dict(map(self._unit, firsts))

    def _unit(self, first: str) -> tuple[str, str]:
        """Name and text of the unit that begins with a function."""
        texts, left = {first: self.parts[first].text(True)}, [first]
        constants = list[str]()
        while left:
            for symbol in self.parts[left.pop()].references:
                part = self.parts.get(symbol)
                if part is None:
                    constants.append(symbol)
                elif symbol not in texts:
                    texts[symbol] = part.declaration if part.is_first else part.text(False)
                    left += [] if part.is_first else [symbol]
        text = self._joined(list(texts.values()), constants)
        return _named(first, text), text

    def _joined(self, parts: list[str], constants: Iterable[str]) -> str:
        kept = [
            f'@"{name}" = private constant {self.constants[name]}'
            for name in dict.fromkeys(constants)
        ]
        checks = CHECKS if self.is_checked else ()
        heads = [*builtin.declarations(), *threads.DECLARED, *addresses.DECLARED, *checks]
        return "\n".join([*heads, *kept, *parts])

    def keep(self, text: str) -> str:
        """The name of a constant."""
        name = _named("constant", text)
        self.constants[name] = text
        return f'@"{name}"'

    def call(self, text: Text, function: FunctionType, given: list[Value]) -> Value:
        """Call a kernel. Raises Untranslatable, TranslationError."""
        if not hasattr(function, "compiled_as"):
            raise Untranslatable(f"{getattr(function, '__name__', function)} is no kernel")
        key = (function, tuple(value.kind for value in given))
        if key not in self._known:
            self._known[key] = None
            self._known[key] = self._translate(function, key[1])
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

    def _translate(self, function: FunctionType, kinds: tuple[Kind, ...], entry: str = "") -> Known:
        """A function as a part, under the name of an entry or one with a hash."""
        tree = _trees(Path(function.__code__.co_filename))[function.__code__.co_firstlineno]
        one = Function(tree, function, kinds, self)
        try:
            one.translate()
        except Untranslatable as why:
            where = f"{function.__code__.co_filename}:{one.where}: {function.__name__}"
            raise TranslationError(f"{where}: {why}") from why
        assert one.returns is not None
        how = function.compiled_as  # type: ignore[attr-defined]
        before, after = _head(one, how)
        end = [] if one.text.ended else ["unreachable"]
        lines = ["{", "entry:", *one.rooms(), *one.text.lines, *end, "}"]
        body = "\n".join(lines)
        symbol = entry or _named(function.__name__, f"{how} {before} {after} {body}")
        is_large = len(lines) > LARGE and how not in ("inlined", "stage")
        self.parts[symbol] = Part(
            head=f'{before} @"{symbol}"{after}',
            body=body,
            references=tuple(dict.fromkeys(REFERENCE.findall(body))),
            is_first=is_large or how in ("entry", "apart"),
        )
        return Known(symbol, one.returns)


def _named(name: str, text: str) -> str:
    """A name that no other text has."""
    return f"{name}.{hashlib.sha256(text.encode()).hexdigest()[:20]}"


def _head(one: Function, how: str) -> tuple[str, str]:
    """What stands before and after the name of a function."""
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
    after = f"({given}) nounwind"
    after += " alwaysinline" * (how in ("inlined", "stage"))
    after += " noinline" * (how == "apart")
    return struct_of(one.returns.words), after


@cache
def _trees(path: Path) -> dict[int, ast.FunctionDef]:
    """Functions of a file by the line in which they, or their decorators, begin."""
    definitions: dict[int, ast.FunctionDef] = {}
    left: list[ast.AST] = [ast.parse(path.read_text("utf-8"), str(path))]
    while left:
        # statements alone: functions stand in no expression
        node = left.pop()
        left += [*getattr(node, "body", ()), *getattr(node, "orelse", ())]
        if isinstance(node, ast.FunctionDef):
            first = node.decorator_list[0].lineno if node.decorator_list else node.lineno
            definitions[first] = node
    return definitions


assert lanes
