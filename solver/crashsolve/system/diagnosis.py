"""Why the compiled loop stopped: location, likely cause and advice, as the user reads them."""

from math import isfinite
from typing import NamedTuple

import numpy as np

from crashsolve.deck.family import families
from crashsolve.foundation.errors import SolverError
from crashsolve.foundation.rows import as_rows
from crashsolve.model import ledger as energy
from crashsolve.model.clock import (
    CONTACT_GAIN,
    CURVE_END,
    LAW_GAIN,
    NOT_FINITE,
    POSITION,
    ROTATED,
    STEP_TOO_SMALL,
    UNHELD,
    UNSOLVED,
    VELOCITY,
)
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.model import Model, State

# of an imbalance: a contact that has made so much is its cause
OF_ONE = 0.5
# of a body that meets the back of an open mesh
FROM_BEHIND = (
    "its faces resist on the side of their outward normals alone, and it would be pushed "
    "out through all of their thickness"
)
OTHER_SIDE = (
    "give the corners of the faces in the opposite order, to resist on the side that is struck; or "
    "close the mesh, to resist on both"
)
# of 2.9 rad: a swing at which the limit of 3 rad is met within a step
COS_SWING = -0.97
# location, likely cause, advice
Diagnosis = tuple[str, str, str]


def diagnose(model: Model, state: State, clock: np.void, ledger: np.ndarray) -> SolverError:
    """The error for a loop that has stopped with this clock and ledger."""
    passed = passed_through(model, state)
    if passed is not None:
        return passed
    status, step = int(clock["status"]), float(clock["next_step"])
    if status == NOT_FINITE:
        at = int(clock["index"])
        name = f"body '{model.bodies[at]}'" if at < len(model.bodies) else model.part_at(at)
        causes = (
            name,
            "its motion has diverged: positions or velocities are not finite",
            closer(model, state),
        )
    elif status == POSITION:
        causes = open_joints(model, state, clock)
    elif status == VELOCITY:
        causes = broken_velocities(model, state)
    elif status == UNSOLVED:
        cause = f"the equations of a step have no solution (the next step would be {step:.3g} s)"
        causes = "the model", cause, advice_on_step(model, state)
    elif status == UNHELD:
        lack = f"{float(clock['value']):.3g} m"
        cause = f"nodes of unilateral constraints leave their surface by {lack}"
        causes = "a unilateral contact", cause, closer(model, state)
    elif status == ROTATED:
        causes = rotated_far(model, state, clock)
    elif status == STEP_TOO_SMALL:
        causes = collapsed_step(model, state, int(clock["limit_node"]), step)
    elif status == CONTACT_GAIN:
        causes = find_contact_gain(model, state, clock)
    elif status == LAW_GAIN:
        causes = find_law_gain(model, state)
    elif status == CURVE_END:
        causes = curve_end(model, state, clock)
    else:
        causes = unbalanced(model, state, clock, ledger)
    return SolverError(float(clock["time"]), int(clock["cycle"]), *causes)


def unbalanced(model: Model, state: State, clock: np.void, ledger: np.ndarray) -> Diagnosis:
    """An energy balance that is off, and the contact whose work nothing accounts for, if any."""
    from crashsolve.system.contact.advice import advice_on_depth, advice_on_gain, advice_on_hollow
    from crashsolve.system.contact.balance import largest_missing

    share = 100.0 * ledger[energy.IMBALANCE] / ledger[energy.LARGEST]
    cause = f"the energy balance is off by {share:.3g} % of the largest energy"
    helps = [advice_on_depth(model, card) for card in range(len(model.contacts))]
    worst = largest_missing(model, state, int(clock["current"]))
    if worst is not None and abs(worst.missing) > OF_ONE * abs(ledger[energy.IMBALANCE]):
        cause += f"; {worst.text(model)}"
        helps += [advice(model, worst.card) for advice in (advice_on_gain, advice_on_hollow)]
    known = next((f"{text}; or " for text in helps if text), "")
    advice = f"{known}{closer(model, state)}; control.energy_limit sets the bound"
    return "the model", cause, advice


class _Passed(NamedTuple):
    """A pair of which one side has passed the other."""

    time: float  # [s]
    location: str
    what: str
    cause: str = "the contact is too soft for this speed, or the step too long"
    advice: str = "make the contact stiffer"
    helps_step: bool = True  # a shorter step may help too


