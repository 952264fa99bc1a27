"""Paints a drawing with matplotlib alone: polygons from the farthest to the nearest.

Where polygons run through each other it may show the wrong one; paint_vtk.py does not.
"""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from crashpost.renders.camera import Camera
from crashpost.renders.colour_scale import ColourScale, rgb
from crashpost.renders.shapes import Drawing, Surface

DPI = 100
LIGHT = np.array([0.35, 0.55, 0.76])
EDGE = "#3a424a"

Polygons = tuple[np.ndarray, np.ndarray, np.ndarray]  # depth (m,), corners (m, k, 2), colours


class Painter:
    """A window of fixed size into which drawings are painted one after the other."""

    def __init__(self, width: int, height: int) -> None:
        self.size = width, height

    def paint(
        self, layers: Sequence[Drawing], camera: Camera, colour_scale: ColourScale
    ) -> np.ndarray:
        """The picture (height, width, 3) of drawings, each before the one it follows."""
        figure = Figure(figsize=(self.size[0] / DPI, self.size[1] / DPI), dpi=DPI)
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        half = camera.half_height
        axes.set_xlim(-half * camera.aspect, half * camera.aspect)
        axes.set_ylim(-half, half)
        for order, drawing in enumerate(layers):
            self._add(axes, drawing, camera, colour_scale, order)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()

    def _add(
        self, axes: Axes, drawing: Drawing, camera: Camera, colour_scale: ColourScale, order: int
    ) -> None:
        """Put a drawing before those of lower order."""
        _add_polygons(
            axes, [self._polygons(s, camera, colour_scale) for s in drawing.surfaces], order
        )
        for lines in drawing.lines:
            flat = camera.flat(lines.ends.reshape(-1, 3))[:, :2].reshape(-1, 2, 2)
            colour = (
                lines.colour if lines.values is None else colour_scale.colours(lines.values) / 255
            )
            widths = lines.width
            axes.add_collection(
                LineCollection(list(flat), colors=colour, linewidths=widths, zorder=order + 0.5)
            )
        # a dot as large as paint_vtk.py draws it, its width in points of 1/72 inch
        size = 2.0 * camera.dot / (2.0 * camera.half_height) * self.size[1] / DPI * 72.0
        for dots in drawing.dots:
            flat = camera.flat(dots.points)
            x, y, layer = flat[:, 0], flat[:, 1], order + 0.6
            axes.plot(x, y, "o", color=dots.colour, markersize=size, zorder=layer)

    def close(self) -> None:
        """Nothing is kept open."""

    def _polygons(self, surface: Surface, camera: Camera, colour_scale: ColourScale) -> Polygons:
        surface = surface.seen_from(camera.towards)
        flat = camera.flat(surface.points)[surface.corners]
        palette = np.array([rgb(colour) for colour in surface.colours])
        colours = palette[surface.which]
        if surface.values is not None:
            colours = colour_scale.colours(surface.values)
        one, other = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
        normal = np.cross(one, other)
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        lit = 0.45 + 0.55 * np.abs(normal @ LIGHT)
        if surface.is_flat:
            lit[:] = 1.0
        return flat[:, :, 2].mean(axis=1), flat[:, :, :2], colours * lit[:, None] / 255.0


def _add_polygons(axes: Axes, pieces: list[Polygons], zorder: int) -> None:
    """All polygons in one order from far to near."""
    if not pieces:
        return
    depth = np.concatenate([piece[0] for piece in pieces])
    colours = np.clip(np.concatenate([piece[2] for piece in pieces]), 0.0, 1.0)
    corners = [polygon for piece in pieces for polygon in piece[1]]
    order = np.argsort(depth, kind="stable")
    collection = PolyCollection(
        [corners[k] for k in order],
        facecolors=colours[order],
        edgecolors=colours[order],
        linewidths=0.3,
        zorder=zorder,
    )
    axes.add_collection(collection)
