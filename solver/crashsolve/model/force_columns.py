"""Columns that laws have beside their own, and those by which gains of a law are found.

A law between two bodies is watched where a step may be too long for it: with `control.step` and a
method of one force pass a step. Steps chosen by the run keep to the stiffness that laws report.
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
WATCHED = Record("""
    given       J          work on both bodies so far
    exchanged   J          what was taken and given, both positive
    initially_stored  J          held before the first step
    peak_force  N          largest force so far
    force_a     N       3  on body a
    torque_a    N m     3  about its mass centre
    force_b     N       3  on body b
    torque_b    N m     3  about its mass centre
""")
# families whose laws only store and dissipate energy
PASSIVE = ("springs", "hinges", "tyres")


def history_of_force(keyword: str, module: ModuleType, scene: Scene) -> Record:
    """Columns of HISTORY of a group beside its own."""
    control, columns = scene.deck.control, module.PARAMETERS.dtype
    is_between_two = all(
        name in (columns.names or ()) and not columns[name].shape for name in ("node_a", "node_b")
    )
    is_stated = control.step != "auto" and control.integrator == "rattle"
    is_watched = keyword in PASSIVE and is_between_two and is_stated
    # nodes that bodies carry have no step of their own
    return FORCE_HISTORY + WATCHED if is_watched and not scene.part_nodes else FORCE_HISTORY
