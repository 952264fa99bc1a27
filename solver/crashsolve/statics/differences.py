"""Nodes for which the tangent of statics is found by differences of samples."""

import numpy as np

from crashsolve.model.model import Group, Model


def nodes_with_other_forces(model: Model, free: np.ndarray, beams: list[Group]) -> np.ndarray:
    """Mask (n,) of the free nodes on which forces other than those of beam elements may act."""
    attached_nodes = set(model.attached_nodes["node"])
    named = attached_nodes | set(model.attached_nodes["body"])
    for g in model.groups:
        if not hasattr(g.module, "forces_by_motions"):
            # any whole number may be a node
            whole = [
                k for k in g.parameters.dtype.names or () if g.parameters[k].dtype.kind in "iu"
            ]
            named |= {int(i) for k in whole for i in g.parameters[k].ravel()}
    for g in beams:
        ends = zip(g.parameters["node_a"].tolist(), g.parameters["node_b"].tolist(), strict=True)
        # forces on an attached node act on its body
        named |= {i for pair in ends if attached_nodes & set(pair) for i in pair}
    return np.isin(free, list(named))
