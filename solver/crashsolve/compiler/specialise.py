"""Specialise: one module of just those functions that a scene needs, each a copy for that scene.

A loop is ordinary Python over placeholders, names that stand for the groups of a scene. They are
known before anything is compiled, so a copy of the function can be made in which

    for group in GROUPS:        stands once for every group
    if group.is_flat:           is removed, or only its body remains
    group.law.force(...)        is a call of the kernel in the group's own module
    group.history               is a table of the scene, of those the group names in TABLES
    pairs(group, clock, scene)  calls a copy of `pairs` for that group

What depends on no placeholder is copied as it is, with its comments. All of this works on the
syntax tree and knows no mechanics: the placeholders, and the modules that are copied instead
of imported, come from the caller (system/compose.py).
"""

import ast
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any, Protocol

# functions that may be called with placeholders
BUILTINS: dict[str, Callable[..., object]] = {
    f.__name__: f for f in (all, any, bool, enumerate, getattr, hasattr, len, range, zip)
}
# the argument whose attributes are the scene's tables
TABLES = "scene"


class SpecialiseError(Exception):
    """A loop that uses a missing attribute of a placeholder, or cannot be copied: a programming
    error.
    """


class _Unknown(Exception):
    """The value of an expression is not known before the step runs."""


@dataclass(frozen=True)
class Table:
    """A table of the scene, by its name."""

    name: str


@dataclass
class Source:
    """A file whose functions are copied."""

    module: str
    lines: list[str]
    functions: dict[str, ast.FunctionDef] = field(default_factory=dict)
    constants: dict[str, ast.stmt] = field(default_factory=dict)
    imports: dict[str, tuple[str, str]] = field(default_factory=dict)  # module and name there


class Program(Protocol):
    """The module that copies become part of, see program.py."""

    home: str  # module from which loops import placeholders
    placeholders: dict[str, object]
    empty: set[str]  # copies that do nothing

    def find(self, source: Source, name: str) -> tuple[str, str] | None:
        """Module and name of a function that is copied; None for any other."""

    def source(self, module: str) -> Source:
        """The file of a module."""

    def add(self, module: str, name: str, bound: dict[str, object] | None = None) -> str:
        """Name of a copy with some arguments bound."""

    def alias(self, module: ModuleType) -> str:
        """Name of an imported module."""


