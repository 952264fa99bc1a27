"""Whether two versions of the solver compose the same steps, and write the same bits.

    python tests/architecture/identity.py steps FOLDER            composed steps of all decks
    python tests/architecture/identity.py results FOLDER [DECK]   hashes after some steps
    python tests/architecture/identity.py compare A B             what differs between two folders

The first two look at the package on PYTHONPATH; run them before a change and after it, the second
also with CRASHSOLVE_PLAIN=1, which compiles nothing. Steps are compared as syntax trees in a
normal form: what a condition excludes is left out, as are functions that nothing calls, and stages
are part of what calls them; names of local variables, modules and tables do not count. Where the
normal forms agree, so do the bits, and nothing need be run.
"""

import ast
import contextlib
import copy
import hashlib
import json
import math
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
METHODS = ("rattle", "dormand_prince_5", "dormand_prince_8", "radau_iia_5", "generalized_alpha")
SETTINGS = [
    {},
    *({"control.integrator": name, "control.step": "auto"} for name in METHODS),
    {"control.threads": "2"},
]
# decks that together have every loop of the step in it, with settings that they run with
BATTERY = {
    "tutorial/bouncing_ball": 500,
    "tutorial/bouncing_ball 2": 60,
    "tutorial/bouncing_ball 4": 40,
    "benchmark/andrews_squeezer": 20,
    "benchmark/andrews_squeezer 1": 20,
    "benchmark/box_stack": 5,
    "scenes/beam_impact_4_continuous": 20,
    "scenes/train_test": 30,
    "verification/contact/drops": 60,
    "verification/contact/edged_shapes": 40,
    "verification/contact/faces": 20,
    "verification/contact/faces_continuous": 10,
    "verification/contact/faces_ellipsoid": 30,
    "verification/contact/faces_failing": 20,
    "verification/contact/faces_friction": 30,
    "verification/contact/flat_on_flat": 40,
    "verification/contact/flat_on_flat 3": 10,
    "verification/contact/flat_on_flat 4": 10,
    "verification/contact/kept_face": 60,
    "verification/contact/unilateral": 60,
    "verification/friction/bristle": 60,
    "verification/friction/stribeck 4": 30,
    "verification/hinges/loops": 60,
    "verification/hinges/portal": 40,
    "verification/hinges/stops": 40,
    "verification/joints/screw": 40,
    "verification/joints/translation_driver": 40,
    "verification/joints/translation_stop": 60,
    "verification/joints/rotation_friction": 40,
    "verification/joints/rotation_stop": 60,
    "verification/joints/universal 2": 40,
    "verification/joints/weld": 40,
    "verification/parts/fibre_beam": 40,
    "verification/parts/fibre_implicit": 4,
    "verification/parts/shell_blast": 10,
    "verification/parts/shell_blast 6": 10,
    "verification/parts/shell_cut": 5,
    "verification/parts/shell_implicit": 2,
    "verification/parts/shell_triangles": 3,
    "verification/parts/welded": 40,
    "verification/springs/brake": 40,
    "verification/springs/bushing": 40,
    "verification/springs/curve": 60,
    "verification/springs/curve_torsional": 60,
    "verification/springs/damper": 60,
}
# names of tables in older versions
SHORT = {
    "powers": "w",
    "parameters": "p",
    "history": "h",
    "output": "o",
    "elements_a": "a",
    "elements_b": "b",
}


def steps(folder: Path) -> None:
    """Write the text of the composed step of every deck with every setting."""
    from crashsolve.deck.reading.deck import read_deck
    from crashsolve.foundation.errors import DeckErrors
    from crashsolve.model.build import build
    from crashsolve.system.compose import compose

    folder.mkdir(parents=True, exist_ok=True)
    for path in sorted((ROOT / "decks").rglob("*.yaml")):
        for number, setting in enumerate(SETTINGS):
            name = f"{'.'.join(path.relative_to(ROOT / 'decks').with_suffix('').parts)}.{number}.py"
            try:
                text = compose(build(read_deck(path, setting))[0])
            except DeckErrors:
                continue
            (folder / name).write_text(text, "utf-8")


