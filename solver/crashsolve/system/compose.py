"""Compose: write, for this deck, the module that makes one step, and compile it.

The composed module is a small readable file in the cache folder: the functions of the integrator
and of the loops (system/loops) that the scene needs, specialised for its groups. Nothing that the
scene lacks appears in it. `crashsolve explain` prints it.
"""

import hashlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from crashsolve.compiler.cache import (
    cache_folder,
    read_own,
    read_sealed,
    write_sealed,
    write_whole,
)
from crashsolve.compiler.machine import Function, machine_code, machine_codes, runs_plain
from crashsolve.compiler.table import Tables
from crashsolve.model.clock import NOT_FINITE
from crashsolve.model.model import Model
from crashsolve.system.placeholders import is_assembled, is_shared, method, placeholders

INTEGRATORS = "crashsolve.integrators"
LOOPS = "crashsolve.system.loops"
IMPLICIT = "crashsolve.system.implicit"
SCENE = "crashsolve.system.placeholders"
TABLEAUX = ("dormand_prince_5", "radau_iia_5")  # those that integrators name as examples


def compose(model: Model) -> str:
    """Text of the composed module.

    Functions of files of integrators with a leading underscore, and of loops, are copied into it;
    the names of a tableau come from that of the deck.
    """
    own = method(model)
    main = f"{INTEGRATORS}.{getattr(own, 'STEPPER', model.integrator)}"
    replaced = {f"{INTEGRATORS}.{name}": own.__name__ for name in TABLEAUX}
    replaced[f"{INTEGRATORS}._collocation"] = f"{INTEGRATORS}.{getattr(own, 'STAGE', '')}"
    replaced[f"{INTEGRATORS}._kick_drift_kick"] = main
    if model.elements:
        replaced["crashsolve.system.timestep"] = "crashsolve.system.element_step"
    if is_assembled(model):
        replaced[f"{IMPLICIT}.compliance"] = f"{IMPLICIT}.global_matrix"

    def is_copied(module: str) -> bool:
        return module.startswith((f"{INTEGRATORS}._", f"{LOOPS}.")) or module == main

    # most runs find the step that was composed before
    from crashsolve.compiler.program import Program

    program = Program(placeholders(model), SCENE, is_copied, replaced)
    program.add(f"{INTEGRATORS}._advance", "advance")
    if is_shared(model):
        program.add(f"{LOOPS}.pieces", "assist")
    return program.text()


def composed(model: Model, deck: str) -> str:
    """The composed step of a model, from the cache where the deck has been composed before.

    The composed text depends on the groups of a scene, on their contents, and on files of
    meshes through their tables: the key has all of them. Raises CacheError.
    """
    key = hashlib.sha256("\n".join([deck, *_description(model)]).encode()).hexdigest()[:32]
    path = cache_folder() / f"program_{key}"
    known = (read_sealed(path) or b"").decode(errors="replace")
    text = (read_own(_step_file(known)) or b"").decode(errors="replace") if known else ""
    if not text or _name_of(text) != known:
        text = compose(model)
        write_whole(_step_file(_name_of(text)), text.encode(), sync=False)
        write_sealed(path, _name_of(text).encode(), sync=False)
    return text


def _description(model: Model) -> Iterator[str]:
    """Properties on which a composed step may depend beside the deck's text."""
    for name, value in placeholders(model).items():
        yield f"{name} {value if isinstance(value, bool) else [g.word for g in value]}"
    for group in (*model.groups, *model.contact_groups, *model.nodal_groups):
        for name, table in group.tables().items():
            yield f"{group.word} {name} {table.dtype.descr} {table.shape}"
        parameters = getattr(group, "parameters", None)
        if parameters is not None:
            yield hashlib.sha256(parameters.tobytes()).hexdigest()


def _name_of(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _step_file(name: str) -> Path:
    return cache_folder() / f"crashsolve_step_{name}.py"


def load(text: str, tables: Tables) -> Function:
    """The composed step, compiled, under a name and file that depend on nothing but the text."""
    path = _step_file(_name_of(text))
    if read_own(path) != text.encode():
        write_whole(path, text.encode())
    if runs_plain():
        return ends_in_nan(machine_code(path, "advance", tables))
    if not tables.of_threads:
        return machine_code(path, "advance", tables)
    from crashsolve.threads.sharing import together

    return together(*machine_codes(path, ("advance", "assist"), tables))


def arrays_of_threads(model: Model) -> list[dict[str, np.ndarray]]:
    """Tables of its own for each thread but the first."""
    if not is_shared(model):
        return []
    from crashsolve.threads import sharing

    return sharing.arrays_of_threads(model)


def ends_in_nan(advance: Function) -> Function:
    """Plain Python raises where compiled code continues with infinity or NaN, and is stopped."""

    def plain(number: float, flag: bool, tables: Tables) -> None:
        try:
            advance(number, flag, tables)
        except (ArithmeticError, ValueError) as error:
            is_meant = isinstance(error, ArithmeticError) or "math domain" in str(error)
            if not is_meant and "cannot convert float" not in str(error):
                raise
            tables.clock[0]["status"] = NOT_FINITE

    return plain
