"""What every law of every family promises: read from its Protocol, tried in a deck.

The file of a law provides what the Protocol of its family asks; its force and its rows are those of
an entry of a verification deck. So a law is under this contract once a deck has it, and a family
once it states itself. What else a family promises, its own tests ask.
"""

import re
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from bench import Bench, Law, Rows, Tangents, tangents_of, written

from crashsolve.deck.card import law_class
from crashsolve.deck.family import ANY, constants, families, provided
from crashsolve.deck.laws import types_in
from crashsolve.foundation.record import Record

DECKS = Path(__file__).resolve().parents[2] / "decks" / "verification"
IMPLICIT = {"radau_iia_5", "generalized_alpha"}
SEEDS = range(2)


def laws_with(what: str) -> list[tuple[str, str]]:
    """Sections and types of the families whose laws provide a function or constant."""
    return [
        (name, word)
        for name, family in families().items()
        if what in (*provided(family.law), *constants(family.law)) and family.entry is not None
        for word in types_in(family.folder)
    ]


def module_of(law: tuple[str, str]) -> ModuleType:
    return import_module(law_class(families()[law[0]].folder, law[1]).__module__)


def acts_on_points(law: tuple[str, str]) -> bool:
    """Whether its force acts on elements or their points, which have tests of their own."""
    module = module_of(law)
    return hasattr(module, "load_elements") or hasattr(module, "force_on_points")


FORCES = [law for law in laws_with("force") if not acts_on_points(law)]
BETWEEN = [law for law in FORCES if not hasattr(module_of(law), "AMPLITUDE")]
ROWS = laws_with("CONSTRAINTS")
# central differences with steps of 1e-5: truncation 1e-10 times third derivatives of order 100,
# round-off 1e-16 / 1e-5
STEP, TOLERANCE = 1e-5, 2e-8


@cache
def deck_of(law: tuple[str, str]) -> Path:
    """The smallest verification deck with the law, its own before others."""
    pattern = re.compile(rf"type: {law[1]}\b")
    paths = [p for p in DECKS.rglob("*.yaml") if pattern.search(p.read_text("utf-8"))]
    assert paths, f"no deck of decks/verification has {'/'.join(law)}"
    paths.sort(key=lambda p: (p.parent.name != law[0], p.stem != law[1], p.stat().st_size))
    return paths[0]


def example(law: tuple[str, str]) -> Law:
    """The first entry of the law in its deck."""
    bench = Bench.of_deck(deck_of(law))
    group = next(g for g in bench.model.groups if (g.keyword, g.type) == law)
    return bench.law(law[0], group.names[0])


