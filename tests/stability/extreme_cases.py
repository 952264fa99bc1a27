"""The stability matrix: every extreme case, the range it is run over, and how a run must end."""

from collections.abc import Iterator
from math import exp

import numpy as np
from long_chains import chain, loop
from sweeps import ALL, EITHER, EXPLICIT, STIFF, Sweep
from train_cases import TRAINS

from crashpost.results.result import Result

SHORTER = "take a shorter step"


def damping_factors(e: float, weak: float) -> dict[str, float]:
    """chi(e) of the laws of restitution, as published (solver/theory/contact.md)."""
    return {
        "flores": 8 * (1 - e) / (5 * e),
        "gonthier": (1 - e * e) / e,
        "hu_guo": 3 * (1 - e) / (2 * e),
        "herbert": 6 * (1 - weak) / ((2 * weak - 1) ** 2 + 3),
        "hunt": 3 * (1 - weak) / 2,
        "lankarani": 3 * (1 - weak * weak) / 4,
        "lee": 3 * (1 - weak) / 4,
    }


def returned(chi: float) -> float:
    """Root x of chi (1 + x) = ln((1 + chi)/(1 - chi x)), by bisection."""
    low, high = 0.0, min(1.0, 1.0 / chi) if chi > 0 else 1.0
    for _ in range(100 if chi > 0 else 0):
        x = 0.5 * (low + high)
        over = (1 + chi) * exp(-chi * (1 + x)) - (1 - chi * x)
        low, high = (x, high) if over < 0 else (low, x)
    return high


def restitutions(result: Result, settings: dict[str, str]) -> Iterator[tuple[str, float, float]]:
    """What every law returns, against the exact relation of its damping factor."""
    given = result.stored_json("parameters")
    for law, chi in damping_factors(given["e"], given["e_weak"]).items():
        x = result.series(f"rbdout.{law}.velocity.z").values[-1] / given["v"]
        # second order: as for the law whose restitution is known in the deck
        yield f"restitution of {law}", abs(x - returned(chi)), 2e-3


def flips(result: Result, settings: dict[str, str]) -> Iterator[tuple[str, float, float]]:
    """How often the nut has turned over: twice in every period."""
    w, x, y, z = (result.series(f"rbdout.nut.quaternion.{c}").values for c in "wxyz")
    given = result.stored_json("parameters")
    momentum = given["w1"], 2.0 * given["w2"], 3.0 * given["w3"]
    axis = 2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)
    along = sum(a * m for a, m in zip(axis, momentum, strict=True))
    found = np.count_nonzero(np.diff(np.sign(along)))
    yield "flips", abs(found - 2 * given["periods"]), 0.0


