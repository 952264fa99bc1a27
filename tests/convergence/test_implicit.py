"""Claim: implicit methods have their order, and steps bound by the motion, not by stiffness."""

import ast
from pathlib import Path

import numpy as np
import pytest
import yaml
from test_runge_kutta import END, SCENE, SLOPE, configuration, order_of_an_impact, run, start

from crashsolve.deck.family import FamilyError
from crashsolve.deck.reading.deck import read_deck
from crashsolve.integrators import generalized_alpha, radau_iia_5
from crashsolve.model.build import build
from crashsolve.model.ledger import IMBALANCE, LARGEST
from crashsolve.springs import bushing
from crashsolve.system.compose import compose

METHODS = {"generalized_alpha": generalized_alpha, "radau_iia_5": radau_iia_5}
LONG = pytest.mark.long
BOTH = pytest.mark.parametrize("method", METHODS)
# every scene compiles with every method anew: one is enough by day
EITHER = pytest.mark.parametrize(
    "method", ["generalized_alpha", pytest.param("radau_iia_5", marks=LONG)]
)
# steps at which the error lies between the last digits and the first
COUNTS = {"generalized_alpha": (320, 640), "radau_iia_5": (80, 160)}

# five bars hang on each other by bushings as stiff as asked
LINKS = 3
BARS = {
    f"bar_{i}": {"mass": 1.0, "inertia": [0.01, 0.1, 0.1], "position": [0.5 + i, 0, 0]}
    for i in range(LINKS)
}
WEIGHT = {"weight": {"type": "gravity", "acceleration": [0, 0, -9.81]}}


def ends(i: int) -> dict[str, str]:
    return {"a": "ground" if i == 0 else f"bar_{i - 1}", "b": f"bar_{i}"}


def bushings(k: float) -> dict[str, object]:
    """Hinges about y of stiffness k [N/m, N m/rad] and a time of relaxation of 0.1 ms."""
    c = 1e-4 * k
    springs = {
        f"bushing_{i}": ends(i)
        | {
            "type": "bushing",
            "at_a": [0.0, 0, 0] if i == 0 else [0.5, 0, 0],
            "at_b": [-0.5, 0, 0],
            "stiffness": [k] * 3,
            "damping": [c] * 3,
            "rotational_stiffness": [k, 0, k],
            "rotational_damping": [c, 0, c],
        }
        for i in range(LINKS)
    }
    return {"bodies": BARS, "springs": springs, "loads": WEIGHT}


HINGES = {
    "bodies": BARS,
    "joints": {
        f"hinge_{i}": ends(i) | {"type": "revolute", "at": [i, 0, 0], "axis": [0, 1, 0]}
        for i in range(LINKS)
    },
    "loads": WEIGHT,
}


def test_the_factors_of_the_tableau_are_those_of_radau() -> None:
    m = radau_iia_5
    np.testing.assert_allclose(m.T @ m.U, m.A, atol=1e-15)
    # collocation: sum a_ij c_j^k = c_i^(k+1) / (k+1) up to the number of stages, exact at the end
    for k in range(3):
        np.testing.assert_allclose(m.A @ m.C**k, m.C ** (k + 1) / (k + 1), atol=1e-15)
    for k in range(m.ORDER):
        assert m.A[-1] @ m.C**k == pytest.approx(1 / (k + 1), abs=1e-14)
    assert m.E.sum() == pytest.approx(0.0, abs=1e-14)


def test_a_pass_over_the_stages_converges_whatever_the_stiffness() -> None:
    A, T = radau_iia_5.A[1:, 1:], radau_iia_5.T[1:, 1:]
    worst = 0.0
    # vibrations, and dampers
    for direction in (1j, -1.0):
        for size in np.logspace(-3, 6, 200):
            z = size * direction
            left = z * np.linalg.inv(np.eye(3) - z * T) @ (A - T)
            worst = max(worst, np.abs(np.linalg.eigvals(left)).max())
    # van der Houwen and de Swart (1997) give 0.37 for three stages
    assert worst < 0.375


@BOTH
def test_the_order_is_the_declared_one(method: str, tmp_path: Path) -> None:
    # how closely the equations of the stages are solved; the step is given
    close = {"tolerance": 1e-12}
    finest = run(tmp_path, SCENE, END, integrator="dormand_prince_8", step=END / 800, **close)
    counts = COUNTS[method]
    runs = [run(tmp_path, SCENE, END, integrator=method, step=END / n, **close) for n in counts]
    for body in SCENE["bodies"]:
        errors = [
            np.linalg.norm(configuration(e, body) - configuration(finest, body)) for e in runs
        ]
        slope = np.log(errors[0] / errors[1]) / np.log(counts[1] / counts[0])
        assert slope == pytest.approx(METHODS[method].ORDER, abs=SLOPE), (body, errors)
    assert max(e.clock.residual for e in runs) <= 1e-10


