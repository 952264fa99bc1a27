"""A small result on disk, written with h5py alone."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

MASS_A, MASS_B, SPEED, STIFFNESS = 60e3, 30e3, 15.0, 10e6
REDUCED = MASS_A * MASS_B / (MASS_A + MASS_B)
OMEGA = np.sqrt(STIFFNESS / REDUCED)
TIME = np.linspace(0.0, np.pi / OMEGA, 401)

# family: (ids, {dataset: (unit, meaning, values (n_time, n_id))})
Families = dict[str, tuple[list[str], dict[str, tuple[str, str, np.ndarray]]]]
Command = Callable[..., tuple[int, str, str]]


def two_cars() -> Families:
    """Car A runs into car B through a linear spring: closed form of one half oscillation."""
    common = MASS_A * SPEED / (MASS_A + MASS_B)
    closing = SPEED * np.cos(OMEGA * TIME)
    velocity = np.stack([common + closing * MASS_B / (MASS_A + MASS_B)] * 2, axis=1)
    velocity[:, 1] = common - closing * MASS_A / (MASS_A + MASS_B)
    force = STIFFNESS * SPEED / OMEGA * np.sin(OMEGA * TIME)
    kinetic = 0.5 * (velocity**2) @ [MASS_A, MASS_B]
    spring = 0.5 * force**2 / STIFFNESS
    momentum = velocity @ [MASS_A, MASS_B]
    missing = 100 * (kinetic + spring - kinetic[0]) / kinetic[0]

    def one(values: np.ndarray) -> np.ndarray:
        return values[:, None]

    return {
        "glstat": (
            ["model"],
            {
                "energy/kinetic": ("J", "kinetic energy", one(kinetic)),
                "energy/spring_stored": ("J", "energy in springs", one(spring)),
                "energy/balance": ("%", "missing energy", one(missing)),
                "momentum/x": ("kg m/s", "linear momentum", one(momentum)),
                "momentum_error": ("1", "not accounted for", one(1e-12 * TIME / TIME[-1])),
            },
        ),
        "rbdout": (["A", "car-b"], {"velocity/x": ("m/s", "of the mass centre", velocity)}),
        "deforc": (
            ["buffer"],
            {
                "force": ("N", "tension positive", one(-force)),
                "length": ("m", "between the ends", one(1 - force / STIFFNESS)),
            },
        ),
    }


def write_result(
    folder: Path,
    families: Families,
    time: np.ndarray = TIME,
    reserved: int = 0,
    **attributes: object,
) -> Path:
    """Write history.h5 as FILE_FORMAT.md has it, with `reserved` rows not yet filled."""
    folder.mkdir(parents=True, exist_ok=True)
    with h5py.File(folder / "history.h5", "w") as file:
        file.attrs.update({"format": "crashsolve history", "format_version": 2, **attributes})
        padded = np.concatenate([time, np.full(reserved, np.nan)])
        for name, (ids, columns) in families.items():
            group = file.create_group(name)
            group["time"] = padded
            group.create_dataset("ids", data=ids, dtype=h5py.string_dtype())
            for path, (unit, meaning, values) in columns.items():
                filled = np.concatenate([values, np.zeros((reserved, len(ids)))])
                dataset = group.create_dataset(path, data=filled)
                dataset.attrs.update({"unit": unit, "meaning": meaning})
    return folder


def write_status(folder: Path, state: str = "finished", **entries: object) -> None:
    """Write status.json."""
    status = {"state": state, "time": TIME[-1], "end_time": TIME[-1], "cycle": 1000, "cpu": 0.2}
    (folder / "status.json").write_text(json.dumps({**status, **entries}))


def expectation(
    channel: str, statistic: str, value: float, tolerance: float, **other: object
) -> Any:
    """One `expect` entry as the solver stores it."""
    entry = {"channel": channel, "statistic": statistic, "value": value, "tolerance": tolerance}
    return {**entry, "relative": False, "because": "exact", "source": "by hand", **other}