class Folded(ast.NodeTransformer):
    """A function without what its constants exclude, its names in a normal form."""

    def __init__(self, constants: dict[str, Any], names: dict[str, str]) -> None:
        self.constants, self.names = constants, names
        self.locals: dict[str, str] = {}

    def normal(self, function: ast.FunctionDef) -> ast.FunctionDef:
        bound = {a.arg for a in function.args.args}
        for node in ast.walk(function):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                bound.add(node.id)
        function.body = self.block(function.body)
        for node in ast.walk(function):
            name = node.arg if isinstance(node, ast.arg) else getattr(node, "id", None)
            if name in bound:
                self.locals.setdefault(name, f"v{len(self.locals)}")
        for node in ast.walk(function):
            if isinstance(node, ast.arg):
                node.arg = self.locals[node.arg]
            elif isinstance(node, ast.Name):
                if node.id in bound:
                    node.id = self.locals[node.id]
                elif node.id in self.constants:
                    node.id = f"{self.constants[node.id]!r}"
                else:
                    node.id = self.names.get(node.id, node.id)
            elif isinstance(node, ast.Attribute):
                head, _, tail = node.attr.rpartition("_")
                for long, short in SHORT.items():
                    if node.attr.endswith(f"_{long}"):
                        node.attr = f"{node.attr.removesuffix(long)}{short}"
        return function

    def block(self, body: list[ast.stmt]) -> list[ast.stmt]:
        """Statements that are reached."""
        statements: list[ast.stmt] = []
        for node in body:
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
                continue
            if isinstance(node, ast.Pass):
                continue
            new = self.visit(node)
            statements += new if isinstance(new, list) else [new]
            if statements and isinstance(statements[-1], (ast.Return, ast.Continue, ast.Break)):
                break
        return statements

    def visit_If(self, node: ast.If) -> ast.If | list[ast.stmt]:
        test, decided = self.decide(node.test)
        if decided is not None:
            return self.block(node.body if decided else node.orelse)
        node.test, node.body, node.orelse = test, self.block(node.body), self.block(node.orelse)
        return node

    def visit_For(self, node: ast.For) -> ast.For | list[ast.stmt]:
        node.body = self.block(node.body)
        return node

    def visit_While(self, node: ast.While) -> ast.AST:
        node.body = self.block(node.body)
        return node

    def decide(self, test: ast.expr) -> tuple[ast.expr, bool | None]:
        """A condition without its known parts, and what it comes to if that is known."""
        if isinstance(test, ast.Name) and isinstance(self.constants.get(test.id), bool):
            return test, self.constants[test.id]
        if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
            _, known = self.decide(test.operand)
            return test, None if known is None else not known
        if isinstance(test, ast.BoolOp):
            is_and = isinstance(test.op, ast.And)
            left = []
            for value in test.values:
                value, known = self.decide(value)
                if known is None:
                    left.append(value)
                elif known != is_and:
                    return test, not is_and
            if not left:
                return test, is_and
            test.values = left
            return (left[0] if len(left) == 1 else test), None
        return test, None


class Inlined(ast.NodeTransformer):
    """A function with the text of its stages in place of their calls.

    Only where arguments have the names that the stage has for them, as they do in this package.
    """

    def __init__(self, stages: dict[str, ast.FunctionDef]) -> None:
        self.stages = stages

    def visit_Expr(self, node: ast.Expr) -> Any:
        return self.inlined(node, node.value, None)

    def visit_Assign(self, node: ast.Assign) -> Any:
        return self.inlined(node, node.value, node.targets[0])

    def block(self, body: list[ast.stmt]) -> list[ast.stmt]:
        """Statements with the stages that they call."""
        statements: list[ast.stmt] = []
        for node in body:
            new = self.visit(node)
            statements += new if isinstance(new, list) else [new]
        return statements

    def inlined(self, node: ast.stmt, call: ast.expr, target: ast.expr | None) -> Any:
        """The statements of a stage, and what takes what it returns."""
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
            return node
        function = self.stages.get(call.func.id)
        if function is None:
            return node
        body = copy.deepcopy(function.body)
        given = dict(zip((a.arg for a in function.args.args), call.args, strict=True))
        for inner in [n for statement in body for n in ast.walk(statement)]:
            for name, value in ast.iter_fields(inner):
                if isinstance(value, ast.Name) and isinstance(given.get(value.id), ast.Constant):
                    setattr(inner, name, given[value.id])
        names = [n for n, a in given.items() if not isinstance(a, ast.Constant)]
        if names != [a.id for a in call.args if isinstance(a, ast.Name)]:
            return node
        returns = [n for s in body for n in ast.walk(s) if isinstance(n, ast.Return)]
        if target is None:
            return node if returns else self.block(body)
        if len(returns) != 1 or returns[0] is not body[-1]:
            return node
        if ast.unparse(returns[0].value) == ast.unparse(target):
            return self.block(body[:-1])
        return node


def split(body: list[ast.stmt]) -> list[ast.stmt]:
    """Statements with those that assign several names at once taken apart."""
    statements: list[ast.stmt] = []
    for node in body:
        for name in ("body", "orelse"):
            if hasattr(node, name):
                setattr(node, name, split(getattr(node, name)))
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Tuple):
            target, value = node.targets[0], node.value
            if isinstance(value, ast.Tuple):
                pairs = zip(target.elts, value.elts, strict=True)
                statements += [ast.Assign([a], b, lineno=0) for a, b in pairs]
                continue
        statements.append(node)
    return statements


def short(name: str) -> str:
    """Name of a function as older versions have it."""
    for loop in ("contact_pairs", "node_to_surface", "node_to_shape", "find_touching"):
        name = name.removeprefix(f"{loop}_")
    return name


