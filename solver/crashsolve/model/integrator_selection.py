"""The method for a deck that names none, from its own stiffness and smoothness.

`integrator: auto`

    law that is computed in whole steps          rattle
    contacts that keep lists of near pairs  rattle: events too many to be located one by one
    stiff                                   radau_iia_5, or generalized_alpha where 1e-3 is enough
    contacts, or laws with corners          dormand_prince_5
    smooth                                  dormand_prince_8, or dormand_prince_5 above 1e-5

`integrator: default`, the word of decks that say nothing

    rigid bodies, smooth, without contacts  dormand_prince_8
    and curves
    anything else                           rattle: of order 2, and passes corners at which others
    stop

Steps of the default resolve every vibration, for any reference of the error of a step
(`resolve`): in a model of kilometres 1e-6 of its size is all that a small oscillator does.

Stiff means that the largest step at which an explicit method is stable (see system/timestep.py) is
short beside the time in which the fastest body crosses the model, and beside the largest step
allowed. Consequence to test: the choice follows from the deck alone, and the log states its cause.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from crashsolve.deck.reading.deck import Deck
from crashsolve.foundation.rows import Rows, as_rows
from crashsolve.model.model import Group, Model, State

# so many stable explicit steps in the time of a crossing cost more than implicit ones
STIFF = 1000.0
COARSE, FINE = 1e-3, 1e-5
# of the default: steps over the stable one of a spring, rotation in a step [rad], steps in a run
SAFETY, ROTATION, LEAST_STEPS = 1.0, 0.7, 40


class Choice(NamedTuple):
    """Name of an integrator, and why."""

    integrator: str
    reason: str


def _only_for_rattle(model: Model, stepwise: list[str]) -> Choice | None:
    """The choice of rattle where no other method serves; None where one does."""
    if stepwise:
        return Choice("rattle", f"'{stepwise[0]}' is computed in whole steps")
    if model.phases:
        return Choice("rattle", "phases check the motion after short steps")
    if len(model.attached_nodes):
        return Choice("rattle", "nodes are welded to rigid bodies")
    return None


def choose(model: Model, state: State, stepwise: list[str], tolerance: float) -> Choice:
    """The integrator of a deck with integrator: auto."""
    if needs_rattle := _only_for_rattle(model, stepwise):
        return needs_rattle
    searched = [c.word for c in model.contact_groups if c.search is not None]
    if searched:
        return Choice("rattle", f"contacts '{searched[0]}' keep a list of near pairs")
    crossing, stable = times(model, state)
    ratio = crossing / stable if stable > 0.0 else 0.0
    if ratio > STIFF:
        method = "generalized_alpha" if tolerance >= COARSE else "radau_iia_5"
        why = f"explicit steps are stable below {stable:.2g} s, a crossing takes {crossing:.2g} s"
        return Choice(method, f"stiff: {why}")
    if model.contact_groups:
        return Choice("dormand_prince_5", "contacts begin and end within the run; not stiff")
    if has_corners(model):
        return Choice("dormand_prince_5", "laws or curves have corners; not stiff")
    if tolerance > FINE:
        return Choice("dormand_prince_5", f"smooth, not stiff, tolerance {tolerance:g}")
    return Choice("dormand_prince_8", f"smooth, not stiff, tolerance {tolerance:g}")


def by_default(model: Model, stepwise: list[str]) -> Choice:
    """The integrator for a deck that names none."""
    if needs_rattle := _only_for_rattle(model, stepwise):
        return needs_rattle
    if model.contacts:
        return Choice("rattle", "contacts begin and end")
    if model.elements or any(g.keyword == "parts" for g in model.groups):
        return Choice("rattle", "parts are flexible")
    if model.curve_names or has_corners(model):
        return Choice("rattle", "laws or curves may have corners")
    return Choice("dormand_prince_8", "rigid bodies, smooth, no contacts")


def resolve(control: np.ndarray) -> None:
    """Bounds of steps that are chosen by their error, of the default and `control.resolve`.

    Writes: control.
    """
    c = control[0]
    c["resolves"] = 1
    c["safety"], c["rotation"] = SAFETY, ROTATION
    c["step_max"] = min(c["step_max"], (c["end"] - c["start"]) / LEAST_STEPS or 1.0)


def with_chosen_method(deck: Deck, model: Model) -> Deck:
    """The deck with the method of its model: runs beside this one must not choose anew."""
    resolves = bool(model.control[0]["resolves"])
    chosen = {"integrator": model.integrator, "resolve": resolves}
    return replace(deck, control=deck.control.model_copy(update=chosen))


def has_corners(model: Model) -> bool:
    """Whether a law has several branches, or a curve a corner, whichever law reads it."""
    if any(_has_branches(group) for group in model.branching_groups()):
        return True
    curves = model.curves
    for start in model.curve_names.values():
        part = curves[start : curves[start]["last"] + 1]
        slope, ends = part["c"][:-1], np.diff(part["x"])
        arriving = slope[:, 1] + ends * (2.0 * slope[:, 2] + 3.0 * ends * slope[:, 3])
        jump = np.abs(arriving[:-1] - slope[1:, 1])
        if (jump > 1e-9 * np.abs(slope[:, 1]).max(initial=0.0)).any():
            return True
    return False


def _has_branches(group: Group) -> bool:
    """Whether a law may change its branch: at yield, at a stop, or at a reversal."""
    p = group.parameters
    # of a curve that is followed in both directions the corners are those of its points
    return "loose" not in (p.dtype.names or ()) or bool((p["loose"] != 0).any())


def times(model: Model, state: State) -> tuple[float, float]:
    """Time in which the fastest body crosses the model, at most step_max, and stable step [s].

    Forces are those of the initial state, evaluated once as plain Python; 0 where nothing is stiff.
    """
    nodes = as_rows(state.nodes.copy())
    nodes.W = _world_tensors(nodes)
    for g in model.force_groups():
        _evaluate(g, state, model, nodes)
    body = nodes[1:]
    acceleration = np.linalg.norm(body.force, axis=1) * body.mass_inv
    spin_rate = np.linalg.norm(
        np.einsum("nij,nj->ni", body.W.reshape(-1, 3, 3), body.torque), axis=1
    )
    size = model.size
    speed = max(
        np.linalg.norm(body.v, axis=1).max(initial=0.0),
        size * np.linalg.norm(body.w, axis=1).max(initial=0.0),
        np.sqrt(size * max(acceleration.max(initial=0.0), size * spin_rate.max(initial=0.0))),
    )
    frequency = np.sqrt(2.0 * body.stiffness + body.damping**2) + body.damping
    fastest = frequency.max(initial=0.0)
    crossing = min(size / speed if speed > 0.0 else np.inf, float(model.control[0]["step_max"]))
    return float(crossing), float(2.0 / fastest) if fastest > 0.0 else 0.0


def _world_tensors(nodes: Rows) -> np.ndarray:
    A, J_inv = nodes.A.reshape(-1, 3, 3), nodes.J_inv.reshape(-1, 3, 3)
    return np.einsum("nij,njk,nlk->nil", A, J_inv, A).reshape(-1, 9)


def _evaluate(group: Group, state: State, model: Model, nodes: np.ndarray) -> None:
    """Forces and stiffness of one group, on copies of the tables that it writes. Writes: nodes."""
    force = group.module.force
    old, new = as_rows(group.history.copy())
    out = as_rows(group.output.copy())
    p, curves = as_rows(group.parameters), as_rows(model.curves.copy())
    rows, time = as_rows(state.rows.copy()), float(state.clock[0]["time"])
    for i in range(len(p)):
        force(p[i], old[i], new[i], out[i], time, 0.0, nodes, rows, curves)
