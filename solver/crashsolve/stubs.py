"""Types of the rows that kernels are given, for editors and type checkers: a stub for every law.

`python -m crashsolve.stubs` writes `FAMILY/_rows/LAW.pyi` beside the law, with the columns of its
records as attributes. No run reads them: a law imports them under TYPE_CHECKING.
"""

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

from crashsolve.deck.family import families
from crashsolve.foundation.record import Column, Record
from crashsolve.model.contact import records as contact
from crashsolve.model.force_columns import FORCE_HISTORY, FORCE_OUTPUT, ROW_PARAMETERS

PACKAGE = Path(__file__).resolve().parent
SHARED_PATH = PACKAGE / "_shared_rows.pyi"
HEAD = "# written by `python -m crashsolve.stubs` from the records of the law"
RECORDS = {"Parameters": "PARAMETERS", "History": "HISTORY", "Output": "OUTPUT"}
SHARED = {
    "RowParameters": ROW_PARAMETERS,
    "ForceHistory": FORCE_HISTORY,
    "ForceOutput": FORCE_OUTPUT,
    "ContactParameters": contact.PARAMETERS,
    "ContactHistory": contact.HISTORY,
    "ContactOutput": contact.OUTPUT,
}
# where the names are that a stub imports
HOMES = {
    "typing": {"Protocol"},
    "crashsolve._shared_rows": {*SHARED},
    "crashsolve.foundation.rows": {"Numbers", "Row"},
}


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


def bases(law: ModuleType) -> dict[str, str]:
    """Classes of SHARED that have the columns of a law beside its own, by those of its stub."""
    if hasattr(law, "CALLS_MATERIAL"):
        # columns of a material are known once the deck names it
        return dict.fromkeys(RECORDS, "Row, Protocol")
    if hasattr(law, "normal_force") or hasattr(law, "friction_force"):
        return {name: f"Contact{name}" for name in RECORDS}
    found = {"Parameters": "RowParameters"} if hasattr(law, "CONSTRAINTS") else {}
    if hasattr(law, "force"):
        found |= {name: f"Force{name}" for name in ("History", "Output")}
    return found


def stub(law: ModuleType) -> str:
    """Text of the stub of a law."""
    own, classes = bases(law), []
    for name, word in RECORDS.items():
        record = getattr(law, word, Record())
        if record.columns or name in own:
            classes.append(_class(name, record, own.get(name, "")))
    return _file(classes)


def shared_stub() -> str:
    """Text of the stub of the columns that many laws have beside their own."""
    return _file([_class(name, record, "") for name, record in SHARED.items()])


def _class(name: str, record: Record, base: str) -> str:
    head = f"class {name}({base}):" if base else f"class {name}:"
    return "\n".join(
        [head, *map(_attribute, record.columns)] if record.columns else [f"{head} ..."]
    )


def _file(classes: list[str]) -> str:
    text = "\n\n".join(classes)
    words = {*re.findall(r"[A-Z]\w+", re.sub(r"#.*", "", text))}
    imports = [
        f"from {home} import {', '.join(found)}"
        for home, names in HOMES.items()
        if (found := sorted(words & names - {*re.findall(r"class (\w+)", text)}))
    ]
    return "\n".join([HEAD, *imports, "", text, ""])


def _attribute(column: Column) -> str:
    kind = "int" if column.is_integer else "float"
    type_ = kind if column.size == 1 else f"Numbers[{kind}]"
    return f"    {column.name}: {type_}  # [{column.unit}] {column.meaning}"


def write() -> None:
    """Write the stubs of all laws."""
    SHARED_PATH.write_text(shared_stub(), "utf-8")
    for path, law in laws():
        path.parent.mkdir(exist_ok=True)
        path.write_text(stub(law), "utf-8")


if __name__ == "__main__":
    write()
