"""Warnings of belts: flows that were not found, surfaces and retractors without effect in a run."""

from collections.abc import Iterator

import numpy as np

from crashsolve.system.engine import Engine


def belt_warnings(engine: Engine) -> list[str]:
    """Flows of webbing that were not found, and what surfaces and retractors did not do so far."""
    now, warnings = float(engine.clock["time"]), []
    for group in engine.model.groups:
        if group.keyword != "belts":
            continue
        history = group.history[int(engine.clock["current"])]
        for name, p, state in zip(group.names, group.parameters, history, strict=True):
            texts = [*_unsettled(p, state), *_untouched(p, state)]
            texts += _ineffective(p, state, now) if p["spool"] else ()
            warnings += [f"belt '{name}': {text}" for text in texts]
    return warnings


def _unsettled(p: np.void, state: np.void) -> Iterator[str]:
    """Of a belt whose flows were not found in some steps."""
    if state["unsettled"]:
        yield (
            f"the flow of webbing through its {p['segments'] - 1} rings did not converge in "
            f"{state['unsettled']} steps: a force was up to {state['unbalanced']:.3g} N off its "
            "friction. Where forces differ much along the belt, by large friction or slack, flows "
            "at its loose end have no effect on the others; take shorter steps if it matters"
        )


def _untouched(p: np.void, state: np.void) -> Iterator[str]:
    """Surfaces of a route that the belt passed by from the start of the run to its end."""
    # of scenes with belts alone
    from crashsolve.belts._route import surface_row

    for j in np.flatnonzero(p["surface"]):
        if not state["has_lain"][surface_row(j)]:
            yield (
                f"it never lay on the surface of its fitting {j + 1}, which it passed by: its "
                "body was not held; render the start, and lead the belt around the surface by rings"
            )


def _ineffective(p: np.void, state: np.void, now: float) -> Iterator[str]:
    """Of one retractor at a time [s]."""
    is_armed = bool(np.isfinite(p["fires"]))
    if is_armed and p["fires"] > now:
        yield (f"its pretensioner fires at {p['fires']:g} s, after the end of the run at {now:g} s")
    elif is_armed and state["wound_in"] == 0.0:
        yield "its pretensioner fired and wound nothing in: the belt was tighter than its curve"
    if not state["locked"]:
        yield f"its retractor did not lock until the end, at {now:g} s: {_unmet(p)}"
    elif p["limiter"] and state["paid_out"] == 0.0 and not state["emptied"]:
        yield (
            "its load limiter paid nothing out: the force at the retractor stayed below the curve "
            "of the limiter"
        )


def _unmet(p: np.void) -> str:
    """The conditions of the lock, which were not met."""
    conditions = {
        "lock_time": f"lock_time is {p['lock_time']:g} s",
        "lock_acceleration": f"its body did not reach {p['lock_acceleration']:g} m/s^2",
        "lock_rate": f"the webbing did not reach {p['lock_rate']:g} m/s",
        "fires": "its pretensioner locks it after winding",
    }
    return ", ".join(text for word, text in conditions.items() if np.isfinite(p[word]))
