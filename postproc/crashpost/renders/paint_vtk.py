"""Paints drawings with VTK, off-screen. Only a child process imports this: see painting.py."""

from collections.abc import Sequence

import numpy as np
import pyvista

# all of vtk would take 75 MB more; this module draws
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkMapper,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

from crashpost.renders.camera import Camera
from crashpost.renders.colour_scale import ColourScale, rgb
from crashpost.renders.shapes import Drawing, Surface

EDGE = "#3a424a"
# degrees between two faces that make an edge
SHARP = 40.0
# more polygons than this are drawn without their edges
MAX_EDGES = 20_000
SAMPLES = 4
# layers of a window: a later one hides those before
LAYERS = 4


class Painter:
    """A window of fixed size into which drawings are painted one after the other."""

    def __init__(self, width: int, height: int) -> None:
        vtkObject.GlobalWarningDisplayOff()
        # lines on a surface are seen whole
        vtkMapper.SetResolveCoincidentTopologyToPolygonOffset()
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(True)
        self.window.SetSize(width, height)
        self.window.SetMultiSamples(SAMPLES)
        self.window.SetNumberOfLayers(LAYERS)
        self.renderers = []
        for layer in range(LAYERS):
            renderer = vtkRenderer()
            renderer.SetLayer(layer)
            renderer.SetBackground(1.0, 1.0, 1.0)
            self.window.AddRenderer(renderer)
            self.renderers.append(renderer)

    def paint(
        self, layers: Sequence[Drawing], camera: Camera, colour_scale: ColourScale
    ) -> np.ndarray:
        """The picture (height, width, 3) of drawings, each before the one it follows."""
        for k, renderer in enumerate(self.renderers):
            renderer.RemoveAllViewProps()
            if k < len(layers):
                self._fill(renderer, layers[k], camera, colour_scale)
            self._look(renderer, camera)
        self.window.Render()
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.ShouldRerenderOff()
        grab.Update()
        image = grab.GetOutput()
        width, height, _ = image.GetDimensions()
        pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)
        return pixels[::-1, :, :3].copy()

    def close(self) -> None:
        self.window.Finalize()

    def _fill(
        self, renderer: vtkRenderer, drawing: Drawing, camera: Camera, colour_scale: ColourScale
    ) -> None:
        surfaces = [surface.seen_from(camera.towards) for surface in drawing.surfaces]
        for surface in (s for s in surfaces if len(s.corners)):
            self._surface(renderer, surface, colour_scale)
        for lines in drawing.lines:
            colours = None if lines.values is None else colour_scale.colours(lines.values)
            if len(lines.ends):
                mesh = segments(lines.ends)
                _add(renderer, mesh, colours, lines.colour, width=2.0 * lines.width)
        ball = pyvista.Sphere(radius=camera.dot)
        for dots in drawing.dots:
            balls = pyvista.PolyData(dots.points).glyph(geom=ball, scale=False, orient=False)
            _add(renderer, balls, None, dots.colour, is_lit=True)

    def _surface(self, renderer: vtkRenderer, surface: Surface, colour_scale: ColourScale) -> None:
        mesh = polygons(surface.points, surface.corners)
        palette = np.array([rgb(colour) for colour in surface.colours])
        colours = palette[surface.which]
        if surface.values is not None:
            colours = colour_scale.colours(surface.values)
        mesh.cell_data["colour"] = colours.astype(np.uint8)
        if surface.is_flat:
            _add(renderer, mesh, colours, "")
            return
        if surface.edges:
            actor = _add(renderer, mesh, colours, "", is_lit=True)
            if len(surface.corners) <= MAX_EDGES:
                actor.GetProperty().EdgeVisibilityOn()
                actor.GetProperty().SetEdgeColor(*(rgb(EDGE) / 255.0))
                actor.GetProperty().SetLineWidth(0.5)
                actor.GetProperty().SetEdgeOpacity(0.5)
            return
        # round shapes look round; edges are those that turn by more
        mesh = mesh.compute_normals(split_vertices=True, feature_angle=SHARP, cell_normals=False)
        edges = mesh.extract_feature_edges(
            SHARP, boundary_edges=True, non_manifold_edges=False, manifold_edges=False
        )
        if edges.n_cells:
            _add(renderer, edges, None, EDGE)
        _add(renderer, mesh, mesh.cell_data["colour"], "", is_lit=True)

    def _look(self, renderer: vtkRenderer, camera: Camera) -> None:
        view = renderer.GetActiveCamera()
        far = 10.0 * camera.half_height * (1.0 + camera.aspect)
        view.ParallelProjectionOn()
        view.SetFocalPoint(*camera.middle)
        view.SetPosition(*(camera.middle + far * camera.towards))
        view.SetViewUp(*camera.up)
        view.SetParallelScale(camera.half_height)
        renderer.ResetCameraClippingRange()


def _add(
    renderer: vtkRenderer,
    mesh: pyvista.PolyData,
    colours: np.ndarray | None,
    colour: str,
    *,
    width: float = 1.0,
    opacity: float = 1.0,
    is_lit: bool = False,
) -> vtkActor:
    """Put a mesh of one colour, or of one (0 to 255) for each cell, into a layer."""
    mapper = vtkPolyDataMapper()
    if colours is not None:
        mesh.cell_data["colour"] = np.asarray(colours).astype(np.uint8)
        mapper.SetScalarModeToUseCellFieldData()
        mapper.SelectColorArray("colour")
        mapper.SetColorModeToDirectScalars()
    else:
        mapper.ScalarVisibilityOff()
    mapper.SetInputData(mesh)
    actor = vtkActor()
    actor.SetMapper(mapper)
    appearance = actor.GetProperty()
    if colours is None:
        appearance.SetColor(*(rgb(colour) / 255.0))
    appearance.SetLineWidth(width)
    appearance.SetOpacity(opacity)
    appearance.SetLighting(is_lit)
    appearance.SetAmbient(0.28)
    appearance.SetDiffuse(0.75)
    renderer.AddActor(actor)
    return actor


def polygons(points: np.ndarray, corners: np.ndarray) -> pyvista.PolyData:
    """A mesh of polygons with one number of corners."""
    count = np.full((len(corners), 1), corners.shape[1])
    return pyvista.PolyData(points, np.hstack([count, corners]).ravel())


def segments(ends: np.ndarray) -> pyvista.PolyData:
    """A mesh of lines (n, 2, 3)."""
    corners = np.arange(2 * len(ends)).reshape(-1, 2)
    cells = np.hstack([np.full((len(ends), 1), 2), corners]).ravel()
    return pyvista.PolyData(ends.reshape(-1, 3), lines=cells)