def passed_through(model: Model, state: State) -> SolverError | None:
    """The error for the first pair of bodies of which one has passed the middle of the other."""
    passages = _passed_pairs(model, state) + _passed_nodes(model)
    if not passages:
        return None
    first = min(passages, key=lambda one: one.time)
    advice = f"{first.advice}; or {closer(model, state)}" if first.helps_step else first.advice
    cause, cycle = f"{first.what}: {first.cause}", int(state.clock[0]["cycle"])
    return SolverError(first.time, cycle, first.location, cause, advice)


def bodies_of_pair(model: Model, group: ContactGroup, pair: int) -> tuple[str, str]:
    """The bodies that side a and side b of a pair of elements belong to, as words of a message."""
    p = group.parameters[pair]
    sides = (group.elements_a[p["a"]]["node"], group.elements_b[p["b"]]["node"])
    a, b = (f"'{model.bodies[node]}'" if node else "the ground" for node in sides)
    return a, b


def _passed_pairs(model: Model, state: State) -> list[_Passed]:
    """Pairs of elements on bodies."""
    current, passages = int(state.clock[0]["current"]), []
    for group in model.contact_groups:
        if "pass_time" not in (group.history.dtype.names or ()):
            continue
        history = group.history[current]
        for i in np.flatnonzero(history["pass_time"]):
            p, time = group.parameters[i], float(history["pass_time"][i])
            names, b = bodies_of_pair(model, group, int(i)), group.elements_b[p["b"]]
            card = f"contact '{model.contacts[p['card']]}'"
            is_open = "thickness" in (b.dtype.names or ()) and isfinite(b["thickness"])
            if time < 0.0 and is_open:
                what = f"{names[0]} has come from behind the open mesh on {names[1]}"
                passages.append(
                    _Passed(-time, card, what, FROM_BEHIND, OTHER_SIDE, helps_step=False)
                )
            else:
                what = f"{names[0]} has passed the middle of what it strikes on {names[1]}"
                passages.append(_Passed(abs(time), card, what))
    return passages


def _passed_nodes(model: Model) -> list[_Passed]:
    """Nodes of shells on rigid shapes, and nodes and balls on faces."""
    passages = []
    for group in model.nodal_groups:
        location = f"contact '{group.card}'"
        if group.narrow is None:
            what = "a node or ball has passed through faces"
            times = group.arrays["totals"]["pass_time"]
        elif group.has_ends:
            what = "a node has passed the middle of what it strikes"
            times = group.arrays["probe_states"]["pass_time"]
        else:
            continue
        if times.any():
            passages.append(_Passed(float(np.abs(times[times != 0.0]).min()), location, what))
    return passages


def closer(model: Model, state: State) -> str:
    """Advice for shorter steps, by the setting that limits the step of the method."""
    if chooses_step(model, state):
        return "take shorter steps: reduce control.tolerance or control.step_max"
    return "take a shorter step: reduce control.safety or control.step"


def advice_on_step(model: Model, state: State) -> str:
    """Advice where no step of a method succeeds."""
    look = "look for a singular configuration, or a jump in a curve or law; integrator: rattle"
    if chooses_step(model, state):
        return f"{look} passes through them, and a larger control.tolerance may"
    return f"{look} passes through them; or {closer(model, state)}"


def chooses_step(model: Model, state: State) -> bool:
    """Whether the method chooses its steps by their errors."""
    return len(state.stages) > 0 and float(model.control[0]["fixed_step"]) == 0.0


def open_joints(model: Model, state: State, clock: np.void) -> Diagnosis:
    """Positions that cannot be brought onto Phi = 0."""
    name, error = joint_of(model, int(clock["index"])), float(clock["value"])
    cause = (
        f"the joints cannot be closed (error {error:.3g} of the model's size): "
        "they contradict each other, or the step is too long"
    )
    return f"joint '{name}'", cause, closer(model, state) + "; or remove a joint"


def broken_joints(model: Model, state: State) -> SolverError | None:
    """The error for joints that have created or lost too much energy."""
    # when a run ends
    from crashsolve.system.joint_balance import gaining_joints

    one = gaining_joints(model, state)
    if one is None:
        return None
    time, cycle = (state.clock[0][name].item() for name in ("time", "cycle"))
    cause = f"{one}; they took and gave {one.exchange:.3g} J"
    return SolverError(time, cycle, f"joint '{one.joint}'", cause, closer(model, state))


def broken_velocities(model: Model, state: State) -> Diagnosis:
    """Velocities that cannot be brought onto D v = nu."""
    speed = velocity_error(model, state) / state.rows["scale"]
    cause = (
        f"the velocities violate the joints (error {speed.max():.3g} of the model's size in a "
        "second): they contradict each other, or the configuration is singular"
    )
    advice = "remove a joint or a driver; integrator: rattle passes singular configurations"
    return f"joint '{joint_of(model, int(speed.argmax()))}'", cause, advice


