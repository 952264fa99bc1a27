"""Belt: webbing through rings from anchor to anchor, without mass, which pulls only.

    T_high <= T_low exp(mu beta) at rings,   sum L_i constant

as in `_webbing.py`, `_flow.py` and `_route.py`. Consequence to test: webbing drawn through
a ring has the ratio of forces exp(mu beta), whatever the step, and a ring at which the belt stays
straight changes nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pydantic import model_validator

from crashsolve.belts._flow import solve_flow
from crashsolve.belts._route import (
    FITTINGS,
    ROUTE,
    ROUTE_HISTORY,
    SEGMENTS,
    SHORT,
    SURFACES,
    Fitting,
    check_route,
    clear_surfaces,
    pull_segments,
    refuse_route,
    route_columns,
    surface_row,
    update_route,
)
from crashsolve.belts._spool import SPOOL, SPOOL_HISTORY, spool_columns, update_spool
from crashsolve.belts._webbing import WEBBING, Webbing, force_at, read_beyond_end, webbing_columns
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, quantity, word
from crashsolve.foundation.curve import REFUSE
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.rows import as_rows
from crashsolve.foundation.vec3 import put_triple

if TYPE_CHECKING:
    from crashsolve.belts._rows.belt import History, Output, Parameters

STEPWISE = True
WARNINGS = {
    "short": "a segment reached zero length, as its ring reached the next fitting: its length was "
    "taken as 0.001 of the belt; move the ring, or give the belt more webbing",
    "slipped": "the belt slipped off a surface, and was taken as straight until it was clear of "
    "it; the webbing that became slack is lost: move its fittings, or guide it by a ring",
    "crossed": "the belt slid sideways over a ball or an ellipsoid by more than a right angle, as "
    "nothing holds it there: it would have slipped off; guide it by a ring",
    "emptied": "the retractor ran out of webbing, and holds what is out; give it more reserve",
    "early": "the retractor locked in the first two steps: its body accelerates by more than "
    "lock_acceleration as the run begins (a falling body by 9.81 m/s^2), or the webbing leaves it "
    "faster than lock_rate; raise them, or state lock_time: 0 if it has locked before",
    "inside": "a fitting was inside a surface that the belt wraps: the belt passed through it; "
    "move the fitting or the surface",
    "beyond": "part of the belt lay beyond an end of a cylinder, which was taken as longer; "
    "lengthen the cylinder, or guide the belt by a ring",
}


class Belt(Card):
    """Webbing through rings from anchor to anchor; it carries tension only, and has no mass."""

    webbing: Webbing = word("stiffness of the webbing")
    route: tuple[Fitting, ...] = word("anchor, rings in their order, anchor")
    slack: float = quantity(
        "m", "webbing beyond the length of the route at the start; negative: pretensioned", 0.0
    )

    @model_validator(mode="after")
    def _consistent(self) -> Belt:
        check_route(self.route)
        return self


PARAMETERS = (
    ROUTE
    + WEBBING
    + SPOOL
    + Record(f"""
    start  m  {SEGMENTS}  unstrained length of each segment at the start
    total  m              their sum
    first  N              force at the start
""")
)
HISTORY = (
    ROUTE_HISTORY
    + SPOOL_HISTORY
    + Record(f"""
    webbing     m    {SEGMENTS}  L, unstrained length
    residual    m    {SEGMENTS}  S, residual elongation
    webbing_0   m    {SEGMENTS}  L before webbing flows, with what surfaces carry
    residual_0  m    {SEGMENTS}  S before
    tension     N    {SEGMENTS}  T
    slip        m    {FITTINGS}  webbing that has passed each fitting, towards the end
    friction    J        lost at rings
    drawn       J        lost in webbing
    straight    m    {SEGMENTS}  length
    short       flag     a segment has reached zero length
    unsettled   count    steps of which the flows are not found
    unbalanced  N        largest force beyond friction, or within it at a ring that slips, in them
    iterations  count    of the search for the flows
    flow        m    {FITTINGS}  q, that passes each fitting in the step
    grip        1    {FITTINGS}  exp(mu beta)
    softens     N/m  {SEGMENTS}  fall of T over webbing that flows in
    moved       m    {SEGMENTS}  growth of S in the step
    direction   flag  {FITTINGS}  1 onwards, -1 back, 0 not
    above       1    {FITTINGS}  part of the tridiagonal matrix
    change      m    {FITTINGS}  of the flow in an iteration
    cleared     flag     rows of fittings, segments and surfaces that there are not are zero