class Copy(ast.NodeTransformer):
    """A copy of one function for given values of some of its arguments."""

    def __init__(
        self, program: Program, source: Source, function: ast.FunctionDef, bound: dict[str, object]
    ) -> None:
        self.program, self.source = program, source
        self.known = dict(bound)
        self.where = f"{source.module}.{function.name}"
        self.unknown = {a.arg for a in function.args.args} | assigned_in(function)
        self.function = copied(function)
        args = self.function.args
        args.args = [a for a in args.args if a.arg not in bound]
        self.function.body = self.block(self.function.body) or [ast.Pass()]

    # values that are known before the step runs

    def value(self, node: ast.expr) -> Any:
        """Value of an expression. Raises _Unknown where only the running step knows it."""
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name):
            return self._value_of_name(node.id)
        if isinstance(node, ast.Attribute):
            return self._value_of_attribute(self.value(node.value), node.attr)
        if isinstance(node, ast.Tuple):
            return tuple(map(self.value, node.elts))
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Attribute):
            entries = self.value(node.value)
            if isinstance(entries, tuple):
                return entries[self.value(node.slice)]
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return not self.value(node.operand)
        if isinstance(node, ast.BoolOp):
            return self._value_of_choice(node)
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            return self._value_of_comparison(node)
        if isinstance(node, ast.Call) and not node.keywords:
            return self._value_of_call(node)
        raise _Unknown

    def _value_of_name(self, name: str) -> object:
        if name in self.known:
            return self.known[name]
        if not self._is_placeholder(name):
            raise _Unknown
        original = self.source.imports[name][1]
        if original not in self.program.placeholders:
            raise SpecialiseError(f"{self.where}: nothing stands for the placeholder {original}")
        return self.program.placeholders[original]

    def _is_placeholder(self, name: str) -> bool:
        imported = self.source.imports.get(name)
        return (
            imported is not None and imported[0] == self.program.home and name not in self.unknown
        )

    def _value_of_attribute(self, value: Any, name: str) -> object:
        if isinstance(value, (Table, int, float, tuple)):
            raise _Unknown
        if isinstance(value, ModuleType):
            attribute = getattr(value, name, None)
            if isinstance(attribute, (bool, int, float, str)):
                return attribute
            raise _Unknown
        try:
            attribute = getattr(value, name)
        except AttributeError:
            message = f"{self.where}: group {word_of(value)} has no '{name}'"
            raise SpecialiseError(message) from None
        if attribute is None or name not in value.TABLES:
            return attribute
        word = f"{value.word}_{name}"
        if isinstance(attribute, tuple):
            return tuple(Table(f"{word}_{k}") for k in range(len(attribute)))
        return Table(word)

    def _value_of_choice(self, node: ast.BoolOp) -> object:
        is_and, value = isinstance(node.op, ast.And), None
        for part in node.values:
            value = self.value(part)
            if bool(value) != is_and:
                break
        return value

    def _value_of_comparison(self, node: ast.Compare) -> bool:
        left, right = self.value(node.left), self.value(node.comparators[0])
        match node.ops[0]:
            case ast.Is():
                return left is right
            case ast.IsNot():
                return left is not right
            case ast.Eq():
                return left == right
            case ast.NotEq():
                return left != right
            case ast.Gt():
                return left > right
        raise _Unknown

    def _value_of_call(self, node: ast.Call) -> object:
        if isinstance(node.func, ast.Name) and node.func.id in BUILTINS:
            return BUILTINS[node.func.id](*map(self.value, node.args))
        raise _Unknown

    def known_value(self, node: ast.expr) -> tuple[bool, Any]:
        """Whether an expression depends on placeholders alone, and its value."""
        if not any(name in self.known or self._is_placeholder(name) for name in names_in(node)):
            return False, None
        try:
            return True, self.value(node)
        except _Unknown:
            return False, None

    def rendered(self, value: object) -> ast.expr:
        """A known value as an expression of the copy."""
        if value is None or isinstance(value, (bool, int, float, str)):
            return ast.Constant(value)
        if isinstance(value, Table):
            if TABLES not in self.unknown:
                raise SpecialiseError(f"{self.where}: its tables need an argument '{TABLES}'")
            return ast.Attribute(ast.Name(TABLES, ast.Load()), value.name, ast.Load())
        if isinstance(value, ModuleType):
            return ast.Name(self.program.alias(value), ast.Load())
        if isinstance(value, tuple):
            return ast.Tuple([self.rendered(part) for part in value], ast.Load())
        raise SpecialiseError(f"{self.where}: a {type(value).__name__} cannot be used in a step")

    # statements and expressions

    def block(self, body: list[ast.stmt]) -> list[ast.stmt]:
        """The statements that are left."""
        statements: list[ast.stmt] = []
        for node in body:
            new = self.visit(node)
            statements += new if isinstance(new, list) else [new]
            if statements and isinstance(statements[-1], (ast.Return, ast.Continue, ast.Break)):
                break
        return statements

    def visit(self, node: ast.AST) -> Any:
        """Copy a statement or an expression."""
        # an operator or the context of a name has no fields
        if not node._fields or isinstance(node, ast.Constant):
            return node
        if isinstance(node, ast.expr) and not isinstance(getattr(node, "ctx", None), ast.Store):
            is_known, value = self.known_value(node)
            if is_known:
                return self.rendered(value)
        return node if isinstance(node, ast.Name) else super().visit(node)

    def visit_If(self, node: ast.If) -> ast.If | list[ast.stmt]:
        test = self._condition(node.test)
        if isinstance(test, bool):
            return self.block(node.body if test else node.orelse)
        node.test = test
        node.body, node.orelse = self.block(node.body) or [ast.Pass()], self.block(node.orelse)
        return node

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        test = self._condition(node.test)
        if isinstance(test, bool):
            return self.visit(node.body if test else node.orelse)
        node.test, node.body, node.orelse = test, self.visit(node.body), self.visit(node.orelse)
        return node

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        test = self._condition(node)
        return ast.Constant(test) if isinstance(test, bool) else test

    def _condition(self, node: ast.expr) -> ast.expr | bool:
        """The unknown part of a condition, or its value."""
        is_known, value = self.known_value(node)
        if is_known:
            return bool(value)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            inner = self._condition(node.operand)
            return not inner if isinstance(inner, bool) else ast.UnaryOp(node.op, inner)
        if not isinstance(node, ast.BoolOp):
            visited: ast.expr = self.visit(node)
            return visited
        is_and, left = isinstance(node.op, ast.And), []
        for part in map(self._condition, node.values):
            if not isinstance(part, bool):
                left.append(part)
            elif part != is_and:
                if not any(isinstance(n, ast.Call) for value in left for n in ast.walk(value)):
                    return part
                # statements before it may write
                left.append(ast.Constant(part))
                break
        if not left:
            return is_and
        return left[0] if len(left) == 1 else ast.BoolOp(node.op, left)

    def visit_While(self, node: ast.While) -> ast.While:
        test = self._condition(node.test)
        node.test = ast.Constant(test) if isinstance(test, bool) else test
        node.body = self.block(node.body) or [ast.Pass()]
        return node

    def visit_For(self, node: ast.For) -> ast.For | list[ast.stmt]:
        is_known, values = self.known_value(node.iter)
        if not is_known:
            node.iter = self.visit(node.iter)
            node.body = self.block(node.body) or [ast.Pass()]
            return node
        if any(isinstance(n, (ast.Break, ast.Continue)) for n in _of_this_loop(node.body)):
            raise SpecialiseError(f"{self.where}: a loop over groups cannot be left or cut short")
        statements: list[ast.stmt] = []
        outside = dict(self.known)
        for value in values:
            self._bind(node.target, value)
            statements += self.block(copied(node.body))
        self.known = outside
        return statements

    def _bind(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Tuple):
            for part, inner in zip(target.elts, value, strict=True):
                self._bind(part, inner)
        elif isinstance(target, ast.Name):
            self.known[target.id] = value

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | list[ast.stmt]:
        node.value = self.visit(node.value)
        match node.value:
            case ast.Call(func=ast.Name(id=word)) if word in self.program.empty:
                return []
        return node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        definition = None
        if isinstance(node.func, ast.Name) and node.func.id not in self.unknown:
            definition = self.program.find(self.source, node.func.id)
        if definition is None:
            return self.generic_visit(node)
        module, name = definition
        names = [a.arg for a in self.program.source(module).functions[name].args.args]
        bound, given = {}, []
        for word, argument in zip(names, node.args, strict=True):
            is_known, value = self.known_value(argument)
            if is_known and _is_bound(value):
                bound[word] = value
            else:
                given.append(self.visit(argument))
        word = self.program.add(module, name, bound)
        return ast.Call(ast.Name(word, ast.Load()), given, [])


