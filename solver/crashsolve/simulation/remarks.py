"""Remarks of a run: contacts and parts without effect, deleted elements, a collapsed step."""

from pathlib import Path

import numpy as np

from crashsolve.foundation.curve import HOLD, REFUSE, curve_value
from crashsolve.foundation.distinct import distinct
from crashsolve.foundation.rows import as_rows
from crashsolve.model.corners import curves_of_time
from crashsolve.model.ledger import HOURGLASS, INTERNAL, LARGEST
from crashsolve.output.files import Json
from crashsolve.output.peaks import Extremes
from crashsolve.system.diagnosis import bodies_of_pair
from crashsolve.system.engine import Engine

# a strain beyond round-off, and the share of the largest energy that one costs at least
STRAINED, STORED = 1e-10, 1e-18
# share of the model's size that is no depth
NO_DEPTH = 1e-9
# share of the half thicknesses of both sides, beyond which a touch is deep
DEEP = 0.25
# crushed length over length at which the folds of a square tube touch: Abramowicz (1983), Int. J.
# Impact Engng 1, 309-317, has 0.73
FOLDED = 0.73
# share of internal energy in hourglass modes that is too much
MUCH_HOURGLASS = 0.05
# columns of beams with strains, or strains over a length
OF_BEAMS = ("strain", "curvature")
# of so many steps the average counts, and by so much shorter is a collapse
STEPS, COLLAPSED = 20, 1e-3


def touching_at_start(engine: Engine) -> list[str]:
    """Contacts that touch when the run begins, with the energy that sets their bodies in motion."""
    deepest = deepest_pairs(engine)
    return overloaded_tyres(engine) + [
        f"contact '{name}' touches at the start: it begins up to {card['depth']:.3g} m deep, with "
        f"a stored energy of {card['stored']:.6g} J{deepest.get(name, '')}"
        for name, card in zip(engine.model.contacts, engine.state.cards, strict=True)
        if card["touching"] and card["depth"] > 0.0
    ]


def deepest_pairs(engine: Engine) -> dict[str, str]:
    """Of each contact with several pairs of elements, the two bodies that begin deepest."""
    current, model = int(engine.clock["current"]), engine.model
    counts = np.zeros(len(model.contacts), int)
    deepest, texts = np.zeros(len(model.contacts)), dict[str, str]()
    for group in model.contact_groups:
        depth, cards = group.history["depth"][current], group.parameters["card"]
        counts += np.bincount(cards, minlength=len(counts))
        for card in distinct(cards[depth > deepest[cards]]):
            pair = int(np.argmax(np.where(cards == card, depth, 0.0)))
            deepest[card], (a, b) = depth[pair], bodies_of_pair(model, group, pair)
            texts[model.contacts[card]] = f"; deepest is {a} on {b}"
    several = {model.contacts[card] for card in np.flatnonzero(counts > 1)}
    return {name: text for name, text in texts.items() if name in several}


def overloaded_tyres(engine: Engine) -> list[str]:
    """Tyres that begin with more than twice all loads together: a wheel stands in an obstacle.

    Where no load acts, as on a test rig, the force is meant.
    """
    load = float(np.linalg.norm(engine.state.nodes["external"][0, :3]))
    return [
        f"tyre '{name}' is pressed by {force:.4g} N at the start, and all loads together are "
        f"{load:.4g} N: its wheel begins in an obstacle, or too low on the road; move it, or set "
        "control: {start: equilibrium}"
        for group in engine.model.groups
        if group.keyword == "tyres"
        for name, force in zip(group.names, group.output["normal"], strict=True)
        if force > 2.0 * load > 0.0
    ]


