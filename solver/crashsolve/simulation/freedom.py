"""Degrees of freedom of a model in its initial configuration, and redundant joints.

    f = 6 n - rank D      n nodes that move, D the rows of their joints

Nothing is compiled: the kernels of the joints run once as plain Python. Consequence to test: a door
on two revolute joints has one degree of freedom, of 6 - 10 by counting rows.
"""

import numpy as np

from crashsolve.foundation.rows import as_rows
from crashsolve.model.jacobian import jacobian, null_space
from crashsolve.model.model import Model, State
from crashsolve.simulation.redundant import MANY, NOTHING


def freedom(model: Model, state: State, time: float) -> list[str]:
    """Lines of `check`: degrees of freedom, and redundant rows with their joints; [] for many."""
    attached = set(model.attached_nodes["node"].tolist())
    free = [i for i in range(1, len(state.nodes)) if i not in attached]
    if not free or model.elements or model.saddle.rows() > MANY or len(free) > MANY:
        return []
    if not model.joints:
        return [f"degrees of freedom: {6 * len(free)}"]
    D = jacobian(model.joints, _rows(model, state, time), len(state.nodes))[:, free]
    D = D.reshape(len(D), 6 * len(free))
    length = np.linalg.norm(D, axis=1)[:, None]
    null = null_space((D / np.where(length > 0.0, length, 1.0)).T)
    excess = null.shape[1]
    held = len(D) - excess
    lines = [f"degrees of freedom: {6 * len(free) - held} = 6 x {len(free)} - {held}"]
    if excess:
        names, first = [], 0
        for joint in model.joints:
            if np.abs(null[first : first + joint.rows]).max(initial=0.0) > NOTHING:
                names.append(f"'{joint.name}'")
            first += joint.rows
        lines.append(
            f"redundant constraint rows: {excess}, among those of joints {', '.join(names)}: "
            "the split of a force between them is arbitrary"
        )
    return lines


def _rows(model: Model, state: State, time: float) -> np.ndarray:
    """The table of rows with the Jacobian of the joints, of the nodes as they are."""
    table = state.rows.copy()
    nodes, rows, curves = as_rows(state.nodes), as_rows(table), as_rows(model.curves)
    for group in model.joint_groups():
        p, old = as_rows(group.parameters), as_rows(group.history)[0]
        for i in range(len(p)):
            for basic, first in group.constraints:
                basic.jacobian(p[i], nodes, rows, p[i].first_row + first)
            if group.has_own_rows:
                group.law.jacobian(p[i], old[i], time, nodes, rows, curves)
    return table