def double_pendulum(count: int) -> float:
    """x of the end's mass centre after 1 s, in angles, by `count` steps of Runge and Kutta."""
    inertia, mass, half, length, g = 1 / 12, 1.0, 0.5, 1.0, 9.81

    def rate(y: np.ndarray) -> np.ndarray:
        a, b, w, v = y
        coupled = mass * length * half
        m = [
            [inertia + mass * (half**2 + length**2), coupled * np.cos(a - b)],
            [coupled * np.cos(a - b), inertia + mass * half**2],
        ]
        f = [
            -coupled * v * v * np.sin(a - b) - mass * g * (half + length) * np.cos(a),
            coupled * w * w * np.sin(a - b) - mass * g * half * np.cos(b),
        ]
        return np.array([w, v, *np.linalg.solve(m, f)])

    y, h = np.zeros(4), 1.0 / count
    for _ in range(count):
        k1 = rate(y)
        k2 = rate(y + 0.5 * h * k1)
        k3 = rate(y + 0.5 * h * k2)
        k4 = rate(y + h * k3)
        y = y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return float(length * np.cos(y[0]) + half * np.cos(y[1]))


# beside them the mass of the other scene: the laws are the same, and so is the compiled step
PENDULUM = SCENE | {
    "bodies": {
        "rod_1": {"mass": 1.0, "inertia": [0.01, 1 / 12, 1 / 12], "position": [0.5, 0, 0]},
        "rod_2": {"mass": 1.0, "inertia": [0.01, 1 / 12, 1 / 12], "position": [1.5, 0, 0]},
        "mass": SCENE["bodies"]["mass"],
    },
    "joints": {
        "first": {"type": "revolute", "a": "ground", "b": "rod_1", "at": [0, 0, 0],
                  "axis": [0, 0, 1]},
        "second": {"type": "revolute", "a": "rod_1", "b": "rod_2", "at": [1, 0, 0],
                   "axis": [0, 0, 1]},
    },
    "loads": {"weight": {"type": "gravity", "acceleration": [0, -9.81, 0]}},
}  # fmt: skip


@pytest.mark.long
def test_generalized_alpha_gets_better_with_every_shorter_step_and_sample(tmp_path: Path) -> None:
    exact = double_pendulum(4000)
    assert exact == pytest.approx(-1.2984612429802, abs=1e-12)
    method = {"integrator": "generalized_alpha"}
    # the tolerance is the default: a stated step is its own measure
    counts = (250, 500, 1000, 2000, 4000)
    engines = [run(tmp_path, PENDULUM, 1.0, step=1 / n, **method) for n in counts]
    errors = [abs(e.state.nodes["r"][2, 0] - exact) for e in engines]
    assert errors[0] < 6e-6
    for finer, coarser in zip(errors[1:], errors, strict=False):
        assert np.log2(coarser / finer) == pytest.approx(2.0, abs=SLOPE), errors
    # samples only make steps shorter
    errors = []
    for samples in (1, 1000, 4000):
        engine = start(tmp_path, PENDULUM, 1.0, tolerance=1e-6, **method)
        for k in range(samples):
            engine.advance((k + 1) / samples)
        errors.append(abs(engine.state.nodes["r"][2, 0] - exact))
    assert errors[0] < 1e-5
    # stated steps as long have 3e-7 and 2e-8
    assert errors[1] < 6e-7
    assert errors[2] < 4e-8


@LONG
def test_radau_keeps_its_order_at_stated_steps(tmp_path: Path) -> None:
    exact, method = double_pendulum(8000), {"integrator": "radau_iia_5"}
    errors = [
        abs(run(tmp_path, PENDULUM, 1.0, step=1 / n, **method).state.nodes["r"][2, 0] - exact)
        for n in (60, 120, 240)
    ]
    # 2^5, less what the last digits leave
    assert errors[1] < errors[0] / 20 and errors[2] < errors[1] / 10, errors
    for n in (1000, 4000):
        x = run(tmp_path, PENDULUM, 1.0, step=1 / n, **method).state.nodes["r"][2, 0]
        assert x == pytest.approx(exact, abs=2e-12)


@EITHER
def test_a_smaller_tolerance_gives_a_smaller_error(method: str, tmp_path: Path) -> None:
    exact = run(tmp_path, SCENE, END, integrator="dormand_prince_8", tolerance=1e-13)
    errors = []
    for tolerance in (1e-4, 1e-6, 1e-8):
        engine = run(tmp_path, SCENE, END, integrator=method, tolerance=tolerance)
        errors.append(
            max(
                np.abs(configuration(engine, b) - configuration(exact, b)).max()
                for b in SCENE["bodies"]
            )
        )
        # few attempts fail: the estimate predicts the error of the next step
        assert engine.clock.rejected < 0.2 * engine.clock.cycle
    # an estimate of order p - 1 in h that is kept to tol: error ~ tol^((p - 1) / p), at least
    assert errors[1] < 0.1 * errors[0]
    assert errors[2] < 0.1 * errors[1]