def contacts_without_depth(engine: Engine) -> list[str]:
    """Contacts that begin without any depth between bodies at rest, while loads act."""
    model, state = engine.model, engine.state
    loaded = any(group.keyword == "loads" for group in model.groups)
    if not loaded or model.phases or model.control[0]["follows_path"]:
        return []
    motion = np.hstack([state.nodes["v"], state.nodes["w"]])
    at_rest: np.ndarray = np.abs(motion).max(axis=1) == 0.0
    # nodes of shells and faces begin apart: whether they are at rest, they touch later
    moving = {int(group.arrays["p"]["card"][0]) for group in model.nodal_groups}
    for group in model.contact_groups:
        for side, elements in (("a", group.elements_a), ("b", group.elements_b)):
            still = at_rest[elements["node"][group.parameters[side]]]
            moving |= set(group.parameters["card"][~still].tolist())
    return [
        f"contact '{name}' begins without penetration under loads: its force will overshoot to "
        "twice the force at rest or more; control: {start: equilibrium} begins in equilibrium"
        for number, name in enumerate(model.contacts)
        if number not in moving and abs(state.cards[number]["depth"]) <= NO_DEPTH * model.size
    ]


def deep_round_contacts(engine: Engine) -> list[str]:
    """Contacts of round sides so deep that one can slip by the other: no other check finds this."""
    now = engine.state.card_history[int(engine.clock["current"])]
    return deep_points(engine) + [
        f"contact '{name}': the penetration reached {100.0 * share:.0f} % of the half thicknesses "
        "of both sides; such a soft contact hardly keeps one body from passing through the other: "
        "make the contact stiffer"
        for name, share in zip(engine.model.contacts, now["peak_share"], strict=True)
        if share > DEEP
    ]


def deep_points(engine: Engine) -> list[str]:
    """Contacts of points and of nodes of shells that penetrated deeply."""
    from crashsolve.system.contact.advice import HALFWAY

    worst: dict[str, tuple[float, float, float]] = {}
    for g in engine.model.nodal_groups:
        deepest, thick = g.depth_and_middle
        one = (deepest / thick, deepest, thick)
        name = engine.model.contacts[int(g.arrays["p"]["card"][0])]
        worst[name] = max(worst.get(name, one), one)
    return [
        f"contact '{name}': points penetrated {depth:.3g} m deep into the body they struck, "
        f"{100.0 * share:.0f} % of the {thick:.3g} m from its surface to its middle; beyond the "
        "middle they come out on the other side: make the contact stiffer, or that body thicker"
        for name, (share, depth, thick) in worst.items()
        if share > HALFWAY
    ]


def range_warnings(engine: Engine) -> list[str]:
    """Warnings of laws outside their range of validity."""
    # when a run ends, as all that follow
    from crashsolve.simulation.belts import belt_warnings
    from crashsolve.simulation.self_penetration import shells_through_themselves

    checks = (
        *(read_beyond, deep_round_contacts, hourglass_share, crushed_hinges, compressed, crushed),
        shells_through_themselves,
        belt_warnings,
    )
    return [text for of in checks for text in of(engine)]


def remarks(engine: Engine, extremes: Extremes, history: Path) -> Json:
    """Remarks at the end of a run, for status.json."""
    return {
        "untouched": contacts_without_touch(engine),
        "below_floor": contacts_below_speed_floor(engine),
        "undeformed": undeformed(engine, extremes),
        "deleted": deleted(engine, history),
    }


def contacts_below_speed_floor(engine: Engine) -> list[str]:
    """Contacts with touches that were pressed on while slower than their speed floor."""
    from crashsolve.system.flags import contact_flags

    cards = {card for card, _ in contact_flags(engine.model, engine.state, "REMARKS")}
    return [engine.model.contacts[card] for card in sorted(cards)]


def read_beyond(engine: Engine) -> list[str]:
    """Curves of displacement or rotation that were read beyond their last point, and how far."""
    model, curves_beyond = engine.model, []
    of_time = curves_of_time(model)
    for name, first in model.curve_names.items():
        points, row = model.curves, model.curves[first]
        last = float(points["x"][row["last"]])
        reached = float(row["farthest"])
        if first in of_time or reached <= last or row["beyond"] == REFUSE:
            continue
        value = float(curve_value(as_rows(points), first, reached)[0])
        how = "held at its last value" if row["beyond"] == HOLD else "continued with its end slope"
        hinge, _, field = name.partition(".")
        if field:
            read = (
                f"hinge '{hinge}' deformed to {reached:.6g} (plastic displacement or plastic "
                f"work, SI), beyond the end of its {field}, {last:.6g}: there it was {how}"
            )
        else:
            read = (
                f"curve '{name}' was read at {reached:.6g}, beyond its last point {last:.6g} "
                f"(SI): there it was {how} and gave {value:.6g}"
            )
        curves_beyond.append(f"{read}; give it more points")
    return curves_beyond


