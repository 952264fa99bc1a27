"""The model at one moment as meshes of pyvista."""

from typing import TYPE_CHECKING

import numpy as np

from crashpost.errors import PostError
from crashpost.results.history import History

if TYPE_CHECKING:
    from pyvista import MultiBlock


def scene(result: History, time: float | None) -> "MultiBlock":
    """The blocks of the state nearest to a time [s], the last one without; its points moved there.

    `field_data["time"]` is the time of the state. Raises PostError for a time between which and the
    nearest state another would fit, without states, and without pyvista.
    """
    try:
        import pyvista as pv
    except ImportError:
        raise PostError("meshes need pyvista: pip install 'crashsolve[picture]'") from None
    index = result.folder / "states.xdmf"
    if not index.is_file():
        raise PostError(f"{index}: no such file: the run has written no states")
    reader = pv.get_reader(str(index))
    times = np.array(reader.time_values)
    wanted = times[-1] if time is None else float(time)
    nearest = float(times[np.argmin(np.abs(times - wanted))])
    reach = 0.5 * float(np.max(np.diff(times))) if len(times) > 1 else 0.0
    if not abs(nearest - wanted) <= reach * (1.0 + 1e-9):
        raise PostError(f"no state near {wanted:g} s, only {times[0]:g} s to {times[-1]:g} s")
    reader.set_active_time_value(nearest)
    blocks: MultiBlock = reader.read()
    for block in (block for block in blocks if block is not None):
        block.points = block.points + block.point_data["displacement"]
    blocks.field_data["time"] = [nearest]
    return blocks
