"""Citations of a run: the references in the docstrings of exactly the laws it uses."""

import re
from types import ModuleType
from typing import Any

PARAGRAPH = re.compile(r"^References?:\s*(.*?)(?:\n\s*\n|\Z)", re.DOTALL | re.MULTILINE)


def citations(modules: list[ModuleType | Any]) -> list[str]:
    """One line per law with references, sorted: `springs/curve: Author (year), ...`."""
    lines = set()
    for module in modules:
        found = PARAGRAPH.search(module.__doc__ or "")
        if found:
            law = module.__name__.partition(".")[2].replace(".", "/")
            lines.add(f"{law}: {' '.join(found.group(1).split())}")
    return sorted(lines)
