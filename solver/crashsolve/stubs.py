"""Types of the rows that kernels are given, for editors and type checkers: a stub for every law.

`python -m crashsolve.stubs` writes `FAMILY/_rows/LAW.pyi` beside the law, with the columns of its
records as attributes. No run reads them: a law imports them under TYPE_CHECKING.
"""

import ast
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

from crashsolve.deck.family import families
from crashsolve.foundation.record import Column, Record
from crashsolve.model.contact import records as contact
from crashsolve.model.force_columns import FORCE_HISTORY, FORCE_OUTPUT, ROW_PARAMETERS

PACKAGE = Path(__file__).resolve().parent
HEAD = "# written by `python -m crashsolve.stubs` from the records of the law"
COLUMNS = "from crashsolve.foundation.rows import"


def laws() -> Iterator[tuple[Path, ModuleType]]:
    """Path of the stub of every law with kernels of a row `p`, and its module."""
    for folder in dict.fromkeys(family.folder for family in families().values()):
        for path in sorted((PACKAGE / folder).glob("*.py")):
            if _has_kernels(path):
                law = import_module(".".join(("crashsolve", *Path(folder).parts, path.stem)))
                if isinstance(getattr(law, "PARAMETERS", None), Record):
                    yield path.parent / "_rows" / f"{path.stem}.pyi", law


def _has_kernels(path: Path) -> bool:
    """Whether functions of a file take a row of parameters first."""
    tree = ast.parse(path.read_text("utf-8"))
    functions = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    return any(function.args.args and function.args.args[0].arg == "p" for function in functions)


def _shared(law: ModuleType) -> tuple[Record, Record, Record]:
    """Columns of parameters, history and output that the law has beside its own."""
    if hasattr(law, "force"):
        has_rows = hasattr(law, "CONSTRAINTS")
        return ROW_PARAMETERS if has_rows else Record(), FORCE_HISTORY, FORCE_OUTPUT
    if hasattr(law, "normal_force") or hasattr(law, "friction_force"):
        return contact.PARAMETERS, contact.HISTORY, contact.OUTPUT
    return ROW_PARAMETERS if hasattr(law, "CONSTRAINTS") else Record(), Record(), Record()


def stub(law: ModuleType) -> str:
    """Text of the stub of a law."""
    names = {"Parameters": "PARAMETERS", "History": "HISTORY", "Output": "OUTPUT"}
    # those of a material are known once the deck names it
    base = "(Row, Protocol)" if hasattr(law, "CALLS_MATERIAL") else ""
    classes = []
    for (name, word), shared in zip(names.items(), _shared(law), strict=True):
        columns = (getattr(law, word, Record()) + shared).columns
        if columns:
            classes.append("\n".join([f"class {name}{base}:", *map(_attribute, columns)]))
    text = "\n\n".join(classes)
    used = [word for word in ("Numbers", "Row") if f"{word}[" in text or f"({word}, " in text]
    imports = ["from typing import Protocol\n"] if base else []
    imports += [f"{COLUMNS} {', '.join(used)}"] if used else []
    return "\n".join([HEAD, *imports, "", text, ""])


def _attribute(column: Column) -> str:
    kind = "int" if column.is_integer else "float"
    type_ = kind if column.size == 1 else f"Numbers[{kind}]"
    return f"    {column.name}: {type_}  # [{column.unit}] {column.meaning}"


def write() -> None:
    """Write the stubs of all laws."""
    for path, law in laws():
        path.parent.mkdir(exist_ok=True)
        path.write_text(stub(law), "utf-8")


if __name__ == "__main__":
    write()
