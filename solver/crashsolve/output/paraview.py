"""The script beside the results that opens them in ParaView ready to play.

    paraview --script=RESULTS/view_in_paraview.py
    pvpython --force-offscreen-rendering RESULTS/view_in_paraview.py PICTURE.png [TIME]

It is written for ParaView 5.10 and later, and needs nothing but ParaView.
"""

import json
from typing import Any

from crashsolve.output.blocks import Block

NAME = "view_in_paraview.py"

TEMPLATE = '''\
"""Opens this run in ParaView: moved, beams as tubes, bodies by name, arrows for contact forces.

    paraview --script=view_in_paraview.py
    pvpython --force-offscreen-rendering view_in_paraview.py PICTURE.png [TIME]
"""

import os
import sys

from paraview.simple import *  # noqa: F403

BLOCKS = @BLOCKS@
BODIES = @BODIES@
UP = @UP@
COLOURS = [
    (0.00, 0.45, 0.70), (0.90, 0.62, 0.00), (0.34, 0.71, 0.91), (0.80, 0.47, 0.65),
    (0.00, 0.62, 0.45), (0.94, 0.89, 0.26), (0.84, 0.37, 0.00),
]

folder = os.path.dirname(os.path.abspath(__file__))
reader = XDMFReader(FileNames=[os.path.join(folder, "states.xdmf")])
reader.UpdatePipelineInformation()
RenameSource("states", reader)
view = GetActiveViewOrCreate("RenderView")
view.OrientationAxesVisibility = 1
# the first reader of a session plays its own times
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()


def moved(block):
    """A block where it is at each time."""
    part = ExtractBlock(Input=reader)
    if hasattr(part, "Selectors"):
        part.Selectors = ["/Root/" + block]
    else:
        part.BlockIndices = [1 + BLOCKS.index(block)]
    RenameSource(block, part)
    surface = MergeBlocks(Input=part, MergePoints=0)
    warped = WarpByVector(Input=surface, Vectors=["POINTS", "displacement"])
    RenameSource(block + ", moved", warped)
    return warped


def by_body(shown):
    """Colours by the names of the bodies."""
    ColorBy(shown, ("CELLS", "body"))
    table = GetColorTransferFunction("body")
    table.InterpretValuesAsCategories = 1
    table.AnnotationsInitialized = 1
    table.Annotations = [word for k, name in enumerate(BODIES) for word in (str(k), name)]
    table.IndexedColors = [x for k in range(len(BODIES)) for x in COLOURS[(k - 1) % len(COLOURS)]]
    table.IndexedOpacities = [1.0] * len(BODIES)


length = 1.0
for name in BLOCKS:
    if name in ("contacts", "mass_centres"):
        continue
    source = moved(name)
    if name == "beams":
        points = CellDatatoPointData(Input=source, PassCellData=1)
        source = Tube(Input=ExtractSurface(Input=points), Scalars=["POINTS", "radius"])
        source.VaryRadius = "By Absolute Scalar"
        RenameSource("beams, as tubes", source)
    shown = Show(source, view)
    if name in ("bodies", "links"):
        by_body(shown)
        # a legend of a hundred names covers the view
        shown.SetScalarBarVisibility(view, len(BODIES) <= 20)
    elif name == "ground":
        shown.ColorArrayName = ["POINTS", ""]
        shown.DiffuseColor, shown.AmbientColor = [0.85, 0.83, 0.78], [0.85, 0.83, 0.78]
    else:
        shown.ColorArrayName = ["POINTS", ""]
    if name in ("springs", "links"):
        shown.LineWidth = 3.0
    if name.startswith("part_"):
        shown.Representation = "Surface With Edges"
    if name != "ground":
        x0, x1, y0, y1, z0, z1 = source.GetDataInformation().GetBounds()
        length = max(length if length != 1.0 else 0.0, x1 - x0, y1 - y0, z1 - z0)

if "contacts" in BLOCKS:
    source = moved("contacts")
    largest = 0.0
    for time in reader.TimestepValues:
        source.UpdatePipeline(time)
        data = source.GetPointDataInformation().GetArray("force")
        largest = max(largest, data.GetRange(-1)[1] if data else 0.0)
    arrows = Glyph(Input=source, GlyphType="Arrow")
    arrows.OrientationArray = ["POINTS", "force"]
    arrows.ScaleArray = ["POINTS", "force"]
    arrows.ScaleFactor = 0.2 * length / largest if largest else 1.0
    arrows.GlyphMode = "All Points"
    RenameSource("contact forces", arrows)
    shown = Show(arrows, view)
    shown.ColorArrayName = ["POINTS", ""]
    shown.DiffuseColor, shown.AmbientColor = [0.70, 0.20, 0.12], [0.70, 0.20, 0.12]

scene.GoToFirst()
ahead = [1.0, 0.0, 0.0] if abs(UP[0]) < 0.7 else [0.0, 0.0, 1.0]
near = [
    ahead[1] * UP[2] - ahead[2] * UP[1],
    ahead[2] * UP[0] - ahead[0] * UP[2],
    ahead[0] * UP[1] - ahead[1] * UP[0],
]
view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraPosition = [0.55 * a + n + 0.5 * u for a, n, u in zip(ahead, near, UP)]
view.CameraViewUp = UP
ResetCamera(view)
Render(view)
if len(sys.argv) > 1 and sys.argv[1].endswith(".png"):
    if len(sys.argv) > 2:
        view.ViewTime = float(sys.argv[2])
        scene.AnimationTime = float(sys.argv[2])
    Render(view)
    SaveScreenshot(sys.argv[1], view, ImageResolution=[1280, 720])
'''


def script(blocks: tuple[Block, ...], description: dict[str, Any]) -> str:
    """The text of the script for a run's blocks and names."""
    names = [block.name for block in blocks]
    bodies = description.get("names", {}).get("bodies", [])
    return (
        TEMPLATE.replace("@BLOCKS@", json.dumps(names))
        .replace("@BODIES@", json.dumps(bodies))
        .replace("@UP@", json.dumps(description.get("up", [0.0, 0.0, 1.0])))
    )
