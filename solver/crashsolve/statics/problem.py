"""Why there is no next equilibrium to go to, as the user reads it."""

from crashsolve.foundation.errors import SolverError
from crashsolve.model import ledger as energy
from crashsolve.statics.equations import Equations
from crashsolve.statics.limit_point import LoadSteps, is_at_limit_point
from crashsolve.system.diagnosis import curve_end


class Problem:
    """Reason why there is no next equilibrium: "lost", "balance", "unstable mode", "bifurcation",
    "jump", "limit", "lost path", "free motion", "end of curve"; "total" where a run that ended is
    out of balance.
    """

    def __init__(self, kind: str, target: float, location: str = "the model") -> None:
        self.kind, self.target, self.location = kind, target, location

    def error(self, engine: Equations, moment: float) -> SolverError:
        """The error for the user, whose results end with the equilibrium at a moment."""
        time, cycle = engine.loading.time(moment), int(engine.clock.cycle)
        if self.kind == "end of curve":
            return SolverError(time, cycle, *curve_end(engine.model, engine.state, engine.clock))
        texts = {"lost": self._lost, "balance": self._unbalanced, "unstable mode": self._unstable}
        texts |= {
            "total": self._unbalanced_run,
            "bifurcation": self._bifurcation,
            "jump": self._beyond_limit_point,
            "limit": self._at_limit_point,
            "lost path": self._lost_path,
            "free motion": self._free_motion,
        }
        cause, advice = texts[self.kind](engine, moment)
        return SolverError(time, cycle, self.location, cause, advice)

    def _lost(self, engine: Equations, moment: float) -> tuple[str, str]:
        return (
            f"no equilibrium found for the next load step, {engine.loading.message(self.target)} "
            f"(last correction {float(engine.clock.value):.2g}, {engine.forces.message()})",
            "support what can move freely; let loads rise along a curve, in more steps; beyond a "
            "limit load there is no equilibrium: where a structure collapses plastically, "
            "prescribe its motion by a driver, whose reaction is the load; where it snaps through, "
            "follow the path of equilibria by control.path: arc_length, or set "
            "solution: transient with damping",
        )

    def _free_motion(self, engine: Equations, moment: float) -> tuple[str, str]:
        return (
            f"no equilibrium found for the next load step, {engine.loading.message(self.target)}: "
            "however far it moves, the forces stay as they are "
            f"({engine.forces.message()})",
            "support what can move freely, rigid motions and mechanisms; where a structure "
            "collapses plastically there is no equilibrium beyond the limit load: prescribe its "
            "motion by a driver, whose reaction is the load",
        )

    def _unbalanced(self, engine: Equations, moment: float) -> tuple[str, str]:
        ratio = 100.0 * engine.ledger[energy.IMBALANCE] / (engine.ledger[energy.LARGEST] or 1.0)
        return (
            f"the energy balance is off in the load step to {engine.loading.message(self.target)} "
            f"({ratio:.3g} % of the largest energy): the equilibrium found at its end is not the "
            "one that continues from its start",
            "take more steps; where a structure collapses, prescribe its motion by a driver, whose "
            "reaction is the load; where it snaps from one equilibrium to another, set "
            "solution: transient with damping; control.energy_limit sets the bound",
        )

    def _unbalanced_run(self, engine: Equations, moment: float) -> tuple[str, str]:
        ratio = 100.0 * engine.ledger[energy.IMBALANCE] / (engine.ledger[energy.LARGEST] or 1.0)
        return (
            f"the energy balance of the run is off by {ratio:.3g} % of the largest energy",
            "take more steps: the work of loads and drivers in a load step is that of the mean of "
            "their forces before and after it; control.energy_limit sets the bound",
        )

    def _unstable(self, engine: Equations, moment: float) -> tuple[str, str]:
        at = engine.loading.message
        return (
            f"the equilibrium becomes unstable between {at(moment)} and {at(self.target)}: "
            "beyond that load the model moves away from it, as a column buckles or a frame "
            "collapses",
            "the load there is the critical load; to continue give a small imperfection or side "
            "load, prescribe the motion by a driver, whose reaction is the load, or set "
            "solution: transient; a body that is balanced above its joint needs a support",
        )

    def _beyond_limit_point(self, engine: Equations, moment: float) -> tuple[str, str]:
        return self._limit_point(
            engine,
            moment,
            "the equilibrium under the higher load is far away (snap-through), and no path of "
            "equilibria leads there while the load rises",
        )

    def _at_limit_point(self, engine: Equations, moment: float) -> tuple[str, str]:
        return self._limit_point(
            engine,
            moment,
            "displacements grow without bound there, and no equilibrium was found under the higher "
            "load",
        )

    def _limit_point(self, engine: Equations, moment: float, what: str) -> tuple[str, str]:
        at = engine.loading.message
        return (
            f"a limit point between {at(moment)} and {at(self.target)}: {what}",
            "the load there is the limit load; to follow the path beyond it set control.path: "
            "arc_length, prescribe the motion by a driver, whose reaction is the load, or set "
            "solution: transient with damping",
        )

    def _lost_path(self, engine: Equations, moment: float) -> tuple[str, str]:
        return (
            "no further equilibrium found along the path, from the loads of "
            f"{engine.loading.message(moment)} ({engine.forces.message()})",
            "take more steps: the path may bend sharply, or branch where symmetry is lost; a small "
            "imperfection or side load makes such a branch smooth",
        )

    def _bifurcation(self, engine: Equations, moment: float) -> tuple[str, str]:
        return (
            "any one of them may continue to yield while the others unload, all with equal "
            "stability: nothing in the model decides which",
            "make one of them a little weaker, or give a small imperfection or side load",
        )


def explanation(engine: LoadSteps, problems: list[Problem]) -> Problem:
    """The earliest unstable mode, which explains the failures beyond it; else the last problem,
    which is that of a limit point where no equilibrium was found beside one.
    """
    displacements = [problem for problem in problems if problem.kind == "unstable mode"]
    if displacements:
        return min(displacements, key=lambda problem: problem.target)
    last = problems[-1]
    is_limit = last.kind == "lost" and is_at_limit_point(engine)
    return Problem("limit", last.target, last.location) if is_limit else last
