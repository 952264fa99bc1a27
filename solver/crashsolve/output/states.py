"""Writes states for ParaView and pyvista: XDMF 2 over HDF5.

mesh.h5 holds the geometry once, states/000012.h5 the fields of one moment, and states.xdmf is
the index: one temporal collection for each block, every moment referring to the same geometry.
"""

import time as clock
from pathlib import Path

import numpy as np

from crashsolve.output.blocks import Block
from crashsolve.output.errors import OutputError
from crashsolve.output.files import Json, replace_text, replacing_hdf5, reported, write_metadata
from crashsolve.output.paraview import script, xdmf
from crashsolve.output.template import Template

FORMAT = "crashsolve states"
FORMAT_VERSION = 3
# the index is rewritten whole, so it may take this share of the run at most
INDEX_SHARE = 0.005


class StateWriter:
    """Writes the states of fixed blocks into a folder; raises OutputError when it cannot."""

    def __init__(
        self,
        folder: Path | str,
        blocks: tuple[Block, ...],
        metadata: Json,
        resume_time: float | None = None,
    ) -> None:
        self.folder = Path(folder)
        self.blocks = blocks
        self.times: list[float] = []
        self._grid_at = {block.name: xdmf.grid(block, "mesh.h5") for block in blocks}
        self._grids: dict[str, list[str]] = {block.name: [] for block in blocks}
        self._index_due = 0.0
        if len(self._grids) < len(blocks):
            raise ValueError("two blocks have the same name")
        with reported(self.folder):
            (self.folder / "states").mkdir(parents=True, exist_ok=True)
        later = self._states_until(-np.inf if resume_time is None else resume_time)
        # the index drops a state before the state is deleted
        self._write_index()
        with reported(self.folder / "states"):
            for path in reversed(later):
                path.unlink()
        self._write_mesh(metadata)
        self._template = Template(blocks)
        replace_text(self.folder / script.NAME, script.script(blocks, metadata))

    def write(self, time: float, values: dict[str, dict[str, np.ndarray]]) -> None:
        """Add one state: block name -> field name -> array, displacement (n, 3) among them."""
        self._template.write(self.folder / _state_file(len(self.times)), time, values)
        self._add_to_index(time)
        if clock.monotonic() >= self._index_due:
            self._write_index()

    def has(self, time: float) -> bool:
        """Whether a state is at a time [s]."""
        return time in self.times

    def insert(self, time: float, values: dict[str, dict[str, np.ndarray]]) -> None:
        """Add a state before those of later times, whose numbers grow by one."""
        number = int(np.searchsorted(self.times, time))
        later, self.times = self.times[number:], self.times[:number]
        with reported(self.folder / "states"):
            for k in range(number + len(later), number, -1):
                (self.folder / _state_file(k - 1)).rename(self.folder / _state_file(k))
        self._template.write(self.folder / _state_file(number), time, values)
        for grids in self._grids.values():
            del grids[number:]
        for moved in (time, *later):
            self._add_to_index(moved)
        self._write_index()

    def close(self) -> None:
        """Bring the index up to date."""
        self._write_index()

    def _states_until(self, last_time: float) -> list[Path]:
        """Take over the states up to `last_time`; returns the later ones."""
        import h5py

        later = []
        for path in sorted((self.folder / "states").glob("*.h5")):
            with reported(path), h5py.File(path, "r") as file:
                time = float(file.attrs["time"])
            if time > last_time:
                later.append(path)
            elif path == self.folder / _state_file(len(self.times)):
                self._add_to_index(time)
            else:
                raise OutputError(path, "the state before this one is missing")
        return later

    def _write_mesh(self, metadata: Json) -> None:
        """Write the geometry of all blocks."""
        with replacing_hdf5(self.folder / "mesh.h5") as file:
            write_metadata(file, FORMAT, FORMAT_VERSION, metadata)
            for block in self.blocks:
                file[f"{block.name}/points"] = block.points.astype("<f8")
                file[f"{block.name}/cells"] = block.connectivity()
                for field, constant in block.fixed_fields:
                    path = f"{block.name}/{field.name}"
                    file.create_dataset(path, data=constant, dtype=field.dtype)
                    file[path].attrs["unit"] = field.unit

    def _add_to_index(self, time: float) -> None:
        """Append the entry of a written state to every block's list."""
        file = _state_file(len(self.times))
        for name, grid_at in self._grid_at.items():
            self._grids[name].append(grid_at(time, file))
        self.times.append(time)

    def _write_index(self) -> None:
        """Replace states.xdmf and set when it may next be replaced."""
        started = clock.monotonic()
        path = self.folder / "states.xdmf"
        if self.times:
            replace_text(path, xdmf.index(self._grids.items()))
        else:
            # ParaView 5.11 crashes on a collection without members
            with reported(path):
                path.unlink(missing_ok=True)
        finished = clock.monotonic()
        self._index_due = finished + (finished - started) / INDEX_SHARE


def _state_file(number: int) -> str:
    """File of one state, relative to the results folder."""
    return f"states/{number:06d}.h5"
