"""The folders of functions and of statistics as registries: `hic(...)` is `functions/hic.py`."""

import importlib
from functools import cache
from pathlib import Path
from types import ModuleType

_HERE = Path(__file__).parent
FUNCTIONS, STATISTICS = "functions", "statistics"


@cache
def words_in(folder: str) -> tuple[str, ...]:
    """Names of the files of a folder, sorted; those that begin with _ are shared by others."""
    return tuple(sorted(path.stem for path in (_HERE / folder).glob("[!_]*.py")))


def module_of(folder: str, word: str) -> ModuleType:
    """The file of a word that exists, imported now."""
    return importlib.import_module(f"{__package__}.{folder}.{word}")