def each(laws: list[tuple[str, str]]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("law", laws, ids="/".join)


def moving(law: Law, seed: int) -> None:
    """Any velocities, with which bodies go a hundredth of the model's size in a second."""
    rng, size = np.random.default_rng(seed), 0.01 * law.bench.model.size
    for node in range(1, len(law.bench.nodes)):
        law.bench.move(node, v=size * rng.normal(size=3), w=0.05 * rng.normal(size=3))


@each(FORCES)
def test_every_column_is_written_and_the_past_is_kept(law: tuple[str, str]) -> None:
    one = example(law)
    before, history = one.old.tobytes(), getattr(one.module, "HISTORY", Record())
    for h in (1e-3, 0.0):
        moving(one, 3)
        one.force(h)
        assert written(one.new, history) and written(one.out, one.module.OUTPUT)
        assert np.isfinite([one.out.stored, one.out.power, one.out.loss]).all()
        # a sample loses nothing
        assert h > 0.0 or one.out.loss == 0.0
    assert one.old.tobytes() == before


@each(BETWEEN)
@pytest.mark.parametrize("seed", SEEDS)
def test_action_equals_reaction_also_in_moment(law: tuple[str, str], seed: int) -> None:
    one = example(law)
    moving(one, seed)
    one.bench.drift(1.0)
    one.force(1e-3)
    n = one.bench.nodes
    scale = np.abs(n.force).max() + np.abs(n.torque).max()
    # sums of some products each
    arms = 1.0 + np.abs(n.r).max()
    assert np.abs(n.force.sum(axis=0)).max() <= 1e-12 * scale
    moment = (n.torque + np.cross(n.r, n.force)).sum(axis=0)
    assert np.abs(moment).max() <= 1e-12 * scale * arms


@each(FORCES)
@pytest.mark.parametrize("seed", [1])
def test_work_is_stored_or_lost_or_done_from_outside(law: tuple[str, str], seed: int) -> None:
    """On a way there and back: the sums over steps a fourth as long agree better."""
    apart = [_missing(law, seed, steps) for steps in (30, 120)]
    # corners of a law, anywhere within a step, leave errors of first order
    assert apart[1] <= max(0.5 * apart[0], 1e-6)
    assert apart[1] <= 0.02


def _missing(law: tuple[str, str], seed: int, steps: int) -> float:
    """Work that is nowhere in the ledger, over the largest of its sums."""
    one = example(law)
    sign = 1.0 if hasattr(one.module, "AMPLITUDE") else -1.0
    moving(one, seed)
    nodes, h, sums, before = one.bench.nodes, 1.0 / steps, np.zeros(2), np.zeros(2)
    ends = [node for node in _ends(one) if node > 0]
    start = {node: (nodes[node].v.copy(), nodes[node].w.copy()) for node in ends}
    first, largest = 0.0, 1e-9

    def go_at(time: float) -> None:
        for node in ends:
            one.bench.move(node, *(None, None), *(np.cos(3.0 * time) * x for x in start[node]))

    for k in range(steps + 1):
        go_at(k * h)
        out = one.force(h if k else 0.0, k * h)
        rates = np.array([one.power_on_bodies(), sign * out.power])
        if k == 0:
            first, before = float(out.stored), rates
        else:
            sums += 0.5 * h * (before + rates) + np.array([0.0, sign * out.loss])
        before, largest = rates, max(largest, *np.abs(sums), abs(out.stored - first))
        one.accept()
        # with the velocity in the middle of the step ahead
        go_at((k + 0.5) * h)
        for node in ends:
            one.bench.rotation(node, h * nodes[node].w)
            one.bench.move(node, r=nodes[node].r + h * nodes[node].v)
    missing = sums[0] - sums[1] + float(one.out.stored) - first
    return float(abs(missing) / largest)


def _ends(one: Law) -> list[int]:
    """Bodies that it acts on."""
    columns = [name for name in one.p.dtype.names if name.startswith("node")]
    ends = [int(node) for name in columns for node in np.ravel(one.p[name])]
    # a law of several bodies names some of them more than once
    return list(dict.fromkeys(ends))


@each(BETWEEN)
def test_implicit_methods_have_its_tangent_or_do_not_step_it(law: tuple[str, str]) -> None:
    family, module = families()[law[0]], module_of(law)
    is_stepped = family.integrators == ANY or IMPLICIT & set(family.integrators)
    is_whole = getattr(module, "STEPWISE", False)
    assert hasattr(module, "tangent") or is_whole or not is_stepped
    assert hasattr(module, "TANGENTS") == hasattr(module, "tangent")


SLOPES = [
    law
    for law in BETWEEN
    # what is computed in whole steps has a slope over a step alone
    if hasattr(module_of(law), "tangent") and not getattr(module_of(law), "STEPWISE", False)
]


@each(SLOPES)
@pytest.mark.parametrize("seed", SEEDS)
def test_its_tangent_is_the_slope_of_the_force_along_its_motion(
    law: tuple[str, str], seed: int
) -> None:
    """dF = dD^T f - D^T (k D dq + c G dq), q along the present motion."""
    one = example(law)
    moving(one, seed)
    for _ in range(20):
        one.bench.drift(0.05)
        one.force(0.05)
        one.accept()
    start = one.bench.state()
    here, own, force = _rows(one), _unmixed(one), _load(one)
    f = np.linalg.lstsq(own.T, force, rcond=None)[0]
    # the force is one along the directions of the rows
    assert np.abs(own.T @ f - force).max() <= 1e-9 * (1.0 + np.abs(force).max())
    direction = np.concatenate([start[n][x] for n in _ends(one) for x in ("v", "w")])
    one.bench.drift(STEP)
    change = (_load(one) - force) / STEP - (_unmixed(one) - own).T @ f / STEP
    reported = here.stiffness * (here.D @ direction) + here.damping * (here.G @ direction)
    # second derivatives over the step, and round-off of the force over it
    bound = 2e-3 * (1.0 + np.abs(change).max()) + 1e-10 * np.abs(force).max() / STEP
    np.testing.assert_allclose(change, -here.D.T @ reported, atol=bound)


def _unmixed(one: Law) -> np.ndarray:
    """D of the forces that the law knows, which turns with the bodies.

    Where motions yield together its rows are mixtures of these, which also change with the flow.
    """
    kept = {}
    for record, name, elastic in ((one.p, "yields", 0), (one.old, "failed", 1)):
        if name in record.dtype.names:
            kept[name] = record, int(record[name])
            record[name] = elastic
    D = _rows(one).D.copy()
    for name, (record, before) in kept.items():
        record[name] = before
    return D


def _load(one: Law) -> np.ndarray:
    """Forces and torques on both bodies (12,)."""
    one.force(1e-3)
    n = one.bench.nodes
    return np.concatenate([column[end] for end in _ends(one) for column in (n.force, n.torque)])


def _rows(one: Law) -> Tangents:
    """The law's compliant rows at the present position."""
    return tangents_of(one, _ends(one))


@each(ROWS)
def test_rows_and_their_derivatives_belong_together(law: tuple[str, str]) -> None:
    """D v - nu is the rate of Phi, and -gamma that of D v - nu, in any configuration."""
    bench, rng = Bench.of_deck(deck_of(law)), np.random.default_rng(7)
    group = next(g for g in bench.model.groups if (g.keyword, g.type) == law)
    rows = Rows(bench.model, type("State", (), {"nodes": bench.nodes}), group, group.names[0])
    for _ in range(3):
        rows.scramble(rng)
        rate, gamma = rows.rate(), rows.gamma()
        rows.move(STEP, time=True)
        phi, later = rows.phi(), rows.rate()
        rows.move(-2 * STEP, time=True)
        scale = 1.0 + np.abs(rate).max() + np.abs(gamma).max()
        np.testing.assert_allclose(rate, (phi - rows.phi()) / (2 * STEP), atol=TOLERANCE * scale)
        np.testing.assert_allclose(
            gamma, -(later - rows.rate()) / (2 * STEP), atol=TOLERANCE * scale
        )


@each(laws_with("measure"))
def test_every_reading_is_written(law: tuple[str, str]) -> None:
    one = example(law)
    one.measure()
    assert written(one.out, one.module.OUTPUT)