def _is_bound(value: object) -> bool:
    """Whether a value is no argument of a compiled function: there is a copy for it instead."""
    return not (value is None or isinstance(value, (bool, int, float, str, Table, tuple)))


def copied(tree: Any) -> Any:
    """A copy of a syntax tree, or of a list of trees: copy.deepcopy takes ten times as long."""
    if isinstance(tree, list):
        return [copied(part) for part in tree]
    # operators and contexts of names have no fields: one serves all
    if not isinstance(tree, ast.AST) or not tree._fields:
        return tree
    new = tree.__class__.__new__(tree.__class__)
    fields = vars(new)
    fields.update(vars(tree))
    for name in tree._fields:
        part = fields.get(name)
        if isinstance(part, (ast.AST, list)):
            fields[name] = copied(part)
    return new


def walk(tree: ast.AST) -> list[ast.AST]:
    """The nodes of a syntax tree, level by level as of ast.walk, in a quarter of its time."""
    nodes = [tree]
    for node in nodes:
        for part in vars(node).values():
            if isinstance(part, ast.AST):
                nodes.append(part)
            elif type(part) is list:
                nodes += [inner for inner in part if isinstance(inner, ast.AST)]
    return nodes


def names_in(tree: ast.AST) -> set[str]:
    """Names that a syntax tree uses. They are found once: a copy has those of its tree.

    A tree that is changed may lose names, which does no harm where each is then asked about.
    """
    names: set[str] | None = getattr(tree, "names_in_it", None)
    if names is None:
        names = {tree.id} if isinstance(tree, ast.Name) else set()
        for part in vars(tree).values():
            for inner in part if type(part) is list else (part,):
                if isinstance(inner, ast.AST):
                    names |= names_in(inner)
        tree.names_in_it = names  # type: ignore[attr-defined]
    return names


def are_same(one: Any, other: Any) -> bool:
    """Whether two syntax trees, or lists of trees, say the same."""
    if type(one) is not type(other):
        return False
    if isinstance(one, list):
        return len(one) == len(other) and all(map(are_same, one, other))
    if not isinstance(one, ast.AST):
        return bool(one == other)
    return all(are_same(getattr(one, f, None), getattr(other, f, None)) for f in one._fields)


def word_of(value: Any) -> str:
    """Name of the argument that a copy is specialised for."""
    if isinstance(value, ModuleType):
        return value.__name__.rpartition(".")[2].strip("_")
    return str(value.word)


def assigned_in(tree: ast.AST) -> set[str]:
    """Names that are given a value; found once for a tree."""
    assigned: set[str] | None = getattr(tree, "assigned_in_it", None)
    if assigned is None:
        names = (n for n in walk(tree) if isinstance(n, ast.Name))
        assigned = {n.id for n in names if isinstance(n.ctx, ast.Store)}
        tree.assigned_in_it = assigned  # type: ignore[attr-defined]
    return assigned


def _of_this_loop(body: list[ast.stmt]) -> Iterable[ast.AST]:
    """Statements of a loop, those of loops within it left out."""
    for node in body:
        yield node
        if not isinstance(node, (ast.For, ast.While)):
            inner = [n for n in ast.iter_child_nodes(node) if isinstance(n, ast.stmt)]
            yield from _of_this_loop(inner)
