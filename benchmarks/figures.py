"""What figures of errors over meshes share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def finish(figure: Figure, axes: Any, meshes: tuple[int, ...], path: Path) -> None:
    """Mark the meshes on the abscissae, add the legend, and write the figure."""
    for axis in axes:
        axis.set_xticks(meshes, [str(n) for n in meshes])
        axis.minorticks_off()
    axes[0].legend()
    figure.savefig(path, dpi=110)
