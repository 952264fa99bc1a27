"""The end of the log: steps, constraints, energy balance, cost, CPU time by stage, references."""

from crashsolve.model.ledger import ENTRIES, LARGEST
from crashsolve.simulation.progress import Account, balance
from crashsolve.system.engine import Engine


def write_totals(account: Account) -> None:
    """Write the totals of the run to the log. Raises OutputError."""
    engine, log = account.engine, account.log
    log.line()
    log.facts(_steps(engine) | _constraints(engine) | _cost(account) | _remarks(account))
    log.section("energy", _energies(engine))
    account.close_stages()
    log.timing(account.cpu)
    log.citations(engine.model.citations)


def _steps(engine: Engine) -> dict[str, str]:
    clock = engine.clock
    lines = {
        "steps accepted, rejected": f"{int(clock['cycle'])}, {int(clock['rejected'])}",
        "onsets located": f"{int(clock['located'])}",
        "energy balance": f"{balance(engine):.3g} %",
    }
    if engine.model.nodal_groups:
        most = float(engine.model.nodal_loads["touched"]["shortened"][0])
        lines["stable step of elements over that with contact"] = f"{most:.3g} at most"
    return lines


def _constraints(engine: Engine) -> dict[str, str]:
    """Rows of the joints and their errors; empty without joints."""
    clock, saddle = engine.clock, engine.model.saddle
    if not engine.model.joints:
        return {}
    return {
        "constraint rows, redundant": f"{saddle.rows()}, {saddle.redundant()}",
        "iterations per step": f"{clock['iterations'] / max(int(clock['cycle']), 1):.2f}",
        "largest constraint error, in position and velocity": (
            f"{float(clock['residual']):.2g} and {float(clock['rate_residual']):.2g} 1/s, "
            "of the model's size"
        ),
    }


def _cost(account: Account) -> dict[str, str]:
    """Average steps and their cost; empty for a run without steps."""
    phases, model = account.phases, account.engine.model
    if phases is None or not phases.cycles():
        return {}
    factor = account.cpu_seconds() / phases.simulated()
    # a step too short for the clock of the process has no rate
    stepping = max(account.cpu["steps"], 1e-6)
    elements = sum(int(g.parameters["element_count"].sum()) for g in model.element_groups())
    rate = f"{elements * phases.cycles() / stepping:.3g} of CPU, {elements} elements"
    return phases.average_steps() | {
        "CPU per step": f"{1e6 * account.cpu['steps'] / phases.cycles():.3g} us",
        **({"element-cycles per second": rate} if elements else {}),
        "real-time factor": f"{factor:.3g} s of CPU per simulated second",
    }


def _remarks(account: Account) -> dict[str, str]:
    """Remarks: contacts that never touched, undetermined motions, deleted elements."""
    remarks_of, remarks = {}, account.remarks
    for name, what in (
        ("untouched", "contacts that never touched"),
        (
            "below_floor",
            "contacts loaded below their speed_floor, damped as at rest (impacts of bodies within "
            "joints that are as slow return more than their restitution: give a lower one)",
        ),
        ("undeformed", "parts that never deformed"),
        ("undetermined", "joints whose share of a force is arbitrary"),
        ("severity", "Severity Index, and its error by the samples"),
        ("unfiltered", "sensors with too few samples for their filter"),
    ):
        if remarks.get(name):
            remarks_of[what] = ", ".join(remarks[name])
    for part, lost in remarks.get("deleted", {}).items():
        count, first, last = lost["count"], lost["first"], lost["last"]
        when = (
            f"at {first:.6g} s" if count == 1 or first == last else f"{first:.6g} to {last:.6g} s"
        )
        remarks_of[f"elements of {part} deleted"] = f"{count}, {when}"
    return remarks_of


def _energies(engine: Engine) -> list[str]:
    """The ledger at the end, in J and in % of the largest energy."""
    ledger = engine.ledger
    largest = float(ledger[LARGEST]) or 1.0
    return [
        f"{name.replace('_', ' '):20} {value:14.6e} J {100 * value / largest:9.3f} %"
        for name, value in zip(ENTRIES, map(float, ledger), strict=True)
        if value != 0.0
    ]
