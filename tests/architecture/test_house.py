"""Claim: the layers are those of ARCHITECTURE.md. Imports only go down, and never in a circle."""

import ast
from collections.abc import Iterator, Mapping
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from crashsolve.deck.family import families

ROOT = Path(__file__).resolve().parents[2]
SOLVER = ROOT / "solver" / "crashsolve"
POST = ROOT / "postproc" / "crashpost"

LAYERS = (
    ("foundation", "channels"),
    ("compiler",),
    # families state themselves what they are
    ("deck", "elements", *dict.fromkeys(f.folder.split("/")[0] for f in families().values())),
    ("model",),
    ("threads",),
    ("system",),
    ("integrators", "output", "statics"),
    ("recording",),
    ("study",),
    ("estimate",),
    ("simulation",),
    ("sweep", "photogrammetry"),
)
# the package's single files: the commands and the Python interface
TOP = len(LAYERS)
# packages of crashpost, each of which imports only those before it
POST_LAYERS = (
    *("results", "values", "figures", "renders", "compare", "exports", "sweeps", "reports"),
    "commands",
)
# every card is made of the deck's fields, so the families stand on deck/ although in its layer
SIDEWAYS = {(family, "deck") for family in LAYERS[2]}
SIDEWAYS |= {
    (name, other.partition("/")[0]) for name, family in families().items() for other in family.uses
}
# what elements are made of, and what is made of them
SIDEWAYS |= {("elements", "materials"), ("parts", "elements"), ("springs", "elements")}
FORBIDDEN = {"utils", "util", "helpers", "helper", "manager", "common", "misc"}
LONGEST_FUNCTION, LONGEST_FILE = 60, 450

MODULES = sorted(SOLVER.rglob("*.py"))


def package_of(name: str) -> str:
    """The package a module belongs to: crashsolve.contact.normal.hertz -> contact."""
    parts = name.split(".")
    return parts[1] if len(parts) > 1 else ""


def layer_of(name: str) -> int:
    for height, packages in enumerate(LAYERS):
        if package_of(name) in packages:
            return height
    return TOP


def module_name(path: Path, package: Path = SOLVER) -> str:
    parts = path.relative_to(package.parent).with_suffix("").parts
    return ".".join(part for part in parts if part != "__init__")


@cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


@cache
def imports(path: Path, types: bool = False) -> tuple[str, ...]:
    """Full names of all modules a file imports when it runs, at the top and within functions.

    With `types` also those that it names in annotations alone.
    """
    return tuple(_imports(path, types))


def _imports(path: Path, types: bool) -> Iterator[str]:
    nodes = list(ast.walk(tree_of(path)))
    for_types = {
        inner
        for node in nodes
        if isinstance(node, ast.If) and _last_name(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    for node in nodes:
        if node in for_types and not types:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _last_name(test: ast.expr) -> str:
    """Of `TYPE_CHECKING` and of `typing.TYPE_CHECKING` the word itself."""
    return getattr(test, "attr", getattr(test, "id", ""))


def functions(path: Path) -> Iterator[ast.FunctionDef]:
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.FunctionDef):
            yield node


def test_imports_only_go_down_the_layers() -> None:
    up = []
    for path in MODULES:
        here = module_name(path)
        for there in imports(path, types=True):
            pair = package_of(here), package_of(there)
            if not there.startswith("crashsolve.") or pair[0] == pair[1]:
                continue
            is_allowed = pair in SIDEWAYS or there == "crashsolve.__version__"
            if layer_of(there) >= layer_of(here) and layer_of(here) < TOP and not is_allowed:
                up.append(f"{here} imports {there}")
    assert not up, "\n".join(up)


def test_the_postprocessor_knows_the_solver_by_its_files_only() -> None:
    """Beside the files it knows what both say of channels, a leaf that imports nothing else."""
    shared = ("crashsolve.channels.", "crashsolve.__version__")
    for path in POST.rglob("*.py"):
        internal = [name for name in imports(path) if name.split(".")[0] == "crashsolve"]
        assert not [name for name in internal if not name.startswith(shared)], path
    for path in (SOLVER / "channels").rglob("*.py"):
        internal = [name for name in imports(path) if name.split(".")[0] == "crashsolve"]
        assert not [name for name in internal if not name.startswith("crashsolve.channels.")], path
    for path in MODULES:
        assert not [name for name in imports(path) if name.split(".")[0] == "crashpost"], path


def test_every_package_of_the_solver_has_its_layer() -> None:
    packages = {path.name for path in SOLVER.iterdir() if (path / "__init__.py").exists()}
    assert packages == {name for names in LAYERS for name in names}


def test_the_packages_of_the_postprocessor_have_an_order() -> None:
    assert {path.parent.name for path in POST.glob("*/__init__.py")} == set(POST_LAYERS)
    up = []
    for path in POST.glob("*/*.py"):
        height = POST_LAYERS.index(path.parent.name)
        for there in imports(path, types=True):
            package = there.split(".")[1] if there.startswith("crashpost.") else ""
            if package in POST_LAYERS and POST_LAYERS.index(package) > height:
                up.append(f"{module_name(path, POST)} imports {there}")
    assert not up, "\n".join(up)


@pytest.mark.parametrize("package", [SOLVER, POST], ids=lambda path: path.name)
def test_no_modules_import_each_other_in_a_circle(package: Path) -> None:
    """Imports at the top of modules, within functions, and for types alone; without exceptions.

    Who needs no more of another than some attributes states a Protocol of them.
    """
    paths = {module_name(path, package): path for path in package.rglob("*.py")}
    graph = {
        name: {
            known
            for there in imports(path, types=True)
            if (known := _module(there, paths)) not in (None, name)
        }
        for name, path in paths.items()
    }
    TopologicalSorter(graph).prepare()


def _module(name: str, known: Mapping[str, Path]) -> str | None:
    """The module that an imported name is, or belongs to."""
    return next((n for n in (name, name.rpartition(".")[0]) if n in known), None)


@pytest.mark.parametrize("package", [SOLVER, POST], ids=lambda path: path.name)
def test_no_module_has_a_generic_name(package: Path) -> None:
    assert not [path for path in package.rglob("*.py") if path.stem.strip("_") in FORBIDDEN]


@pytest.mark.parametrize("package", [SOLVER, POST], ids=lambda path: path.name)
def test_functions_are_short(package: Path) -> None:
    long = [
        f"{path.relative_to(ROOT)}:{node.lineno} {node.name}, {node.end_lineno - node.lineno + 1}"
        for path in package.rglob("*.py")
        for node in functions(path)
        if node.end_lineno is not None and node.end_lineno - node.lineno >= LONGEST_FUNCTION
    ]
    assert not long, "\n".join(long)


@pytest.mark.parametrize("package", [SOLVER, POST], ids=lambda path: path.name)
def test_files_are_short(package: Path) -> None:
    lines = {path: len(path.read_text("utf-8").splitlines()) for path in package.rglob("*.py")}
    long = [f"{p.relative_to(ROOT)}: {n} lines" for p, n in lines.items() if n > LONGEST_FILE]
    assert not long, "\n".join(long)


@pytest.mark.parametrize("package", [SOLVER, POST], ids=lambda path: path.name)
def test_every_module_has_a_docstring(package: Path) -> None:
    assert not [path for path in package.rglob("*.py") if not _docstring(path)]


def _docstring(path: Path) -> str | None:
    return ast.get_docstring(ast.parse(path.read_text("utf-8")))
