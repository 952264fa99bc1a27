"""Laws of force as machine code that checks its bounds, for the tests of their contract.

The kernels of all laws make one module, each on the tables of its own example. What a test does
with a law of test_every_law.py it can do with one of these.
"""

import hashlib
import os
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from bench import Law
from test_every_law import FORCES, example, module_of

from crashsolve.compiler.machine import machine_code, runs_plain
from crashsolve.compiler.table import Tables

HEAD = '''"""Laws of force, each on tables of its own."""

from crashsolve.foundation.kernels import entry, kernel
'''
# the time goes through a table, as an entry has one number alone
ENTRY = """
from {module} import force as force_{k}


@kernel
def law_{k}(h, scene):
    i = scene.place_{k}[0]
    force_{k}(
        scene.parameters_{k}[i],
        scene.history_{k}[0, i],
        scene.history_{k}[1, i],
        scene.output_{k}[i],
        scene.time_{k}[0],
        h,
        scene.nodes_{k},
        scene.rows_{k},
        scene.curves_{k},
    )
"""
# one function for all: the names of several would make that of the file of their code too long
TAIL = """

@entry
def force(h, flag, scene):
    which = scene.which[0]
{calls}
"""
CALL = "    if which == {k}:\n        law_{k}(h, scene)"


class CompiledLaws:
    """Makes examples of laws whose force is compiled."""

    def __init__(self, folder: Path) -> None:
        text = HEAD + "".join(
            ENTRY.format(k=k, module=module_of(law).__name__) for k, law in enumerate(FORCES)
        )
        text += TAIL.format(calls="\n".join(CALL.format(k=k) for k in range(len(FORCES))))
        # code is kept under the name of its source
        self.source = folder / f"laws_{hashlib.sha1(text.encode()).hexdigest()[:12]}.py"
        self.source.write_text(text, "utf-8")
        self.arrays: dict[str, np.ndarray] = {}
        for law in FORCES:
            self._add(law, example(law))

    def _add(self, law: tuple[str, str], one: Law) -> tuple[int, np.ndarray]:
        """Number of the law, and the table of its time."""
        k, time = FORCES.index(law), np.zeros(1)
        group = one.group
        own = {
            "place": np.array([one.i]),
            "parameters": group.parameters,
            "history": group.history,
            "output": group.output,
            "time": time,
            **one.bench.tables,
        }
        self.arrays |= {f"{name}_{k}": array for name, array in own.items()}
        return k, time

    def example(self, law: tuple[str, str]) -> Law:
        """The example of a law with its compiled force, which raises BoundsError."""
        one = example(law)
        assert not one.materials
        k, time = self._add(law, one)
        tables = Tables(self.arrays | {"which": np.array([k])})
        function = self._checked(tables)

        def force(p: Any, old: Any, new: Any, out: Any, t: float, h: float, *scene: object) -> None:
            time[0] = t
            function(h, True, tables)

        one.kernel = force
        return one

    def _checked(self, tables: Tables) -> Any:
        before = os.environ.get("CRASHSOLVE_CHECKED")
        os.environ["CRASHSOLVE_CHECKED"] = "1"
        try:
            return machine_code(self.source, "force", tables)
        finally:
            if before is None:
                del os.environ["CRASHSOLVE_CHECKED"]
            else:
                os.environ["CRASHSOLVE_CHECKED"] = before


@cache
def _laws() -> CompiledLaws:
    return CompiledLaws(Path(tempfile.mkdtemp()))


def compiled(law: tuple[str, str]) -> Law:
    """The example of a law, compiled with its bounds checked; plain Python where that is asked."""
    return example(law) if runs_plain() else _laws().example(law)
