"""Runs of MuJoCo: a model as text, one integrator over its steps, all steps in one call."""

from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np
from numba import carray, cfunc, types
from numba.extending import intrinsic
from problem import Method, Run

# model and data to (actions before the solve, the values to compare)
Watch = Callable[["mujoco.MjModel", "mujoco.MjData"], object]

# warnings are counted in the data of a run; by default they would also go to a file
mujoco.set_mju_user_warning(lambda _text: None)

# loops are closed by soft constraints: the solver must find their forces to the last digits
EXACT = 'solver="Newton" iterations="100" tolerance="1e-15" jacobian="dense"'


def methods(
    text: Callable[[float, str], str],
    end: float,
    entries: Sequence[tuple[str, str, Sequence[float], float]],
    watch: Watch,
    start: Callable[[mujoco.MjModel, mujoco.MjData], object] | None = None,
    law: Callable[[mujoco.MjModel, mujoco.MjData, float], object] | None = None,
) -> list[Method]:
    """One method per entry (integrator, settings of the model, steps, settling).

    Settling is the time, in steps, in which the gap of a loop closes; see `closure`.
    `text` gives the model for a step and the words of an equality constraint that closes a loop,
    `start` sets the initial state, `law` gives a compiled force law.
    """

    def prepare(integrator: str, settling: float, step: float) -> Run:
        steps = max(1, round(end / step))
        model = mujoco.MjModel.from_xml_string(text(end / steps, closure(settling * end / steps)))
        model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
        data = mujoco.MjData(model)
        if start is not None:
            start(model, data)
        force = law(model, data, end / steps) if law else None

        def solve() -> None:
            mujoco.set_mjcb_passive(force)
            try:
                mujoco.mj_step(model, data, nstep=steps)
            finally:
                mujoco.set_mjcb_passive(None)
            if data.warning.number.any():
                raise ArithmeticError("unstable")

        return Run(solve, lambda: np.array(watch(model, data), float))

    return [
        Method(
            "mujoco",
            f"{integrator}, {model}",
            "step",
            values,
            lambda value, i=integrator, s=settling: prepare(i, s, value),
        )
        for integrator, model, values, settling in entries
    ]


def closure(time: float) -> str:
    """Words of an equality constraint whose gap closes with a time constant.

    Constraints here are soft; their residual falls with the square of this time, while an
    explicit step that is long beside it loses stability or order. The problems state the best we
    found.
    """
    return f'solref="{time!r} 1" solimp="0.9999 0.9999 0.001 0.5 2"'


def plane_body(
    name: str,
    mass: float,
    inertia: float,
    hinge: Sequence[float],
    centre: Sequence[float],
    parent: Sequence[float] = (0.0, 0.0),
    inside: str = "",
) -> str:
    """Body on a hinge about z. Hinge, mass centre and the parent's hinge are points of the world at
    the start, where the axes of all bodies are those of the world."""
    x, y = hinge[0] - parent[0], hinge[1] - parent[1]
    u, v = centre[0] - hinge[0], centre[1] - hinge[1]
    return f"""
    <body name="{name}" pos="{x!r} {y!r} 0">
      <joint name="{name}" type="hinge" axis="0 0 1"/>
      <inertial pos="{u!r} {v!r} 0" mass="{mass!r}" diaginertia="{inertia} {inertia} {inertia}"/>
      {inside}
    </body>"""


@intrinsic
def floats(_context: Any, _position: Any = None) -> Any:
    """Pointer to floats at an address."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.inttoptr(given[0], context.get_value_type(signature.return_type))

    return types.CPointer(types.float64)(types.int64), generate


def native(
    kernel: Any, history: Any = None
) -> Callable[[mujoco.MjModel, mujoco.MjData, float], object]:
    """Compiled force law for MuJoCo from a kernel (positions, velocities, forces, history).

    Where the arrays of a run are is written into a box that the law reads: it is compiled once.
    """
    box, kept = np.zeros(5), np.zeros(1) if history is None else history
    at = box.ctypes.data

    @cfunc(types.void(types.voidptr, types.voidptr))
    def law(_model: mujoco.MjModel, _data: mujoco.MjData) -> None:
        positions = carray(floats(at), 5).view(np.int64)
        n = positions[3]
        kernel(
            carray(floats(positions[0]), n),
            carray(floats(positions[1]), n),
            carray(floats(positions[2]), n),
            carray(floats(positions[4]), positions[3]),
        )

    def bind(_model: mujoco.MjModel, data: mujoco.MjData, _step: float) -> object:
        kept[:] = 0.0
        arrays = (data.qpos, data.qvel, data.qfrc_passive)
        box.view(np.int64)[:3] = [array.ctypes.data for array in arrays]
        box.view(np.int64)[3:] = len(data.qpos), kept.ctypes.data
        return law.ctypes

    return bind