""")
)
OUTPUT = Record(f"""
    force       N    {SEGMENTS}  tension of each segment from the start of the route on
    length      m    {SEGMENTS}  present length of each segment
    webbing     m    {SEGMENTS}  its unstrained length
    strain      1    {SEGMENTS}  of each segment; negative: slack
    slip        m    {FITTINGS}  webbing that has passed each fitting, towards the end of the route
    angle       rad  {FITTINGS}  by which the belt turns at each fitting
    friction    J        lost at rings so far
    hysteresis  J        lost in webbing so far
    retractor   J        energy taken by the retractor so far; negative where it has done work
    pay_out     m        webbing that has left the retractor
    locked      count    1 once the retractor is locked
""")
# columns of the bodies for the layout at the start
PLACED = Record("""
    r  m  3  position of the mass centre
    A  1  9  rotation matrix by rows
""")


def build(card: Belt, scene: Scene) -> Columns:
    columns = route_columns(card.route, scene) | webbing_columns(card.webbing, scene)
    columns |= spool_columns(card.route[0].retractor, scene)
    initial, lengths = initial_route(columns, scene)
    refuse_route(card.route, initial, lengths, scene)
    straight = float(lengths.sum())
    total = straight + card.slack
    if not total > 0.0:
        message = f"must be more than -{straight:.6g} m, or no webbing is left"
        raise scene.fail(message, "slack")
    strain = straight / total - 1.0
    if columns["curve"]:
        curve = scene.curve_points[columns["curve"]]
        last = float(scene.curve_points[curve["last"]]["x"])
        if strain > last and curve["beyond"] == REFUSE:
            message = f"strains the webbing by {strain:.3g} at the start, and its curve ends at "
            raise scene.fail(f"{message}{last:g}", "slack")
    start = np.zeros(SEGMENTS)
    start[: len(lengths)] = lengths * (total / straight)
    first = force_at(columns, strain, scene)
    shortest = SHORT * straight
    return columns | {"start": start, "total": total, "first": first, "shortest": shortest}


def initial_route(columns: Columns, scene: Scene) -> tuple[np.void, np.ndarray]:
    """Columns ROUTE_HISTORY and lengths of the segments at the start [m]."""
    p, new, old = (as_rows(np.zeros(1, r.dtype))[0] for r in (ROUTE, ROUTE_HISTORY, ROUTE_HISTORY))
    out, nodes = (
        as_rows(np.zeros(1, OUTPUT.dtype))[0],
        as_rows(np.zeros(len(scene.r), PLACED.dtype)),
    )
    for name in ROUTE.dtype.names or ():
        p[name] = columns[name]
    for name, values in scene.placed_nodes().items():
        nodes[name] = values
    for j in np.flatnonzero(columns["surface"]):
        old["turned"][surface_row(j)] = columns["turned"][j]
    update_route(p, old, new, out, nodes)
    return new, np.array(out["length"][: columns["segments"]])


def initial_history(card: Belt, p: np.void, scene: Scene) -> Columns:
    initial, lengths = initial_route(ROUTE.columns_of(p), scene)
    used, n = np.arange(SEGMENTS) < p["segments"], len(lengths)
    residual, straight = np.zeros(SEGMENTS), np.zeros(SEGMENTS)
    straight[:n] = lengths
    if p["curve"]:
        # a pretensioned belt has reached its curve
        L = p["start"][:n]
        residual[:n] = np.maximum(lengths - L - L * p["first"] / p["k"], 0.0)
    own: Columns = {
        "straight": straight,
        "webbing": p["start"],
        "residual": residual,
        "tension": used * p["first"],
    }
    return {column.name: initial[column.name] for column in ROUTE_HISTORY.columns} | own


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    clear_unused(p, old, new, out)
    update_route(p, old, new, out, nodes)
    solve_flow(p, old, new, out, t, h, curves)
    pull_segments(p, new, out, nodes)
    update_spool(p, old, new, nodes, new.flow[0], h, curves)
    update_energies(p, old, new, out, h)
    if p.curve > 0:
        for i in range(p.segments):
            read_beyond_end(p, out.strain[i], curves)


@kernel
def clear_unused(p: Parameters, old: History, new: History, out: Output):
    """Clear columns of fittings, segments and surfaces that there are not. Writes: new, out.

    Nothing else writes those of new, so each of both buffers of the history is cleared once.
    """
    if new.cleared != 1:
        clear_history(p, new)
        new.cleared = 1
    for i in range(p.segments, SEGMENTS):
        out.force[i] = out.length[i] = out.webbing[i] = out.strain[i] = 0.0
    for j in range(p.segments, FITTINGS):
        out.slip[j] = out.angle[j] = 0.0
    new.short, new.iterations = old.short, 0
    new.unsettled, new.unbalanced = old.unsettled, old.unbalanced


@kernel
def clear_history(p: Parameters, new: History):
    """Clear those of the history. Writes: new."""
    clear_surfaces(p, new)
    for i in range(p.segments, SEGMENTS):
        new.webbing[i] = new.residual[i] = new.tension[i] = new.straight[i] = 0.0
        new.softens[i] = new.moved[i] = new.webbing_0[i] = new.residual_0[i] = 0.0
        put_triple(new.along, i, (0.0, 0.0, 0.0))
    for j in range(p.segments, FITTINGS):
        put_triple(new.arrive, j, (0.0, 0.0, 0.0))
        put_triple(new.leave, j, (0.0, 0.0, 0.0))
        new.slip[j] = new.flow[j] = new.carried[j] = 0.0
        new.grip[j], new.direction[j] = 1.0, 0
    new.direction[0] = 0
    # those of the search are written where it needs them
    for j in range(FITTINGS):
        new.above[j] = new.change[j] = 0.0


@kernel
def has_left_a_surface(p, old, new):
    """Whether the belt has left a surface at once, as it slipped off or a fitting came within."""
    left = False
    for k in range(SURFACES):
        left = left or (old.touches[k] == 1 and new.touches[k] < 0)
    return left


@kernel
def update_energies(p: Parameters, old: History, new: History, out: Output, h):
    """Update stored and dissipated energies, and outputs. Writes: new, out."""
    stored = friction = drawn = slack = 0.0
    leaves, by_k, mean_before = has_left_a_surface(p, old, new), 1.0 / p.k, 0.0
    for i in range(p.segments):
        T_0, T_1 = old.tension[i], out.force[i]
        mean, L = 0.5 * (T_0 + T_1), new.webbing[i]
        dL, dS = L - old.webbing[i], new.residual[i] - old.residual[i]
        friction += mean * (dL + dS - new.moved[i]) + 0.5 * T_0 * T_1 * dL * by_k
        drawn += mean * new.moved[i]
        if new.flow[0] != 0.0:
            # slack that the spool takes from a segment moves at no force
            before = max(old.webbing[i] + old.residual[i] - old.straight[i], 0.0)
            slack += mean * (before - max(L + new.residual[i] - out.length[i], 0.0))
        stored += 0.5 * T_1 * T_1 * L * by_k
        if leaves:
            # a length that vanishes at once does no work on the bodies: it is lost as far as it was
            # stretched, not as far as the segment becomes slack
            after = max(out.length[i], L + new.residual[i])
            before = max(old.straight[i], old.webbing[i] + old.residual[i])
            friction -= mean * (after - before)
        elif p.surface[i] > 0:
            # work of a surface on the webbing that goes with it past an end of the arc
            friction += new.excess[surface_row(i)] * (mean - mean_before)
        mean_before = mean
        new.tension[i], out.webbing[i], new.straight[i] = T_1, L, out.length[i]
        out.strain[i] = out.length[i] / L - 1.0
        if out.length[i] < p.shortest and T_1 > 0.0:
            new.short = 1
    out.stored, out.power = stored, 0.0
    T_0, T_1, q = old.tension[0], out.force[0], new.flow[0]
    absorbed = 0.0
    if p.spool == 1:
        absorbed = slack + 0.5 * (T_0 + T_1) * q + 0.5 * T_0 * T_1 * q / p.k
    friction += slack
    new.friction, new.drawn, new.absorbed, out.loss = old.friction, old.drawn, old.absorbed, 0.0
    if h > 0.0:
        new.friction += friction - absorbed
        new.absorbed += absorbed
        new.drawn += drawn
        out.loss = friction + drawn
    out.friction, out.hysteresis, out.retractor = new.friction, new.drawn, new.absorbed
    out.pay_out, out.locked = new.slip[0], new.locked
    for j in range(p.segments + 1):
        out.slip[j] = new.slip[j]