def joint_of(model: Model, row: int) -> str:
    """Name of the joint that a row belongs to."""
    return next(j.name for j in model.joints if row < j.first_row + j.rows * j.parts)


def collapsed_step(model: Model, state: State, limit_node: int, step: float) -> Diagnosis:
    """A step shorter than step_min: by the stiffness of a body, or by the error of the method."""
    if limit_node:
        what = "body" if limit_node > 0 else "element"
        return (
            f"{what} '{limiter(model, limit_node)}'",
            f"the step has collapsed to {step:.3g} s",
            f"look for a stiffness that is far too large, or a mass that is far too small, on this "
            f"{what}",
        )
    return (
        "the model",
        f"no step is short enough for control.tolerance (the next would be {step:.3g} s)",
        advice_on_step(model, state),
    )


def rotated_far(model: Model, state: State, clock: np.void) -> Diagnosis:
    """A stated step in which a body rotates so far that angles cannot be counted."""
    from crashsolve.system.timestep import QUARTER

    at = int(np.linalg.norm(state.nodes["w"], axis=1).argmax())
    speed, step = float(clock["value"]), float(clock["step"])
    cause = f"it rotates by {speed * step:.3g} rad in a step of {step:.3g} s"
    advice = (
        "angles are counted in steps of less than a quarter of a revolution: take steps below "
        f"{QUARTER / speed:.3g} s"
    )
    return f"body '{model.node_with_element(at)}'", cause, advice


def limiter(model: Model, limit_node: int) -> str:
    """The body, or element and its node, that sets the step; empty where none does."""
    if limit_node < 0:
        return model.element_with_node(-1 - limit_node)
    return model.node_with_element(limit_node) if limit_node else ""


def curve_end(model: Model, state: State, clock: np.void) -> Diagnosis:
    """A curve read beyond its points, be it for a step too long for the elements."""
    curves = model.curves
    first, x = int(curves[0]["fault"]), float(curves[0]["x"])
    if first < 0:
        return folded(model, state, -first, x)
    name = next(n for n, start in model.curve_names.items() if start == first)
    last = curves[int(curves[first]["last"])]["x"]
    cause = f"read at {x:.6g}, outside its range {curves[first]['x']:.6g} to {last:.6g}"
    advice = "extend the curve, or set extrapolate: hold or linear on its card"
    times = 0.5 * float(clock["step"]) * float(clock["element_rate"]) ** 0.5
    if model.integrator == "rattle" and times > 1.0:
        cause += f", with a step {times:.2g} times the one that is sure to be stable"
        advice = f"take a shorter step; if that does not help, {advice}"
    if "." in name:
        hinge, _, field = name.partition(".")
        cause = (
            f"deformed to {x:.6g}, beyond the end of its curve, {last:.6g} (plastic displacement "
            "or plastic work)"
        )
        advice = f"extend its {field}, or set extrapolate: hold; a hinge about two axes rotates "
        return f"hinge '{hinge}'", cause, f"{advice}by 3 rad at most"
    return f"curve '{name}'", cause, advice


def folded(model: Model, state: State, node: int, angle: float) -> Diagnosis:
    """A bushing, segment or beam element that has rotated by nearly pi, angle [rad].

    A negative angle: the link of an anti-roll bar at its dead centre.
    """
    if angle < 0.0:
        cause = "its link to an anti-roll bar is at the dead centre, with no lever arm on the bar"
        advice = "give longer arms or links, or stops that end the travel of the wheel before"
        return f"body '{model.node_with_element(node)}'", cause, advice
    if (name := _range_left(model, state, node)) is not None:
        cause = f"its joint has swung by {angle:.3g} rad, where azimuth and twist are not defined"
        advice = "keep its swing below 3 rad: by narrower half angles or a stiffer stop, or a cone"
        return f"spring '{name}'", cause, f"{advice} where there is none"
    cause = (
        f"it has rotated by {angle:.3g} rad relative to the body at the other end of a spring or "
        "beam element"
    )
    advice = (
        "such an element is valid for relative rotations below 3 rad: take more elements or "
        "segments; where parts rotate freely, take a joint with springs of its own"
    )
    return f"body '{model.node_with_element(node)}'", cause, advice


