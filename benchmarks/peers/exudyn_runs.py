"""Runs of Exudyn: a system built anew for each run, one solver over its steps or tolerances."""

from collections.abc import Callable, Sequence
from typing import Any

import exudyn as exu
import numpy as np
from exudyn.utilities import (
    LoadMassProportional,
    MarkerBodyMass,
    MarkerBodyPosition,
    NodeGenericODE2,
    NodeRigidBody2D,
    ObjectGround,
    ObjectJointRevolute2D,
    ObjectKinematicTree,
    ObjectRigidBody2D,
)
from problem import Method, Run

ADAPTIVE = ("DOPRI5", "DVERK6", "ODE23")

# fills a system and returns the function that reads the values to compare
Fill = Callable[["exu.MainSystem"], Callable[[], object]]


def settings(end: float, solver: str, value: float) -> exu.SimulationSettings:
    """Settings of a run without files; `value` is a tolerance where the solver adapts its step."""
    given = exu.SimulationSettings()
    given.solution.file.write = False
    given.solution.sensors.active = False
    march = given.timeIntegration
    march.endTime, march.verboseMode = end, 0
    march.automaticStepSize = solver in ADAPTIVE
    if solver in ADAPTIVE:
        # as many steps as this sets only the longest one
        march.numberOfSteps = 10
        march.absoluteTolerance = march.relativeTolerance = value
        march.minimumStepSize = 1e-12
    else:
        march.numberOfSteps = max(1, round(end / value))
    return given


def methods(
    fill: Fill, end: float, entries: Sequence[tuple[str, str, Sequence[float]]]
) -> list[Method]:
    """One method per entry (solver, settings of the model, steps or tolerances)."""

    def prepare(solver: str, value: float) -> Run:
        container = exu.SystemContainer()
        system = container.AddSystem()
        watch = fill(system)
        system.Assemble()
        given = settings(end, solver, value)
        kind = getattr(exu.DynamicSolverType, solver)

        def solve() -> None:
            if not system.SolveDynamic(given, solverType=kind, showHints=False):
                raise ArithmeticError("no convergence")

        def watched(_keep: object = container) -> np.ndarray:
            return np.array(watch(), float)

        return Run(solve, watched)

    return [
        Method(
            "exudyn",
            f"{solver}, {model}",
            "tolerance" if solver in ADAPTIVE else "step",
            values,
            lambda value, s=solver: prepare(s, value),
        )
        for solver, model, values in entries
    ]


def coordinates(system: exu.MainSystem, node: int) -> np.ndarray:
    """Reference plus present coordinates of a node."""
    total = system.GetNodeOutput(node, exu.OutputVariableType.Coordinates)
    start = system.GetNodeOutput(
        node, exu.OutputVariableType.Coordinates, configuration=exu.ConfigurationType.Reference
    )
    return np.ravel(total) + np.ravel(start)


def plane_body(
    system: exu.MainSystem,
    mass: float,
    inertia: float,
    configuration: Sequence[float],
    rates: Sequence[float] = (0.0, 0.0, 0.0),
) -> tuple[int, int]:
    """Node and body; configuration and rates are (x, y, angle) of the mass centre."""
    node = system.AddNode(
        NodeRigidBody2D(referenceCoordinates=list(configuration), initialVelocities=list(rates))
    )
    return node, system.AddObject(ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=node))


def point(system: exu.MainSystem, body: int, position: Sequence[float]) -> int:
    """Marker at a point in the axes of a body."""
    return system.AddMarker(MarkerBodyPosition(bodyNumber=body, localPosition=[*position, 0.0][:3]))


def ground(system: exu.MainSystem) -> int:
    return system.AddObject(ObjectGround())


def hinge(system: exu.MainSystem, first: int, second: int) -> None:
    """Plane hinge between two markers."""
    system.AddObject(ObjectJointRevolute2D(markerNumbers=[first, second]))


def weight(system: exu.MainSystem, body: int, gravity: Sequence[float]) -> None:
    """Gravity on one body."""
    marker = system.AddMarker(MarkerBodyMass(bodyNumber=body))
    system.AddLoad(LoadMassProportional(markerNumber=marker, loadVector=list(gravity)))


def tree(
    system: exu.MainSystem,
    links: Sequence[dict[str, Any]],
    gravity: Sequence[float],
    rates: Sequence[float],
) -> tuple[int, int]:
    """Node and object of a tree; a link has type, parent, offset, mass, centre, inertia, start."""
    n = len(links)
    node = system.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[link.get("start", 0.0) for link in links],
            initialCoordinates=[0.0] * n,
            initialCoordinates_t=list(rates),
            numberOfODE2Coordinates=n,
        )
    )
    body = system.AddObject(
        ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[link["type"] for link in links],
            linkParents=[link["parent"] for link in links],
            jointTransformations=exu.Matrix3DList([np.eye(3)] * n),
            jointOffsets=exu.Vector3DList([link["offset"] for link in links]),
            linkInertiasCOM=exu.Matrix3DList([np.diag(link["inertia"]) for link in links]),
            linkCOMs=exu.Vector3DList([link["centre"] for link in links]),
            linkMasses=[link["mass"] for link in links],
            gravity=list(gravity),
        )
    )
    return node, body
