"""What joints have created or lost, mechanism by mechanism, by their work (joint_work.py).

Compared with what they took and gave it ends a run; with the kinetic energy, it is a warning.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from crashsolve.model.hubs import mechanisms
from crashsolve.model.model import Model, State

# of the bodies of a mechanism
SUMS = ("work", "unseen", "exchange")


class Created(NamedTuple):
    """Energies of the joints of a mechanism [J], in steps of many iterations."""

    joint: str  # the first of them
    others: int
    work: float
    unseen: float  # over what they stood open
    exchange: float
    kinetic: float  # the largest of their bodies

    def __str__(self) -> str:
        more = f"{self.others} other joints" if self.others > 1 else "other joint"
        beside = f", with the {more} of its mechanism," if self.others else ""
        verb = "created" if self.work > 0.0 else "lost"
        return f"it has{beside} {verb} {abs(self.work):.3g} J in steps too long for it"


def created_by_joints(model: Model, state: State) -> Iterator[Created]:
    """The energies of every mechanism whose joints took many iterations."""
    if not state.nodes["joint_exchange"].any():
        return
    for joints in mechanisms(model.joints):
        held = sorted({node for joint in joints for node in joint.nodes} - {0})
        b = state.nodes[held]
        v = b["v"] - state.nodes["v"][b["reference"]]
        mass = np.divide(1.0, b["mass_inv"], where=b["mass_inv"] > 0.0, out=np.zeros(len(held)))
        now = 0.5 * ((v * v).sum(axis=1) * mass + (b["w"] * b["L"]).sum(axis=1))
        kinetic = max(float(now.sum()), float(b["largest_kinetic"].sum()))
        work, unseen, exchange = (float(b[f"joint_{name}"].sum()) for name in SUMS)
        yield Created(joints[0].name, len(joints) - 1, work, unseen, exchange, kinetic)


def gaining_joints(model: Model, state: State) -> Created | None:
    """The mechanism that has created or lost most, where that is more than the energy limit."""
    limit = float(model.control[0]["energy_limit"])
    gains = [
        one
        for one in created_by_joints(model, state)
        if abs(one.work) > max(limit * max(one.exchange, one.kinetic), one.unseen) and limit > 0.0
    ]
    return max(gains, key=lambda one: abs(one.work), default=None)


def joint_warnings(model: Model, state: State) -> list[str]:
    """Mechanisms that have created or lost more than that share of their kinetic energy."""
    limit = float(model.control[0]["energy_limit"])
    return [
        f"joint '{one.joint}': {one}, of {one.kinetic:.3g} J of motion; halve control.step or "
        "control.step_max, and compare the results"
        for one in created_by_joints(model, state)
        if abs(one.work) > max(limit * one.kinetic, one.unseen) and limit > 0.0
    ]
