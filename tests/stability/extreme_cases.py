"""The stability matrix: every extreme case, the range it is run over, and how a run must end."""

from collections.abc import Iterator
from math import exp

import numpy as np
from long_chains import chain, loop
from sweeps import ADAPTIVE, ALL, BOTH, RATTLE, STIFF, Sweep

from crashpost.result import Result

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
        integrators=ALL,
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
        integrators=BOTH,
        quick=(0.9,),
        look=restitutions,
    ),
    Sweep(
        "restitution of nothing, where a law allows it",
        "extreme/impact",
        "e_weak",
        (0,),
        integrators=BOTH,
        look=restitutions,
    ),
    Sweep(
        "restitution of nothing, where damping has no bound",
        "extreme/impact",
        "e",
        (0,),
        "is refused",
        "restitution.* above 0|greater than 0",
        BOTH,
        also={"end": "1"},
        quick=(0,),
    ),
    Sweep(
        "impact speed, m/s",
        "extreme/impact",
        "v",
        (1e-6, 1e-3, 1, 1e3),
        look=restitutions,
    ),
    # below, the depth of 1e-9 m nears the round-off of a position, and error control fails on it
    Sweep(
        "impact speed with error control, m/s",
        "extreme/impact",
        "v",
        (1e-3, 1, 1e3),
        integrators=ADAPTIVE,
        look=restitutions,
    ),
    Sweep(
        "contact at rest for 100 s",
        "extreme/rest",
        "lift",
        (0, 1e-3),
        integrators=RATTLE + STIFF,
    ),
    Sweep(
        "initial penetration, m",
        "extreme/spheres",
        "depth",
        (1e-9, 1e-6, 1e-3, 0.1),
        integrators=BOTH,
        # the deepest leaves at 1600 m/s, and errors are over the largest speed
        also={"control.tolerance": "1e-9"},
        quick=(0.1,),
    ),
    Sweep(
        "initial penetration beyond the middle, m",
        "extreme/spheres",
        "depth",
        (1.5, 2),
        "is refused",
        "begins .* m deep",
        BOTH,
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
        integrators=BOTH,
        quick=(1e3,),
    ),
    Sweep("reversals of friction", "extreme/friction_reversal", "reversals", (1, 100, 10_000)),
    Sweep(
        "spin, rad/s",
        "extreme/free_spin",
        "spin",
        (1, 1e3, 1e5),
        integrators=BOTH,
        also={"control.tolerance": "1e-10"},
        look=flips,
    ),
    Sweep(
        "turning over, periods",
        "extreme/free_spin",
        "periods",
        (1, 100, 1000),
        integrators=BOTH,
        also={"control.tolerance": "1e-10"},
        look=flips,
    ),
    Sweep("singular mechanisms, start from flat, rad", "extreme/singular", "start", (0, 1e-9, 0.5)),
    Sweep(
        "the A2 mechanism through its flat posture, s", "benchmark/four_bar_singular", "end", (10,)
    ),
    Sweep("redundant constraints", "extreme/redundant", "misfit", (0,), integrators=ALL),
    Sweep(
        "constraints that contradict each other at the start, m",
        "extreme/redundant",
        "misfit",
        (1e-8, 1e-3, 1),
        "is refused",
        "are .* m apart at the start",
        BOTH,
        quick=(1e-8,),
    ),
    Sweep(
        "constraints that contradict each other later, m",
        "extreme/redundant",
        "way",
        (1e-3, 1),
        "stops",
        "contradict each other",
        BOTH,
    ),
    Sweep("closed loop of bodies", "", "bodies", (4, 100), integrators=BOTH, make=loop),
    Sweep("chain of bodies", "", "bodies", (10, 100, 1000), make=chain),
    Sweep(
        "chain of bodies with error control",
        "",
        "bodies",
        (10, 100),
        integrators=ADAPTIVE,
        make=chain,
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
        BOTH,
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
        "vertical curves", "extreme/steep_curve", "width", (0,), "is refused", "", BOTH, quick=(0,)
    ),
    Sweep(
        "tables read past their end, s",
        "extreme/table_end",
        "last",
        (0.1, 0.5, 2),
        integrators=BOTH,
        quick=(0.5,),
    ),
    Sweep(
        "tables read past their end though they refuse",
        "extreme/table_end",
        "refused",
        (1,),
        "stops",
        "outside its range",
        BOTH,
        quick=(1,),
    ),
    Sweep("steps as they should be", "extreme/long_step", "factor", (1,)),
    Sweep(
        "steps too long by",
        "extreme/long_step",
        "factor",
        (10, 1e3, 1e6, 1e9),
        "stops",
        SHORTER,
        quick=(1e6,),
    ),
    Sweep("steps in the run", "extreme/duration", "steps", (0, 1, 10, 1e6), quick=(0,)),
    # nearer to the critical 4/3 the force grows so slowly that the weight acts meanwhile
    Sweep(
        "Painleve's rod, friction",
        "benchmark/painleve_rod",
        "mu_above",
        (1.8, 2, 3, 5),
        integrators=BOTH,
    ),
)
