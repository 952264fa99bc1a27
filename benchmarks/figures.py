"""What figures of errors over meshes share."""

from pathlib import Path
from typing import Any


def finish(figure: Any, axes: Any, meshes: tuple[int, ...], path: Path) -> None:
    """Mark the meshes on the abscissae, add the legend, and write the figure."""
    for axis in axes:
        axis.set_xticks(meshes, [str(n) for n in meshes])
        axis.minorticks_off()
    axes[0].legend()
    figure.savefig(path, dpi=110)