@EITHER
@pytest.mark.long
def test_stiff_bushings_become_hinges_at_steps_of_the_motion(method: str, tmp_path: Path) -> None:
    hinged = run(tmp_path, HINGES, 0.5, integrator="dormand_prince_8", tolerance=1e-10)
    previous = np.inf
    for k in (1e4, 1e6, 1e8):
        engine = run(tmp_path, bushings(k), 0.5, integrator=method, tolerance=1e-5)
        gap = np.abs(engine.state.nodes["r"] - hinged.state.nodes["r"]).max()
        # they give way by force over k, until the method's own error is larger
        assert gap < 0.1 * previous or gap < 1e-4
        previous = gap
        # an explicit step would be below 2 / omega = 2 / sqrt(12 k / m), 3e5 steps at 1e8
        assert engine.clock.cycle < 1500
        assert abs(engine.ledger[IMBALANCE]) < 1e-2 * engine.ledger[LARGEST]


@EITHER
def test_an_impact_converges_at_order_two_or_better(method: str, tmp_path: Path) -> None:
    assert order_of_an_impact(method, tmp_path) > 2 - SLOPE


@pytest.mark.long
@pytest.mark.parametrize(
    "method",
    [
        pytest.param("dormand_prince_5", marks=LONG),
        pytest.param("dormand_prince_8", marks=LONG),
        pytest.param("generalized_alpha", marks=LONG),
        "radau_iia_5",
    ],
)
def test_a_force_that_jumps_at_its_onset_does_not_bind_the_steps_before_it(
    method: str, tmp_path: Path
) -> None:
    normal = {"type": "kelvin_voigt", "stiffness": 1e6, "restitution": 0.1}
    scene = {
        "bodies": {
            # held by a hinge far away, whose reaction jumps as well
            "arm": {
                "mass": 1,
                "inertia": [1e-3] * 3,
                "position": [0, 0, 0.101],
                "velocity": [0, 0, -1],
                "angular_velocity": [0, -0.1, 0],
            }
        },
        "joints": {"far": {"type": "spherical", "b": "arm", "at": [10, 0, 0.101]}},
        "surfaces": {
            "skin": {"type": "sphere", "body": "arm", "radius": 0.1},
            "floor": {"type": "plane"},
        },
        "contacts": {"impulse": {"a": ["skin"], "b": ["floor"], "normal": normal}},
    }
    engine = run(tmp_path, scene, 1.0001e-3, integrator=method, tolerance=1e-10)
    assert engine.clock["located"] == 1
    # steps grow by at most 5 from the first to the onset, and begin anew after it
    assert engine.clock["cycle"] + engine.clock["rejected"] < 100
    engine.advance(0.02)
    # the hinge adds 1e-5 of inertia, and turns the arm by 1e-4 meanwhile
    assert engine.state.nodes["v"][1, 2] == pytest.approx(0.1, abs=1e-4)


@pytest.mark.long
@EITHER
def test_a_wall_with_a_corner_is_elastic(method: str, tmp_path: Path) -> None:
    scene = {
        "bodies": {
            "block": {"mass": 1, "inertia": [1] * 3, "position": [1, 0, 0], "velocity": [-1, 0, 0]}
        },
        "curves": {"wall": {"points": [[-1, -1e6], [0, 0], [1, 0]]}},
        "springs": {"wall": {"type": "curve", "a": "ground", "b": "block", "curve": "wall"}},
    }
    engine = run(tmp_path, scene, 0.1, integrator=method, tolerance=1e-8)
    # it is back where it was after half a period
    gone = 0.1 - np.pi / np.sqrt(1e6)
    node = engine.state.nodes[1]
    # a hundred steps, each with an error of 1e-8 of the model's size and speed, some 1 m and 1 m/s
    assert node["v"][0] == pytest.approx(1.0, abs=1e-6)
    assert node["r"][0] == pytest.approx(1.0 + gone, abs=1e-6)
    # where it meets the wall, which begins at 0 elongation; and where it leaves it
    assert engine.clock["located"] == 2


@pytest.mark.parametrize("method", ["rattle", "dormand_prince_5", *METHODS])
def test_a_composed_step_has_one_meaning_for_every_name(method: str, tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    deck = {"control": {"end_time": 1.0, "integrator": method}} | SCENE
    path.write_text(yaml.safe_dump(deck, sort_keys=False))
    model, _ = build(read_deck(path))
    meanings: dict[str, set[str]] = {}
    for node in ast.parse(compose(model)).body:
        if isinstance(node, ast.ImportFrom):
            for name in node.names:
                meaning = f"{node.module}.{name.name}"
                meanings.setdefault(name.asname or name.name, set()).add(meaning)
        elif isinstance(node, ast.FunctionDef):
            meanings.setdefault(node.name, set()).add(f"line {node.lineno}")
    assert not {name: where for name, where in meanings.items() if len(where) > 1}


def test_more_rows_than_a_block_holds_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # a seventh row would be written past the end of its block
    monkeypatch.setattr(bushing, "TANGENTS", 7)
    with pytest.raises(FamilyError, match="bushing: TANGENTS is 7; two bodies have at most 6"):
        start(tmp_path, bushings(1e4), 1e-3, integrator="radau_iia_5")
