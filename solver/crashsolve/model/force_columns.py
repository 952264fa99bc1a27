"""Columns that laws have beside their own, and those by which gains of a law are found.

A law between bodies, two or several, is watched where a step may be too long for it: with
`control.step` and a method of one force pass a step. Steps chosen by the run keep to the stiffness
that laws report.
"""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING

from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.model.scene import Scene

# every law with constraint rows has these beside its own columns
ROW_PARAMETERS = Record("first_row  index  first constraint row")
# every law that stores or loses energy has these
FORCE_HISTORY = Record("""
    dissipated  J  energy lost so far
    power       W  its present rate
""")
FORCE_OUTPUT = Record("""
    stored  J  recoverable energy
    power   W  rate of energy lost, or of work done by a load
    loss    J  energy lost in this step without a rate
""")
WORK = Record("""
    work_done         J  work on its bodies so far
    exchanged         J  what was taken and given, both positive
    initially_stored  J  stored before the first step
    peak_force        N  largest force so far
""")
ON_TWO = Record("""
    force_a   N    3  on body a
    torque_a  N m  3  about its mass centre
    force_b   N    3  on body b
    torque_b  N m  3  about its mass centre
""")
# families whose laws only store and dissipate energy
PASSIVE = ("springs", "belts", "hinges", "tyres")


def history_of_force(keyword: str, module: ModuleType, scene: Scene) -> Record:
    """Columns of HISTORY of a group beside its own."""
    control = scene.deck.control
    is_stated = control.step != "auto" and control.integrator == "rattle"
    # nodes that bodies carry have no step of their own
    if keyword not in PASSIVE or not is_stated or scene.part_nodes:
        return FORCE_HISTORY
    on_bodies = _on_bodies(module.PARAMETERS)
    return FORCE_HISTORY if on_bodies is None else FORCE_HISTORY + WORK + on_bodies


def _on_bodies(parameters: Record) -> Record | None:
    """Columns of the actions on the bodies of a law: on two, or on those of a column of several."""
    columns = parameters.dtype
    names = columns.names or ()
    if "node" in names and columns["node"].shape:
        values = 3 * columns["node"].shape[0]
        return Record(f"""
            forces   N    {values}  on each body; nothing where it is repeated
            torques  N m  {values}  about its mass centre
        """)
    is_between_two = all(name in names and not columns[name].shape for name in ("node_a", "node_b"))
    return ON_TWO if is_between_two else None