def hourglass_share(engine: Engine) -> list[str]:
    """Warning that hourglass modes have more than a twentieth of the internal energy."""
    at_most = float(engine.ledger[HOURGLASS])
    internal = float(engine.ledger[INTERNAL])
    if at_most <= MUCH_HOURGLASS * internal or internal <= STORED * float(engine.ledger[LARGEST]):
        return []
    return [
        f"hourglass modes store {at_most:.4g} J, {100.0 * at_most / internal:.3g} % of the "
        f"internal energy, {internal:.4g} J: more than {100.0 * MUCH_HOURGLASS:.0f} % is a sign "
        "that the mesh is too coarse for this deformation; take smaller elements, or element: "
        "fully_integrated"
    ]


def crushed_hinges(engine: Engine) -> list[str]:
    """Hinges that bore more along their beam than its section does when it is crushed."""
    worst: tuple[float, str, float] = (1.0, "", 0.0)
    count = 0
    for g in engine.model.groups:
        if "axial_yield" not in (g.parameters.dtype.names or ()):
            continue
        peak = g.history["peak_axial"][int(engine.clock["current"])]
        over = peak / g.parameters["axial_yield"]
        count += int((over > 1.0).sum())
        k = int(over.argmax())
        worst = max(worst, (float(over[k]), g.names[k], float(peak[k])))
    if not count:
        return []
    share, name, force = worst
    others = f" ({count - 1} other hinges exceed theirs too)" if count > 1 else ""
    return [
        f"hinge '{name}' carried {force:.4g} N along its beam, {share:.3g} times the force at "
        f"which its section yields{others}: hinges bend and do not shorten, so that such a force "
        "is too large; take deformation: segments, beams or shells"
    ]


def compressed(engine: Engine) -> list[str]:
    """Members that bore more along them than as columns, each by its worst hinge or spring."""
    loads_of, current = dict[str, tuple[float, float]](), int(engine.clock["current"])
    for g in engine.model.groups:
        if "buckling" not in (g.parameters.dtype.names or ()):
            continue
        peaks = g.history["peak_compression"][current]
        for name, peak, load in zip(g.names, peaks, g.parameters["buckling"], strict=True):
            # NAME_start, NAME_3: hinges and springs of one member
            member, force = name.rpartition("_")[0] or name, float(peak)
            if force > load:
                loads_of[member] = max(
                    loads_of.get(member, (0.0, 0.0)), (force / float(load), force)
                )
    if not loads_of:
        return []
    name, (share, force) = max(loads_of.items(), key=lambda one: one[1])
    others = f" ({len(loads_of) - 1} other members exceed theirs too)" if len(loads_of) > 1 else ""
    return [
        f"member '{name}' was compressed by {force:.4g} N, {share:.3g} times its Euler load "
        f"with hinged ends{others}: a perfectly straight member does not buckle in a computation; "
        "give it a small bow or a side load (the Euler load is 4 times as large with clamped "
        "ends, and a quarter with one end free)"
    ]


def crushed(engine: Engine) -> list[str]:
    """Segments and beams that are shorter at the end than a fully folded tube."""
    shortened: list[tuple[float, str]] = []
    for g in engine.model.groups:
        names = g.output.dtype.names or () if "length" in (g.parameters.dtype.names or ()) else ()
        if g.keyword == "parts" and "strain" in names and g.output["strain"].ndim == 2:
            stretch = g.output["strain"][:, 0]
        elif g.keyword == "springs" and "plastic_strain" in names:
            stretch = g.output["displacement"][:, 0] / g.parameters["length"]
        else:
            continue
        shortened += [(float(-e), name) for e, name in zip(stretch, g.names, strict=False)]
    over = sorted((one for one in shortened if one[0] > FOLDED), reverse=True)
    if not over:
        return []
    share, name = over[0]
    others = f" ({len(over) - 1} more beyond that)" if len(over) > 1 else ""
    how = "it is turned inside out" if share >= 1.0 else "its folds are solid"
    return [
        f"element '{name}' is {100.0 * share:.3g} % shorter than at the start{others}: a tube "
        f"folds to some {100.0 * (1.0 - FOLDED):.0f} % of its length and then bears any force, "
        f"which segments and beams do not represent; {how}, and the model is too soft from "
        "there on; take deformation: shells with self_contact, a longer member, or less energy"
    ]