def normal_form(text: str) -> dict[str, str]:
    """Functions that `advance` and `assist` reach, as dumps, by their names.

    Stages are part of what calls them, where the two have the same names for what is handed over.
    """
    constants: dict[str, Any] = {"float": None}
    names: dict[str, str] = {}
    functions: dict[str, ast.FunctionDef] = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                word = alias.asname or alias.name
                module = import_module(node.module)
                value = getattr(module, alias.name, None)
                if isinstance(value, (bool, int, float, tuple)):
                    constants[word] = value
                names[word] = f"{getattr(value, '__module__', node.module)}.{alias.name}"
        elif isinstance(node, ast.Assign):
            # constants are arithmetic, with functions of math
            value = eval(
                compile(ast.Expression(node.value), "", "eval"), vars(math) | {}, constants
            )
            target = node.targets[0]
            if isinstance(target, ast.Tuple):
                constants |= {t.id: v for t, v in zip(target.elts, value, strict=True)}
            else:
                constants[target.id] = value
        elif isinstance(node, ast.FunctionDef):
            functions[node.name] = node
    for function in functions.values():
        function.body = Folded(constants, names).block(function.body)
    stages = {name: f for name, f in functions.items() if f.decorator_list[0].id == "stage"}
    texts: dict[str, str] = {}

    def dump(name: str) -> str:
        function = copy.deepcopy(functions[name])
        for _ in range(4):
            function = Inlined(stages).generic_visit(function)
        function.body = split(function.body)
        Folded(constants, names).normal(function)
        for node in ast.walk(function):
            if isinstance(node, ast.Name) and node.id in functions:
                if node.id not in texts:
                    dump(node.id)
                node.id = f"f_{short(node.id)}"
        function.name = short(name)
        texts[name] = ast.unparse(function)
        return texts[name]

    for name in ("advance", "assist"):
        if name in functions:
            dump(name)
    return texts


class Enough(Exception):
    """As many steps as are wanted."""


def results(folder: Path, decks: list[str]) -> None:
    """Take some steps of the decks of the battery, and write hashes of all that a run changes."""
    folder.mkdir(parents=True, exist_ok=True)
    for word, steps in BATTERY.items():
        path, _, number = word.partition(" ")
        name = f"{path.replace('/', '.')}.{number or 0}.json"
        if not decks or word in decks:
            state = state_after(ROOT / "decks" / f"{path}.yaml", SETTINGS[int(number or 0)], steps)
            (folder / name).write_text(json.dumps(state, indent=1), "utf-8")
            print(name, flush=True)


def state_after(path: Path, setting: dict[str, str], steps: int) -> dict[str, str]:
    """Hashes of the tables of a run after so many steps, and of a sample then."""
    from crashsolve.deck.reading.deck import read_deck
    from crashsolve.foundation.errors import SolverError
    from crashsolve.model.build import build
    from crashsolve.system.engine import Engine

    deck = read_deck(path, setting)
    model, state = build(deck)
    engine = Engine(model, state)
    engine.start()

    def count() -> None:
        engine._steps_per_call = 1
        if state.clock[0]["cycle"] >= steps:
            raise Enough

    engine.on_pause, engine._steps_per_call = count, 1
    with contextlib.suppress(Enough):
        engine.advance(deck.control.end_time)
    with contextlib.suppress(SolverError):
        engine.sample()
    tables = {
        name: getattr(state, name) for name in ("nodes", "rows", "ledger", "points", "blocks")
    }
    tables |= {"clock": state.clock, "cards": state.cards, "card_history": state.card_history}
    tables |= {"sampled": engine.nodes, "sampled_ledger": engine.ledger}
    for group in (*model.groups, *model.contact_groups):
        tables |= {f"{group.word}.h": group.history, f"{group.word}.o": group.output}
    for nodal in model.nodal_groups:
        tables |= {f"{nodal.word}.{name}": array for name, array in nodal.arrays.items()}
    hashes = {name: hashlib.sha1(table.tobytes()).hexdigest() for name, table in tables.items()}
    return hashes | {"cycles": str(state.clock[0]["cycle"])}


def compare(before: Path, after: Path) -> int:
    """Print what differs. Returns the number of files that do."""
    differing = 0
    for path in sorted(p for p in before.iterdir() if p.suffix in (".py", ".json")):
        other = after / path.name
        if not other.exists():
            print(f"{path.name}: missing")
            differing += 1
            continue
        texts = path.read_text("utf-8"), other.read_text("utf-8")
        if path.suffix == ".py":
            old, new = map(normal_form, texts)
        else:
            old, new = map(json.loads, texts)
        if path.suffix == ".py":
            # functions may have other names, and more may be stages of others
            wrong = sorted(k for k in old if old[k] not in new.values())
        else:
            wrong = sorted(k for k in {*old, *new} if old.get(k) != new.get(k))
        if wrong:
            print(f"{path.name}: {', '.join(wrong[:6])}{', ...' if len(wrong) > 6 else ''}")
            differing += 1
    print(f"{differing} differ")
    return differing


if __name__ == "__main__":
    what, *folders = sys.argv[1:]
    if what == "compare":
        sys.exit(compare(*map(Path, folders)) > 0)
    elif what == "steps":
        steps(Path(folders[0]))
    else:
        results(Path(folders[0]), folders[1:])
