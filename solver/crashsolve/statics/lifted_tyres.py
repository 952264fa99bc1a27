"""Tyres that the loads pull off their roads, so that no equilibrium can follow.

Without motion a tyre pushes, and never pulls. Consequence to test: a car under gravity that points
upwards is refused after a few iterations, with the reason.
"""

import numpy as np

from crashsolve.foundation.rows import as_rows
from crashsolve.model.model import Model

# share of the load that nothing carries, from which all of it counts as that
WHOLE = 0.999


def lifted_tyres(model: Model, nodes: np.ndarray, unsupported: np.ndarray) -> list[str]:
    """Names of all tyres, where none touches its roads and the load points away from them.

    `unsupported` (3,) is the sum of the forces that accelerate the bodies [N]. Empty where a tyre
    touches, where anything carries a part of the load, and where it points to a road.
    """
    load = nodes["external"][0, :3]
    if not np.linalg.norm(unsupported) >= WHOLE * np.linalg.norm(load) > 0.0:
        return []
    table, curves, names = as_rows(nodes), as_rows(model.curves), []
    for group in model.groups:
        if not hasattr(group.module, "patch_of"):
            continue
        data = tuple(as_rows(part) for part in group.data) or None
        for name, p in zip(group.names, as_rows(group.parameters), strict=True):
            names.append(name)
            for road in range(p.roads):
                at = group.module.patch_of(p, road, table, curves, data)
                if at.depth > 0.0 or np.dot(at.n, load) <= 0.0:
                    return []
    return names