def _range_left(model: Model, state: State, node: int) -> str | None:
    """The cone or twist stop of a joint on body `node` that has swung by nearly half a turn."""
    for g in model.force_groups():
        known = g.parameters.dtype.names or ()
        pointer = next((n for n in ("pointer", "axis_b") if n in known), None)
        if pointer is None or "margin" not in (g.output.dtype.names or ()):
            continue
        for i in np.flatnonzero(g.parameters["node_b"] == node):
            p = g.parameters[i]
            A_a, A_b = (state.nodes[p[n]]["A"].reshape(3, 3) for n in ("node_a", "node_b"))
            if A_a @ p["axis_a"] @ (A_b @ p[pointer]) < COS_SWING:
                return g.names[int(i)]
    return None


def velocity_error(model: Model, state: State) -> np.ndarray:
    """|D v - nu| (rows,) [m/s, rad/s]; the parts of a row of several parts add up."""
    rows = state.rows
    total = -rows["nu"].copy()
    for side, column in (("node_a", 0), ("node_b", 6)):
        body, D = state.nodes[rows[side]], rows["D"]
        total += np.einsum("ij,ij->i", D[:, column : column + 3], body["v"])
        total += np.einsum("ij,ij->i", D[:, column + 3 : column + 6], body["w"])
    for joint in model.joints:
        first = slice(joint.first_row, joint.first_row + joint.rows)
        for part in range(1, joint.parts):
            start = joint.first_row + part * joint.rows
            total[first] += total[start : start + joint.rows]
    return np.abs(total)


def find_contact_gain(model: Model, state: State, clock: np.void) -> Diagnosis:
    """A contact card whose normal force, or friction, has created energy."""
    number, is_friction = int(clock["index"]), float(clock["value"]) == 1.0
    card = state.card_history[int(clock["current"])][number]
    initial, exchanged = max(float(card["initially_stored"]), 0.0), float(card["exchanged"])
    taken = 0.5 * (exchanged - float(card["work"]))
    gained = float(card["work"]) - initial
    if is_friction:
        gained, exchanged = float(card["friction_work"]), float(card["friction_exchanged"])
        taken, initial = 0.5 * (exchanged - gained), 0.0
    force = "friction" if is_friction else "the normal force"
    cause = (
        f"{force} has created energy: it has given its bodies {gained:.3g} J more than it took "
        f"from them ({taken:.3g} J) and stored at the start ({initial:.3g} J)"
    )
    from crashsolve.system.contact.advice import advice_on_depth, advice_on_gain

    known, shorter = advice_on_gain(model, number), closer(model, state)
    known = known or advice_on_depth(model, number)
    advice = f"{known}; or {shorter}" if known else shorter
    advice += "; control.energy_limit sets the bound"
    return f"contact '{model.contacts[number]}'", cause, advice


def find_law_gain(model: Model, state: State) -> Diagnosis:
    """The spring, belt, hinge or tyre that has created most energy over the energy it exchanged."""
    current, most, where, why = int(state.clock[0]["current"]), 0.0, "", ""
    limit = float(model.control[0]["energy_limit"])
    for group in (g for g in model.force_groups() if g.is_watched):
        rows = zip(group.names, as_rows(group.history[current]), group.output, strict=True)
        for name, now, out in rows:
            share, cause = _gain_of(now, float(out["stored"]), limit)
            if share > most:
                most, where, why = share, f"{families()[group.keyword].entry} '{name}'", cause
    return where, why, f"{closer(model, state)}; control.energy_limit sets the bound"


def _gain_of(now: np.void, stored: float, limit: float) -> tuple[float, str]:
    """Energy that a law has created, over the energy it exchanged, and in words."""
    from crashsolve.system.gain import OVERSTATED, energy_gain, has_gain, overstates

    taken, initial = (
        0.5 * float(now["exchanged"] - now["work_done"]),
        float(now["initially_stored"]),
    )
    gain = float(energy_gain(now, stored))
    if overstates(now, stored, limit, 0.0, 0.0) and not has_gain(now, stored, limit, 0.0, 0.0):
        stated = stored + float(now["dissipated"])
        return 1.0 / (1.0 - OVERSTATED), (
            f"its force reverses a velocity in every step: it reports as dissipated and stored "
            f"{stated:.3g} J, and has received {initial - float(now['work_done']):.3g} J"
        )
    return gain / max(float(now["exchanged"]), 1e-300), (
        f"its force has created energy: it has given its bodies {gain:.3g} J more than it took "
        f"from them ({taken:.3g} J) and stored at the start ({initial:.3g} J)"
    )
