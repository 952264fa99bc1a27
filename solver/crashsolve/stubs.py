"""Types of the rows that kernels are given, for editors and type checkers: a stub for every law.

`python -m crashsolve.stubs` writes `FAMILY/_rows/LAW.pyi` beside the law, with the columns of its
records as attributes. No run reads them: a law imports them under TYPE_CHECKING.
"""

import ast
import re
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType

from crashsolve.deck.family import families
from crashsolve.foundation.angles import ROTATION_ABOUT_AXIS
from crashsolve.foundation.record import Column, Record
from crashsolve.hinges import _joint as hinge
from crashsolve.hinges import _law as hinge_law
from crashsolve.joints import _card as joint
from crashsolve.loads._on_body import BODY_LOAD
from crashsolve.materials import _von_mises, elastic
from crashsolve.model.contact import records as contact
from crashsolve.model.force_columns import FORCE_HISTORY, FORCE_OUTPUT, ROW_PARAMETERS
from crashsolve.parts import beam
from crashsolve.springs import _between, _bristle, _joint, _range, _resistance, linear
from crashsolve.tyres import _road, _tyre

PACKAGE = Path(__file__).resolve().parent
SHARED_PATH = PACKAGE / "_shared_rows.pyi"
HEAD = "# written by `python -m crashsolve.stubs` from the records of the law"
RECORDS = {"Parameters": "PARAMETERS", "History": "HISTORY", "Output": "OUTPUT"}
# of a material, whose kernels take its row as `m`
RECORDS_OF_MATERIAL = {"Parameters": "PARAMETERS", "Solid": "SOLID"}
SHARED = {
    "RowParameters": ROW_PARAMETERS,
    "ForceHistory": FORCE_HISTORY,
    "ForceOutput": FORCE_OUTPUT,
    "ContactParameters": contact.PARAMETERS,
    "ContactHistory": contact.HISTORY,
    "ContactOutput": contact.OUTPUT,
}
# records that laws add to their own, the larger of two with common columns first
PARTS = {
    "HingeLaw": hinge_law.LAW,
    "HingePath": hinge_law.PATH,
    "HingeOutput": hinge.COMMON,
    "JointFrame": joint.FRAME,
    "JointPoints": joint.POINTS,
    "BodyLoad": BODY_LOAD,
    "RangeMoment": _range.MOMENT,
    "Resistance": _resistance.RESISTANCE,
    "Slider": _range.SLIDER,
    "Stops": _joint.STOPS,
    "Bristle": _bristle.BRISTLE,
    "JointPressure": _bristle.PRESSING,
    "SpringPoints": _between.POINTS,
    "JointSlide": _between.SLIDE,
    "SpringOutput": linear.OUTPUT,
    "FullTurn": ROTATION_ABOUT_AXIS,
    "BeamElement": beam.ELEMENT,
    "BeamOutput": beam.OUTPUT,
    "Tyre": _tyre.TYRE,
    "TyreDeflection": _tyre.CARCASS,
    "TyreForces": _tyre.FORCES_OF_TYRE,
    "Roads": _road.ROADS,
    "VonMisesMetal": _von_mises.PARAMETERS,
    "ElasticMaterial": elastic.PARAMETERS,
    "VonMisesSolid": _von_mises.SOLID,
    "ElasticSolid": elastic.SOLID,
}
# where the names are that a stub imports
HOMES = {
    "typing": {"Protocol"},
    "crashsolve._shared_rows": {*SHARED, *PARTS},
    "crashsolve.foundation.rows": {"Numbers", "Row"},
}


def laws() -> Iterator[tuple[Path, ModuleType]]:
    """Path of the stub of every law with kernels of a row `p`, or `m`, and its module."""
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
    first = {function.args.args[0].arg for function in functions if function.args.args}
    return "p" in first or ("m" in first and path.parent.name == "materials")


def bases(law: ModuleType) -> dict[str, str]:
    """Classes of SHARED that have the columns of a law beside its own, by those of its stub."""
    if hasattr(law, "CALLS_MATERIAL"):
        # columns of a material are known once the deck names it
        return dict.fromkeys(RECORDS, "Row, Protocol")
    if hasattr(law, "normal_force") or hasattr(law, "friction_force"):
        return {name: f"Contact{name}" for name in RECORDS}
    names_of_bases = {"Parameters": "RowParameters"} if hasattr(law, "CONSTRAINTS") else {}
    if hasattr(law, "force"):
        names_of_bases |= {name: f"Force{name}" for name in ("History", "Output")}
    return names_of_bases


def stub(law: ModuleType) -> str:
    """Text of the stub of a law."""
    own, classes = bases(law), []
    for name, word in (RECORDS_OF_MATERIAL if hasattr(law, "SOLID") else RECORDS).items():
        record = getattr(law, word, Record())
        if record.columns or name in own:
            classes.append(_class(name, *_divided(record, own.get(name, ""))))
    return _file(classes)


def _divided(record: Record, base: str) -> tuple[list[Column], str]:
    """Columns of a record that are in none of PARTS, and its bases: `base`, and those of PARTS."""
    columns, names_of_bases = [*record.columns], [base] if base else []
    for name, part in PARTS.items() if "Protocol" not in base else ():
        if {*part.columns} <= {*columns}:
            columns = [column for column in columns if column not in part.columns]
            names_of_bases.append(name)
    return columns, ", ".join(names_of_bases)


def shared_stub() -> str:
    """Text of the stub of the columns that many laws have beside their own."""
    return _file([_class(name, r.columns, "") for name, r in {**SHARED, **PARTS}.items()])


def _class(name: str, columns: Sequence[Column], base: str) -> str:
    head = f"class {name}({base}):" if base else f"class {name}:"
    return "\n".join([head, *map(_attribute, columns)] if columns else [f"{head} ..."])


def _file(classes: list[str]) -> str:
    text = "\n\n".join(classes)
    words = {*re.findall(r"[A-Z]\w+", re.sub(r"#.*", "", text))}
    imports = [
        f"from {home} import {', '.join(used)}"
        for home, names in HOMES.items()
        if (used := sorted(words & names - {*re.findall(r"class (\w+)", text)}))
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
