"""Compose: write, for this deck, the module that makes one step, and compile it.

The composed module is a small readable file in the cache folder: the functions of the integrator
and of the loops (system/loops) that the scene needs, specialised for its groups. Nothing that the
scene lacks appears in it. `crashsolve explain` prints it.
"""

import hashlib
from typing import Any

from crashsolve.compiler.cache import cache_folder, read_own, write_whole
from crashsolve.compiler.machine import Function, machine_code, machine_codes, runs_plain
from crashsolve.compiler.program import Program
from crashsolve.compiler.table import Tables
from crashsolve.model.clock import NOT_FINITE
from crashsolve.system.placeholders import is_assembled, is_shared, method, placeholders
from crashsolve.threads import sharing

INTEGRATORS = "crashsolve.integrators"
LOOPS = "crashsolve.system.loops"
IMPLICIT = "crashsolve.system.implicit"
SCENE = "crashsolve.system.placeholders"
TABLEAUX = ("dormand_prince_5", "radau_iia_5")  # those that integrators name as examples


def compose(model: Any) -> str:
    """Text of the composed module.

    Functions of files of integrators with a leading underscore, and of loops, are copied into it;
    the names of a tableau come from that of the deck.
    """
    own = method(model)
    main = f"{INTEGRATORS}.{getattr(own, 'STEPPER', model.integrator)}"
    replaced = {f"{INTEGRATORS}.{name}": own.__name__ for name in TABLEAUX}
    replaced[f"{INTEGRATORS}._collocation"] = f"{INTEGRATORS}.{getattr(own, 'STAGE', '')}"
    replaced[f"{INTEGRATORS}.rattle"] = main
    if model.elements:
        replaced["crashsolve.system.timestep"] = "crashsolve.system.element_step"
    if is_assembled(model):
        replaced[f"{IMPLICIT}.compliance"] = f"{IMPLICIT}.global_matrix"

    def is_copied(module: str) -> bool:
        return module.startswith((f"{INTEGRATORS}._", f"{LOOPS}.")) or module == main

    program = Program(placeholders(model), SCENE, is_copied, replaced)
    program.add(f"{INTEGRATORS}._advance", "advance")
    if is_shared(model):
        program.add(f"{LOOPS}.pieces", "assist")
    return program.text()


def load(text: str, tables: Tables) -> Function:
    """The composed step, compiled, under a name and file that depend on nothing but the text."""
    path = cache_folder() / f"crashsolve_step_{hashlib.sha256(text.encode()).hexdigest()[:16]}.py"
    if read_own(path) != text.encode():
        write_whole(path, text.encode())
    if runs_plain():
        return ends_in_nan(machine_code(path, "advance", tables))
    if not tables.of_threads:
        return machine_code(path, "advance", tables)
    return sharing.together(*machine_codes(path, ("advance", "assist"), tables))


def ends_in_nan(advance: Function) -> Function:
    """Plain Python raises where compiled code goes on with infinity or NaN, and is stopped."""

    def plain(number: float, flag: bool, tables: Any) -> None:
        try:
            advance(number, flag, tables)
        except (ArithmeticError, ValueError) as error:
            is_meant = isinstance(error, ArithmeticError) or "math domain" in str(error)
            if not is_meant and "cannot convert float" not in str(error):
                raise
            tables.clock[0]["status"] = NOT_FINITE

    return plain
