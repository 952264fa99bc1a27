"""Program: the functions that some entry points reach, specialised, as one module.

Modules of some packages are copied, function by function, others are imported; every name has one
meaning. compiler/specialise.py states the values that replace placeholders.
"""

import ast
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from crashsolve.compiler.specialise import (
    Copy,
    Source,
    SpecialiseError,
    are_same,
    walk,
    word_of,
)


class Program:
    """Functions that some entry points reach, as the text of one module."""

    def __init__(
        self,
        placeholders: dict[str, object],
        home: str,
        is_copied: Callable[[str], bool],
        replaced: dict[str, str],
    ) -> None:
        """`placeholders`: values by name, of the names that loops import from module `home`;
        `is_copied`: whether the functions of a module are copied, others are imported;
        `replaced`: modules that stand in place of others.
        """
        self.placeholders, self.home = placeholders, home
        self.is_copied, self.replaced = is_copied, replaced
        self._sources: dict[str, Source] = {}
        # meaning of every name of the text
        self._meanings: dict[str, tuple[object, ...]] = {}
        self._imports: dict[str, tuple[str, str]] = {}
        self._parts: list[str] = []
        # copied objects must stay alive, because their identity is the key
        self._bound: list[object] = []
        # copies that are empty
        self.empty: set[str] = set()

    def text(self) -> str:
        """The module."""
        lines = [
            f"from {module} import {name}" + (f" as {word}" if word != name else "")
            for word, (module, name) in sorted(self._imports.items(), key=lambda item: item[1])
        ]
        return "\n".join(lines) + "\n\n\n" + "\n\n\n".join(self._parts) + "\n"

    def add(self, module: str, name: str, bound: dict[str, object] | None = None) -> str:
        """Copy a function with some arguments bound, and all that it needs; returns its name."""
        module = self.replaced.get(module, module)
        source, bound = self.source(module), bound or {}
        word = "_".join([name, *map(word_of, bound.values())])
        if self._is_new(word, (module, name, *map(id, bound.values()))):
            self._bound += bound.values()
            original = source.functions[name]
            function = Copy(self, source, original, bound).function
            function.name = word
            if all(map(_is_ineffective, function.body)):
                self.empty.add(word)
            else:
                self._resolve(source, function)
                self._parts.append(_written(source, original, function))
        return word

    def alias(self, module: ModuleType) -> str:
        """Import a module under the name that is its own and its folder's; returns that name."""
        package, _, leaf = module.__name__.rpartition(".")
        word = f"{package.rpartition('.')[2]}_{leaf}"
        self._import(word, package, leaf)
        return word

    def find(self, source: Source, name: str) -> tuple[str, str] | None:
        """Module and name of a function that is copied, where a name of a file means one."""
        if name in source.functions:
            return source.module, name
        module, original = source.imports.get(name, ("", ""))
        module = self.replaced.get(module, module)
        if module and self.is_copied(module):
            module_source = self.source(module)
            if original in module_source.functions:
                return module, original
        return None

    def source(self, module: str) -> Source:
        if module not in self._sources:
            self._sources[module] = read_source(module)
        return self._sources[module]

    def _resolve(self, source: Source, tree: ast.AST) -> None:
        """Copy the objects that a copied function or constant names."""
        nodes = walk(tree)
        names = [n for n in nodes if isinstance(n, ast.Name)]
        own = {n.arg for n in nodes if isinstance(n, ast.arg)}
        own |= {n.id for n in names if isinstance(n.ctx, ast.Store)}
        for name in dict.fromkeys(n.id for n in names):
            if name in own:
                continue
            if name in source.constants:
                self._constant(source, name)
            elif name in source.imports:
                module, original = source.imports[name]
                module = self.replaced.get(module, module)
                if self.is_copied(module):
                    # its functions are there already, by the visitor
                    if original in self.source(module).constants:
                        self._constant(self.source(module), original)
                else:
                    self._import(name, module, original)

    def _constant(self, source: Source, name: str) -> None:
        """Copy the statement that a constant is given its value by."""
        node = source.constants[name]
        if self._is_new(name, (source.module, name)):
            self._resolve(source, node)
            names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
            for word in names & {n for n, other in source.constants.items() if other is node}:
                self._is_new(word, (source.module, word))
            self._parts.append(ast.unparse(node))

    def _import(self, word: str, module: str, name: str) -> None:
        if self._is_new(word, (module, name)):
            self._imports[word] = (module, name)

    def _is_new(self, word: str, meaning: tuple[object, ...]) -> bool:
        """Whether a name of the text has no meaning yet. Raises SpecialiseError for two."""
        known = self._meanings.setdefault(word, meaning)
        if known is meaning:
            return True
        if known != meaning:
            raise SpecialiseError(f"'{word}' is {known[:2]} and {meaning[:2]} in one step")
        return False


def read_source(module: str) -> Source:
    """The parsed file of a module."""
    spec = find_spec(module)
    assert spec is not None and spec.origin is not None
    text = Path(spec.origin).read_text("utf-8")
    source = Source(module, text.splitlines())
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef):
            source.functions[node.name] = node
        elif isinstance(node, ast.Assign):
            names = (n.id for t in node.targets for n in ast.walk(t) if isinstance(n, ast.Name))
            source.constants |= dict.fromkeys(names, node)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                source.imports[alias.asname or alias.name] = (node.module, alias.name)
    return source


def _is_ineffective(node: ast.stmt) -> bool:
    """Whether a statement does nothing."""
    return isinstance(node, ast.Pass) or (
        isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    )


def _written(source: Source, original: ast.FunctionDef, function: ast.FunctionDef) -> str:
    """Text of a copied function under the name of its file; its own text where nothing changed."""
    header = f"# {source.module}\n"
    if not are_same(original, function):
        return header + ast.unparse(function)
    first = min([original.lineno, *(d.lineno for d in original.decorator_list)])
    return header + "\n".join(source.lines[first - 1 : original.end_lineno])
