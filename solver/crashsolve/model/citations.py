"""Citations of a run: the references in the docstrings of exactly the laws it uses."""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from crashsolve.model.contact.groups import Touching
    from crashsolve.model.model import Group

PARAGRAPH = re.compile(r"^References?:\s*(.*?)(?:\n\s*\n|\Z)", re.DOTALL | re.MULTILINE)


def laws_in_use(groups: list[Group], contacts: Sequence[Touching]) -> list[object]:
    """Modules of all laws in use, and of the kinetics."""
    laws = [module for g in groups for module in (g.module, *(law for _, law in g.materials))]
    for c in contacts:
        laws += [c.narrow, c.normal, c.friction]
    return [*laws, import_module("crashsolve.system.kinetics")]


def citations(modules: Iterable[Any]) -> list[str]:
    """One line per law with references, sorted: `springs/curve: Author (year), ...`."""
    lines = set()
    for module in modules:
        reference = PARAGRAPH.search(module.__doc__ or "")
        if reference:
            law = module.__name__.partition(".")[2].replace(".", "/")
            lines.add(f"{law}: {' '.join(reference.group(1).split())}")
    return sorted(lines)
