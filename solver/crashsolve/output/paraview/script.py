"""The script beside the results that opens them in ParaView ready to play.

    paraview --script=RESULTS/view_in_paraview.py
    pvpython RESULTS/view_in_paraview.py PICTURE.png [TIME]

Debian's ParaView draws on a display alone; without one begin with
`xvfb-run -s '-screen 0 1280x1024x24 -noreset' pvpython`.
It is written for ParaView 5.10 and later, and needs nothing but ParaView.
"""

import json

from crashsolve.output.blocks import Block
from crashsolve.output.files import Json

NAME = "view_in_paraview.py"

TEMPLATE = '''\
"""Opens this run in ParaView: moved, beams as tubes, bodies by name, arrows for contact forces.

    paraview --script=view_in_paraview.py
    pvpython view_in_paraview.py PICTURE.png [TIME]
"""

import os
import sys

from paraview import servermanager
from paraview.simple import *  # noqa: F403

BLOCKS = @BLOCKS@
BODIES = @BODIES@
UP = @UP@
COLOURS = [
    (0.00, 0.45, 0.70), (0.90, 0.62, 0.00), (0.34, 0.71, 0.91), (0.80, 0.47, 0.65),
    (0.00, 0.62, 0.45), (0.94, 0.89, 0.26), (0.84, 0.37, 0.00),
]
BLACK, WHITE, GROUND, FORCE = [0.0] * 3, [1.0] * 3, [0.85, 0.83, 0.78], [0.70, 0.20, 0.12]
# what elements are coloured by, the first of these that they have
FIELDS = ("plastic_strain", "plastic_strain_mid", "von_mises")
# a legend of a hundred names covers the view
LONGEST_LEGEND = 20
PICTURE = sys.argv[1] if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else ""

folder = os.path.dirname(os.path.abspath(__file__))
reader = XDMFReader(FileNames=[os.path.join(folder, "states.xdmf")])
reader.UpdatePipelineInformation()
TIMES = list(reader.TimestepValues)
RenameSource("states", reader)
view = GetActiveViewOrCreate("RenderView")
if PICTURE:
    # the window of ParaView keeps the size it has
    view.ViewSize = [1280, 720]
view.UseColorPaletteForBackground, view.Background = 0, WHITE
view.OrientationAxesVisibility, view.OrientationAxesLabelColor = 1, BLACK
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


def tubes(beams):
    """Beams as tubes with the radius of their sections."""
    points = CellDatatoPointData(Input=beams, PassCellData=1)
    tube = Tube(Input=ExtractSurface(Input=points), Scalars=["POINTS", "radius"])
    tube.VaryRadius = "By Absolute Scalar"
    RenameSource("beams, as tubes", tube)
    return tube


def plain(shown, colour):
    """One colour for all."""
    shown.ColorArrayName = ["POINTS", ""]
    shown.DiffuseColor = shown.AmbientColor = colour


def legend(shown, table, bottom, height):
    """A legend at the right of the view, in black; bottom and height in shares of the view's."""
    bar = GetScalarBar(table, view)
    bar.AutoOrient, bar.Orientation, bar.WindowLocation = 0, "Vertical", "Any Location"
    bar.Position, bar.ScalarBarLength, bar.ScalarBarThickness = [0.85, bottom], height, 14
    bar.TitleFontSize = bar.LabelFontSize = 14
    bar.TitleColor = bar.LabelColor = BLACK
    shown.SetScalarBarVisibility(view, True)


def bodies_of(block):
    """Numbers of the bodies that a block draws."""
    data = servermanager.Fetch(block).GetCellData().GetArray("body")
    return {int(data.GetValue(k)) for k in range(data.GetNumberOfTuples())}


def by_body(shown, numbers):
    """Colours by the names of these bodies."""
    ColorBy(shown, ("CELLS", "body"))
    table = GetColorTransferFunction("body")
    table.InterpretValuesAsCategories = 1
    table.AnnotationsInitialized = 1
    table.Annotations = [word for k in numbers for word in (str(k), BODIES[k])]
    table.IndexedColors = [x for k in numbers for x in COLOURS[(k - 1) % len(COLOURS)]]
    table.IndexedOpacities = [1.0] * len(numbers)
    if len(numbers) <= LONGEST_LEGEND:
        height = 0.04 * len(numbers)
        legend(shown, table, 0.92 - height, height)
    else:
        shown.SetScalarBarVisibility(view, False)


def by_field(shown, field, largest):
    """Colours by a field of elements, from zero to its largest value in the run."""
    ColorBy(shown, ("CELLS", field))
    table = GetColorTransferFunction(field)
    table.ApplyPreset("Viridis (matplotlib)", True)
    table.RescaleTransferFunction(0.0, largest or 1.0)
    # light where nothing has happened
    table.InvertTransferFunction()
    legend(shown, table, 0.06, 0.35)


def largest_of(source, where, field):
    """The largest value of a field, or size of its vectors, of all times."""
    largest = 0.0
    for time in TIMES:
        source.UpdatePipeline(time)
        data = getattr(source, where).GetArray(field)
        if data:
            largest = max(largest, data.GetRange(-1 if data.GetNumberOfComponents() > 1 else 0)[1])
    return largest


def bounds_of(source):
    """The box that holds a block at the start and at the end."""
    boxes = []
    for time in (TIMES[0], TIMES[-1]):
        source.UpdatePipeline(time)
        boxes.append(source.GetDataInformation().GetBounds())
    return [(min if k % 2 == 0 else max)(box[k] for box in boxes) for k in range(6)]


sources = {name: moved(name) for name in BLOCKS if name != "mass_centres"}
largest = {}
for name in [name for name in sources if name == "beams" or name.startswith("part_")]:
    field = next((f for f in FIELDS if f in sources[name].CellData.keys()), "")
    if field:
        largest[name] = field, largest_of(sources[name], "CellData", field)
peak = {field: max(v for f, v in largest.values() if f == field) for field, _ in largest.values()}
named = set()
for name in ("bodies", "links"):
    named |= bodies_of(sources[name]) if name in sources else set()
box = []
for name, source in sources.items():
    if name == "contacts":
        continue
    shown = Show(tubes(source) if name == "beams" else source, view)
    if name in ("bodies", "links"):
        by_body(shown, sorted(named))
    elif name in largest:
        by_field(shown, largest[name][0], peak[largest[name][0]])
    else:
        plain(shown, GROUND if name == "ground" else [0.45] * 3)
    if name in ("springs", "links"):
        shown.LineWidth = 3.0
    if name.startswith("part_"):
        shown.Representation, shown.EdgeColor = "Surface With Edges", [0.35] * 3
    if name != "ground":
        own = bounds_of(source)
        box = [(min if k % 2 == 0 else max)(own[k], (box or own)[k]) for k in range(6)]

if "contacts" in sources:
    source = sources["contacts"]
    force = largest_of(source, "PointData", "force")
    length = max(box[k + 1] - box[k] for k in (0, 2, 4)) if box else 1.0
    arrows = Glyph(Input=source, GlyphType="Arrow")
    arrows.OrientationArray = ["POINTS", "force"]
    arrows.ScaleArray = ["POINTS", "force"]
    arrows.ScaleFactor = 0.2 * length / force if force else 1.0
    arrows.GlyphMode = "All Points"
    RenameSource("contact forces", arrows)
    plain(Show(arrows, view), FORCE)

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
if box:
    view.SMProxy.ResetCamera(box)
Render(view)
if PICTURE:
    if len(sys.argv) > 2:
        view.ViewTime = scene.AnimationTime = float(sys.argv[2])
    Render(view)
    SaveScreenshot(PICTURE, view, ImageResolution=[1280, 720])
'''


def script(blocks: tuple[Block, ...], description: Json) -> str:
    """The text of the script for a run's blocks and names."""
    names = [block.name for block in blocks]
    bodies = description.get("names", {}).get("bodies", [])
    return (
        TEMPLATE.replace("@BLOCKS@", json.dumps(names))
        .replace("@BODIES@", json.dumps(bodies))
        .replace("@UP@", json.dumps(description.get("up", [0.0, 0.0, 1.0])))
    )