def contacts_without_touch(engine: Engine) -> list[str]:
    """Contacts that never touched."""
    now = engine.state.card_history[int(engine.clock["current"])]
    ineffective = (now["onsets"] == 0) & (now["peak_normal"] == 0.0)
    return [
        name
        for name, is_ineffective in zip(engine.model.contacts, ineffective, strict=True)
        if is_ineffective
    ]


def undeformed(engine: Engine, extremes: Extremes) -> list[str]:
    """Parts that never deformed beyond round-off, at any sample."""
    least, names = STORED * float(engine.ledger[LARGEST]), []
    for g in engine.model.groups:
        if g.keyword != "parts" or not g.names:
            continue
        if hasattr(g.module, "KINDS"):
            largest = _largest(extremes, f"matsum-{g.type}", ("strain", "plastic"))
            names += [name for name in g.names if largest[name] <= least]
            continue
        strained: dict[str, float] = {}
        for name, strain in _largest(extremes, f"elout-{g.type}", OF_BEAMS).items():
            part = name.rpartition("_")[0]
            strained[part] = max(strained.get(part, 0.0), strain)
        names += [part for part, strain in strained.items() if strain < STRAINED]
    return names


def _largest(extremes: Extremes, family: str, columns: tuple[str, ...]) -> dict[str, float]:
    """Largest magnitude of some columns of a family, by entity, where they are written."""
    numbers = [k for k, f in enumerate(extremes.families) if f.name == family]
    if not numbers:
        return {}
    number, its = numbers[0], extremes.families[numbers[0]]
    which = [k for k, c in enumerate(its.columns) if c.path.split("/")[0] in columns]
    if {its.columns[k].path.split("/")[0] for k in which} != set(columns):
        return {}
    bounds = np.abs([extremes.least[number][which], extremes.greatest[number][which]])
    return dict(zip(its.ids, bounds.max(axis=(0, 1)).tolist(), strict=True))


def deleted(engine: Engine, history: Path) -> dict[str, Json]:
    """Elements deleted by part: their number, and when the first and the last went [s]."""
    groups = [g for g in engine.model.element_groups() if g.output["deleted"].any()]
    if not groups:
        return {}
    import h5py

    deletions = {}
    with h5py.File(history) as file:
        for g in groups:
            family = file[f"matsum-{g.type}"]
            time, counts = family["time"][:], family["deleted"][:]
            rows = np.isfinite(time)
            for name, count in zip(family["ids"].asstr(), counts[rows].T, strict=True):
                if count.any():
                    first, last = np.argmax(count > 0.0), np.argmax(count == count.max())
                    deletions[str(name)] = {
                        "count": int(count.max()),
                        "first": float(time[first]),
                        "last": float(time[last]),
                    }
    return deletions


class StepWatch:
    """Detects an average step that has fallen to a thousandth of its earlier value."""

    def __init__(self) -> None:
        self._longest = 0.0
        self._from: tuple[float, int] | None = None
        self._has_fallen = False

    def warning(self, time: float, cycle: int) -> str:
        """The warning at this time [s] and cycle; empty for none, or for one given before."""
        if self._from is None or cycle < self._from[1]:
            self._from = time, cycle
        steps = cycle - self._from[1]
        if steps < STEPS or self._has_fallen:
            return ""
        average = (time - self._from[0]) / steps
        self._from = time, cycle
        self._longest = max(self._longest, average)
        if average > COLLAPSED * self._longest:
            return ""
        self._has_fallen = True
        return (
            f"the average step has fallen from {self._longest:.3g} s to {average:.3g} s "
            f"at t = {time:.6g} s, cycle {cycle}"
        )