MATRIX = (
    Sweep(
        "mass ratio across a joint",
        "extreme/mass_ratio",
        "ratio",
        (1, 1e2, 1e4, 1e6, 1e8),
        integrators=(*ALL, "dormand_prince_8"),
    ),
    Sweep(
        "stiffness over 12 decades in one model",
        "extreme/stiffness_decades",
        "top",
        (1, 1e4, 1e8, 1e12),
        integrators=ALL,
        quick=(1e12,),
    ),
    Sweep(
        "joints by bushings, N/m",
        "extreme/bushings",
        "k",
        (1e3, 1e6, 1e9, 1e12),
        integrators=ALL,
        also={"control.tolerance": "1e-10"},
    ),
    Sweep(
        "restitution in every law",
        "extreme/impact",
        "e",
        (0.01, 0.1, 0.5, 0.9, 1),
        integrators=ALL,
        quick=(0.9,),
        look=restitutions,
    ),
    Sweep(
        "restitution of nothing, where a law allows it",
        "extreme/impact",
        "e_weak",
        (0,),
        integrators=ALL,
        look=restitutions,
    ),
    Sweep(
        "restitution of nothing, where damping has no bound",
        "extreme/impact",
        "e",
        (0,),
        "is refused",
        "restitution.* above 0|greater than 0",
        ALL,
        also={"end": "1"},
        quick=(0,),
    ),
    Sweep(
        "impact speed, m/s",
        "extreme/impact",
        "v",
        (1e-6, 1e-3, 1, 1e3),
        integrators=ALL,
        look=restitutions,
    ),
    Sweep(
        "contact at rest for 100 s",
        "extreme/rest",
        "lift",
        (0, 1e-3),
        integrators=("rattle", "radau_iia_5"),
    ),
    Sweep(
        "contact at rest for 100 s, by an implicit method of order 2",
        "extreme/rest",
        "lift",
        (0, 1e-3),
        integrators=("generalized_alpha",),
        also={"control.tolerance": "1e-8"},
    ),
    # it rests at the limit of stability, where a place is as good as the tolerance, and the force
    # that the deck asks for to 1e-6 is the stiffness times the place
    Sweep(
        "contact at rest for 100 s, by an explicit method with error control",
        "extreme/rest",
        "lift",
        (0, 1e-3),
        integrators=("dormand_prince_5",),
        also={"control.tolerance": "1e-10"},
    ),
    Sweep(
        "initial penetration, m",
        "extreme/spheres",
        "depth",
        (1e-9, 1e-6, 1e-3, 0.1),
        integrators=ALL,
        # the deepest leaves at 1600 m/s, and errors are over the largest speed
        also={"control.tolerance": "1e-10"},
        quick=(0.1,),
    ),
    Sweep(
        "initial penetration beyond the middle, m",
        "extreme/spheres",
        "depth",
        (1.5, 2),
        "is refused",
        "begins .* m deep",
        ALL,
        quick=(2,),
    ),
    Sweep(
        "grazing impact, of the speed",
        "extreme/spheres",
        "graze",
        (1e-6, 1e-4, 1),
        integrators=ALL,
    ),
    Sweep(
        "two contacts on one body at once, m/s",
        "extreme/spheres",
        "speed",
        (1e-2, 1, 10),
        integrators=ALL,
        # the others as fast: errors are over the largest speed in the model
        also={"depth": "${(speed**2/(0.8*K))**0.4}"},
    ),
    Sweep(
        "contact of unequal masses",
        "extreme/spheres",
        "ratio",
        (1, 1e3, 1e6, 1e9),
        integrators=ALL,
    ),
    Sweep(
        "contacts too short for a sample, m/s",
        "extreme/fly_past",
        "speed",
        (1, 1e3, 1e6),
        integrators=ALL,
        quick=(1e3,),
    ),
    Sweep(
        "reversals of friction, of bristles and of a brake",
        "extreme/friction_reversal",
        "reversals",
        (1, 100, 10_000),
    ),
    Sweep(
        "reversals of friction",
        "extreme/friction_turns",
        "reversals",
        (1, 100, 10_000),
        integrators=("rattle", "dormand_prince_5", "radau_iia_5"),
    ),
    # step_max does more for it here than the tolerance
    Sweep(
        "reversals of friction by an implicit method of order 2",
        "extreme/friction_turns",
        "reversals",
        (1, 100, 10_000),
        integrators=("generalized_alpha",),
        also={"control.tolerance": "3e-8"},
    ),
    Sweep(
        "spin, rad/s",
        "extreme/free_spin",
        "spin",
        (1, 1e3, 1e5),
        integrators=EXPLICIT,
        also={"control.tolerance": "1e-10"},
        look=flips,
    ),
    Sweep(
        "turning over, periods",
        "extreme/free_spin",
        "periods",
        (1, 100, 1000),
        integrators=EXPLICIT,
        also={"control.tolerance": "1e-10"},
        look=flips,
    ),
    # their unknown is the angular velocity: the momentum errs by the tolerance, in 1e5 steps
    Sweep(
        "spin by an implicit method, rad/s",
        "extreme/free_spin",
        "spin",
        (1, 1e3, 1e5),
        integrators=STIFF,
        also={"control.tolerance": "1e-10", "lost": "1e-5"},
        look=flips,
    ),
    Sweep(
        "turning over by an implicit method, periods",
        "extreme/free_spin",
        "periods",
        (1, 100),
        integrators=STIFF,
        also={"control.tolerance": "1e-10", "lost": "1e-5"},
        look=flips,
    ),
    Sweep(
        "singular mechanisms, start from flat, rad",
        "extreme/singular",
        "start",
        (0, 1e-9, 0.5),
        integrators=("rattle", "dormand_prince_5", "radau_iia_5"),
    ),
    # its multipliers are unknowns of the step, and lose more digits the nearer the configuration is
    Sweep(
        "singular mechanisms by multipliers, errors of a step",
        "extreme/singular",
        "control.tolerance",
        (1e-7, 1e-8, 1e-10),
        EITHER,
        "singular configuration",
        ("generalized_alpha",),
        also={"start": "0.5"},
    ),
    Sweep(
        "the A2 mechanism through its flat configuration, s",
        "benchmark/four_bar_singular",
        "end",
        (10,),
        integrators=("rattle", "dormand_prince_5"),
        # the deck asks for 1e-5 of its size at the end
        also={"control.tolerance": "1e-7"},
    ),
    # how near a step comes to the flat configuration decides whether an implicit method passes it
    # (of order 2, it errs by ten times the deck's bound at 1e-8)
    Sweep(
        "the A2 mechanism by multipliers, errors of a step",
        "benchmark/four_bar_singular",
        "control.tolerance",
        (1e-10, 3e-11),
        EITHER,
        "singular configuration",
        ("generalized_alpha",),
    ),
    Sweep(
        "the A2 mechanism by collocation, errors of a step",
        "benchmark/four_bar_singular",
        "control.tolerance",
        (1e-7, 1e-8, 1e-10),
        EITHER,
        "configuration is singular|singular configuration",
        ("radau_iia_5",),
    ),
    Sweep("redundant constraints", "extreme/redundant", "misfit", (0,), integrators=ALL),
    Sweep(
        "constraints that contradict each other at the start, m",
        "extreme/redundant",
        "misfit",
        (1e-8, 1e-3, 1),
        "is refused",
        "are .* m apart at the start",
        ALL,
        quick=(1e-8,),
    ),
    Sweep(
        "constraints that contradict each other later, m",
        "extreme/redundant",
        "way",
        (1e-3, 1),
        "stops",
        "contradict each other",
        ALL,
    ),
    Sweep(
        "taut beam, N l^2 / 12 E I",
        "extreme/taut",
        "ratio",
        (0.1, 1, 100, 1e4),
        integrators=ALL,
    ),
    Sweep(
        "taut beam at rest, N l^2 / 12 E I",
        "extreme/taut",
        "ratio",
        (0.1, 1, 100, 1e4),
        also={"control.solution": "quasi_static"},
        quick=(1e4,),
    ),
    Sweep("closed loop of bodies", "", "bodies", (4, 100), integrators=ALL, make=loop),
    Sweep(
        "chain of bodies",
        "",
        "bodies",
        (10, 100, 1000),
        integrators=("rattle", "dormand_prince_5", "radau_iia_5"),
        make=chain,
    ),
    # of 1000 rods at up to 1000 m/s it sees errors of 1e-9 and less as the round-off of multipliers
    Sweep(
        "chain of bodies by an implicit method of order 2",
        "",
        "bodies",
        (10, 100, 1000),
        integrators=("generalized_alpha",),
        make=chain,
        also={"control.tolerance": "1e-8"},
    ),
    Sweep(
        "springs of no length, passed by m",
        "extreme/zero_length",
        "miss",
        (0, 1e-15, 1e-6, 1),
        integrators=ALL,
    ),
    Sweep(
        "springs of no length that should push, m",
        "extreme/zero_length",
        "natural",
        (1e-6, 0.1),
        "is refused",
        "no direction",
        ALL,
        quick=(0.1,),
    ),
    Sweep(
        "kinked and all but vertical curves, N/m",
        "extreme/steep_curve",
        "slope",
        (1e3, 1e6, 1e9, 1e12),
        integrators=ALL,
    ),
    Sweep(
        "vertical curves", "extreme/steep_curve", "width", (0,), "is refused", "", ALL, quick=(0,)
    ),
    Sweep("finite segments, springs of a beam", "extreme/segments", "n", (1, 2, 8, 50, 200)),
    Sweep("hinges that soften, over their hardening", "extreme/hinges", "ratio", (1, 10, 100)),
    Sweep(
        "hinges bent beyond a curve that refuses",
        "extreme/hinges",
        "ratio",
        (10, 100),
        "stops",
        "beyond what it is known for",
        also={"curves.fold.extrapolate": "refuse"},
    ),
    Sweep("hinges with growth at high speed, m/s", "extreme/hinges", "speed", (1, 30, 1000)),
    Sweep(
        "a table used up to its last share",
        "extreme/table_spent",
        "spent",
        (0.5, 0.9, 0.999),
        # methods that try a step again
        integrators=("dormand_prince_5", *STIFF),
        quick=(0.9,),
    ),
    Sweep(
        "tables read past their end, s",
        "extreme/table_end",
        "last",
        (0.1, 0.5, 2),
        integrators=ALL,
        # where a force of the time has a corner is left to the estimated error of the step
        also={"control.tolerance": "1e-10"},
        quick=(0.5,),
    ),
    Sweep(
        "tables read past their end though they refuse",
        "extreme/table_end",
        "refused",
        (1,),
        "stops",
        "outside its range",
        ALL,
        quick=(1,),
    ),
    Sweep(
        "steps as they should be",
        "extreme/long_step",
        "factor",
        (1,),
        # generalized_alpha lags by more than the (w h)^2/24 that the deck allows
        integrators=("rattle", "dormand_prince_5", "radau_iia_5"),
        also={"control.step": "${step}"},
    ),
    Sweep(
        "steps too long by",
        "extreme/long_step",
        "factor",
        (10, 1e3, 1e6, 1e9),
        "stops",
        SHORTER,
        ("rattle", "dormand_prince_5"),
        # a fixed one also where errors of steps are known
        also={"control.step": "${step}"},
        quick=(1e6,),
    ),
    # ten steps a period are not too long for order 5
    Sweep(
        "steps too long for an implicit method by",
        "extreme/long_step",
        "factor",
        (1e3, 1e6, 1e9),
        "stops",
        SHORTER,
        STIFF,
        also={"control.step": "${step}"},
    ),
    Sweep("no time at all", "extreme/duration", "steps", (0,), integrators=ALL, quick=(0,)),
    Sweep("steps in the run", "extreme/duration", "steps", (1, 10, 1e6)),
    Sweep(
        "steps in the run, of high order",
        "extreme/duration",
        "steps",
        (1, 10, 1e6),
        integrators=("dormand_prince_5", "dormand_prince_8"),
        also={"control.step": "${step}", "exact": "1"},
    ),
    # nearer to the critical 4/3 the force grows so slowly that the weight acts meanwhile
    Sweep(
        "Painleve's rod, friction",
        "benchmark/painleve_rod",
        "mu_above",
        (1.8, 2, 3, 5),
        integrators=ALL,
        # the peak of the force is known at the ends of steps alone
        also={"control.tolerance": "1e-10"},
    ),
    Sweep(
        "full friction from a sliding speed on, m/s",
        "extreme/friction_stops",
        "v1",
        (1e-12, 1e-9, 1e-6),
    ),
    Sweep("folds that stick and slip, friction", "extreme/folding_tube", "mu", (0.1, 0.25, 0.4)),
    Sweep(
        "elements as small as their walls are thick, friction",
        "extreme/small_elements",
        "mu",
        (0, 0.2),
    ),
    *TRAINS,
)
